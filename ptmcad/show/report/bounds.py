"""Arithmetic with rational bounds of real numbers, and decimals that are certified to their last
digit.

Guarantee: the bounds of a result contain its value whenever those of the operands do;
`decimal_text` is within one unit of its last digit of every number between the bounds.
"""

from __future__ import annotations

from fractions import Fraction
from math import atan2
from typing import Any, NamedTuple

from ptmcad.text.balls import rational_bounds
from ptmcad.text.numerals import integer_text, magnitude, nearest_multiple


class Bounds(NamedTuple):
    """Rational bounds of a real number; sums, products and natural powers have bounds of theirs."""

    low: Fraction
    high: Fraction

    def __neg__(self) -> Bounds:
        return Bounds(-self.high, -self.low)

    def __add__(self, other: Any) -> Bounds:
        return Bounds(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Bounds) -> Bounds:
        return self + -other

    def __mul__(self, other: Any) -> Bounds:
        if self is other:
            return Bounds.__pow__(self, 2)
        # of a point two products, as nearly all coefficients are points
        corners = [x * y for x in self[: 1 + (self.low < self.high)] for y in other]
        return Bounds(min(corners), max(corners))

    def __pow__(self, exponent: int) -> Bounds:
        """An even power is not negative."""
        low, high = sorted(x**exponent for x in self)
        return Bounds(
            Fraction(0) if exponent and exponent % 2 == 0 and self.low < 0 < self.high else low,
            high,
        )


_PER_RADIAN = Bounds(
    Fraction(180 * 10**18, 3141592653589793239), Fraction(180 * 10**18, 3141592653589793238)
)
"""Degrees."""
_MAX_PLAIN_PLACES = 12
"""Places before or after the point from which the form with an exponent is used."""


def exactly(value: Fraction | int) -> Bounds:
    """The bounds of a rational number."""
    return Bounds(Fraction(value), Fraction(value))


def square_root(a: Bounds) -> Bounds:
    """The square root of a number that is not negative, though its lower bound may be."""
    low, high = (rational_bounds(lambda ball: ball.sqrt(), max(end, Fraction(0))) for end in a)
    return Bounds(low[0], high[1])


def degrees(cosine: Bounds, sine: Bounds) -> Bounds | None:
    """The angle, in (-180, 180] up to its own width, whose cosine and sine lie between these
    bounds.

    None when the bounds are too wide to decide, or no angle has such a cosine and sine nearby.
    """
    guess = Fraction(round(atan2(float(sum(sine)), float(sum(cosine))) * 2**60), 2**60)
    c, s = _cosine_sine(guess)
    across, along = sine * c - cosine * s, cosine * c + sine * s  # sine and cosine of angle - guess
    widest = max(abs(across[0]), abs(across[1]))
    if along[0] <= 0 or widest > Fraction(1, 1000):
        return None
    # |arcsin d - d| <= |d|^3 where |d| < 1/2
    return (exactly(guess) + across + Bounds(-(widest**3), widest**3)) * _PER_RADIAN


def cosine_sine(angle: Bounds) -> tuple[Bounds, Bounds]:
    """Cosine and sine of an angle in radians: those at the middle of its bounds, which nothing
    leaves faster than the angle itself."""
    slack = (angle.high - angle.low) / 2
    cosine, sine = (at + Bounds(-slack, slack) for at in _cosine_sine((angle.low + angle.high) / 2))
    return cosine, sine


def _cosine_sine(angle: Fraction) -> tuple[Bounds, Bounds]:
    cosine, sine = (
        rational_bounds(lambda ball: ball.cos(), angle),
        rational_bounds(lambda ball: ball.sin(), angle),
    )
    return Bounds(*cosine), Bounds(*sine)


def decimal_text(a: Bounds, exponent: int) -> str:
    """A decimal with 10^exponent as the unit of its last digit, or a larger unit where the bounds
    are wider.

    >>> decimal_text((Fraction(-1, 3), Fraction(-1, 3)), -4), decimal_text((Fraction(1), Fraction(11, 10)), -4)
    ('−0.3333', '1.0')
    >>> decimal_text(exactly(123456), 3), decimal_text(exactly(Fraction(1, 10**20)), -22)
    ('123e3', '100e-22')
    """
    width = a[1] - a[0]
    if width > 0:
        exponent = max(exponent, magnitude(width))
    unit = Fraction(10) ** exponent
    while (digits := nearest_multiple(a, unit)) is None:
        exponent, unit = exponent + 1, unit * 10
    text = integer_text(abs(digits))
    sign = "−" if digits < 0 else ""
    if exponent > 0 or exponent < -_MAX_PLAIN_PLACES:
        return f"{sign}{text}e{exponent}" if digits else "0"
    text = text.zfill(1 - exponent)
    return sign + (f"{text[:exponent]}.{text[exponent:]}" if exponent else text)


def last_place(values: list[Bounds], digits: int) -> int:
    """The exponent of the last place that gives the largest of some numbers so many digits."""
    largest = max((abs(end) for value in values for end in value), default=Fraction(0))
    return (magnitude(largest) if largest else 0) + 1 - digits
