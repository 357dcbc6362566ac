"""FLINT's rational numbers as Python's fractions and back, for all that computes and all that
checks.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from flint import fmpq


def to_fraction(value: fmpq) -> Fraction:
    """A FLINT rational as a Python fraction."""
    return Fraction(int(value.p), int(value.q))


def from_fraction(value: Fraction | int) -> fmpq:
    """A Python fraction or integer as a FLINT rational."""
    return fmpq(value.numerator, value.denominator)


def interval_of(ends: Any) -> tuple[fmpq, fmpq]:
    """The ends ``low`` and ``high`` of an axis or an enclosure as FLINT's numbers."""
    return from_fraction(ends.low), from_fraction(ends.high)


def simplest_between(low: fmpq, high: fmpq) -> fmpq:
    """The rational with the smallest denominator strictly between low and high, the one nearest to
    zero of these.
    """
    if low < 0 < high:
        return fmpq(0)
    if high <= 0:
        return -simplest_between(-high, -low)
    # continued fraction descent in integers: no fraction has to be reduced on the way
    numerator, denominator, upper, lower = int(low.p), int(low.q), int(high.p), int(high.q)
    a, b, c, d = 1, 0, 0, 1
    while True:
        whole, rest = divmod(numerator, denominator)
        excess = upper - whole * lower
        if excess > lower:  # whole + 1 lies below the upper end
            return fmpq(a * (whole + 1) + b, c * (whole + 1) + d)
        a, b, c, d = a * whole + b, a, c * whole + d, c
        if rest == 0:  # the smallest 1/t below the rest of the upper end, t integer
            t = lower // excess + 1
            return fmpq(a * t + b, c * t + d)
        # both in (0, 1]; take reciprocals
        numerator, denominator, upper, lower = lower, excess, denominator, rest


def simplest_fraction(one: Fraction, other: Fraction) -> Fraction:
    """The simplest one strictly between two numbers."""
    low, high = sorted((one, other))
    return to_fraction(simplest_between(from_fraction(low), from_fraction(high)))
