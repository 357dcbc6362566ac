"""The real points of a fibre with their multiplicities, and polynomials in the unknowns as numbers there.

Guarantee: exact, also where points are multiple. Each real solution is there once; its multiplicity is the dimension
of the local algebra.

Reference: Rouillier, Solving zero-dimensional systems through the rational univariate representation, AAECC 9 (1999),
theorem 3.1 (the traces) and lemma 2.1 (the list of forms).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_mat, fmpq_poly, fmpz_poly

from ptmcad.algebra.fibre import Fibre, RationalPolynomial, evaluate, hermite_matrix, signature
from ptmcad.algebra.isolation import root_bound
from ptmcad.algebra.number_field import Element, Expression, Modulus, RealField, polynomial_at
from ptmcad.algebra.real_roots import RealRoot, isolate, sign_at


@dataclass(frozen=True, slots=True)
class RealPoint:
    """A real solution: the unknowns as elements of a real field, and the multiplicity."""

    field: RealField
    unknowns: tuple[Element, ...]
    multiplicity: int


@dataclass(frozen=True, slots=True)
class Points:
    """The points of a fibre.

    Attributes
    ----------
    real : by the value of the separating form, which increases.
    form : the separating form's coefficients, one for each unknown, not negative.
    distinct, total : numbers of complex points, once each and with multiplicity.
    """

    real: tuple[RealPoint, ...]
    form: tuple[int, ...]
    distinct: int
    total: int


def points(algebra: Fibre, bound: int | None = 1) -> Points:
    """The points of a fibre.

    Parameters
    ----------
    bound : of the unknowns at all real points, where one is known; it bounds the search.
    """
    form, matrix, characteristic, distinct = _separating_form(algebra)
    factors = [(factor, int(multiplicity)) for factor, multiplicity in characteristic.numer().factor()[1]]
    radical = _product([factor for factor, _ in factors])
    numerators = _trace_polynomials(algebra, matrix, radical)
    limit = root_bound(radical) if bound is None else fmpq(bound * sum(form) + 1)
    coordinates: dict[int, tuple[Modulus, list[Expression]]] = {}
    found = []
    for root in isolate(radical, -limit, limit):
        number = next(n for n, (factor, _) in enumerate(factors) if _owns(factor, root))
        factor, multiplicity = factors[number]
        interval = RealRoot(factor, root.low, root.high)
        if number not in coordinates:
            modulus = Modulus(factor)
            coordinates[number] = modulus, _coordinates(RealField(modulus, interval), numerators)
        modulus, residues = coordinates[number]
        field = RealField(modulus, interval)
        found.append(RealPoint(field, tuple(Element(field, r) for r in residues), multiplicity))
    return Points(tuple(found), form, distinct, algebra.dimension)


def value_at(point: RealPoint, p: RationalPolynomial) -> Element:
    """A polynomial in the unknowns as a number."""
    return polynomial_at(point.field, point.unknowns, p)


def real_values(algebra: Fibre, p: RationalPolynomial, bound: fmpq | None = None) -> tuple[RealRoot, ...]:
    """The real numbers, in (-bound, bound), that p takes at complex points of the fibre, in increasing order."""
    factors = evaluate(algebra, p).charpoly().numer().factor()[1]
    radical = _product([factor for factor, _ in factors])
    limit = root_bound(radical) if bound is None else bound
    return isolate(radical, -limit, limit)


def _separating_form(algebra: Fibre) -> tuple[tuple[int, ...], fmpq_mat, fmpq_poly, int]:
    """The first linear form of a fixed list with a different value at each point: coefficients, matrix,
    characteristic polynomial, and the number of points."""
    size, count = algebra.dimension, len(algebra.multiplication)
    expected: int | None = None
    for trial in range(1, size * (size - 1) // 2 * (count - 1) + 2):
        form = tuple(trial**k for k in range(count))  # points on a moment curve
        matrix = fmpq_mat(size, size)
        for coefficient, m in zip(form, algebra.multiplication, strict=True):
            matrix = matrix + m * fmpq(coefficient)
        characteristic = matrix.charpoly()
        distinct = size - characteristic.gcd(characteristic.derivative()).degree()
        if distinct < size and expected is None:
            one = evaluate(algebra, {(0,) * count: fmpq(1)})
            expected = sum(signature(hermite_matrix(algebra, one)))
        if distinct in (size, expected):
            return form, matrix, characteristic, distinct
    raise ArithmeticError("no form of the list separates the points of a fibre")


def _trace_polynomials(algebra: Fibre, matrix: fmpq_mat, radical: fmpz_poly) -> list[fmpq_poly]:
    """For v = 1 and each unknown, the sum over the points of multiplicity times v times the product of (T - value of
    the form) over the other points; the value of v at a point is the quotient of that by the first of them."""
    size, degree = algebra.dimension, radical.degree()
    # in integers over common denominators: reducing every fraction on the way would take most of the time
    traces, trace_denominator = fmpq_mat(
        1, size, [_trace(evaluate(algebra, {m: fmpq(1)})) for m in algebra.basis]
    ).numer_denom()
    step, step_denominator = matrix.numer_denom()
    one = fmpq_mat(size, 1, [fmpq(int(i == 0)) for i in range(size)])
    tails = [fmpz_poly([radical[degree - k + i] for i in range(k + 1)]) for k in range(degree)]
    result = []
    for column in (one, *(m * one for m in algebra.multiplication)):
        vector, denominator = column.numer_denom()
        total, factor = fmpz_poly([0]), step_denominator ** (degree - 1)
        for j in range(degree):
            total += tails[degree - 1 - j] * ((traces * vector)[0, 0] * factor)
            vector, factor = step * vector, factor // step_denominator
        result.append(
            fmpq_poly(total)
            / fmpq(radical[degree] * trace_denominator * denominator * step_denominator ** (degree - 1))
        )
    return result


def _trace(matrix: fmpq_mat) -> fmpq:
    return sum((matrix[i, i] for i in range(matrix.nrows())), fmpq(0))


def _coordinates(field: RealField, numerators: Sequence[fmpq_poly]) -> list[Expression]:
    """The unknowns at the points of one factor: quotients of the trace polynomials by the first of them."""
    first, *others = map(field.element, numerators)
    inverse = first.inverse()  # it vanishes at no point of the fibre
    return [(other * inverse).expression for other in others]


def _owns(factor: fmpz_poly, root: RealRoot) -> bool:
    """Whether the only root in an isolating interval of a product is one of this factor's."""
    if root.is_rational:
        return sign_at(factor, root.low) == 0
    return sign_at(factor, root.low) != sign_at(factor, root.high)


def _product(factors: Sequence[fmpz_poly]) -> fmpz_poly:
    product = fmpz_poly([1])
    for factor in factors:
        product *= factor
    return product
