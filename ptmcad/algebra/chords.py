"""Branches of a plane curve near a point and over a short interval: on which side of a line, how
steep, and where they have a given direction.

Guarantee: answers of `side_of_chord` are proved; enclosures of slopes contain them for every
abscissa of the panel; None means not proved. No point of the curve off the real roots of
`tangent_resultant` has the direction.

A chord starts at a point (u0, v0) of the curve p = 0, u0 rational, v0 algebraic: v = v0 + s
(u - u0). The coefficients of p(u0 + t, v0 + s t) by powers of t are polynomials in v0; which of
them vanish is decided by its minimal polynomial. Divided by the power of t that is common to them,
the polynomial has a proved sign on [0, d] when a ball evaluation excludes zero on each piece of it.
So the branch does not meet the chord there, even if the start is a singular point.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import (
    Ordering,
    arb,
    arb_poly,
    ctx,
    fmpq,
    fmpq_mpoly_ctx,
    fmpq_poly,
    fmpz_poly,
)

from ptmcad.algebra.polynomials import Coefficient, coefficients_in, local_coefficients
from ptmcad.algebra.real_roots import RealRoot, avoids, refine, squarefree_part
from ptmcad.algebra.resultants import resultant

_TWO: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(("v", "t"), Ordering.degrevlex)
_DEPTH = 12
"""Halvings of the interval in which a sign is proved."""
_BITS = 256


def side_of_chord(
    in_v: Sequence[fmpz_poly], start: fmpq, origin: RealRoot, slope: fmpq, length: fmpq
) -> bool:
    """Whether p is proved to have no zero on the chord, but for its start.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    start : u0.
    origin : v0, a root of an irreducible polynomial.
    length : the chord goes from u0 to u0 + length (negative: to the left), its end included.
    """
    v, t = _TWO.gens()
    along = v + t * slope
    u = t + start
    total = _TWO.constant(0)
    for row_in_u in reversed(in_v):
        value = _TWO.constant(0)
        for d in reversed(row_in_u.coeffs()):
            value = value * u + fmpq(d)
        total = total * along + value
    rows: dict[int, dict[int, fmpq]] = {}
    for (i, k), c in total.terms():
        rows.setdefault(int(k), {})[int(i)] = c
    minimal = fmpq_poly(origin.polynomial.coeffs())
    coefficients: list[arb] = []
    with ctx.workprec(_BITS):
        ball = refine(origin, fmpq(1, 2**_BITS)).ball
        for k in range(max(rows, default=-1) + 1):
            row = rows.get(k, {})
            rest = (
                fmpq_poly([row.get(i, fmpq(0)) for i in range(max(row, default=-1) + 1)]) % minimal
            )
            if coefficients or rest:  # what vanishes at first vanishes exactly
                coefficients.append(arb_poly(rest)(ball))
        return bool(coefficients) and _no_zero(arb_poly(coefficients), fmpq(0), length, _DEPTH)


def _no_zero(p: arb_poly, low: fmpq, high: fmpq, depth: int) -> bool:
    if avoids(p, low, high):
        return True
    if depth == 0:
        return False
    middle = (low + high) / 2
    return _no_zero(p, low, middle, depth - 1) and _no_zero(p, middle, high, depth - 1)


def slope_over(
    in_v: Sequence[fmpz_poly], at_middle: RealRoot, middle: fmpq, radius: fmpq
) -> tuple[arb, arb] | None:
    """Enclosures of a branch's first and second derivative for every u in [middle - radius,
    middle + radius].

    Parameters
    ----------
    at_middle : the branch's value at the middle, isolated among the roots of p(middle, v).

    Notes
    -----
    With p(m + r h, v0 + w) = sum b_i(h) w^i let |p_v| >= D > 0 and |p(., v0)| <= e where |h| <= 1,
    |w| <= R, with e <= D R. Then for each h there is exactly one root |w| <= R, it lies within e/D,
    and at h = 0 it is the branch.
    """
    with ctx.workprec(_BITS):
        root = refine(at_middle, radius / 2**40)
        local = local_coefficients(in_v, middle, radius, root.low)
        norms = [sum((abs(c) for c in b.coeffs()), arb(0)) for b in local]
        spread = norms[1] - abs(local[1][0])
        reach = arb(root.high - root.low)
        for _ in range(60):
            higher, power = arb(0), reach
            for i in range(2, len(local)):
                higher, power = higher + i * norms[i] * power, power * reach
            least = (abs(local[1][0]) - spread - higher).lower()
            if not least > 0:
                return None
            near = (norms[0] / least).upper()
            if near <= reach and arb(root.high - root.low) <= reach:
                break
            reach = (2 * near + arb(root.high - root.low)).upper()
        else:
            return None
        w = near * arb(0, 1)
        unit = arb(0, 1)
        scale = 1 / arb(radius)
        by_h = [b.derivative() for b in local]
        by_hh = [b.derivative() for b in by_h]

        def value(rows: Sequence[arb_poly]) -> arb:
            total = arb(0)
            for b in reversed(rows):
                total = total * w + b(unit)
            return total

        def by_w(rows: Sequence[arb_poly]) -> list[arb_poly]:
            return [b * i for i, b in enumerate(rows)][1:]

        p_v, p_u = value(by_w(local)), value(by_h) * scale
        first = -p_u / p_v
        p_vv, p_uv, p_uu = (
            value(by_w(by_w(local))),
            value(by_w(by_h)) * scale,
            value(by_hh) * scale * scale,
        )
        second = -(p_vv * first * first + 2 * p_uv * first + p_uu) / p_v
        return (first, second) if first.is_finite() and second.is_finite() else None


Direction = tuple[int, int]
"""(dx, dy), not both zero: (1, 0) is horizontal, where the curve folds over the y-axis."""


def tangent_resultant(p: Coefficient, direction: Direction) -> fmpz_poly:
    """The squarefree polynomial in y that vanishes where p = 0 has such a (complex) point or a
    singular one.

    Raises
    ------
    ArithmeticError
        When there are infinitely many: the curve contains a line of that direction, or a multiple
        component.
    """
    tangent = p.derivative(0) * direction[0] + p.derivative(1) * direction[1]
    eliminated = resultant(coefficients_in(p, 0), coefficients_in(tangent, 0))
    if not eliminated:
        raise ArithmeticError("the curve contains a line of the direction, or a multiple component")
    return squarefree_part(eliminated)
