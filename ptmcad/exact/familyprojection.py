"""The discriminant variety of a family in three dimensions, and the values of its free parameter at
which the arrangement of its members' regions can change.

Guarantee: between neighbouring values of a complete list the members' maps are the same up to a
continuous motion that keeps the window's sides: cells, counts, what is adjacent, and in which order
regions lie along the sides.

Why. What `discriminant_variety` says of curves holds over Q(x, y, z) word for word. Surfaces at infinity are taken
by what they divide, the denominators of the multiplication matrices, unless solutions are proved to
stay regular near almost all of their points: the exceptional points form curves, which do not cut a
part of space in two.

Let the surfaces p be irreducible in Z[x, y, z], and let them be projected along v, one of x
and y, the other one being w. Let E be the curves in the plane of (z, w) that are given by the
irreducible factors of disc_v p, of res_v(p, q), of p on the window's two edges v = const, and of p
itself where v is not in it; and D the values of z that the projection of E along w gives in the
same way, together with those of points (z, w) over which a p vanishes for all v. Between values of
D, discriminants and resultants have a constant order on each graph of E, and no p vanishes
identically over a point: the known exception of McCallum's projection in three dimensions does not
occur. So the surfaces are delineable over the graphs of E and over the parts between them, and all
pieces are products with the interval of z. docs/method.md has the proof, also of why leading
coefficients are not needed.

References: McCallum, An improved projection operation for cylindrical algebraic decomposition of
three-dimensional space, J. Symb. Comp. 5 (1988); Strzebonski, J. Symb. Comp. 29 (2000).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import gcd

from ptmcad.algebra.bernstein import nowhere_zero
from ptmcad.algebra.polynomials import (
    Coefficient,
    UnivariatePolynomial,
    coefficients_in,
    irreducible_factors,
)
from ptmcad.algebra.quotient_algebra import multiples, multiplication_denominator, quotient_algebra
from ptmcad.algebra.real_roots import Interval, RealRoot
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.algebra.space import (
    Rows,
    at_value,
    common_zeros,
    discriminant,
    predicted_work,
    resultant,
    rows_in,
)
from ptmcad.exact.cad.projection import curve, deflation, predicted_cost, project
from ptmcad.exact.discriminant_variety import harmless, settles, sign_changes
from ptmcad.exact.familyvariety import FamilyVariety
from ptmcad.exact.models.system import SystemOnAxes

MAX_WORK = 5 * 10**10
"""Of all discriminants and resultants in three variables together, by `space.predicted_work`; a
minute or two.
"""
MAX_COST = 5 * 10**9
"""Of the second projection, by `projection.predicted_cost`; some minutes."""


def critical_values(
    surfaces: Sequence[Coefficient], box: Sequence[Interval], check: Check = nothing
) -> tuple[RealRoot, ...] | str:
    """All values in the open range of z at which the arrangement can change, in increasing order.

    Or, where elimination would take too long, the reason.

    Parameters
    ----------
    surfaces : irreducible, in Z[x, y, z]; off them counts are constant.
    box : the ranges of x, y and z.
    check : called now and then; may raise to stop.
    """
    works = [(_work(surfaces, axis), axis) for axis in (1, 0)]
    work, axis = min(works, key=lambda pair: pair[0])
    if work > MAX_WORK:
        return f"the surfaces' discriminants and resultants would take {work:.1e} operations, more than {MAX_WORK:.0e}"
    curves, points = _projected(surfaces, axis, box[axis], check)
    base, fibre = box[2], box[1 - axis]
    seen = [curve(n, p, 0) for n, p in enumerate(curves) if p.degrees()[1] > 0]
    lines = [coefficients_in(p, 1)[0] for p in curves if p.degrees()[1] == 0]
    cost = predicted_cost(seen)
    if cost > MAX_COST:
        return f"the second projection would take {cost:.1e} operations, more than {MAX_COST:.0e}"
    found = project(seen, [*lines, *points], base, fibre, check)
    return found.abscissae


def _work(surfaces: Sequence[Coefficient], axis: int) -> int:
    rows = [_deflated(rows_in(p, axis))[0] for p in surfaces]
    varying = [r for r in rows if len(r) > 1]
    return sum(predicted_work([r]) for r in varying) + sum(
        predicted_work(pair) for pair in combinations(varying, 2)
    )


def _projected(
    surfaces: Sequence[Coefficient], axis: int, fibre: Interval, check: Check
) -> tuple[list[Coefficient], list[UnivariatePolynomial]]:
    """The curves of the first projection, and polynomials of the values of z over which a surface
    has a whole line.
    """
    points: list[UnivariatePolynomial] = []
    curves = irreducible_factors(*_images(surfaces, axis, fibre, check))
    for p in surfaces:
        rows = rows_in(p, axis)
        if len(rows) > 1:
            points += common_zeros(rows, check)
    return curves, points


def _images(
    surfaces: Sequence[Coefficient], axis: int, fibre: Interval, check: Check
) -> Iterator[Coefficient]:
    varying = []
    for p in surfaces:
        rows = rows_in(p, axis)
        if len(rows) == 1:
            yield rows[0]
            continue
        varying.append(rows)
        shorter, power = _deflated(rows)
        yield from _not_zero(discriminant(shorter, check))
        for edge in fibre:
            yield from _not_zero(at_value(rows, edge))
        if power > 1 and fibre[0] < 0 < fibre[1]:
            yield from _not_zero(rows[0])
    for first, second in combinations(varying, 2):
        power = gcd(_deflated(first)[1], _deflated(second)[1])
        yield resultant(first[::power], second[::power], check)


def _not_zero(p: Coefficient) -> list[Coefficient]:
    """Nothing where a surface is itself the edge: there it is none of the open window's."""
    return [] if p.is_zero() else [p]


def _deflated(rows: Rows) -> tuple[Rows, int]:
    """The polynomial in the largest power of v of which only powers occur, and that power's
    exponent.
    """
    power = deflation(rows)
    return rows[::power], power


def surfaces_of(
    on: SystemOnAxes, known: FamilyVariety, box: Sequence[Interval]
) -> tuple[Coefficient, ...]:
    """The irreducible surfaces that may have a point in an open box.

    Parameters
    ----------
    on : the system on the axes x, y and z.
    known : the variety over Q(x, y, z).
    box : the ranges of x, y and z.
    """
    equations = on.equations
    algebra = quotient_algebra(known.basis)
    assert algebra is not None  # it was, when the variety was computed
    given = [
        known.jacobian_norm[0],
        *equations.boundary,
        *on.limits,
        *sign_changes(equations, algebra),
    ]
    found = irreducible_factors(*given)
    everywhere = irreducible_factors(multiplication_denominator(algebra))
    suspects = [f for f in everywhere if f not in found and not nowhere_zero(f, box)]
    if suspects and settles(equations):
        rows = multiples(algebra, equations.jacobian)
        proved = harmless(equations, rows, known.jacobian_norm, suspects)
        suspects = [f for f in suspects if f not in proved]
    return (*(f for f in found if not nowhere_zero(f, box)), *suspects)
