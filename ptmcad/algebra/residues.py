"""Primes of one machine word, quotients modulo them, and integers from their residues.

Guarantee: exact. Consecutive integers are the points of interpolation, so that no divisor is divisible by the prime.

Reference: von zur Gathen & Gerhard, Modern Computer Algebra, sections 5.2 to 5.4 and 10.3.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import accumulate

from flint import fmpz, fmpz_poly, nmod_poly

PRIME_BITS = 63
"""FLINT's arithmetic is fastest where two residues add up without overflow."""


class FaultyValue(ArithmeticError):
    """A result disagrees with a value that it was not made from: the machine or the program is at fault."""


def primes() -> Iterator[int]:
    """Primes, from the largest of `PRIME_BITS` bits downwards."""
    candidate = fmpz(2**PRIME_BITS - 1)
    while True:
        if candidate.is_prime():
            yield int(candidate)
        candidate -= 2


def quotients(numerators: Sequence[int], denominators: Sequence[int], prime: int) -> list[int]:
    """Modulo a prime that divides no denominator; one inverse is computed."""
    products = list(accumulate(denominators, lambda a, b: a * b % prime))
    inverse = pow(products[-1], -1, prime)
    found = []
    for k in range(len(numerators) - 1, -1, -1):
        before = products[k - 1] if k else 1
        found.append(numerators[k] * before % prime * inverse % prime)
        inverse = inverse * denominators[k] % prime
    return found[::-1]


def combined(images: Sequence[tuple[nmod_poly, int]]) -> fmpz_poly:
    """The polynomial with these images modulo primes whose coefficients are least in absolute value."""
    modulus = math.prod(prime for _, prime in images)
    parts = []
    for image, prime in images:
        scaled = image * pow(modulus // prime % prime, -1, prime)
        parts.append((fmpz_poly([int(c) for c in scaled.coeffs()]), prime))
    while len(parts) > 1:  # of coprime p and q, remainders a / q and b / p have the sum (a q + b p) / (p q)
        pairs = zip(parts[::2], parts[1::2], strict=False)
        rest = parts[-1:] if len(parts) % 2 else []
        parts = [(a * q + b * p, p * q) for (a, p), (b, q) in pairs] + rest
    residues = [int(c) % modulus for c in parts[0][0].coeffs()]
    return fmpz_poly([c - modulus if 2 * c > modulus else c for c in residues])
