"""Branches of a plane curve near a point and over a short interval: on which side of a line, how
steep, where they have a given direction, and between which parabolic arcs.

Guarantee: answers of `side_of_chord` are proved; enclosures of slopes contain them for every
abscissa of the panel, and those of integrals the integral; None means not proved. No point of the
curve off the real roots of `tangent_resultant` has the direction.

A chord starts at a point (u0, v0) of the curve p = 0, u0 rational, v0 algebraic: v = v0 + s
(u - u0). The coefficients of p(u0 + t, v0 + s t) by powers of t are polynomials in v0; which of
them vanish is decided by its minimal polynomial. Divided by the power of t that is common to them,
the polynomial has a proved sign on [0, d] when a ball evaluation excludes zero on each piece of it.
So the branch does not meet the chord there, even if the start is a singular point.

Over a panel without turning points a branch is a continuous graph. If it runs between z - d and
z + d at one place of the panel, and the curve meets neither of these two arcs over the panel, then
it runs between them everywhere. Nothing is asked of the other branches: many may lie in the same
tube, at any distance from each other, where a Taylor series of one of them would need hundreds of
bits to distinguish them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

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
from ptmcad.algebra.real_roots import (
    Interval,
    RealRoot,
    avoids,
    has_root_between,
    refine,
    squarefree_part,
)
from ptmcad.algebra.resultants import resultant

_TWO: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(("v", "t"), Ordering.degrevlex)
_DEPTH = 12
"""Halvings of the interval in which a sign is proved."""
_BITS = 256
NODES = (fmpq(-7, 8), fmpq(0), fmpq(7, 8))
"""Where the arc meets the branch, on the panel as [-1, 1]."""
PROBE = fmpq(-1, 2)
"""Where its distance from the branch is measured, which shows how wide the tube has to be about."""
ARC_BITS = 7
"""The branch is isolated this much finer than the height is wanted."""
TUBES = (2, 8, 64)
"""Widths of the tubes that are tried, in units of that distance."""


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


def arc_integral(
    in_v: Sequence[fmpz_poly],
    branch: Callable[[fmpq], RealRoot],
    middle: fmpq,
    radius: fmpq,
    fibre: Interval,
    wanted: fmpq,
) -> arb | None:
    """An enclosure of the integral of a branch over a panel.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    branch : the branch's value at a rational abscissa, isolated.
    middle, radius : of the panel, over whose interior no branches of the curve meet.
    wanted : half the width of a tube that would do; positive.

    Returns
    -------
    The enclosure, or None when no tube of those tried was proved.
    """
    unit = fmpq(2) ** (
        int(wanted.p).bit_length() - int(wanted.q).bit_length() - ARC_BITS
    )  # short, as all starts from it
    left, here, right = (_rounded(branch(middle + radius * x), unit) for x in NODES)
    slope = (right - left) / (NODES[2] - NODES[0])
    curvature = (left + right - 2 * here) / (2 * NODES[2] ** 2)
    arc = fmpq_poly([here, slope, curvature])
    miss = abs(_rounded(branch(middle + radius * PROBE), unit) - arc(PROBE)) + unit
    along = fmpq_poly([middle, radius])
    rows = [fmpq_poly(c)(along) for c in in_v]
    for tube in TUBES:
        distance = tube * miss
        if distance * 16 > fibre[1] - fibre[0]:
            return None
        if not any(
            has_root_between(on_graph(rows, arc + end), fmpq(-1), fmpq(1))
            for end in (-distance, distance)
        ):
            mean = here + curvature / 3
            return (arb(mean) + arb(distance) * arb(0, 1)) * arb(2 * radius)
    return None


def _rounded(root: RealRoot, unit: fmpq) -> fmpq:
    """A multiple of the unit within two units of the root."""
    return unit * (refine(root, unit).middle / unit).floor()


def on_graph(rows: Sequence[fmpz_poly | fmpq_poly], graph: fmpq_poly) -> fmpz_poly:
    """A positive multiple of p(u, graph(u)); zero where the graph is a part of the curve.

    Parameters
    ----------
    rows : coefficients of p as a polynomial in v.
    """
    total = fmpq_poly([0])
    for row in reversed(rows):
        total = total * graph + row
    return total.numer()


def graph_integral(in_v: Sequence[fmpz_poly], low: fmpq, high: fmpq) -> fmpq | None:
    """The integral of v over [low, high] on the curve p(u, v) = 0; None where it is not the graph
    of a polynomial in u.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    """
    if len(in_v) != 2 or in_v[1].degree() > 0:
        return None
    whole = fmpq_poly(-in_v[0]).integral()
    return (whole(high) - whole(low)) / fmpq(in_v[1][0])
