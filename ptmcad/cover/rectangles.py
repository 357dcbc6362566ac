"""The data of a cover: closed rectangles on a lattice of the window, and slanted pieces in frames
on it.

Guarantee: all its numbers are integers.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

Rectangle = tuple[int, int, int, int]
"""left, right, bottom, top in lattice steps from the window's lower left corner; closed;
0 <= left < right <= steps.
"""
Window = tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]
"""Low and high end of both axes."""
MAX_STEPS = 2**40


@dataclass(frozen=True, slots=True, order=True)
class Tube:
    """All points that are within ``half`` of a polynomial's graph, in the direction across it.

    Attributes
    ----------
    half : lattice steps, positive.
    controls : the polynomial's coefficients in Bernstein's basis of the frame's interval, in
        lattice steps.
    """

    half: int
    controls: tuple[int, ...]


@dataclass(frozen=True, slots=True, order=True)
class Patch:
    """A closed rectangle of the lattice, the frame, of which the cover has tubes only.

    Attributes
    ----------
    along : the axis (0 or 1) along which the tubes go, from one side of the frame to the opposite
        one; where a tube passes the frame's other sides, what is outside of the frame is no part of
        it.
    tubes : ascending and disjoint: control by control the next one is higher by more than both half
        widths. The controls of each ascend, or descend, or all tubes' hulls are inside of the
        frame.
    """

    frame: Rectangle
    along: int
    tubes: tuple[Tube, ...]

    @property
    def ends(self) -> tuple[int, int]:
        """The frame's interval along its tubes."""
        return self.frame[2 * self.along], self.frame[2 * self.along + 1]

    @property
    def heights(self) -> tuple[int, int]:
        """The frame's interval across its tubes."""
        return self.frame[2 - 2 * self.along], self.frame[3 - 2 * self.along]


@dataclass(frozen=True, slots=True)
class Cover:
    """The rectangles, sorted and distinct; they may overlap.

    Attributes
    ----------
    steps : number of equal lattice steps along each axis of the window, a power of two, at most
        `MAX_STEPS`.
    patches : sorted; no interior of a frame meets that of another frame or of a rectangle.
    """

    steps: int
    rectangles: tuple[Rectangle, ...]
    patches: tuple[Patch, ...] = ()
