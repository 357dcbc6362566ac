"""Sample points: for each component a rational point of small height, well inside of it.

Guarantee: the point is in the component, and not in any closed rectangle.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.cover import Rectangle, Window
from ptmcad.cover.complement import Components

_MIDDLE = Fraction(1, 4)
"""The point is taken from the middle of the component's rectangle: this part of its sides is left out at each end."""


def sample(components: Components, number: int, window: Window) -> tuple[Fraction, Fraction]:
    """The simplest point in the middle of the component's rectangle, in the axes' own units."""
    left, right, bottom, top = components.rectangles[number]
    steps = components.cover.steps
    x = _in_the_middle(left, right, window[0], steps)
    y = _in_the_middle(bottom, top, window[1], steps)
    return x, y


def _in_the_middle(first: int, last: int, interval: tuple[Fraction, Fraction], steps: int) -> Fraction:
    width = (interval[1] - interval[0]) / steps
    rim = (last - first) * _MIDDLE
    return simplest_between(interval[0] + (first + rim) * width, interval[0] + (last - rim) * width)


def simplest_between(low: Fraction, high: Fraction) -> Fraction:
    """The fraction of least denominator, then of least absolute value, in the closed interval from low to high.

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


def rectangle_of(rectangle: Rectangle, steps: int, window: Window) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    """A rectangle's left, right, bottom and top in the axes' own units."""
    (x0, x1), (y0, y1) = window
    left, right, bottom, top = rectangle
    across, up = (x1 - x0) / steps, (y1 - y0) / steps
    return x0 + left * across, x0 + right * across, y0 + bottom * up, y0 + top * up
