"""The quotient algebra Q(x, y)[unknowns]/I of a zero-dimensional ideal, by its multiplication table.

Guarantee: exact. The norm of an element h is the product of its values at the solutions, with multiplicity; it is the
determinant of multiplication by h. The Hermite form is (b_i, b_j) -> trace(h b_i b_j) on the monomial basis.

References: Lazard & Rouillier, J. Symb. Comp. 42 (2007); Le & Safey El Din, arXiv 2011.14136 (Hermite matrices).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from operator import add
from typing import NamedTuple

from flint import fmpz_mat

from ptmcad.algebra.assignment import least_assignment
from ptmcad.algebra.determinants import determinant
from ptmcad.algebra.groebner import GroebnerBasis, Monomial, shifted
from ptmcad.algebra.polynomials import (
    Coefficient,
    Ratio,
    UnknownPolynomial,
    add_ratios,
    common_factor,
    constant_like,
    irreducible_factors,
    lcm,
    multiplicity,
    ratio,
)
from ptmcad.algebra.resultants import nothing
from ptmcad.errors import LimitReached

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
        kept = sorted(m for m in layer if not any(all(i <= j for i, j in zip(n, m, strict=True)) for n in leading))
        found += kept
        if most is not None and len(found) > most:
            raise LimitReached(f"more than {most} monomials are outside of the leading ideal")
        layer = {shifted(m, k) for m in kept for k in range(unknowns)}
    return tuple(found)


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
    unknowns = len(groebner.order.permutation)
    basis = standard_monomials(groebner.leading, unknowns)
    if basis is None:
        return None
    some = next(iter(groebner.elements[0].values()))
    one, zero = constant_like(some, 1), constant_like(some, 0)
    position = {m: i for i, m in enumerate(basis)}
    table: dict[Monomial, Vector] = {
        m: (tuple(one if i == k else zero for i in range(len(basis))), one) for m, k in position.items()
    }
    rules = dict(zip(groebner.leading, groebner.elements, strict=True))
    algebra = QuotientAlgebra(basis, table, zero, one)
    border = {shifted(m, k) for m in basis for k in range(unknowns)} - position.keys()
    for m in sorted(border, key=groebner.order.key):
        if m in rules:
            row = [zero] * len(basis)
            for n, c in rules[m].items():
                if n != m:
                    row[position[n]] = -c
            table[m] = _normalised(row, rules[m][m])
        else:
            # m is a proper multiple of a leading monomial, hence of a smaller border monomial
            k, below = next(
                (k, below)
                for k in range(unknowns)
                if m[k] and (below := shifted(m, k, -1)) in table and below not in position
            )
            table[m] = _times_unknown(algebra, k, table[below])
    return algebra


def _normalised(row: Sequence[Coefficient], denominator: Coefficient) -> Vector:
    common = common_factor([denominator, *row])
    if common.is_one():
        return tuple(row), denominator
    return tuple(c / common for c in row), denominator / common


def _sum(algebra: QuotientAlgebra, terms: Sequence[tuple[Coefficient, Coefficient, Vector]]) -> Vector:
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
        (c, denominator, algebra.table[shifted(m, k)])
        for m, c in zip(algebra.basis, row, strict=True)
        if not c.is_zero()
    ]
    return _sum(algebra, terms)


def normal_form(algebra: QuotientAlgebra, monomial: Monomial) -> Vector:
    """Coordinates of a monomial on the basis."""
    if monomial not in algebra.table:
        k = next(k for k, e in enumerate(monomial) if e)
        below = shifted(monomial, k, -1)
        algebra.table[monomial] = _times_unknown(algebra, k, normal_form(algebra, below))
    return algebra.table[monomial]


def element(algebra: QuotientAlgebra, p: UnknownPolynomial) -> Vector:
    """Coordinates of a polynomial on the basis."""
    return _sum(algebra, [(c, algebra.one, normal_form(algebra, m)) for m, c in p.items()])


def norm(algebra: QuotientAlgebra, p: UnknownPolynomial) -> Ratio:
    """The product of p over all complex solutions, as a rational function of the axes."""
    return determinant([[ratio(c, denominator) for c in row] for row, denominator in multiples(algebra, p)])


def multiples(algebra: QuotientAlgebra, p: UnknownPolynomial) -> tuple[Vector, ...]:
    """p times each element of the basis: the rows of the matrix of multiplication by p."""
    images: dict[Monomial, Vector] = {algebra.basis[0]: element(algebra, p)}
    for m in algebra.basis[1:]:
        k, below = next((k, below) for k in range(len(m)) if m[k] and (below := shifted(m, k, -1)) in images)
        images[m] = _times_unknown(algebra, k, images[below])
    return tuple(images[m] for m in algebra.basis)


def bounded_away_from_zero(rows: Sequence[Vector], product: Ratio, factor: Coefficient) -> bool:
    """Whether the values of p at the solutions are proved to stay away from 0 near almost all points of a curve.

    Also where solutions leave every bounded set. True is a proof; False means that the test did not decide.

    Parameters
    ----------
    rows : the `multiples` of p.
    product : its `norm`, not zero.
    factor : the curve's irreducible polynomial.

    Why: a coefficient of the characteristic polynomial is a sum of products of entries, one in each of some rows and
    columns of the same numbers. So its pole along the curve has at most the order of such a product of entries, the
    greatest of which is an assignment problem. When the constant one, the norm, has a pole of that order, the
    polynomial times a common denominator keeps a constant coefficient that does not vanish on the curve, and its roots
    stay away from 0 wherever that coefficient does.
    """
    orders = [[_order(c, denominator, factor) for c in row] for row, denominator in rows]
    for k, row in enumerate(orders):
        row[k] = min(row[k] or 0, 0)  # a row may be left out with its column
    return least_assignment(orders) == _order(product[0], product[1], factor)


def _order(numerator: Coefficient, denominator: Coefficient, factor: Coefficient) -> int | None:
    """The order of the zero of a fraction along a curve, negative for a pole; None for the fraction 0."""
    return None if numerator.is_zero() else multiplicity(numerator, factor) - multiplicity(denominator, factor)


def multiplication_denominator(algebra: QuotientAlgebra) -> Coefficient:
    """A common denominator of the multiplication matrices of the unknowns."""
    return lcm(algebra.table[shifted(m, k)][1] for m in algebra.basis for k in range(len(m)))


def table_terms(algebra: QuotientAlgebra) -> int:
    """The number of terms in the multiplication matrices of the unknowns."""
    rows = (algebra.table[shifted(m, k)][0] for m in algebra.basis for k in range(len(m)))
    return sum(len(c) for row in rows for c in row)


def power_trace_denominators(algebra: QuotientAlgebra, k: int) -> Coefficient:
    """The common denominator of trace(u^j), j = 1 ... dimension, for the unknown number k.

    By Newton's identities the zeros of this polynomial are the poles of the characteristic polynomial of u: the
    points of the plane near which the unknown u is unbounded on the solutions.
    """
    scale = algebra.one
    vectors = [algebra.table[m] for m in algebra.basis]
    for _ in range(algebra.dimension):
        vectors = [_times_unknown(algebra, k, v) for v in vectors]
        total: Ratio = (algebra.zero, algebra.one)
        for i, (numerators, denominator) in enumerate(vectors):
            total = add_ratios(total, ratio(numerators[i], denominator))
        scale = lcm((scale, total[1]))
    return scale


def poles_of_characteristic_polynomial(
    algebra: QuotientAlgebra, k: int, suspects: Sequence[Coefficient]
) -> list[Coefficient]:
    """Those of the irreducible polynomials on which the characteristic polynomial of the unknown number k has a pole.

    The same answer as by `power_trace_denominators`, with proof of each, from one interpolation.
    """
    from ptmcad.algebra import pencils  # few slices need it

    rows = [algebra.table[shifted(m, k)] for m in algebra.basis]
    matrix, scales = [row for row, _ in rows], [scale for _, scale in rows]
    coefficients, factors = pencils.characteristic(matrix, scales, pencils.places_of(lcm(scales)), nothing)
    found = []
    for f in suspects:
        leading = sum(multiplicity(scale, f) for scale in scales)
        known = sum(e for g, e in factors if g == f)
        if any(c and known + multiplicity(c, f) < leading for c in coefficients):
            found.append(f)
    return found


def poles_at_points(
    algebra: QuotientAlgebra, asked: Sequence[Coefficient], coordinates: Sequence[int]
) -> list[Coefficient]:
    """Those of the asked-for factors of `multiplication_denominator` on which solutions are seen to have poles.

    Guarantee: every polynomial that is returned divides the denominator of a power trace. For at an integer point the
    traces' denominators consist of primes of the values of the normal forms' denominators there; a prime that among
    these divides only the value of one factor, and is there, comes from that factor. One that is not returned had no
    such prime among those of values with a product of `_LARGE` or more, at as many points as that takes. That none is
    missed is not proved: where a numerator vanishes modulo all these primes, which has a probability near 1/`_LARGE`.
    """
    denominator = multiplication_denominator(algebra)
    content = math.gcd(*(int(c) for _, c in denominator.terms()))
    every = irreducible_factors(denominator)
    # of each polynomial in which no pole was seen so far, the product of its values' parts with primes of their own
    products, found = [1] * len(asked), [False] * len(asked)
    points = _points()
    while any(p < _LARGE and not pole for p, pole in zip(products, found, strict=True)):
        point = next(points)
        values = [abs(int(f(*point))) for f in every]
        if 0 in values:
            continue
        denominators = math.lcm(*(_trace_denominator(algebra, k, point) for k in coordinates))
        for k, f in enumerate(asked):
            others = content * math.prod(v for g, v in zip(every, values, strict=True) if g != f)
            own = _without_primes_of(abs(int(f(*point))), others)
            products[k] *= own
            found[k] = found[k] or math.gcd(own, denominators) > 1
    return [f for f, pole in zip(asked, found, strict=True) if pole]


_LARGE = 2**96
"""A product of a factor's values from which on it is no accident that no trace has a pole."""


def _points() -> Iterator[tuple[int, int]]:
    """Integer points without end, the same in every run.

    Any do, but at large ones values have more primes of their own. They grow, so that any curve is left in the end.
    """
    yield from ((1_000_003, 998_244_353), (2_147_483_647, 179_424_673))
    import random  # which few need

    source = random.Random("points")
    for bits in itertools.count(32):
        yield source.getrandbits(bits), source.getrandbits(bits)


def _trace_denominator(algebra: QuotientAlgebra, k: int, point: tuple[int, int]) -> int:
    """The common denominator of trace(u^j), j = 1 ... dimension, at a point, for the unknown number k."""
    size = algebra.dimension
    rows, scales = [], []
    for m in algebra.basis:
        numerators, denominator = algebra.table[shifted(m, k)]
        rows.append([int(c(*point)) for c in numerators])
        scales.append(int(denominator(*point)))
    scale = math.lcm(*scales)
    # powers of an integer matrix, which need no greatest common divisors on the way
    matrix = fmpz_mat(size, size, [c * (scale // s) for row, s in zip(rows, scales, strict=True) for c in row])
    power, common = matrix, 1
    for j in range(1, size + 1):
        denominator_of_power = scale**j
        trace = int(sum(power[i, i] for i in range(size)))
        common = math.lcm(common, denominator_of_power // math.gcd(denominator_of_power, trace))
        power = power * matrix
    return common


def _without_primes_of(n: int, other: int) -> int:
    while (common := math.gcd(n, other)) > 1:
        n //= common
    return n


def trace_form(algebra: QuotientAlgebra) -> list[list[Ratio]]:
    """The Hermite matrix trace(b_i b_j); its determinant vanishes where solutions coincide."""
    basis = algebra.basis
    products = [[normal_form(algebra, tuple(map(add, a, b))) for b in basis] for a in basis]
    traces = []
    for row in products:
        total: Ratio = (algebra.zero, algebra.one)
        for j, (numerators, denominator) in enumerate(row):
            total = add_ratios(total, ratio(numerators[j], denominator))
        traces.append(total)
    matrix = []
    for row in products:
        entries = []
        for numerators, denominator in row:
            total = (algebra.zero, algebra.one)
            for c, (trace, trace_denominator) in zip(numerators, traces, strict=True):
                if not c.is_zero():
                    total = add_ratios(total, ratio(c * trace, denominator * trace_denominator))
            entries.append(total)
        matrix.append(entries)
    return matrix
