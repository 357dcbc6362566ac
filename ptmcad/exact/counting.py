"""Equilibria at a rational point of a slice, counted by two independent methods.

Guarantee: `count_by_isolation` and `count_by_signature` are exact; both raise `DegeneratePoint` when an equilibrium
there has a singular Hessian, so no count is ever given on the discriminant variety, and `DimensionError` for a system
that does not have two angles.

By isolation: the real roots of a univariate representation, then the Hessian's signs there by ball arithmetic, with
precision doubled until every sign is certain (the Hessian is nonsingular, so this ends). By signature: Hermite forms
weighted with 1, det H, tr H and their product (Tarski queries). The two share the fibre's multiplication matrices.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from flint import arb, ctx, fmpq

from ptmcad.algebra.fibre import (
    Fibre,
    UnivariateRepresentation,
    coordinates_at,
    evaluate,
    fibre,
    hermite_matrix,
    signature,
    univariate_representation,
)
from ptmcad.algebra.real_roots import RealRoot, isolate, refine
from ptmcad.errors import HypothesisError
from ptmcad.exact.models.system import ParametricSystem, RationalPolynomial, at_point, require_two_angles


class DegeneratePoint(HypothesisError):
    """Some equilibrium at the point has a singular Hessian, or there are infinitely many."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Numbers of equilibria by Morse index; on a torus minima - saddles + maxima is zero."""

    minima: int
    saddles: int
    maxima: int

    @property
    def total(self) -> int:
        return self.minima + self.saddles + self.maxima

    @property
    def stable(self) -> int:
        return self.minima

    @property
    def index(self) -> tuple[int, int, int]:
        return (self.minima, self.saddles, self.maxima)


@dataclass(frozen=True, slots=True)
class PointSystem:
    """Gradient, Hessian and quotient algebra at one rational point."""

    hessian: tuple[tuple[RationalPolynomial, ...], ...]
    algebra: Fibre


def point_system(system: ParametricSystem, values: Mapping[str, fmpq]) -> PointSystem:
    """The system at rational values of all parameters.

    Raises
    ------
    DegeneratePoint
        When there are infinitely many solutions.
    """
    gradient, hessian = at_point(system, values)
    unknowns = 2 * system.dimension
    circles = [
        {tuple(2 if i == 2 * k + offset else 0 for i in range(unknowns)): fmpq(1) for offset in (0, 1)}
        | {(0,) * unknowns: fmpq(-1)}
        for k in range(system.dimension)
    ]
    algebra = fibre([g for g in gradient if g] + circles, unknowns)
    if algebra is None:
        raise DegeneratePoint(f"infinitely many solutions at {_text(values)}")
    return PointSystem(hessian, algebra)


def _text(values: Mapping[str, fmpq]) -> str:
    return ", ".join(f"{name}={value}" for name, value in values.items())


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """A real solution: the only one within ``radius`` of ``center`` in every unknown, and its Hessian's signs.

    Attributes
    ----------
    center, radius : decimals.
    negative : number of negative eigenvalues of the Hessian.
    """

    center: tuple[fmpq, ...]
    radius: fmpq
    negative: int


@dataclass(frozen=True, slots=True)
class Equilibria:
    """All real solutions at a rational point, in disjoint boxes.

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
    DimensionError
        When the system does not have two angles.
    """
    return equilibria(system, values).counts


def equilibria(system: ParametricSystem, values: Mapping[str, fmpq]) -> Equilibria:
    """All real solutions at rational values of all parameters, by real-root isolation.

    Raises
    ------
    DegeneratePoint
        When some solution, real or not, is singular, or there are infinitely many.
    DimensionError
        When the system does not have two angles.
    """
    require_two_angles(system, "numbers of minima, saddles and maxima")
    point = point_system(system, values)
    representation = univariate_representation(point.algebra)
    if representation is None:
        raise DegeneratePoint(f"an equilibrium has a singular Hessian at {_text(values)}")
    # at a real solution cosines and sines are at most 1, and real values of the form come from real solutions only
    bound = fmpq(sum(representation.form) + 1)
    roots = isolate(representation.minimal, -bound, bound)
    bits = 40
    while (found := _enclosed(point, representation, roots, bits)) is None:
        bits *= 2
    numbers = [0, 0, 0]
    for solution in found:
        numbers[solution.negative] += 1
    counts = Counts(*numbers)
    if counts.minima - counts.saddles + counts.maxima != 0:
        raise ArithmeticError(f"the Euler sum of {counts} at {_text(values)} is not zero")
    return Equilibria(counts, found, bits)


def _enclosed(
    point: PointSystem, representation: UnivariateRepresentation, roots: Sequence[RealRoot], bits: int
) -> tuple[Equilibrium, ...] | None:
    """The solutions at these roots in disjoint boxes; None when the precision is too low to decide all signs."""
    found: list[Equilibrium] = []
    with ctx.workprec(bits):
        for root in roots:
            short = refine(root, fmpq(1, 2 ** (bits - 8)) * (abs(root.middle) + 1))
            unknowns = coordinates_at(representation, arb(short.low).union(arb(short.high)))
            if unknowns is None:
                return None
            negative = _negative_eigenvalues(point, unknowns)
            box = _decimal_box(unknowns)
            if negative is None or box is None:
                return None
            found.append(Equilibrium(*box, negative))
    disjoint = all(
        any(abs(x - y) > a.radius + b.radius for x, y in zip(a.center, b.center, strict=True))
        for a, b in combinations(found, 2)
    )
    return tuple(found) if disjoint else None


def _negative_eigenvalues(point: PointSystem, unknowns: list[arb]) -> int | None:
    """The number of negative eigenvalues of the (2 x 2) Hessian in a box; None when its signs are not certain."""
    h11, h12, h22 = (_value(point.hessian[i][j], unknowns) for i, j in ((0, 0), (0, 1), (1, 1)))
    determinant = h11 * h22 - h12 * h12
    if not determinant.is_finite():
        raise ArithmeticError(f"the Hessian's determinant is {determinant} at {ctx.prec} bits")
    if determinant < 0:
        return 1
    if determinant > 0:
        if h11 > 0:
            return 0
        if h11 < 0:
            return 2
    return None


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


def solutions_at(system: ParametricSystem, values: Mapping[str, fmpq]) -> tuple[int | None, int]:
    """Number of different complex solutions, and their number with multiplicity; (None, 0) for infinitely many."""
    try:
        algebra = point_system(system, values).algebra
    except DegeneratePoint:
        return None, 0
    one = evaluate(algebra, {(0,) * len(algebra.multiplication): fmpq(1)})
    return sum(signature(hermite_matrix(algebra, one))), algebra.dimension


def count_by_signature(system: ParametricSystem, values: Mapping[str, fmpq]) -> Counts:
    """Counts at rational values of all parameters, by signatures of Hermite matrices.

    Raises
    ------
    DegeneratePoint
        When some real solution has a singular Hessian, or there are infinitely many.
    DimensionError
        When the system does not have two angles.
    """
    require_two_angles(system, "numbers of minima, saddles and maxima")
    point = point_system(system, values)
    h11, h12, h22 = (evaluate(point.algebra, point.hessian[i][j]) for i, j in ((0, 0), (0, 1), (1, 1)))
    determinant, trace = h11 * h22 - h12 * h12, h11 + h22
    one = evaluate(point.algebra, {(0,) * len(point.algebra.multiplication): fmpq(1)})

    def query(weight: object) -> tuple[int, int]:
        return signature(hermite_matrix(point.algebra, weight))  # type: ignore[arg-type]

    positive, negative = query(one)
    total = positive - negative
    positive, negative = query(determinant)
    if positive + negative != point.algebra.dimension:
        raise DegeneratePoint(f"an equilibrium has a singular Hessian at {_text(values)}")
    definite_minus_saddles = positive - negative
    # let N(s, t) solutions have det H of sign s and tr H of sign t:
    # the query of tr H gives the sum of t N(s, t), that of det H tr H the sum of s t N(s, t); half their sum has s = 1
    positive, negative = query(trace)
    trace_sum = positive - negative
    positive, negative = query(determinant * trace)
    minima_minus_maxima = (trace_sum + positive - negative) // 2
    saddles = (total - definite_minus_saddles) // 2
    definite = total - saddles
    return Counts((definite + minima_minus_maxima) // 2, saddles, (definite - minima_minus_maxima) // 2)
