"""Checks of the components that are left out: they have no point in the open window.

Guarantee: exact. Bounds on boxes prove most of them; what they do not settle is settled by Sturm counts over a point in
each interval that the curve's discriminant and edge values leave, and by balls around what may be isolated points.
"""

from __future__ import annotations

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.regionmap import CriticalValue
from ptmcad.verification.claims import Claims, PlaneCurve, ball, fraction, short
from ptmcad.verification.report import Violation
from ptmcad.verification.structure import points_over, projection_of_one
from ptmcad.verification.sturm import isolating_intervals, points_apart, roots_between

NO_POINT = "no point in the window"
BOXES = 600
"""Boxes into which the window may be cut before the algebraic way is taken."""


def check_left_out(claims: Claims) -> str:
    """A component that is left out has no point in the open window."""
    result = claims.result
    number = 0
    for n, c in enumerate(result.components):
        if not c.left_out:
            continue
        if c.left_out != NO_POINT:
            raise Violation(f"component {n} is left out for a reason that can not be checked: {c.left_out[:60]}")
        number += 1
        hit = _point_in_window(PlaneCurve.of(n, c.polynomial, result.base), claims)
        if hit is not None:
            raise Violation(f"component {n} is left out, but {hit}: {c.polynomial.text(result.slice.axis_names)[:60]}")
    return f"{number} components"


def _point_in_window(curve: PlaneCurve, claims: Claims) -> str | None:
    """What is known of a point of the curve in the open window; None when there is none."""
    runs = "runs through the window"
    if curve.degrees[1] == 0:
        return runs if roots_between(curve.in_v[0], *claims.base) else None
    if curve.degrees[0] == 0:
        return runs if roots_between(curve.in_u[0], *claims.height) else None
    if _nowhere_zero(curve, claims):
        return None
    product = fmpz_poly([1])
    singular = []
    for f, origin in projection_of_one(curve, claims.height):
        product = product * (f // f.gcd(product))
        if "edge" not in origin:
            singular.append(f)
    if any(roots_between(curve.over(u), *claims.height) for u in points_apart(product, *claims.base)):
        return runs
    # no branch runs through the window; what is left are isolated points, over roots of the discriminant
    for f in singular:
        for a, b in isolating_intervals(f, *claims.base):
            place = CriticalValue(tuple(int(c) for c in f.coeffs()), fraction(a), fraction(b), "")
            points = points_over(curve, place)
            for c, d in isolating_intervals(points, *claims.height):
                at = CriticalValue(tuple(int(k) for k in points.coeffs()), fraction(c), fraction(d), "")
                if not _excluded(curve, place, at):
                    return f"an isolated point near {short(a)}, {short(c)} could not be excluded"
    return None


def _nowhere_zero(curve: PlaneCurve, claims: Claims) -> bool:
    """Whether the curve is proved, by bounds on boxes, to have no point in the closed window."""
    rows = [arb_poly(c) for c in curve.in_v]
    waiting, done = [(*claims.base, *claims.height)], 0
    while waiting:
        if done > BOXES:
            return False
        done += 1
        a, b, c, d = waiting.pop()
        half_u, half_v = (b - a) / 2, (d - c) / 2
        local = [row(arb_poly([a + half_u, half_u])) for row in rows]
        columns = range(max(len(row) for row in local))
        center, spread = arb(0), arb(0)
        for i in columns:
            column = arb_poly([row[i] for row in local])(arb_poly([c + half_v, half_v]))
            for j, value in enumerate(column.coeffs()):
                if i == j == 0:
                    center = value
                else:
                    spread += abs(value)
        if not abs(center) > spread:
            waiting += [(a, a + half_u, c, c + half_v), (a + half_u, b, c, c + half_v),
                        (a, a + half_u, c + half_v, d), (a + half_u, b, c + half_v, d)]  # fmt: skip
    return True


def _excluded(curve: PlaneCurve, place: CriticalValue, at: CriticalValue) -> bool:
    """Whether the curve is proved not to pass through the point with these coordinates."""
    rows = [arb_poly(c) for c in curve.in_v]
    for bits in (64, 128, 256, 512, 1024):
        with ctx.workprec(2 * bits):
            u, v = (ball(value, fmpq(1, 2**bits)) for value in (place, at))
            if not arb_poly([row(u) for row in rows])(v).contains(0):
                return True
    return False
