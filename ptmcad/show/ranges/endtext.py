"""Ends and widths as text, all digits of which are right.

Guarantee: a text is the number rounded to nearest; it is refined as far as that needs.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.algebra.real_roots import refined
from ptmcad.answer.intervals import AnyEnd, Span
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.numerals import magnitude

MAX_DIGITS = 1000
"""That may be asked for."""
_ENCLOSED_DIGITS = 6
"""Of a width between enclosed ends, at most."""
NARROW = Fraction(1, 10**20)
"""A number that is so nearly known and does not settle a digit is taken for the short decimal that
it cannot leave.
"""


def end_text(end: AnyEnd, digits: int) -> str:
    """An end as a decimal; of one that is enclosed as many digits as are known."""
    if isinstance(end, Enclosure):
        return known(end, digits)
    end = AlgebraicNumber.of(end)
    if (exact := end.exact) is not None:
        return Enclosure(exact, exact).text(digits)
    while not (found := Enclosure(end.low, end.high)).settles(digits):
        end = refined(end, (end.high - end.low) / 2**64)
    return found.text(digits)


def known(enclosure: Enclosure, digits: int) -> str:
    """The text of a narrow enclosure; where it holds a decimal of so many digits, which it cannot
    settle, that one.
    """
    if (text := enclosure.settled_text(digits)) is not None:
        return text
    size = max(abs(enclosure.low), abs(enclosure.high))
    unit = Fraction(10) ** (magnitude(size) + 1 - digits) if size else Fraction(1)
    value = (
        round(enclosure.center / unit) * unit
        if enclosure.low > 0 or enclosure.high < 0
        else Fraction(0)
    )
    return Enclosure(value, value).text(digits)


def narrowly_known(enclosure: Enclosure, digits: int) -> str | None:
    """As many digits as the enclosure settles, or what `known` says of one that is narrow; None of
    a wider one.
    """
    text = enclosure.settled_text(digits)
    return known(enclosure, digits) if text is None and enclosure.radius < NARROW else text


def width_text(interval: Span, digits: int) -> str:
    """The width of an interval as a decimal.

    A width that is a short decimal or lies nearer to one than 10^-1000 is shown with as many digits
    as are certain; one between enclosed ends with as many as are known.
    """
    if isinstance(interval.low, Enclosure) or isinstance(interval.high, Enclosure):
        return known(interval.width, min(digits, _ENCLOSED_DIGITS))
    bits = 128
    while True:
        found = finer(interval, Fraction(1, 2**bits) * (interval.width.high or 1)).width
        if found.settles(digits):
            return found.text(digits)
        if bits > 4 * MAX_DIGITS:
            return found.settled_text(digits) or "0"
        bits *= 2


def finer(interval: Span, width: Fraction) -> Span:
    """The same interval with its ends isolated within ``width`` > 0."""
    low, high = (
        refined(e, width) if isinstance(e, AlgebraicNumber) else e
        for e in (interval.low, interval.high)
    )
    return Span(low, high)
