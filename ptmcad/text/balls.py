"""From Arb's balls to enclosures in decimals.

Guarantee: the enclosure contains the ball, has decimal ends, and settles the digits that were asked for.
"""

from __future__ import annotations

from fractions import Fraction

from flint import arb

from ptmcad.text.enclosure import Enclosure

_GUARD = 6
"""Digits of the enclosure's middle beyond those asked for, at first."""


def enclosed(ball: arb, digits: int) -> Enclosure | None:
    """An enclosure that settles ``digits`` digits of any number in the ball; None when the ball is too wide."""
    if not ball.is_finite() or ball.contains(0) or 10 * ball.rel_accuracy_bits() < 33 * (digits + _GUARD - 2):
        return None  # the test of the radius below would say so too; most balls that are too wide end here
    mantissa, exponent = (int(n) for n in ball.mid().man_exp())
    radius = _fraction(ball.rad())
    # the place of the first digit, to within one: 0.30103 is the logarithm of 2
    first = (abs(mantissa).bit_length() + exponent - 1) * 30103 // 100000
    middle = _fraction(ball.mid())
    guard = _GUARD
    while True:
        unit = Fraction(10) ** (first - digits - guard)
        if 2 * radius > unit:
            return None
        center = round(middle / unit) * unit  # within half a unit of the middle, so within a unit of each number
        if (found := Enclosure(center - unit, center + unit)).settles(digits):
            return found
        guard *= 2


def _fraction(ball: arb) -> Fraction:
    """The number that a ball of radius zero is."""
    mantissa, exponent = (int(n) for n in ball.man_exp())
    return Fraction(mantissa * 2**exponent) if exponent >= 0 else Fraction(mantissa, 2**-exponent)
