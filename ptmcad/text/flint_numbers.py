"""FLINT's rational numbers as Python's fractions and back, for all that computes and all that checks."""

from __future__ import annotations

from fractions import Fraction

from flint import fmpq


def to_fraction(value: fmpq) -> Fraction:
    """A FLINT rational as a Python fraction."""
    return Fraction(int(value.p), int(value.q))


def from_fraction(value: Fraction | int) -> fmpq:
    """A Python fraction or integer as a FLINT rational."""
    return fmpq(value.numerator, value.denominator)
