"""Polynomials over Q in the two axes: their irreducible factors, and discriminants and resultants of those
in Z[u, v].

Guarantee: exact. FLINT eliminates v by subresultants. Where u is eliminated with a polynomial in u
alone, coefficients are at most the largest absolute value on the unit circle, which Hadamard's
inequality bounds. (The decomposition interpolates modulo primes; see `ptmcad.algebra.resultants`,
which is not used here.)
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache
from math import lcm

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.plane import PlanePolynomial

Interval = tuple[fmpq, fmpq]
# Not over Z: python-flint sorts those factors by coefficients as machine integers.
PLANE: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(("u", "v"), Ordering.lex)


def polynomial(terms: Iterable[tuple[int, int, Fraction | int]]) -> fmpq_mpoly:
    """The polynomial of some terms."""
    return PLANE.from_dict({(i, j): from_fraction(c) for i, j, c in terms})


def factored(p: fmpq_mpoly) -> list[tuple[PlanePolynomial, int]]:
    """The irreducible factors of a polynomial that is not zero, with their multiplicities."""
    return [(_primitive(factor), int(multiplicity)) for factor, multiplicity in p.factor()[1]]


def factors(p: fmpq_mpoly) -> list[PlanePolynomial]:
    """Each of them once."""
    return [factor for factor, _ in factored(p)]


def _primitive(p: fmpq_mpoly) -> PlanePolynomial:
    scale = lcm(*(int(c.q) for c in p.coeffs()))
    return PlanePolynomial.of((int(i), int(j), int((c * scale).p)) for (i, j), c in p.terms())


Terms = tuple[tuple[int, int, int], ...]
"""(i, j, c) for c u^i v^j."""

_INTEGRAL: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(("u", "v"), Ordering.lex)


# every critical value asks for them, and so does every further map with the same curves
@lru_cache(maxsize=256)
def discriminant(p: Terms) -> fmpz_poly:
    """The discriminant of p with respect to v, up to sign; 1 where p is linear in v."""
    if max(j for _, j, _ in p) < 2:
        return fmpz_poly([1])
    return _in_u(_integral(p).discriminant("v"))


@lru_cache(maxsize=256)
def resultant(p: Terms, q: Terms) -> fmpz_poly:
    """The resultant of p and q with respect to v, up to sign."""
    return _in_u(_integral(p).resultant(_integral(q), "v"))


def _integral(p: Terms) -> fmpz_mpoly:
    return _INTEGRAL.from_dict({(i, j): c for i, j, c in p})


def _in_u(p: fmpz_mpoly) -> fmpz_poly:
    row = {int(i): c for (i, _), c in p.terms()}
    return fmpz_poly([row.get(i, 0) for i in range(max(row, default=-1) + 1)])


def norm(p: Terms, q: fmpz_poly) -> fmpz_poly:
    """The resultant of p and a polynomial in u alone with respect to u, up to sign: a polynomial in
    v that is zero where p is at some root of q.

    Its value at a large power of two has its coefficients as digits.
    """
    rows = [{j: c for i, j, c in p if i == k} for k in range(1 + max(i for i, _, _ in p))]
    sizes = sum(sum(map(abs, row.values())) ** 2 for row in rows), sum(int(c) ** 2 for c in q)
    bits = (sizes[0] ** int(q.degree()) * sizes[1] ** (len(rows) - 1)).bit_length() // 2 + 3
    at_base = fmpz_poly([sum(c << (bits * j) for j, c in row.items()) for row in rows])
    rest, half, digits = int(at_base.resultant(q)), 1 << (bits - 1), list[int]()
    while rest:
        digits.append((rest + half) % (2 * half) - half)
        rest = (rest - digits[-1]) >> bits
    return fmpz_poly(digits)
