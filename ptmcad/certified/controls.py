"""Bernstein coefficients of a polynomial in one variable over an interval."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

from flint import fmpq


def controls(coefficients: Sequence[fmpq], start: fmpq, length: fmpq) -> list[fmpq]:
    """Those of p(start + length t) for t in [0, 1], from the first to the last, exact.

    Parameters
    ----------
    coefficients : of p, the constant one first.

    >>> controls([fmpq(0), fmpq(0), fmpq(1)], fmpq(1), fmpq(2))
    [1, 3, 9]
    """
    composed: list[fmpq] = []
    for c in reversed(coefficients):
        # Horner's rule: (...) (start + length t) + c
        composed = [
            start * a + length * b
            for a, b in zip([*composed, fmpq(0)], [fmpq(0), *composed], strict=True)
        ]
        composed[0] += c
    degree = len(coefficients) - 1
    return [
        sum((fmpq(comb(k, j), comb(degree, j)) * composed[j] for j in range(k + 1)), fmpq(0))
        for k in range(degree + 1)
    ]
