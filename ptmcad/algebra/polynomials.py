"""Polynomials and fractions over Z[x, y], x and y being the axes of a slice, and over Z[x, y, z]
for a family of them.

Guarantee: exact. Fractions are kept in lowest terms up to sign. What is said of Z[x, y] holds in
either ring: a function answers in that of its arguments.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

from flint import (
    Ordering,
    arb,
    arb_poly,
    fmpq,
    fmpq_mpoly,
    fmpq_mpoly_ctx,
    fmpq_poly,
    fmpz_mat,
    fmpz_mpoly,
    fmpz_mpoly_ctx,
    fmpz_poly,
)

from ptmcad.text.expressions import Expression
from ptmcad.text.plane import PlanePolynomial

PLANE: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(("x", "y"), Ordering.degrevlex)
ZERO: fmpz_mpoly = PLANE.constant(0)
ONE: fmpz_mpoly = PLANE.constant(1)
SPACE: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(("x", "y", "z"), Ordering.degrevlex)
"""The ring of a family, whose third parameter is z."""

Coefficient = fmpz_mpoly
"""An element of Z[x, y], or of Z[x, y, z]."""
UnivariatePolynomial = fmpz_poly
"""An element of Z[u] or Z[v], the polynomials in one axis."""
RationalUnivariate = fmpq_poly
"""An element of Q[u]."""
Monomial = tuple[int, ...]
"""Exponents of the unknowns."""
UnknownPolynomial = dict[Monomial, fmpz_mpoly]
"""A polynomial in the unknowns with coefficients in Z[x, y]: exponent vector -> nonzero
coefficient.
"""
Ratio = tuple[fmpz_mpoly, fmpz_mpoly]
"""Numerator and nonzero denominator."""
Ratios = Mapping[str, Ratio]
"""Parameters by name, as functions of axes."""
Values = Mapping[str, fmpq]
"""Parameters by name, as numbers."""


def ratio(numerator: fmpz_mpoly, denominator: fmpz_mpoly) -> Ratio:
    """numerator/denominator in lowest terms."""
    common = numerator.gcd(denominator)
    return (
        (numerator, denominator) if common.is_one() else (numerator / common, denominator / common)
    )


def add_ratios(left: Ratio, right: Ratio) -> Ratio:
    """The sum in lowest terms."""
    if left[1] == right[1]:
        return ratio(left[0] + right[0], left[1])
    common = left[1].gcd(right[1])
    cofactor = right[1] / common
    return ratio(left[0] * cofactor + right[0] * (left[1] / common), left[1] * cofactor)


def constant_like(p: fmpz_mpoly, value: int) -> fmpz_mpoly:
    """An integer in the ring of another polynomial."""
    return p.context().constant(value)


def lcm(polynomials: Iterable[fmpz_mpoly]) -> fmpz_mpoly:
    """Least common multiple, up to a unit; 1 in Z[x, y] of none."""
    found = iter(polynomials)
    return reduce(lambda a, b: a * (b / a.gcd(b)), found, next(found, ONE))


def common_factor(polynomials: Iterable[fmpz_mpoly]) -> fmpz_mpoly:
    """Greatest common divisor, integer content included; 0 when all are zero, in Z[x, y] when there
    are none.
    """
    common: fmpz_mpoly | None = None
    for p in polynomials:
        common = p.gcd(constant_like(p, 0) if common is None else common)
        if common.is_one():
            break
    return ZERO if common is None else common


def irreducible_factors(*polynomials: Coefficient) -> list[Coefficient]:
    """The different irreducible factors over Q that are not constant, primitive and without
    multiplicity.

    The factorisation goes through polynomials over Q, because python-flint 0.9 sorts the factors
    over Z by coefficients as machine integers and raises OverflowError for longer ones.
    """
    found: dict[str, Coefficient] = {}
    for p in polynomials:
        ring = p.context()
        over_q = fmpq_mpoly_ctx.get(ring.names(), Ordering.degrevlex).from_dict(p.to_dict())
        factors = [_primitive(factor, ring) for factor, _ in over_q.factor()[1]]
        found |= {str(factor): factor for factor in factors}
    return list(found.values())


def multiplicity(p: Coefficient, factor: Coefficient) -> int:
    """How often a polynomial that is not constant divides p, which is not zero."""
    count = 0
    quotient, rest = divmod(p, factor)
    while rest.is_zero():
        count += 1
        quotient, rest = divmod(quotient, factor)
    return count


def _primitive(p: fmpq_mpoly, ring: fmpz_mpoly_ctx) -> fmpz_mpoly:
    """The polynomial over Z without common factor, the coefficient of the highest exponents
    positive.
    """
    integers = dict(
        zip(
            (tuple(map(int, powers)) for powers in p.monoms()), integral(p.coeffs())[0], strict=True
        )
    )
    content = math.gcd(*integers.values())
    if integers[max(integers)] < 0:
        content = -content
    return ring.from_dict({powers: c // content for powers, c in integers.items()})


def integral(values: Iterable[fmpq]) -> tuple[list[int], int]:
    """Rational numbers as integers over their least common denominator."""
    known = [(int(value.p), int(value.q)) for value in values]
    scale = math.lcm(*(q for _, q in known))
    return [p * (scale // q) for p, q in known], scale


def from_terms(terms: Iterable[tuple[int, int, Fraction]]) -> tuple[fmpz_mpoly, int]:
    """Terms with rational coefficients as (p, d), meaning p/d with p in Z[x, y] and an integer
    d > 0.
    """
    terms = tuple(terms)
    scale = math.lcm(*(c.denominator for _, _, c in terms))
    return PLANE.from_dict(
        {(i, j): c.numerator * (scale // c.denominator) for i, j, c in terms}
    ), scale


def from_expression(expression: Expression) -> Ratio:
    """An expression in the axes as a ratio of polynomials."""
    numerator, numerator_scale = from_terms(expression.numerator)
    denominator, denominator_scale = from_terms(expression.denominator)
    return ratio(numerator * denominator_scale, denominator * numerator_scale)


def at_third(p: fmpz_mpoly, value: fmpq, degree: int | None = None) -> fmpz_mpoly:
    """An element of Z[x, y, z] at a rational z, in Z[x, y]: the value times d^degree, d being the
    denominator of z.

    Parameters
    ----------
    degree : at least the degree in z, which it is when None.
    """
    top = int(p.degrees()[2]) if degree is None else degree
    a, b = int(value.p), int(value.q)
    powers = [a**k * b ** (top - k) for k in range(top + 1)]
    found: dict[tuple[int, ...], int] = {}
    for (i, j, k), c in p.terms():
        place = (int(i), int(j))
        found[place] = found.get(place, 0) + int(c) * powers[int(k)]
    return PLANE.from_dict(found)


def to_plane(p: fmpz_mpoly) -> PlanePolynomial:
    """The engine-neutral form, primitive."""
    return PlanePolynomial.of((i, j, int(c)) for (i, j), c in p.terms())


def from_plane(p: PlanePolynomial) -> fmpz_mpoly:
    """The FLINT form of an engine-neutral polynomial."""
    return PLANE.from_dict({(i, j): c for i, j, c in p.terms})


def coefficients_in(p: fmpz_mpoly, variable: int) -> tuple[fmpz_poly, ...]:
    """Coefficients of p as a polynomial in one axis, constant first; each is a polynomial in the
    other axis.
    """
    rows: dict[int, dict[int, int]] = {}
    for monomial, c in p.terms():
        rows.setdefault(int(monomial[variable]), {})[int(monomial[1 - variable])] = int(c)
    return tuple(
        fmpz_poly([row.get(i, 0) for i in range(max(row, default=-1) + 1)])
        for row in (rows.get(k, {}) for k in range(max(rows, default=0) + 1))
    )


def univariate(coefficients: tuple[fmpz_poly, ...], at: fmpq) -> fmpz_poly:
    """The integer polynomial proportional, by a positive factor, to sum_j c_j(at) v^j."""
    return fmpz_poly(integral([fmpq(c(at)) for c in coefficients])[0])


def evaluate(p: fmpz_mpoly, *at: fmpq) -> fmpq:
    """The exact value at a rational point."""
    if p.is_constant():  # as most parameters of a slice are
        return fmpq(p.coeffs()[0]) if p else fmpq(0)
    terms = ((fmpq(c), map(pow, at, map(int, powers))) for powers, c in p.terms())
    return sum((math.prod(factors, start=c) for c, factors in terms), fmpq(0))


def translated(rows: Sequence[Any], by: Any, number: int | None = None) -> list[Any]:
    """The coefficients of p(by + w) by w, from those of p(w): all, or so many first ones."""
    found = list(rows)
    number = len(found) if number is None else number
    for start in range(min(len(found) - 1, number)):
        for i in range(len(found) - 2, start - 1, -1):
            found[i] = found[i] + found[i + 1] * by
    return found[:number]


def local_coefficients(
    in_v: Sequence[fmpz_poly],
    middle: fmpq | arb,
    radius: fmpq | arb,
    origin: fmpq | arb,
    number: int | None = None,
) -> list[arb_poly]:
    """Coefficients b_i(h) of p(middle + radius h, origin + w) = sum_i b_i(h) w^i: all, or so many
    first ones.
    """
    line = arb_poly([arb(middle), arb(radius)])
    return translated([arb_poly(c)(line) for c in in_v], arb(origin), number)


class Restrictions:
    """sum_j c_j(u) v^j for given u, in hundreds of places.

    The coefficients are a matrix, and one place is one product with the powers of its number: three
    to five times faster than evaluating each coefficient, which reduces fractions.

    Parameters
    ----------
    rows : c_j in Z[u], the last one not zero.
    """

    __slots__ = ("_matrix", "_rows")

    def __init__(self, rows: tuple[UnivariatePolynomial, ...]) -> None:
        self._rows = rows
        self._matrix: fmpz_mat | None = None

    def at(self, u: fmpq) -> UnivariatePolynomial:
        """A positive multiple of the polynomial in Z[v]."""
        if self._matrix is None:
            length = 1 + max(row.degree() for row in self._rows)
            self._matrix = fmpz_mat([[row[i] for i in range(length)] for row in self._rows])
        # u^i times the largest power of the denominator
        p, q = int(u.p), int(u.q)
        powers = [1]
        for _ in range(self._matrix.ncols() - 1):
            powers.append(powers[-1] * p)
        factor = 1
        for i in range(len(powers) - 1, -1, -1):
            powers[i] *= factor
            factor *= q
        return fmpz_poly((self._matrix * fmpz_mat(len(powers), 1, powers)).entries())
