"""Certified bounds and shares as text, the same in every table, picture and page.

Guarantee: every digit of a number is certified within one unit of the last; bounds are rounded outwards.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.text.numerals import decimal, magnitude


def certified_digits(bounds: tuple[Fraction, Fraction], most: int = 10) -> str:
    """The longest decimal, of at most ``most`` digits, that is within one unit of its last digit of both bounds.

    Two decimals, joined by "to", when not even two digits are certain (or the one that is asked for).
    """
    low, high = bounds
    middle = (low + high) / 2
    if high == 0:
        return "0"
    top = magnitude(middle)
    for exponent in range(top - most, top + (most == 1)):
        unit = Fraction(10) ** exponent
        digits = round(middle / unit)
        if len(str(digits)) <= most and digits > 0 and high - digits * unit <= unit and digits * unit - low <= unit:
            return decimal(digits * unit, up=False, digits=most)
    return f"{decimal(low, up=False, digits=2)} to {decimal(high, up=True, digits=2)}"


def interval_text(bounds: tuple[Fraction, Fraction]) -> str:
    """Both bounds, rounded outwards by a hundredth of their distance at most.

    >>> interval_text((Fraction("1.69822"), Fraction("1.75450"))), interval_text((Fraction(0), Fraction(2)))
    ('1.6982 to 1.7545', '0 to 2')
    """
    low, high = bounds
    if low >= high:
        return certified_digits(bounds)
    digits = max(2, magnitude(high) - magnitude(high - low) + 3)
    return f"{_down_to(low, digits, high)} to {decimal(high, up=True, digits=digits)}"


def _down_to(value: Fraction, digits: int, largest: Fraction) -> str:
    """The value rounded down to the decimal place that ``digits`` digits of the largest end in."""
    unit = Fraction(10) ** (magnitude(largest) + 1 - digits)
    return decimal(value // unit * unit, up=False)


def percent(share: Fraction) -> str:
    """A share as an upper bound in percent: two digits, rounded up.

    >>> percent(Fraction("0.043034")), percent(Fraction(1, 4))
    ('4.4 %', '25 %')
    """
    return f"{decimal(100 * share, up=True, digits=2)} %"


def share_text(bounds: tuple[Fraction, Fraction], certified: bool) -> str:
    """A share in percent by its bounds: both of them of a certified map, else four digits.

    >>> share_text((Fraction("0.389846"), Fraction("0.389847")), False)
    '38.98 %'
    """
    low, high = (100 * share for share in bounds)
    return f"{interval_text((low, high)) if certified else certified_digits((low, high), 4)} %"
