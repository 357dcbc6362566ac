"""Checks of the components that are left out: they have no point in the open window, or no real
count feels them.

Guarantee: the first is exact, the second up to the probability of `ptmcad.verification.variety`,
which checks it. Signs of coefficients on boxes prove most of the first; what they do not settle is
settled by Sturm counts over a point in each interval that the curve's discriminant and edge values
leave, and over its roots, where isolated points would be.
"""

from __future__ import annotations

from flint import fmpq, fmpq_poly, fmpz_poly

from ptmcad.answer.regionmap import HARMLESS, NO_POINT, CriticalValue, Kind
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.verification.claims import Claims, PlaneCurve, short
from ptmcad.verification.heights import Heights
from ptmcad.verification.report import Violation
from ptmcad.verification.structure import projection_of_one
from ptmcad.verification.sturm import isolating_intervals, roots_between, separated_points

BOXES = 600
"""Boxes into which the window may be cut before the algebraic way is taken."""
HALVINGS = 4
"""Times that the window's sides are halved before a curve may be used although it has no point in
the window.
"""


RUNS = "runs through the window"
Interval = tuple[fmpq, fmpq]


def check_left_out(claims: Claims) -> str:
    """A component that is left out has no point in the open window, or is checked with the variety."""
    result = claims.result
    number = 0
    for n, c in enumerate(result.components):
        if not c.left_out or (c.left_out == HARMLESS and c.kind is Kind.INFINITY):
            continue
        if c.left_out != NO_POINT:
            raise Violation(
                f"component {n} is left out for a reason that cannot be checked: {c.left_out[:60]}"
            )
        number += 1
        curve = PlaneCurve.of(n, c.polynomial, result.base)
        if min(curve.degrees) > 0 and _nowhere_zero(curve, claims.base, claims.height):
            continue
        hit = point_in_window(curve, claims.base, claims.height)
        if hit is not None:
            raise Violation(
                f"component {n} is left out, but {hit}: {c.polynomial.text(result.slice.axis_names)[:60]}"
            )
    return f"{number} components"


def point_in_window(
    curve: PlaneCurve, base: Interval, height: Interval, isolated: bool = True
) -> str | None:
    """What is known of a point of the curve in the open window; None when there is none.

    Parameters
    ----------
    isolated : whether points through which it does not run are asked for, too.
    """
    if curve.degrees[1] == 0:
        return RUNS if roots_between(curve.in_v[0], *base) else None
    if curve.degrees[0] == 0:
        return RUNS if roots_between(curve.in_u[0], *height) else None
    product = fmpz_poly([1])
    singular = []
    for f, origin in projection_of_one(curve, height):
        product = product * (f // f.gcd(product))
        if "edge" not in origin:
            singular.append(f)
    if any(roots_between(curve.over(u), *height) for u in separated_points(product, *base)):
        return RUNS
    # no branch runs through the window; what is left are isolated points, over roots of the
    # discriminant
    for f in singular if isolated else ():
        for a, b in isolating_intervals(f, *base):
            place = CriticalValue(
                tuple(int(c) for c in f.coeffs()), to_fraction(a), to_fraction(b), ""
            )
            if Heights((curve,), place).between(*height):
                return f"it has an isolated point near {short(a)}"
    return None


def _nowhere_zero(curve: PlaneCurve, base: Interval, height: Interval) -> bool:
    """Whether the curve is proved to have no point in the open window; False may mean undecided.

    With u = (a + b x)/(1 + x), v = (c + d y)/(1 + y) an open box becomes the quadrant x, y > 0, on
    which a polynomial whose coefficients have one sign has no zero. A box that is not settled is
    cut in four; Sturm settles the cuts.
    """
    waiting, done = [(*base, *height)], 0
    rows = [fmpq_poly(row) for row in curve.in_v]
    while waiting:
        done += 1
        a, b, c, d = waiting.pop()
        if _one_sign(rows, curve.degrees[0], (a, b), (c, d)):
            continue
        u, v = (a + b) / 2, (c + d) / 2
        if (
            done > BOXES
            or roots_between(curve.over(u), c, d)
            or roots_between(curve.along(v), a, b)
        ):
            return False
        waiting += [(a, u, c, v), (u, b, c, v), (a, u, v, d), (u, b, v, d)]
    return True


def plainly_outside(curve: PlaneCurve, claims: Claims) -> bool:
    """Whether few signs show that the curve has no point in the open window: those for which it has
    to be left out.

    A curve in one variable is decided by its roots; another one is asked for on the window and on
    what halving both sides up to `HALVINGS` times makes of it, with constant terms then.
    """
    if curve.degrees[1] == 0:
        return not roots_between(curve.in_v[0], *claims.base)
    if curve.degrees[0] == 0:
        return not roots_between(curve.in_u[0], *claims.height)
    rows = [fmpq_poly(row) for row in curve.in_v]
    if _one_sign(rows, curve.degrees[0], claims.base, claims.height):
        return True
    waiting = [(0, claims.base, claims.height)]
    while waiting:
        halved, (a, b), (c, d) = waiting.pop()
        if _one_sign(rows, curve.degrees[0], (a, b), (c, d), strict=True):
            continue
        if halved == HALVINGS or curve.over(a)(c) * curve.over(b)(d) <= 0:
            return False
        u, v = (a + b) / 2, (c + d) / 2
        waiting += [
            (halved + 1, base, height) for base in ((a, u), (u, b)) for height in ((c, v), (v, d))
        ]
    return True


def _one_sign(
    rows: list[fmpq_poly],
    degree: int,
    base: tuple[fmpq, fmpq],
    height: tuple[fmpq, fmpq],
    strict: bool = False,
) -> bool:
    lines = [_on_half_line(row, degree, base) for row in rows]
    signs = set()
    for i in range(degree + 1):
        column = _on_half_line(fmpq_poly([line[i] for line in lines]), len(rows) - 1, height)
        signs |= {
            (c > 0) - (c < 0) for c in (column[j] for j in range(len(rows))) if strict or c != 0
        }
        if len(signs) > 1:
            return False
    return 0 not in signs


def _on_half_line(p: fmpq_poly, degree: int, interval: tuple[fmpq, fmpq]) -> fmpq_poly:
    """(1 + x)^degree p((low + high x)/(1 + x)): its values for x > 0 are those of p in the
    interval, times a power.
    """
    low, high = interval
    on_unit = p(fmpq_poly([low, high - low]))  # p(low + (high - low) z), z = x/(1 + x)
    reversed_ = fmpq_poly(
        [on_unit[degree - i] for i in range(degree + 1)]
    )  # (1 + x)^degree q(x/(1+x)) = x^degree r(1 + 1/x)
    shifted = reversed_(fmpq_poly([1, 1]))
    return fmpq_poly([shifted[degree - i] for i in range(degree + 1)])
