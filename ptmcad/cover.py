"""A cover: closed rectangles on a lattice of the window that contain everything a certified map leaves open.

Guarantee: all its numbers are integers, so what lies in a rectangle, and what is connected outside all of them, is
decided exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

Rectangle = tuple[int, int, int, int]
"""left, right, bottom, top in lattice steps from the window's lower left corner; closed; 0 <= left < right <= steps."""


@dataclass(frozen=True, slots=True)
class Cover:
    """The rectangles, sorted and distinct; they may overlap.

    Attributes
    ----------
    steps : number of equal lattice steps along each axis of the window, a power of two.
    """

    steps: int
    rectangles: tuple[Rectangle, ...]
