"""A system at one rational point of a slice: its polynomials there and the quotient algebra of its
solutions.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import prod
from operator import add
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.bases import quotient
from ptmcad.algebra.fibre_algebra import (
    FibreAlgebra,
    UnivariateRepresentation,
    WorkLimit,
    evaluate,
    hermite_matrix,
    univariate_representation,
)
from ptmcad.algebra.polynomials import Values
from ptmcad.algebra.trigonometric_ring import RationalPolynomial
from ptmcad.answer.words import with_article
from ptmcad.errors import HypothesisError
from ptmcad.exact.models.system import ParametricSystem, at_point, polynomial_at


class DegeneratePoint(HypothesisError):
    """Some solution at the point has a singular Jacobian, or there are infinitely many."""


class PointSystem(NamedTuple):
    """The system and its quotient algebra at one rational point.

    Attributes
    ----------
    algebra : of all solutions, or of those at which no inequality's polynomial vanishes
        (`saturated`); then it has one coordinate more.
    """

    jacobian: tuple[tuple[RationalPolynomial, ...], ...]
    inequalities: tuple[RationalPolynomial, ...]
    stability: tuple[RationalPolynomial, ...]
    algebra: FibreAlgebra
    is_bounded: bool
    is_saturated: bool

    @property
    def conditions(self) -> tuple[RationalPolynomial, ...]:
        return (*self.inequalities, *self.stability)


def point_system(
    system: ParametricSystem, values: Values, saturated: bool = False, most: WorkLimit | None = None
) -> PointSystem:
    """The system at rational values of all parameters.

    Parameters
    ----------
    saturated : whether solutions at which an inequality's polynomial vanishes are left out.

    Raises
    ------
    DegeneratePoint
        When there are infinitely many solutions.
    LimitReached
        When it is more work than `most`.
    """
    equations, jacobian = at_point(system, values)
    inequalities, stability = (
        tuple(polynomial_at(system, p, values) for p in conditions)
        for conditions in (system.inequalities, system.stability)
    )
    ring = system.ring
    generators = [e for e in equations if e] + [
        {m: fmpq(c) for m, c in circle.items()} for circle in ring.circles
    ]
    width = ring.width
    if saturated:
        generators = [{(*m, 0): c for m, c in g.items()} for g in generators]
        inverse = {(*m, 1): c for m, c in _product(inequalities).items()}
        generators.append({**inverse, (0,) * (width + 1): fmpq(-1)})
        width += 1
    algebra = quotient(generators, width, most)
    if algebra is None:
        raise DegeneratePoint(f"infinitely many solutions at {text_of_point(values)}")
    return PointSystem(
        jacobian, inequalities, stability, algebra, not (ring.reals or saturated), saturated
    )


def _product(factors: Sequence[RationalPolynomial]) -> RationalPolynomial:
    first, *others = factors
    for other in others:
        total: RationalPolynomial = {}
        for m, a in first.items():
            for n, b in other.items():
                key = tuple(map(add, m, n))
                total[key] = total.get(key, fmpq(0)) + a * b
        first = {m: c for m, c in total.items() if c}
    return first


def text_of_point(values: Values) -> str:
    """The point in words, for messages."""
    return ", ".join(f"{name}={value}" for name, value in values.items())


def point_systems(
    system: ParametricSystem, values: Values, most: WorkLimit | None = None
) -> Iterator[PointSystem]:
    """The system of all solutions, and then of those at which no inequality's polynomial vanishes.

    One of infinitely many solutions is left out.

    Raises
    ------
    DegeneratePoint
        When the last one has infinitely many.
    LimitReached
        When it is more work than `most`.
    """
    for saturated in (False, True) if system.inequalities else (False,):
        try:
            point = point_system(system, values, saturated, most)
        except DegeneratePoint:
            if saturated or not system.inequalities:
                raise
            continue
        yield point


def simple_solutions(
    system: ParametricSystem, values: Values, most: WorkLimit | None = None
) -> tuple[PointSystem, UnivariateRepresentation | None]:
    """The point's system when its solutions are simple, and their representation; None when there
    are none.

    Solutions at which an inequality's polynomial vanishes, which do not count, are left out where
    they are not simple.

    Raises
    ------
    DegeneratePoint
        When some solution is singular, or there are infinitely many.
    LimitReached
        When it is more work than `most`.
    """
    for point in point_systems(system, values, most):
        if not point.algebra.dimension:
            return point, None
        representation = univariate_representation(point.algebra)
        if representation is not None:
            return point, representation
    raise DegeneratePoint(f"{with_article(system.criterion.singular)} at {text_of_point(values)}")


def degree_bound(system: ParametricSystem, values: Values) -> tuple[int, int]:
    """The greatest degree of an equation, and Bezout's bound for the number of complex solutions,
    were it finite.
    """
    equations, _ = at_point(system, values)
    degrees = [max(map(sum, e), default=0) for e in equations]
    return max(degrees), prod(degrees) * 2 ** len(system.ring.angles)


def solutions_at(
    system: ParametricSystem, values: Values, saturated: bool = False, most: WorkLimit | None = None
) -> tuple[int | None, int]:
    """Number of different complex solutions, and their number with multiplicity; (None, 0) for
    infinitely many.

    Parameters
    ----------
    saturated : whether solutions at which an inequality's polynomial vanishes are left out.

    Raises
    ------
    LimitReached
        When it is more work than `most`.
    """
    try:
        point = (
            next(point_systems(system, values, most))
            if saturated
            else point_system(system, values, most=most)
        )
    except DegeneratePoint:
        return None, 0
    # of an algebra with an inverse they are left out already
    return _off(point, point.inequalities if saturated and not point.is_saturated else ())


def none_is_stable(system: ParametricSystem, values: Values, most: WorkLimit | None = None) -> bool:
    """Whether at a point some condition for stability is zero at each of finitely many solutions,
    of which there are.

    Raises
    ------
    LimitReached
        When it is more work than `most`.
    """
    if not system.stability:
        return False
    try:
        point = point_system(system, values, most=most)
    except DegeneratePoint:
        return False
    return bool(point.algebra.dimension) and any(_off(point, (p,))[0] == 0 for p in point.stability)


def _off(point: PointSystem, conditions: Sequence[RationalPolynomial]) -> tuple[int, int]:
    """Number of different solutions at which no condition vanishes, and their number with
    multiplicity.

    Of the conditions' product p they are the ranks of Hermite's form with the weight p, and of
    multiplication by a high power of p. A basis of the ideal with one more unknown, p's inverse,
    would say the same, and can take hours.
    """
    algebra = point.algebra
    weight = algebra.one
    for p in conditions:
        weight = weight * evaluate(algebra, p)
    different = hermite_matrix(algebra, weight).rank()
    power = 1
    while conditions and power < algebra.dimension and weight.rank() > different:
        weight, power = weight * weight, 2 * power
    return different, weight.rank() if conditions else algebra.dimension
