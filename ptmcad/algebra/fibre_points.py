"""The real points of a fibre with their multiplicities, and polynomials in the unknowns as numbers
there.

Guarantee: exact, also where points are multiple. Each real solution is there once; its multiplicity
is the dimension of the local algebra.

Reference: Rouillier, Solving zero-dimensional systems through the rational univariate
representation, AAECC 9 (1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_poly

from ptmcad.algebra.descartes import root_bound
from ptmcad.algebra.fibre_algebra import (
    FibreAlgebra,
    univariate_representation,
)
from ptmcad.algebra.membership import RationalPolynomial
from ptmcad.algebra.number_field import Expression, FieldElement, Modulus, RealField, polynomial_at
from ptmcad.algebra.real_roots import RealRoot, is_root_of, isolate


@dataclass(frozen=True, slots=True)
class RealPoint:
    """A real solution: the unknowns as elements of a real field, and the multiplicity."""

    field: RealField
    unknowns: tuple[FieldElement, ...]
    multiplicity: int


def points(algebra: FibreAlgebra, bound: int | None = 1) -> tuple[list[RealPoint], int]:
    """The real points of a fibre, and the number of different complex ones.

    The real ones stand in the order of a form that separates all of them.

    Parameters
    ----------
    bound : of the unknowns at all real points, where one is known; it bounds the search.
    """
    separated = univariate_representation(algebra, multiple=True)
    if separated is None:
        raise ArithmeticError("no form of the list separates the points of a fibre")
    radical, form = separated.minimal, separated.form
    factors = [
        (factor, int(multiplicity)) for factor, multiplicity in separated.characteristic.factor()[1]
    ]
    numerators = [separated.slope, *separated.coordinates]
    limit = root_bound(radical) if bound is None else fmpq(bound * sum(form) + 1)
    coordinates: dict[int, tuple[Modulus, list[Expression]]] = {}
    found = []
    for root in isolate(radical, -limit, limit):
        number = next(n for n, (factor, _) in enumerate(factors) if is_root_of(factor, root))
        factor, multiplicity = factors[number]
        interval = RealRoot(factor, root.low, root.high)
        if number not in coordinates:
            modulus = Modulus(factor)
            coordinates[number] = modulus, _coordinates(RealField(modulus, interval), numerators)
        modulus, residues = coordinates[number]
        field = RealField(modulus, interval)
        found.append(
            RealPoint(field, tuple(FieldElement(field, r) for r in residues), multiplicity)
        )
    return found, int(radical.degree())


def value_at(point: RealPoint, p: RationalPolynomial) -> FieldElement:
    """A polynomial in the unknowns as a number."""
    return polynomial_at(point.field, point.unknowns, p)


def _coordinates(field: RealField, numerators: Sequence[fmpq_poly]) -> list[Expression]:
    """The unknowns at the points of one factor: quotients of the trace polynomials by the first of
    them.
    """
    first, *others = map(field.element, numerators)
    inverse = first.inverse()  # it vanishes at no point of the fibre
    return [(other * inverse).expression for other in others]
