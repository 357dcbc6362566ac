"""The quotient algebra Q(x, y)[unknowns]/I of a zero-dimensional ideal, by its multiplication
table.

Guarantee: exact. The norm of an element h is the product of its values at the solutions, with
multiplicity; it is the determinant of multiplication by h. The Hermite form is (b_i,
b_j) -> trace(h b_i b_j) on the monomial basis.

References: Lazard & Rouillier, J. Symb. Comp. 42 (2007); Le & Safey El Din, arXiv 2011.14136
(Hermite matrices).
"""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Sequence
from functools import lru_cache, reduce
from operator import add
from typing import NamedTuple

from ptmcad.algebra.groebner import GroebnerBasis, divides, order_key, raised
from ptmcad.algebra.plane_determinants import characteristic, determinant, least_assignment
from ptmcad.algebra.polynomials import (
    Coefficient,
    Monomial,
    Ratio,
    UnknownPolynomial,
    add_ratios,
    common_factor,
    constant_like,
    lcm,
    multiplicity,
    ratio,
)
from ptmcad.errors import LimitReached

LINE = 1009
"""The second axis is so much more than the first one on a line on which poles are looked for; any
number does.
"""
Vector = tuple[tuple[Coefficient, ...], Coefficient]
"""Coordinates on the monomial basis: numerators and one common denominator."""


@lru_cache(maxsize=64)
def standard_monomials(
    leading: tuple[Monomial, ...], unknowns: int, most: int | None = None
) -> tuple[Monomial, ...] | None:
    """The monomials outside the leading ideal, by degree; None when there are infinitely many.

    The points of a slice have few leading ideals, most of them one.

    Raises
    ------
    LimitReached
        When they are more than ``most``.
    """
    for k in range(unknowns):
        if not any(sum(m) == m[k] for m in leading):
            return None
    found: list[Monomial] = []
    layer = {(0,) * unknowns}
    while layer:
        kept = sorted(m for m in layer if not any(divides(n, m) for n in leading))
        found += kept
        if most is not None and len(found) > most:
            raise LimitReached(f"more than {most} monomials are outside of the leading ideal")
        layer = {raised(m, k) for m in kept for k in range(unknowns)}
    return tuple(found)


def border_of(basis: Collection[Monomial]) -> set[Monomial]:
    """The multiples of a basis's monomials by one unknown that are not of it."""
    return {raised(m, k) for m in basis for k in range(len(m))}.difference(basis)


def divided(monomial: Monomial, known: Container[Monomial]) -> tuple[int, Monomial]:
    """The first unknown by which a monomial can be divided to a known one, and the known one."""
    divisors = ((k, raised(monomial, k, -1)) for k, e in enumerate(monomial) if e)
    return next((k, below) for k, below in divisors if below in known)


class QuotientAlgebra(NamedTuple):
    """Monomial basis and normal forms; ``table`` grows as normal forms are asked for.

    Attributes
    ----------
    zero, one : of the ring of the coefficients.
    """

    basis: tuple[Monomial, ...]
    table: dict[Monomial, Vector]
    zero: Coefficient
    one: Coefficient

    @property
    def dimension(self) -> int:
        """The number of complex solutions, counted with multiplicity, for generic axes."""
        return len(self.basis)


def quotient_algebra(groebner: GroebnerBasis) -> QuotientAlgebra | None:
    """The quotient by the ideal; None when it is not zero-dimensional."""
    unknowns = len(groebner.order)
    basis = standard_monomials(groebner.leading, unknowns)
    if basis is None:
        return None
    some = next(iter(groebner.elements[0].values()))
    one, zero = constant_like(some, 1), constant_like(some, 0)
    position = {m: i for i, m in enumerate(basis)}
    table: dict[Monomial, Vector] = {
        m: (tuple(one if i == k else zero for i in range(len(basis))), one)
        for m, k in position.items()
    }
    rules = dict(zip(groebner.leading, groebner.elements, strict=True))
    algebra = QuotientAlgebra(basis, table, zero, one)
    border = border_of(basis)
    for m in sorted(border, key=order_key(groebner.order)):
        if m in rules:
            row = [zero] * len(basis)
            for n, c in rules[m].items():
                if n != m:
                    row[position[n]] = -c
            table[m] = _normalised(row, rules[m][m])
        else:
            # m is a proper multiple of a leading monomial, hence of a smaller border monomial
            k, below = divided(m, border)
            table[m] = _times_unknown(algebra, k, table[below])
    return algebra


def _normalised(row: Sequence[Coefficient], denominator: Coefficient) -> Vector:
    common = common_factor([denominator, *row])
    if common.is_one():
        return tuple(row), denominator
    return tuple(c / common for c in row), denominator / common


def _sum(
    algebra: QuotientAlgebra, terms: Sequence[tuple[Coefficient, Coefficient, Vector]]
) -> Vector:
    """The sum of (a/b) v over (a, b, v)."""
    scale = lcm((algebra.one, *(b * v[1] for _, b, v in terms)))
    total = [algebra.zero] * algebra.dimension
    for a, b, (row, denominator) in terms:
        factor = a * (scale / (b * denominator))
        for i, c in enumerate(row):
            if not c.is_zero():
                total[i] = total[i] + factor * c
    return _normalised(total, scale)


def _times_unknown(algebra: QuotientAlgebra, k: int, vector: Vector) -> Vector:
    row, denominator = vector
    terms = [
        (c, denominator, algebra.table[raised(m, k)])
        for m, c in zip(algebra.basis, row, strict=True)
        if not c.is_zero()
    ]
    return _sum(algebra, terms)


def normal_form(algebra: QuotientAlgebra, monomial: Monomial) -> Vector:
    """Coordinates of a monomial on the basis."""
    if monomial not in algebra.table:
        k = next(k for k, e in enumerate(monomial) if e)
        below = raised(monomial, k, -1)
        algebra.table[monomial] = _times_unknown(algebra, k, normal_form(algebra, below))
    return algebra.table[monomial]


def element(algebra: QuotientAlgebra, p: UnknownPolynomial) -> Vector:
    """Coordinates of a polynomial on the basis."""
    return _sum(algebra, [(c, algebra.one, normal_form(algebra, m)) for m, c in p.items()])


def norm(algebra: QuotientAlgebra, p: UnknownPolynomial) -> Ratio:
    """The product of p over all complex solutions, as a rational function of the axes."""
    return determinant(matrix_of(multiples(algebra, p)))


def matrix_of(rows: Sequence[Vector]) -> list[list[Ratio]]:
    """Rows over common denominators as a matrix over Q(x, y)."""
    return [[ratio(c, denominator) for c in row] for row, denominator in rows]


def multiples(algebra: QuotientAlgebra, p: UnknownPolynomial) -> tuple[Vector, ...]:
    """p times each element of the basis: the rows of the matrix of multiplication by p."""
    images: dict[Monomial, Vector] = {algebra.basis[0]: element(algebra, p)}
    for m in algebra.basis[1:]:
        k, below = divided(m, images)
        images[m] = _times_unknown(algebra, k, images[below])
    return tuple(images[m] for m in algebra.basis)


def bounded_away_from_zero(rows: Sequence[Vector], product: Ratio, factor: Coefficient) -> bool:
    """Whether the values of p at the solutions are proved to stay away from 0 near almost all
    points of a curve.

    Also where solutions leave every bounded set. True is a proof; False means that the test did not
    decide.

    Parameters
    ----------
    rows : the `multiples` of p.
    product : its `norm`, not zero.
    factor : the curve's irreducible polynomial.

    Why: a coefficient of the characteristic polynomial is a sum of products of entries, one in each
    of some rows and columns of the same numbers. So its pole along the curve has at most the order
    of such a product of entries, the greatest of which is an assignment problem. When the constant
    one, the norm, has a pole of that order, the polynomial times a common denominator keeps a
    constant coefficient that does not vanish on the curve, and its roots stay away from 0 wherever
    that coefficient does.
    """
    return _least_order(rows, factor) == _order(product[0], product[1], factor)


def _least_order(rows: Sequence[Vector], factor: Coefficient) -> int | None:
    """A bound from below for the order along a curve of each coefficient of a matrix's
    characteristic polynomial.
    """
    orders = [[_order(c, denominator, factor) for c in row] for row, denominator in rows]
    for k, row in enumerate(orders):
        row[k] = min(row[k] or 0, 0)  # a row may be left out with its column
    return least_assignment(orders)


def _order(numerator: Coefficient, denominator: Coefficient, factor: Coefficient) -> int | None:
    """The order of the zero of a fraction along a curve, negative for a pole; None for the fraction
    0.
    """
    return (
        None
        if numerator.is_zero()
        else multiplicity(numerator, factor) - multiplicity(denominator, factor)
    )


def multiplication_denominator(algebra: QuotientAlgebra) -> Coefficient:
    """A common denominator of the multiplication matrices of the unknowns."""
    return lcm(algebra.table[raised(m, k)][1] for m in algebra.basis for k in range(len(m)))


def poles(
    algebra: QuotientAlgebra,
    suspects: Sequence[Coefficient],
    coordinates: Sequence[int],
    remarks: Sequence[Coefficient] = (),
) -> list[Coefficient]:
    """Those of the irreducible polynomials on which the characteristic polynomial of some
    coordinate has a pole.

    Near these points of the plane the coordinate is unbounded on the solutions. Often the entries'
    orders tell that there is none, and a line of the plane that there is one: what f^n divides it
    divides on the line.

    Parameters
    ----------
    suspects : each is found if and only if there is a pole.
    remarks : of curves that no count depends on: found only if there is a pole and the line shows
        it, as it does but for a coincidence of zeros. Those that do not meet the line, such as one
        of the axes' difference alone, are looked for as the others are.
    """
    found: list[Coefficient] = []
    x, y = algebra.one.context().gens()
    line, plane = (x, x + LINE), (x, y)
    everywhere = (*suspects, *(f for f in remarks if f.compose(*line).is_constant()))
    for k in coordinates:
        vectors = [algebra.table[raised(m, k)] for m in algebra.basis]
        rows, scales = [row for row, _ in vectors], [denominator for _, denominator in vectors]
        for places, asked in ((line, (*suspects, *remarks)), (plane, everywhere)):
            on_places = [scale.compose(*places) for scale in scales]
            left = [f for f in asked if f not in found and (_least_order(vectors, f) or 0) < 0]
            # a line on which a denominator vanishes shows nothing
            if not left or any(scale.is_zero() for scale in on_places):
                continue
            coefficients = characteristic(
                [[c.compose(*places) for c in row] for row in rows], on_places
            )
            for f in left:
                power = f ** sum(multiplicity(scale, f) for scale in scales)
                _, divisor = power.compose(*places).primitive()
                if any(not (c % divisor).is_zero() for c in coefficients):
                    found.append(f)
    return found


def trace_form(algebra: QuotientAlgebra) -> list[list[Ratio]]:
    """The Hermite matrix trace(b_i b_j); its determinant vanishes where solutions coincide."""
    basis = algebra.basis
    products = [[normal_form(algebra, tuple(map(add, a, b))) for b in basis] for a in basis]

    def total(terms: Iterable[Ratio]) -> Ratio:
        return reduce(add_ratios, terms, (algebra.zero, algebra.one))

    traces = [
        total(ratio(numerators[j], denominator) for j, (numerators, denominator) in enumerate(row))
        for row in products
    ]
    return [
        [
            total(
                ratio(c * trace, denominator * below)
                for c, (trace, below) in zip(numerators, traces, strict=True)
                if not c.is_zero()
            )
            for numerators, denominator in row
        ]
        for row in products
    ]
