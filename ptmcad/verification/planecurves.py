"""Polynomials over Q in the two axes: their irreducible factors, and discriminants and resultants with
respect to v of those in Z[u, v].

Guarantee: exact. Resultants are interpolated over Z, by as many values as Bezout's bounds ask for.
(The decomposition interpolates modulo primes; see `ptmcad.algebra.resultants`, which is not used
here.)
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache
from math import lcm

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx, fmpz, fmpz_poly

from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.plane import PlanePolynomial

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


# every critical value asks for them, and so does every further map with the same curves
@lru_cache(maxsize=256)
def discriminant(p: Terms) -> fmpz_poly:
    """The discriminant of p with respect to v, up to sign; 1 where p is linear in v."""
    if max(j for _, j, _ in p) < 2:
        return fmpz_poly([1])
    # res(p, p') is the leading coefficient times the discriminant
    return resultant(p, tuple((i, j - 1, j * c) for i, j, c in p if j)) // coefficients(p)[-1]


@lru_cache(maxsize=256)
def resultant(p: Terms, q: Terms) -> fmpz_poly:
    """The resultant of p and q with respect to v, up to sign, from its values at whole numbers."""
    rows = coefficients(p), coefficients(q)
    n, m = (len(one) - 1 for one in rows)
    of_p, of_q = (max(int(c.degree()) for c in one) for one in rows)
    whole_p, whole_q = (max(i + j for i, j, _ in one) for one in (p, q))
    degree = min(m * of_p + n * of_q, whole_p * whole_q)
    points: list[int] = []
    values: list[fmpz] = []
    u = 0
    while len(points) <= degree:
        left, right = (fmpz_poly([c(u) for c in one]) for one in rows)
        if left.degree() == n and right.degree() == m:
            points.append(u)
            values.append(left.resultant(right))
        u = -u if u > 0 else 1 - u
    for step in range(1, degree + 1):
        for k in range(degree, step - 1, -1):
            # whole, as divided differences at whole numbers of a polynomial over Z are
            values[k] = (values[k] - values[k - 1]) // (points[k] - points[k - step])
    found = fmpz_poly([0])
    while points:
        found = found * fmpz_poly([-points.pop(), 1]) + values.pop()
    return found


def coefficients(p: Terms, kept: int = 1) -> list[fmpz_poly]:
    """Coefficients, each in the other variable, of the powers of variable ``kept``: of v in Z[u]."""
    heights, lengths = (1 + max(term[k] for term in p) for k in (kept, 1 - kept))
    rows = [[0] * lengths for _ in range(heights)]
    for term in p:
        rows[term[kept]][term[1 - kept]] = term[2]
    return [fmpz_poly(row) for row in rows]
