"""Certified bounds and shares as text, the same in every table, picture and page.

Guarantee: every digit of a number is certified within one unit of the last; bounds are rounded
outwards.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.text.numerals import decimal, magnitude


def nearest_multiple(bounds: tuple[Fraction, Fraction], unit: Fraction) -> int | None:
    """The multiple of the unit next to the middle, where no number between the bounds is more than
    a unit from it.
    """
    low, high = bounds
    digits = round((low + high) / 2 / unit)
    return digits if high - digits * unit <= unit and digits * unit - low <= unit else None


def rounded(value: Fraction, unit: Fraction, up: bool) -> Fraction:
    """The next multiple of the unit above or below, or the value if it is one.

    >>> rounded(Fraction(-1, 3), Fraction(1, 10), up=True), rounded(Fraction(-1, 3), Fraction(1, 10), up=False)
    (Fraction(-3, 10), Fraction(-2, 5))
    """
    return (-(-value // unit) if up else value // unit) * unit


def certified_digits(bounds: tuple[Fraction, Fraction], most: int = 10) -> str:
    """The longest decimal, of at most ``most`` digits, that is within one unit of its last digit of
    both bounds.

    Two decimals, joined by "to", when not even two digits are certain (or the one that is asked
    for).
    """
    low, high = bounds
    if high == 0:
        return "0"
    top = magnitude((low + high) / 2)
    for exponent in range(top - most, top + (most == 1)):
        unit = Fraction(10) ** exponent
        digits = nearest_multiple(bounds, unit)
        if digits is not None and digits > 0 and len(str(digits)) <= most:
            return decimal(digits * unit, up=False, digits=most)
    return f"{decimal(low, up=False, digits=2)} to {decimal(high, up=True, digits=2)}"


def interval_text(bounds: tuple[Fraction, Fraction]) -> str:
    """Both bounds, rounded outwards by a hundredth of their distance at most, each in two digits at
    least.

    >>> interval_text((Fraction("1.69822"), Fraction("1.75450"))), interval_text((Fraction(0), Fraction(2)))
    ('1.6982 to 1.7545', '0 to 2')
    >>> interval_text((Fraction("0.00000432"), Fraction("0.0014367")))
    '0.0000043 to 0.00144'
    """
    low, high = bounds
    if low >= high:
        return certified_digits(bounds)
    digits = max(2, magnitude(high) - magnitude(high - low) + 3)
    unit = Fraction(10) ** (magnitude(high) + 1 - digits)
    down = rounded(low, unit, up=False)
    if low > 0:  # what is proved to be there is not rounded away
        down = max(down, rounded(low, Fraction(10) ** (magnitude(low) - 1), up=False))
    return f"{decimal(down, up=False)} to {decimal(high, up=True, digits=digits)}"


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
