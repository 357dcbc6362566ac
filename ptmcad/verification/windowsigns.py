"""Signs in the open window: components that are left out have no point in it, and rational functions
are positive there.

Guarantee: exact; `Sign.PROVED` and `Sign.WRONG` are theorems. `Sign.UNCHECKED` is answered where a
function of both axes has a degree over `MAX_DEGREE`, or may be zero at an isolated point. That no
real count feels a component is checked in `ptmcad.verification.norms`.

Values in balls settle most components; others are settled by root counts over a point in each
interval that the curve's discriminant and edge values leave, and over its roots, where isolated
points would be. A function changes sign in the open window where one of its irreducible
factors of odd multiplicity does. Nothing is shared with what the engines ask
(`ptmcad.question.positivity`): no Bernstein coefficients, no Descartes' rule, another elimination.
"""

from __future__ import annotations

from enum import Enum
from itertools import product

from flint import arb, arb_poly, ctx, fmpq, fmpq_mpoly, fmpz_poly

from ptmcad.answer.regionmap import HARMLESS, NO_POINT, CriticalValue, Kind
from ptmcad.text.expressions import Expression
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.verification.claims import Claims, PlaneCurve, short
from ptmcad.verification.planecurves import factored, polynomial
from ptmcad.verification.projections import Heights, projection_of_one
from ptmcad.verification.report import Violation
from ptmcad.verification.rootcounts import (
    Interval,
    isolating_intervals,
    roots_between,
    separated_points,
)

_HALVINGS = 5
"""Times that the window's sides are halved before a curve's discriminant is asked."""
_BITS = 256

RUNS = "runs through the window"


def check_left_out(claims: Claims) -> str:
    """A component that is left out has no point in the open window, or is checked with the variety."""
    result = claims.result
    number = 0
    for n, c in enumerate(result.components):
        if c.kind is Kind.AUXILIARY:
            raise Violation(
                f"component {n} is auxiliary, but no saving was switched off that leaves it out"
            )
        if not c.left_out or (c.left_out == HARMLESS and c.kind is Kind.INFINITY):
            continue
        if c.left_out != NO_POINT:
            raise Violation(
                f"component {n} is left out for a reason that cannot be checked: {c.left_out[:60]}"
            )
        number += 1
        curve = PlaneCurve.of(n, c.polynomial, result.base)
        if _plainly_outside(curve, claims):
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


def _plainly_outside(curve: PlaneCurve, claims: Claims) -> bool:
    """Whether balls show that the curve has no point in the window: on the whole, or on the parts
    into which up to `_HALVINGS` halvings of both sides divide it.
    """
    waiting = [(0, claims.base, claims.height)]
    with ctx.workprec(_BITS):
        rows = [arb_poly(row) for row in curve.in_v]
        while waiting:
            halved, (a, b), (c, d) = waiting.pop()
            column = arb_poly([row(arb(a).union(arb(b))) for row in rows])
            if not column(arb(c).union(arb(d))).contains(0):
                continue
            if halved == _HALVINGS or curve.over(a)(c) * curve.over(b)(d) <= 0:
                return False
            u, v = (a + b) / 2, (c + d) / 2
            halves = product(((a, u), (u, b)), ((c, v), (v, d)))
            waiting += [(halved + 1, base, height) for base, height in halves]
    return True


MAX_DEGREE = 30
"""The sum of the degrees in the two axes up to which a function of both is looked at."""

Window = tuple[Interval, Interval]


class Sign(Enum):
    """What is known of a function in the window."""

    PROVED = "proved"
    WRONG = "wrong"
    UNCHECKED = "not checked"


def has_no_pole(e: Expression, window: Window) -> Sign:
    """Whether the denominator, as it is stored, has no zero in the open window."""
    denominator = polynomial(e.denominator)
    return _sign(denominator * _side(denominator, window), window, strict=True)


def is_in_domain(e: Expression, window: Window, strict: bool) -> Sign:
    """Whether a function is positive, or not negative, in the open window; it has no pole there
    where that is proved. Nothing is said of one that may have a pole.
    """
    if not e.numerator:
        return Sign.WRONG if strict else Sign.PROVED
    if has_no_pole(e, window) is not Sign.PROVED:
        return Sign.UNCHECKED
    denominator = polynomial(e.denominator)
    return _sign(polynomial(e.numerator) * _side(denominator, window), window, strict)


def _side(p: fmpq_mpoly, window: Window) -> int:
    """The sign at the window's middle, where it has one."""
    return -1 if _at(p, window, fmpq(1, 2), fmpq(1, 2)) < 0 else 1


def _sign(p: fmpq_mpoly, window: Window, strict: bool) -> Sign:
    """Whether a polynomial that is not zero is positive, or not negative, in the open window."""
    relevant = [
        PlaneCurve.of(0, f, 0) for f, multiplicity in factored(p) if strict or multiplicity % 2
    ]
    if any(min(f.degrees) > 0 and sum(f.degrees) > MAX_DEGREE for f in relevant):
        grid = [fmpq(k, 32) for k in range(1, 32)]
        values = (_at(p, window, s, t) for s in grid for t in grid)
        return Sign.WRONG if any(value < 0 for value in values) else Sign.UNCHECKED
    met = {point_in_window(f, *window, isolated=strict) for f in relevant}
    # of low degree, so that it is not zero at all of so many points
    values = (_at(p, window, fmpq(1, k), fmpq(1, m)) for k, m in product(range(2, 200), repeat=2))
    if RUNS in met or next(value for value in values if value != 0) < 0:
        return Sign.WRONG
    return Sign.PROVED if met <= {None} else Sign.UNCHECKED


def _at(p: fmpq_mpoly, window: Window, s: fmpq, t: fmpq) -> fmpq:
    """The value at shares of the window's sides."""
    (u0, u1), (v0, v1) = window
    return fmpq(p(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t))
