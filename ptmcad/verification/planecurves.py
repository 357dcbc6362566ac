"""Polynomials over Q in the two axes: their irreducible factors, and discriminants and resultants with
respect to v of those in Z[u, v], from their values at integers u.

Guarantee: exact. With a weight w >= 0 for v, a Sylvester determinant of polynomials of weighted
degrees a, b and of degrees n, m in v has degree at most a m + b n - w n m in u: v = u^w z scales
row by row and column by column. The smallest of these bounds over the slopes between two exponents
is taken, and modulo each prime one value more than it is computed. Coefficients are at most the
largest absolute value on the unit circle, which Hadamard's inequality bounds; primes are taken
until their product is more than twice that.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import lru_cache
from itertools import accumulate
from math import floor, lcm

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx, fmpz, fmpz_poly, nmod, nmod_poly

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

    left, right = _highest(p), _highest(q)
    slopes = _slopes(left) | _slopes(right)
    bound = min(floor(_weight(left, w) * m + _weight(right, w) * n - w * n * m) for w in slopes)
    over = [
        (fmpz_poly([c(u) for c in rows_p]), fmpz_poly([c(u) for c in rows_q]))
        for u in range(bound + 1)
    ]
    found, modulus = fmpz_poly([0]), fmpz(1)
    for prime in _primes(1 + (_square(p) ** m * _square(q) ** n).bit_length() // 2 + 1):
        residue = _interpolated([_modulo(prime, *pair, n, m) for pair in over], prime)
        step = (residue - nmod_poly(found, prime)) * (1 / nmod(modulus, prime))
        found += fmpz_poly([int(c) for c in step.coeffs()]) * modulus
        modulus *= prime
    return fmpz_poly([c - modulus if 2 * c > modulus else c for c in found.coeffs()])


def _modulo(prime: int, p: fmpz_poly, q: fmpz_poly, n: int, m: int) -> nmod:
    """The determinant of Sylvester's form of polynomials of degrees up to n and m, modulo a prime."""
    left, right = nmod_poly(p, prime), nmod_poly(q, prime)
    short_left, short_right = n - left.degree(), m - right.degree()
    if short_left and short_right:
        return nmod(0, prime)
    # a determinant perhaps with leading zeros in one polynomial
    found: nmod = (
        left.resultant(right)
        * right[m] ** short_left
        * left[n] ** short_right
        * (-1) ** (m * short_left)
    )
    return found


def _primes(bits: int) -> Iterator[int]:
    """Primes whose product has at least so many bits."""
    number, product = 2**62, 1
    while product.bit_length() <= bits:
        number -= 1
        if fmpz(number).is_prime():
            yield number
            product *= number


def _square(p: Terms) -> int:
    """A bound of the sum of the squares of the coefficients of powers of v, for |u| = 1."""
    return sum(sum(abs(c) for _, j, c in p if j == power) ** 2 for power in {j for _, j, _ in p})


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


def _interpolated(values: list[nmod], prime: int) -> nmod_poly:
    """The polynomial of least degree with these values at 0, 1, ..., modulo a prime, put together
    by a tree.
    """
    factorials = [*accumulate(range(1, len(values)), lambda a, k: a * k, initial=nmod(1, prime))]
    weights = [
        (-1) ** k * a * b
        for k, (a, b) in enumerate(zip(factorials, reversed(factorials), strict=True))
    ]
    sign = (-1) ** (len(values) - 1)
    # sums of numbers over linear factors, with their common denominators
    parts = [
        (nmod_poly([sign * value / weight], prime), nmod_poly([-u, 1], prime))
        for u, (value, weight) in enumerate(zip(values, weights, strict=True))
    ]
    while len(parts) > 1:
        joined = [
            (a * d + c * b, b * d) for (a, b), (c, d) in zip(parts[::2], parts[1::2], strict=False)
        ]
        parts = joined + parts[len(parts) - len(parts) % 2 :]
    return parts[0][0]
