"""Discriminants and resultants with respect to v of polynomials in Z[u, v], from their values at integers u.

Guarantee: exact. With a weight w >= 0 for v, a Sylvester determinant of polynomials of weighted degrees a, b and of
degrees n, m in v has degree at most a m + b n - w n m in u: v = u^w z scales row by row and column by column. The
smallest of these bounds over the slopes between two exponents is taken, and one value more than it is computed. Each
value is FLINT's for polynomials in one variable.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from math import floor

from flint import fmpz, fmpz_poly

Terms = tuple[tuple[int, int, int], ...]
"""(i, j, c) for c u^i v^j."""


# every critical value asks for them, and so does every further map with the same curves
@lru_cache(maxsize=256)
def discriminant(p: Terms) -> fmpz_poly:
    """The discriminant of p, up to sign."""
    n = _degree(p)
    if n < 2:
        return fmpz_poly([1])
    derivative = tuple((i, j - 1, j * c) for i, j, c in p if j)
    # res(p, p') is the leading coefficient times the discriminant
    return resultant(p, derivative) // fmpz_poly(_row(p, n))


@lru_cache(maxsize=256)
def resultant(p: Terms, q: Terms) -> fmpz_poly:
    """The resultant of p and q, up to sign."""
    n, m = _degree(p), _degree(q)
    if n == 0 or m == 0:
        return fmpz_poly(_row(p, 0)) ** m if n == 0 else fmpz_poly(_row(q, 0)) ** n
    rows_p, rows_q = ([fmpz_poly(_row(t, j)) for j in range(d + 1)] for t, d in ((p, n), (q, m)))

    def value(u: int) -> fmpz:
        left, right = fmpz_poly([c(u) for c in rows_p]), fmpz_poly([c(u) for c in rows_q])
        short_left, short_right = n - left.degree(), m - right.degree()
        if short_left and short_right:
            return fmpz(0)
        # a determinant of Sylvester's form with leading zeros in one polynomial
        factor = fmpz(right[m]) ** short_left * fmpz(left[n]) ** short_right
        return fmpz(left.resultant(right)) * (-factor if (m * short_left) % 2 else factor)

    left, right = _highest(p), _highest(q)
    slopes = _slopes(left) | _slopes(right)
    bound = min(floor(_weight(left, w) * m + _weight(right, w) * n - w * n * m) for w in slopes)
    return _from_values(value, bound)


def _degree(p: Terms) -> int:
    return max(j for _, j, _ in p)


def _row(p: Terms, power: int) -> list[int]:
    row: dict[int, int] = {i: c for i, j, c in p if j == power}
    return [row.get(i, 0) for i in range(max(row, default=-1) + 1)]


def _highest(p: Terms) -> dict[int, int]:
    """The degree in u of the coefficient of each power of v."""
    highest: dict[int, int] = {}
    for i, j, _ in p:
        highest[j] = max(highest.get(j, 0), i)
    return highest


def _weight(highest: dict[int, int], w: Fraction) -> Fraction:
    return max(i + w * j for j, i in highest.items())


def _slopes(highest: dict[int, int]) -> set[Fraction]:
    found = {Fraction(0)}
    for j, i in highest.items():
        found |= {Fraction(i - k, m - j) for m, k in highest.items() if m > j and i > k}
    return found


def _from_values(value: Callable[[int], fmpz], degree: int) -> fmpz_poly:
    """The integer polynomial of at most this degree with these values at 0, 1, ..., by binomial coefficients."""
    row = [value(u) for u in range(degree + 1)]
    heads = []
    while row:
        heads.append(row[0])
        row = [b - a for a, b in pairwise(row)]
    # sum of heads[k] binomial(u, k), nested: binomial(u, k + 1) = binomial(u, k) (u - k) / (k + 1)
    total, scale = fmpz_poly([0]), fmpz(1)
    for k in range(degree, -1, -1):
        total = total * fmpz_poly([-k, 1]) + heads[k] * scale
        scale *= max(k, 1)
    return total / int(scale)
