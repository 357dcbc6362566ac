"""Discriminants and resultants with respect to v of polynomials in Z[u, v], which FLINT computes.

Guarantee: exact, up to sign.
"""

from __future__ import annotations

from functools import lru_cache

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

Terms = tuple[tuple[int, int, int], ...]
"""(i, j, c) for c u^i v^j."""
_RING: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(("u", "v"), Ordering.lex)


# every critical value asks for them, and so does every further map with the same curves
@lru_cache(maxsize=256)
def discriminant(p: Terms) -> fmpz_poly:
    """The discriminant of p, up to sign."""
    return fmpz_poly([1]) if max(j for _, j, _ in p) < 2 else _in_u(_polynomial(p).discriminant("v"))


@lru_cache(maxsize=256)
def resultant(p: Terms, q: Terms) -> fmpz_poly:
    """The resultant of p and q, up to sign."""
    return _in_u(_polynomial(p).resultant(_polynomial(q), "v"))


def _polynomial(terms: Terms) -> fmpz_mpoly:
    return _RING.from_dict({(i, j): c for i, j, c in terms})


def _in_u(p: fmpz_mpoly) -> fmpz_poly:
    """A polynomial in which no v is left."""
    coefficients = [0] * (int(p.degrees()[0]) + 1 if p else 1)
    for (i, _), c in p.terms():
        coefficients[int(i)] = int(c)
    return fmpz_poly(coefficients)
