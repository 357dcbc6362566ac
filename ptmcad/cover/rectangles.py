"""The data of a cover: closed rectangles on a lattice of the window.

Guarantee: all its numbers are integers.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

Rectangle = tuple[int, int, int, int]
"""left, right, bottom, top in lattice steps from the window's lower left corner; closed;
0 <= left < right <= steps.
"""
Window = tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]
"""Low and high end of both axes."""
MAX_STEPS = 2**40


class Cover(NamedTuple):
    """The rectangles, sorted and distinct; they may overlap.

    Attributes
    ----------
    steps : number of equal lattice steps along each axis of the window, a power of two, at most
        `MAX_STEPS`.
    """

    steps: int
    rectangles: tuple[Rectangle, ...]
