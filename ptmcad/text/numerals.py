"""Exact numbers as text, of any length, and back; certified bounds and shares as text, the same in
every table, picture and page.

Guarantee: what `text_of` writes `fraction_of` reads back exactly; decimals made by `decimal` bound
the value from the side that was asked for, and those of bounds are rounded outwards, each digit
certified within one unit of the last. Python's own conversion refuses integers of more than 4300
digits, which coefficients of a discriminant can have; here they are split at powers of ten.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from math import ceil, floor
from numbers import Rational
from operator import index
from typing import Any, SupportsIndex

Numbers = Mapping[str, Fraction]
"""Exact numbers by the names of what has these values."""
Texts = Mapping[str, str]
"""Texts by names: values as they are written, or units."""
Bounds = tuple[Fraction, Fraction]
"""What a number is not below, and what it is not above."""
MAX_DIGITS = 200_000
"""Of a numerator, a denominator or a decimal: longer ones are refused when reading."""
MAX_EXPONENT = 20_000
FINITE = (
    "all values are finite: write a large number, or make the reciprocal the parameter or the axis"
)
_PIECE = 4000

_NUMBER = re.compile(r"(-?)([0-9]+)(?:/([0-9]+)|(?:\.([0-9]+))?(?:e(-?[0-9]{1,6}))?)", re.ASCII)


def integer_text(n: int) -> str:
    """The decimal digits of an integer.

    >>> integer_text(-(10**5000)) == "-1" + 5000 * "0"
    True
    """
    if n < 0:
        return "-" + integer_text(-n)
    if n.bit_length() < 3 * _PIECE:
        return str(n)
    half = n.bit_length() * 3 // 20
    high, low = divmod(n, 10**half)
    return integer_text(high) + integer_text(low).zfill(half)


def integer_of(digits: str) -> int:
    """The integer with these decimal digits (no sign)."""
    if len(digits) <= _PIECE:
        return int(digits)
    half = len(digits) // 2
    power: int = 10**half
    return integer_of(digits[:-half]) * power + integer_of(digits[-half:])


def pointed(digits: str, exponent: int) -> str:
    """Digits times a power of ten, written without an exponent.

    >>> pointed("125", -2), pointed("125", -5), pointed("125", 1)
    ('1.25', '0.00125', '1250')
    """
    point = len(digits) + exponent
    if exponent >= 0:
        return digits + "0" * exponent
    return f"{digits[:point]}.{digits[point:]}" if point > 0 else f"0.{'0' * -point}{digits}"


def exactly(number: object) -> Fraction:
    """The value of a number: an integer, a rational of any library's, or a float.

    A float is the shortest decimal that rounds to it, which is what it is printed as and what a
    record would say.

    >>> exactly(0.5), exactly(-0.1)
    (Fraction(1, 2), Fraction(-1, 10))

    Raises
    ------
    TypeError
        For anything else, also for a truth value.
    ValueError
        For an infinite float, and one that is not a number.
    """
    # numpy's truth values are indices before numpy 2
    kind = getattr(getattr(number, "dtype", None), "kind", "")
    if isinstance(number, bool | type) or kind == "b":  # a class has its numbers' methods
        raise TypeError(_no_number(number))
    if isinstance(number, SupportsIndex):
        try:
            return Fraction(index(number))
        except TypeError as error:  # an array
            raise TypeError(_no_number(number)) from error
    if isinstance(number, Rational):
        return Fraction(int(number.numerator), int(number.denominator))
    ratio = getattr(number, "as_integer_ratio", None)
    if ratio is None:
        raise TypeError(_no_number(number))
    try:
        # numerator and denominator of a Fraction made from numpy's integers are such
        return (
            Fraction(str(number))
            if isinstance(number, float) or kind == "f"
            else Fraction(*map(int, ratio()))
        )
    except (ValueError, OverflowError) as error:
        raise ValueError(
            f"{number!r} is not a number that can be computed with; {FINITE}"
        ) from error


def _no_number(value: object) -> str:
    return f"{value!r} of type {type(value).__name__} is not an exact number"


def text_of(value: Fraction | int) -> str:
    """An exact number as ``7/10`` or ``-3``."""
    if value.denominator == 1:
        return integer_text(value.numerator)
    return f"{integer_text(value.numerator)}/{integer_text(value.denominator)}"


def decimal_places(value: Fraction) -> int | None:
    """How many decimals an exact number has; None where they do not end.

    >>> decimal_places(Fraction(-3, 40)), decimal_places(Fraction(7)), decimal_places(Fraction(1, 3))
    (3, 0, None)
    """
    twos = (value.denominator & -value.denominator).bit_length() - 1
    rest = value.denominator >> twos
    fives = (
        rest.bit_length() * 43067655807 // 10**11
    )  # divided by the logarithm of 5 to base 2, so off by one at most
    return next((max(twos, k) for k in range(max(0, fives - 1), fives + 2) if 5**k == rest), None)


def equalities(values: Mapping[str, Any], text: Callable[[Any], str] = str) -> str:
    """Values by name in words.

    >>> equalities({"rho": Fraction(1, 8), "L2": Fraction(2)}, shortest_text)
    'rho = 0.125, L2 = 2'
    """
    return ", ".join(f"{name} = {text(value)}" for name, value in values.items())


def shortest_text(value: Fraction) -> str:
    """An exact number as a decimal where it is one with few digits, else as a fraction.

    >>> shortest_text(Fraction(-1, 8)), shortest_text(Fraction(1, 10**12)), shortest_text(Fraction(1, 3))
    ('-0.125', '1e-12', '1/3')
    """
    digits = decimal_places(value)
    if not digits or digits > MAX_SHORT:
        return text_of(value)
    scaled = value.numerator * (10**digits // value.denominator)
    if abs(scaled) == 1 and digits > 6:
        return f"{scaled}e-{digits}"
    return ("-" if scaled < 0 else "") + pointed(integer_text(abs(scaled)), -digits)


MAX_SHORT = 24
"""Characters of an exact number in a message."""


def short_text(value: Fraction) -> str:
    """A number for a message: as it is where that is short, else about what it is.

    >>> short_text(Fraction(-2, 21)), short_text(Fraction(1, 3 * 10**40))
    ('-2/21', 'about 3.33333333e-41')
    """
    text = text_of(value)
    return text if len(text) <= MAX_SHORT else f"about {approximate_text(value)}"


def of_digits(whole: str, decimals: str, exponent: int) -> Fraction:
    """The number that digits before and after a point stand for, times a power of ten.

    >>> of_digits("1", "50", -1)
    Fraction(3, 20)
    """
    value, scale = integer_of(whole + decimals), exponent - len(decimals)
    return Fraction(value * 10**scale) if scale >= 0 else Fraction(value, 10**-scale)


def fraction_of(text: str) -> Fraction:
    """The number written as ``7/10``, ``-3``, ``0.25`` or ``1.5e-7``.

    >>> fraction_of("-1.5e-3"), fraction_of("7/10")
    (Fraction(-3, 2000), Fraction(7, 10))

    Raises
    ------
    ValueError
        For any other text, a zero denominator, or a number beyond the limits of this module.
    """
    if len(text) > 2 * MAX_DIGITS:
        raise ValueError(f"a number has {len(text)} characters")
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise ValueError(f"{text[:40]!r} is not an exact number such as 7/10 or 0.25")
    sign, whole, denominator_text, decimals, exponent = match.groups()
    digits = max(len(whole + (decimals or "")), len(denominator_text or ""))
    if digits > MAX_DIGITS or (exponent is not None and abs(int(exponent)) > MAX_EXPONENT):
        raise ValueError(f"the number {text[:20]}... is too long")
    value = of_digits(whole, decimals or "", int(exponent or 0))
    if denominator_text is not None:
        if (denominator := integer_of(denominator_text)) == 0:
            raise ValueError(f"{text[:40]!r} has a zero denominator")
        value /= denominator
    return -value if sign else value


def magnitude(value: Fraction) -> int:
    """The e with 10^e <= value < 10^(e+1).

    Raises
    ------
    ValueError
        Unless the value is positive.
    """
    if value <= 0:
        raise ValueError("only positive numbers have a magnitude")
    # log10(2) to twelve digits: at most a few steps remain, of which each is expensive for numbers
    # of many digits
    e = (value.numerator.bit_length() - value.denominator.bit_length()) * 301_029_995_664 // 10**12
    while value >= Fraction(10) ** (e + 1):
        e += 1
    while value < Fraction(10) ** e:
        e -= 1
    return e


def decimal(value: Fraction, up: bool, digits: int = 18) -> str:
    """A decimal text with ``digits`` significant digits that bounds a value from the side asked
    for.

    >>> decimal(Fraction(-1, 3), up=True, digits=2), decimal(Fraction(2, 3), up=True, digits=2)
    ('-0.33', '0.67')
    """
    if value == 0:
        return "0"
    if value < 0:
        return f"-{decimal(-value, not up, digits)}"
    exponent = magnitude(value) + 1 - digits
    scaled = value / Fraction(10) ** exponent
    text = str(ceil(scaled) if up else floor(scaled))
    point = len(text) + exponent
    if -7 < point <= max(21, len(text) - 1):
        plain = pointed(text, exponent)
        return plain.rstrip("0").rstrip(".") if exponent < 0 else plain
    return f"{text[0]}.{text[1:].rstrip('0') or '0'}e{point - 1}"


SUPERSCRIPTS = dict(zip("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹", strict=True))
"""How a sign and digits are printed in an exponent."""


def power_of_ten(exponent: int) -> str:
    """A power of ten as it is printed.

    >>> power_of_ten(-12)
    '10⁻¹²'
    """
    return "10" + "".join(SUPERSCRIPTS[c] for c in str(exponent))


def approximate_text(value: Fraction) -> str:
    """A number for a message: short, rounded towards zero, of any size."""
    return decimal(value, up=value < 0, digits=9)


def nearest_multiple(bounds: Bounds, unit: Fraction) -> int | None:
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
    return (ceil(value / unit) if up else floor(value / unit)) * unit


def certified_digits(bounds: Bounds, most: int = 10) -> str:
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
    return between(low, high, 2)


def between(low: Fraction, high: Fraction, digits: int) -> str:
    """Both bounds, rounded outwards to so many digits.

    >>> between(Fraction(1, 3), Fraction(2, 3), 2)
    '0.33 to 0.67'
    """
    return f"{decimal(low, up=False, digits=digits)} to {decimal(high, up=True, digits=digits)}"


def interval_text(bounds: Bounds) -> str:
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


def share_text(bounds: Bounds, certified: bool) -> str:
    """A share in percent by its bounds: both of them of a certified map, else four digits.

    >>> share_text((Fraction("0.389846"), Fraction("0.389847")), False)
    '38.98 %'
    """
    low, high = (100 * share for share in bounds)
    return f"{interval_text((low, high)) if certified else certified_digits((low, high), 4)} %"
