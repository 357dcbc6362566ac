"""Polynomials and fractions over Z[x, y], x and y being the axes of a slice.

Guarantee: exact. Fractions are kept in lowest terms up to sign.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from functools import reduce

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from ptmcad.text.expressions import Expression
from ptmcad.text.plane import PlanePolynomial

PLANE: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(("x", "y"), Ordering.degrevlex)
ZERO: fmpz_mpoly = PLANE.constant(0)
ONE: fmpz_mpoly = PLANE.constant(1)

Coefficient = fmpz_mpoly
"""An element of Z[x, y]."""
UnivariatePolynomial = fmpz_poly
"""An element of Z[u] or Z[v], the polynomials in one axis."""
Ratio = tuple[fmpz_mpoly, fmpz_mpoly]
"""Numerator and nonzero denominator."""


def ratio(numerator: fmpz_mpoly, denominator: fmpz_mpoly) -> Ratio:
    """numerator/denominator in lowest terms."""
    common = numerator.gcd(denominator)
    return (numerator, denominator) if common.is_one() else (numerator / common, denominator / common)


def add_ratios(left: Ratio, right: Ratio) -> Ratio:
    """The sum in lowest terms."""
    if left[1] == right[1]:
        return ratio(left[0] + right[0], left[1])
    common = left[1].gcd(right[1])
    cofactor = right[1] / common
    return ratio(left[0] * cofactor + right[0] * (left[1] / common), left[1] * cofactor)


def lcm(polynomials: Iterable[fmpz_mpoly]) -> fmpz_mpoly:
    """Least common multiple, up to a unit."""
    return reduce(lambda a, b: a * (b / a.gcd(b)), polynomials, ONE)


def common_factor(polynomials: Iterable[fmpz_mpoly]) -> fmpz_mpoly:
    """Greatest common divisor, integer content included; 0 when all are zero."""
    common = ZERO
    for p in polynomials:
        common = common.gcd(p)
        if common.is_one():
            break
    return common


_RATIONAL_PLANE: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(("x", "y"), Ordering.degrevlex)


def irreducible_factors(p: Coefficient) -> list[Coefficient]:
    """The irreducible factors over Q that are not constant, primitive and without multiplicity."""
    return [factor for factor, _ in factors_with_multiplicity(p)]


def factors_with_multiplicity(p: Coefficient) -> list[tuple[Coefficient, int]]:
    """The irreducible factors over Q that are not constant, primitive, each with its multiplicity.

    The factorisation goes through Q[x, y], because python-flint 0.9 sorts the factors over Z[x, y] by coefficients as
    machine integers and raises OverflowError for longer ones.
    """
    over_q = _RATIONAL_PLANE.from_dict({(int(i), int(j)): c for (i, j), c in p.terms()})
    return [(from_plane(_primitive(factor)), int(power)) for factor, power in over_q.factor()[1]]


def _primitive(p: fmpq_mpoly) -> PlanePolynomial:
    terms = [(int(i), int(j), c) for (i, j), c in p.terms()]
    scale = math.lcm(*(int(c.q) for _, _, c in terms))
    return PlanePolynomial.of((i, j, int(c.p) * (scale // int(c.q))) for i, j, c in terms)


def from_terms(terms: Iterable[tuple[int, int, Fraction]]) -> tuple[fmpz_mpoly, int]:
    """Terms with rational coefficients as (p, d), meaning p/d with p in Z[x, y] and an integer d > 0."""
    terms = tuple(terms)
    scale = math.lcm(*(c.denominator for _, _, c in terms))
    return PLANE.from_dict({(i, j): c.numerator * (scale // c.denominator) for i, j, c in terms}), scale


def from_expression(expression: Expression) -> Ratio:
    """An expression in the axes as a ratio of polynomials."""
    numerator, numerator_scale = from_terms(expression.numerator)
    denominator, denominator_scale = from_terms(expression.denominator)
    return ratio(numerator * denominator_scale, denominator * numerator_scale)


def to_plane(p: fmpz_mpoly) -> PlanePolynomial:
    """The engine-neutral form, primitive."""
    return PlanePolynomial.of((i, j, int(c)) for (i, j), c in p.terms())


def from_plane(p: PlanePolynomial) -> fmpz_mpoly:
    """The FLINT form of an engine-neutral polynomial."""
    return PLANE.from_dict({(i, j): c for i, j, c in p.terms})


def coefficients_in(p: fmpz_mpoly, variable: int) -> tuple[fmpz_poly, ...]:
    """Coefficients of p as a polynomial in one axis, constant first; each is a polynomial in the other axis."""
    rows: dict[int, dict[int, int]] = {}
    for monomial, c in p.terms():
        rows.setdefault(int(monomial[variable]), {})[int(monomial[1 - variable])] = int(c)
    return tuple(
        fmpz_poly([row.get(i, 0) for i in range(max(row, default=-1) + 1)])
        for row in (rows.get(k, {}) for k in range(max(rows, default=0) + 1))
    )


def univariate(coefficients: tuple[fmpz_poly, ...], at: fmpq) -> fmpz_poly:
    """The integer polynomial proportional, by a positive factor, to sum_j c_j(at) v^j."""
    values = [fmpq(c(at)) for c in coefficients]
    scale = math.lcm(*(int(value.q) for value in values))
    return fmpz_poly([int(value.p) * (scale // int(value.q)) for value in values])


def to_fraction(value: fmpq) -> Fraction:
    """A FLINT rational as a Python fraction."""
    return Fraction(int(value.p), int(value.q))


def from_fraction(value: Fraction) -> fmpq:
    """A Python fraction as a FLINT rational."""
    return fmpq(value.numerator, value.denominator)


def evaluate(p: fmpz_mpoly, x: fmpq, y: fmpq) -> fmpq:
    """The exact value at a rational point."""
    return sum((fmpq(c) * x**i * y**j for (i, j), c in p.terms()), fmpq(0))


UnknownPolynomial = dict[tuple[int, ...], fmpz_mpoly]
"""A polynomial in the unknowns with coefficients in Z[x, y]: exponent vector -> nonzero coefficient."""
