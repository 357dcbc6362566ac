"""Balls as decimals that are certified to their last digit.

Guarantee: `decimal_text` is within one unit of its last digit of every number between the bounds;
the angle of `degrees` is enclosed.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from math import atan2

from flint import arb

from ptmcad.text.balls import enclosure_of, exact
from ptmcad.text.bounds import nearest_multiple
from ptmcad.text.numerals import integer_text, magnitude

_MAX_PLAIN_PLACES = 12
"""Places before or after the point from which the form with an exponent is used."""
_WIDEST = 1e-3
"""Radians by which an angle may be uncertain that is said to be known."""


def degrees(cosine: arb, sine: arb) -> arb | None:
    """The angle, in (-180, 180] up to its own width, whose cosine and sine lie in these balls.

    None when the balls are too wide to decide.
    """
    if cosine.contains(0) and sine.contains(0):
        return None
    guess = arb(atan2(float(sine.mid()), float(cosine.mid())))
    c, s = guess.cos(), guess.sin()
    rest = arb.atan2(sine * c - cosine * s, cosine * c + sine * s)
    return (guess + rest) * 180 / arb.pi() if rest.abs_upper() < _WIDEST else None


def decimal_text(bounds: tuple[Fraction, Fraction], exponent: int) -> str:
    """A decimal with 10^exponent as the unit of its last digit, or a larger unit where the bounds
    are wider.

    >>> decimal_text((Fraction(-1, 3), Fraction(-1, 3)), -4), decimal_text((Fraction(1), Fraction(11, 10)), -4)
    ('−0.3333', '1.0')
    >>> decimal_text((Fraction(123456),) * 2, 3), decimal_text((Fraction(1, 10**20),) * 2, -22)
    ('123e3', '100e-22')
    """
    width = bounds[1] - bounds[0]
    if width > 0:
        exponent = max(exponent, magnitude(width))
    unit = Fraction(10) ** exponent
    while (digits := nearest_multiple(bounds, unit)) is None:
        exponent, unit = exponent + 1, unit * 10
    text = integer_text(abs(digits))
    sign = "−" if digits < 0 else ""
    if exponent > 0 or exponent < -_MAX_PLAIN_PLACES:
        return f"{sign}{text}e{exponent}" if digits else "0"
    text = text.zfill(1 - exponent)
    return sign + (f"{text[:exponent]}.{text[exponent:]}" if exponent else text)


def ball_text(ball: arb, exponent: int) -> str:
    """The same of all numbers in a ball."""
    ends = enclosure_of(ball)
    return decimal_text((ends.low, ends.high), exponent)


def last_place(balls: Iterable[arb], digits: int) -> int:
    """The exponent of the last place that gives the largest of some numbers so many digits."""
    largest = max((exact(ball.abs_upper()) for ball in balls), default=Fraction(0))
    return (magnitude(largest) if largest else 0) + 1 - digits
