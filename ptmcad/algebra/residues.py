"""Primes of one machine word."""

from __future__ import annotations

from collections.abc import Iterator

from flint import fmpz

PRIME_BITS = 63
"""FLINT's arithmetic is fastest where two residues add up without overflow."""


def primes() -> Iterator[int]:
    """Primes, from the largest of `PRIME_BITS` bits downwards."""
    candidate = fmpz(2**PRIME_BITS - 1)
    while True:
        if candidate.is_prime():
            yield int(candidate)
        candidate -= 2
