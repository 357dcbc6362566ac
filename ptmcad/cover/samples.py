"""Sample points: for each component a rational point of small height, well inside of it.

Guarantee: the point is in the component, and not in any closed rectangle.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ptmcad.cover.complement import Components
from ptmcad.cover.rectangles import Window

_PLACES = (
    (Fraction(1, 2), Fraction(1, 2)),
    (Fraction(1, 3), Fraction(3, 7)),
    (Fraction(3, 5), Fraction(2, 7)),
)
"""Where the points are, as parts of the sides of the component's rectangle ..."""
_REACH = Fraction(1, 8)
"""... and how far they may be from there."""


def samples(
    components: Components, number: int, window: Window
) -> Iterator[tuple[Fraction, Fraction]]:
    """Simple points in the middle of the component's rectangle, and then off the middle, in the
    axes' own units.
    """
    left, right, bottom, top = components.rectangles[number]
    steps = components.cover.steps
    for u, v in _PLACES:
        yield _near(left, right, u, window[0], steps), _near(bottom, top, v, window[1], steps)


def _near(
    first: int, last: int, place: Fraction, interval: tuple[Fraction, Fraction], steps: int
) -> Fraction:
    step = (interval[1] - interval[0]) / steps
    middle, reach = first + (last - first) * place, (last - first) * _REACH
    return simplest_between(
        interval[0] + (middle - reach) * step, interval[0] + (middle + reach) * step
    )


def simplest_between(low: Fraction, high: Fraction) -> Fraction:
    """The fraction of least denominator, then of least absolute value, in the closed interval from
    low to high.

    >>> simplest_between(Fraction(3, 10), Fraction(7, 20)), simplest_between(Fraction(-5, 2), Fraction(-3, 2))
    (Fraction(1, 3), Fraction(-2, 1))
    """
    if low <= 0 <= high:
        return Fraction(0)
    if high < 0:
        return -simplest_between(-high, -low)
    # continued fractions of both ends, as far as they agree
    terms = []
    while True:
        whole = low.__ceil__()
        if whole <= high:
            terms.append(whole)
            break
        floor = whole - 1
        terms.append(floor)
        low, high = 1 / (high - floor), 1 / (low - floor)
    value = Fraction(terms.pop())
    while terms:
        value = terms.pop() + 1 / value
    return value
