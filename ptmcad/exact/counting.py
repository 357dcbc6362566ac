"""Solutions of a system at a rational point of a slice, isolated and counted.

Guarantee: exact for any number of unknowns; `DegeneratePoint` is raised when a solution there has a singular Jacobian,
so no count is ever given on the discriminant variety.

The real roots of a univariate representation are isolated, then the Hessian's inertia there is found by ball
arithmetic, with precision doubled until every sign is certain (the Hessian is nonsingular, so this ends).
`ptmcad.exact.signatures` counts in another way.

A condition that is zero at a solution is not positive there; it is found to be zero by a greatest common divisor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.algebra.fibre import (
    UnivariateRepresentation,
    coordinates_at,
)
from ptmcad.algebra.inertia import negative_eigenvalues
from ptmcad.algebra.isolation import root_bound
from ptmcad.algebra.real_roots import RealRoot, is_root_of, isolate, refine
from ptmcad.algebra.vanishing import Divisor, vanishing_divisor
from ptmcad.answer.counts import Counts
from ptmcad.exact.models.system import ParametricSystem, RationalPolynomial
from ptmcad.exact.point_system import PointSystem, simple_solutions, text_of_point


class Equilibrium(NamedTuple):
    """A real solution: the only one within ``radius`` of ``center`` in every coordinate, and what is stable about it.

    Attributes
    ----------
    center, radius : decimals.
    signs : of the Hessian's eigenvalues, positive ones first; without a potential, of the stability conditions in their
        order, 0 where one is zero.
    """

    center: tuple[fmpq, ...]
    radius: fmpq
    signs: str


class Equilibria(NamedTuple):
    """All real solutions that count at a rational point, in disjoint boxes.

    Attributes
    ----------
    bits : the precision at which every sign was certain and the boxes were disjoint.
    """

    counts: Counts
    solutions: tuple[Equilibrium, ...]
    bits: int


def count_by_isolation(system: ParametricSystem, values: Mapping[str, fmpq]) -> Counts:
    """Counts at rational values of all parameters, by real-root isolation.

    Raises
    ------
    DegeneratePoint
        When some solution, real or not, is singular, or there are infinitely many.
    """
    return equilibria(system, values).counts


def equilibria(system: ParametricSystem, values: Mapping[str, fmpq]) -> Equilibria:
    """All real solutions that count at rational values of all parameters, by real-root isolation.

    Raises
    ------
    DegeneratePoint
        When some solution, real or not, is singular, or there are infinitely many.
    """
    point, representation = simple_solutions(system, values)
    bits = 40
    if representation is None:
        return Equilibria(_counts(system, ()), (), bits)
    # where coordinates are at most 1, real values of the form come from real solutions only, and so they do elsewhere
    bound = fmpq(sum(representation.form) + 1) if point.is_bounded else root_bound(representation.minimal)
    roots = isolate(representation.minimal, -bound, bound)
    zeros = [vanishing_divisor(point.algebra, representation, p) for p in point.conditions]
    while (found := _enclosed(system, point, representation, roots, zeros, bits)) is None:
        bits *= 2
    counts = _counts(system, found)
    if counts.index is not None and system.is_on_torus and sum(counts.index[::2]) != sum(counts.index[1::2]):
        raise ArithmeticError(f"the Euler sum of {counts} at {text_of_point(values)} is not zero")
    return Equilibria(counts, found, bits)


def _counts(system: ParametricSystem, found: Sequence[Equilibrium]) -> Counts:
    stable = sum(not e.signs.strip("+") for e in found) if system.tells_stability else None
    index = None
    if system.has_index:
        numbers = [0] * (system.dimension + 1)
        for solution in found:
            numbers[solution.signs.count("-")] += 1
        index = tuple(numbers)
    return Counts(len(found), stable, index)


def _enclosed(
    system: ParametricSystem,
    point: PointSystem,
    representation: UnivariateRepresentation,
    roots: Sequence[RealRoot],
    zeros: Sequence[Divisor | None],
    bits: int,
) -> tuple[Equilibrium, ...] | None:
    """The solutions at these roots that count, in disjoint boxes; None when the precision does not decide all signs."""
    found: list[Equilibrium] = []
    with ctx.workprec(bits):
        for root in roots:
            short = refine(root, fmpq(1, 2 ** (bits - 8)) * (abs(root.middle) + 1))
            at = coordinates_at(representation, arb(short.low).union(arb(short.high)))
            if at is None:
                return None
            unknowns = at[: system.ring.width]
            conditions = _condition_signs(point, root, unknowns, zeros)
            if conditions is None:
                return None
            if conditions[: len(point.inequalities)].strip("+"):
                continue
            signs = conditions[len(point.inequalities) :]
            if system.has_index:
                negative = _negative_eigenvalues(point, unknowns)
                if negative is None:
                    return None
                signs = "+" * (system.dimension - negative) + "-" * negative
            box = _decimal_box(unknowns)
            if box is None:
                return None
            found.append(Equilibrium(*box, signs))
    disjoint = all(
        any(abs(x - y) > a.radius + b.radius for x, y in zip(a.center, b.center, strict=True))
        for a, b in combinations(found, 2)
    )
    return tuple(found) if disjoint else None


def _condition_signs(
    point: PointSystem, root: RealRoot, unknowns: list[arb], zeros: Sequence[Divisor | None]
) -> str | None:
    """The signs of inequalities and stability conditions at a solution; None when one is not certain."""
    signs = ""
    for p, divisor in zip(point.conditions, zeros, strict=True):
        if divisor is not None and is_root_of(divisor, root):
            signs += "0"
            continue
        value = _value(p, unknowns)
        if value.contains(0):
            return None
        signs += "+" if value > 0 else "-"
    return signs


def _negative_eigenvalues(point: PointSystem, unknowns: list[arb]) -> int | None:
    """The number of negative eigenvalues of the Hessian in a box; None when its signs are not certain."""
    size = len(point.jacobian)
    upper = {(i, j): _value(point.jacobian[i][j], unknowns) for i in range(size) for j in range(i, size)}
    return negative_eigenvalues([[upper[min(i, j), max(i, j)] for j in range(size)] for i in range(size)])


def _decimal_box(unknowns: Sequence[arb]) -> tuple[tuple[fmpq, ...], fmpq] | None:
    """Center and radius, in decimals, of a box around the balls; None when these are wider than the coarsest box.

    The finest box has 12 digits after the point, and more as the precision grows, so that all boxes come apart.
    """
    for digits in range(max(12, ctx.prec // 5), 5, -1):
        unit = fmpq(1, 10**digits)
        center = tuple(fmpq(_nearest(x, 10**digits), 10**digits) for x in unknowns)
        if all(abs(x - c) < arb(unit) for x, c in zip(unknowns, center, strict=True)):
            return center, unit
    return None


def _nearest(ball: arb, scale: int) -> int:
    """The integer nearest to scale times the ball's middle."""
    mantissa, exponent = (int(n) for n in ball.mid().man_exp())
    scaled = mantissa * scale
    return scaled << exponent if exponent >= 0 else (scaled + (1 << (-exponent - 1))) >> -exponent


def _value(p: RationalPolynomial, unknowns: list[arb]) -> arb:
    total = arb(0)
    for monomial, c in p.items():
        term = arb(c)
        for value, e in zip(unknowns, monomial, strict=True):
            for _ in range(e):  # python-flint's ball ** int is not a number when the ball's middle is zero
                term = term * value
        total = total + term
    return total
