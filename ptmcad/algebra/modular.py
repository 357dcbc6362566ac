"""Discriminants and resultants in Z[u] from their values at integers modulo primes of one machine word.

Guarantee: exact, and no prime is a bad one. What is computed modulo a prime is the formal discriminant or resultant
(the polynomial in the coefficients, for the given degrees in v), which commutes with every map of rings, also where
leading coefficients vanish. It is determined by as many points as a proved bound for the degree asks for, and by
primes whose product is more than twice a proved bound for its coefficients: nothing is left to chance.

The bound: a coefficient of D in Z[u] is at most the largest |D(u)| on the circle |u| = 1, where |c(u)| is at most the
sum |c|_1 of c's absolute coefficients. There Hadamard's inequality for Sylvester's matrix, with t v in place of v,
says

    |res_v(p, q)| <= t^(-n m) (sum_i |p_i|_1^2 t^(2i))^(m/2) (sum_j |q_j|_1^2 t^(2j))^(n/2)    for every t > 0,

and n^(n-2) disc_v(p) is up to sign the resultant of n p - v p' and p', both of degree n - 1. Any t will do; the
logarithm is convex in log t, so that a good one is soon found.

As a guard against a fault of the machine or of this program the result is compared, at a point and modulo a prime of
which nothing was used, with one further value.

References: Collins, The calculation of multivariate polynomial resultants, J. ACM 18 (1971); Goldstein & Graham, SIAM
Review 16 (1974); von zur Gathen & Gerhard, Modern Computer Algebra, sections 5.5, 6.8 and 10.3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from flint import fmpz, fmpz_poly, nmod_poly

from ptmcad.algebra import orders
from ptmcad.algebra.residues import PRIME_BITS, FaultyValue, blocks, combined, expanded, newton, primes, quotients

Coefficients = Sequence[fmpz_poly]
Check = Callable[[], None]
_CALL = 150.0
"""What one value modulo a prime costs besides Euclid's algorithm, in its steps (products of residues)."""


def discriminant(p: Coefficients, check: Check) -> fmpz_poly:
    """The discriminant with respect to v of sum_i p_i(u) v^i, for degree at least 2 in v."""
    from ptmcad.algebra import heights  # NumPy takes long to load

    n, degree = len(p) - 1, orders.discriminant_degree(p)
    if degree < 0:
        return fmpz_poly([])
    bits, s = _discriminant_bits(p)
    closer = heights.discriminant_bits(p, degree, math.floor(s))
    if closer is not None:
        bits = min(bits, closer)
    return _lifted(
        lambda u: _discriminant_at(_fibre(p, u), n), Bounds(degree, bits, orders.discriminant_factors(p)), check
    )


def resultant(p: Coefficients, q: Coefficients, check: Check) -> fmpz_poly:
    """The resultant with respect to v."""
    n, m = len(p) - 1, len(q) - 1
    bounds = Bounds(orders.resultant_degree(p, q), resultant_bits(p, q), ())
    return _lifted(lambda u: _resultant_at(_fibre(p, u), _fibre(q, u), n, m), bounds, check)


def pays(degrees: tuple[int, int], degree: int, bits: int) -> bool:
    """Whether this way is predicted to be the faster one than by values in integers.

    Parameters
    ----------
    degrees : in v of the two polynomials whose resultant it is; of a discriminant those of p and p'.
    degree : bound for that in u.
    bits : bound for the length of the result's coefficients.
    """
    steps = degrees[0] * degrees[1]
    # a value at u is longer than the coefficients by that of u^degree, and its primes are also one word
    in_integers = bits + degree * math.log2(degree / 2 + 2)
    return bits * (steps + _CALL) < in_integers * steps


def discriminant_bits(p: Coefficients) -> int:
    """A number b with 2^b larger than every coefficient of the discriminant, by Hadamard's inequality."""
    return _discriminant_bits(p)[0]


def _discriminant_bits(p: Coefficients) -> tuple[int, float]:
    n = len(p) - 1
    norms = _norms(p)
    bits, s = _hadamard([(n - i) * c for i, c in enumerate(norms[:-1])], [i * c for i, c in enumerate(norms)][1:])
    return max(bits - math.floor((n - 2) * math.log2(n)), 0), s


def resultant_bits(p: Coefficients, q: Coefficients) -> int:
    """A number b with 2^b larger than every coefficient of the resultant."""
    return _hadamard(_norms(p), _norms(q))[0]


def _norms(p: Coefficients) -> list[int]:
    return [sum(abs(int(a)) for a in c.coeffs()) for c in p]


def _hadamard(p: Sequence[int], q: Sequence[int]) -> tuple[int, float]:
    """Of the bound above the binary logarithm, rounded up with a bit to spare for the rounding of doubles; and log2
    t."""
    n, m = len(p) - 1, len(q) - 1
    left, right = ([(i, math.log2(c)) for i, c in enumerate(r) if c] for r in (p, q))
    if not left or not right:
        return 0, 0.0

    def bits(s: float) -> float:
        return m * _half_log(left, s) + n * _half_log(right, s) - n * m * s

    low, high = -256.0, 256.0
    for _ in range(60):
        third = (high - low) / 3
        if bits(low + third) < bits(high - third):
            high -= third
        else:
            low += third
    found = bits(low)
    return max(math.ceil(found + 1 + 2**-30 * (abs(found) + n * m * abs(low))), 0), low


def _half_log(logs: Sequence[tuple[int, float]], s: float) -> float:
    """log2 of the root of sum c_i^2 2^(2 i s), from the pairs (i, log2 c_i)."""
    terms = [c + i * s for i, c in logs]
    most = max(terms)
    return most + math.log2(math.fsum(4.0 ** (t - most) for t in terms)) / 2


ValueModulo = Callable[[int], int]
"""A value in dependence of the prime modulo which it is taken."""


class Bounds(NamedTuple):
    """What is proved of a polynomial in Z[u] beforehand.

    Attributes
    ----------
    degree : it has at most this one.
    bits : its coefficients are smaller than 2^bits.
    factors : powers of irreducible polynomials that divide it.
    """

    degree: int
    bits: int
    factors: orders.Factors


def _lifted(at: Callable[[int], ValueModulo], bounds: Bounds, check: Check) -> fmpz_poly:
    """The polynomial of which ``at(u)(prime)`` are values: its cofactor of the known factors is interpolated."""
    degree = bounds.degree - orders.degree(bounds.factors)
    if degree < 0:
        return fmpz_poly([])
    first = _first_point(bounds.factors, degree)
    points = range(first, first + degree + 1)
    values = [at(u) for u in points]
    known = [fmpz(v) for v in orders.values(bounds.factors, points)]
    factor = math.prod((f**e for f, e in bounds.factors), start=fmpz_poly([1]))
    products = blocks(first, degree + 1)
    images: list[tuple[nmod_poly, int]] = []
    waiting = primes()
    while (bounds.bits + 1) // (PRIME_BITS - 1) >= len(images):
        check()
        prime = next(waiting)
        divisors = [int(v % prime) for v in known]
        if 0 in divisors:
            continue
        found = quotients([value(prime) for value in values], divisors, prime)
        cofactor = expanded(newton(found, prime), first, products, prime)
        images.append((cofactor * nmod_poly(factor, prime), prime))
    result = combined(images)
    further, fresh = first + degree + 1, next(waiting)
    if int(result(further)) % fresh != at(further)(fresh):
        raise FaultyValue(f"a polynomial interpolated modulo {len(images)} primes is wrong at {further}")
    return result


def _first_point(factors: orders.Factors, degree: int) -> int:
    """The first of ``degree`` + 1 consecutive integers, small ones, at which no factor is zero."""
    zeros = [-int(f[0]) // int(f[1]) for f, _ in factors if f.degree() == 1 and abs(int(f[1])) == 1]
    zeros = sorted(z for z in zeros if -degree <= z <= degree)
    return zeros[-1] + 1 if zeros else -(degree // 2)


def _fibre(p: Coefficients, u: int) -> fmpz_poly:
    return fmpz_poly([c(u) for c in p])


def _discriminant_at(fibre: fmpz_poly, n: int) -> ValueModulo:
    """The formal discriminant of degree n, modulo a prime."""

    def value(prime: int) -> int:
        image = nmod_poly(fibre, prime)
        d = image.degree()
        if d == n:
            return int(image.discriminant())
        if d < n - 1:
            return 0
        return int(image.leading_coefficient() ** 2 * (image.discriminant() if d > 1 else 1))

    return value


def _resultant_at(left: fmpz_poly, right: fmpz_poly, n: int, m: int) -> ValueModulo:
    """The formal resultant of degrees n and m, modulo a prime."""

    def value(prime: int) -> int:
        p, q = nmod_poly(left, prime), nmod_poly(right, prime)
        short, shorter = n - p.degree(), m - q.degree()
        if short and shorter:
            return 0
        found = p.resultant(q)
        if short:
            found *= q.leading_coefficient() ** short * (-1) ** (m * short)
        elif shorter:
            found *= p.leading_coefficient() ** shorter
        return int(found)

    return value
