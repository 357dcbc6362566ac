"""Boxes of unknowns on circles and lines, in floats, and solutions of which each is alone in one.

Guarantee: on circles boxes are compared with all whole turns between them; what is said to be so is
so in spite of the floats' rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import pi

from flint import arb

Floats = tuple[float, ...]
"""A number for each unknown."""
Box = tuple[Floats, Floats]
"""Middle and half widths."""
MIN_HALF_WIDTH = 2.0**-34
"""Share of the first boxes' widths below which one is not halved again, unless another one is asked
for.
"""


class Unproved(Exception):
    """The number of solutions could not be proved; the message says why."""


@dataclass(frozen=True, slots=True)
class Zero:
    """The only solution within ``alone`` of ``center``, and it is within ``radii``; for each choice
    of parameters.

    ``signs`` are those of the Hessian's eigenvalues, positive ones first; empty where the equations
    are no gradient.
    """

    center: Floats
    radii: Floats
    alone: Floats
    signs: str

    @property
    def within(self) -> tuple[arb, ...]:
        """Balls of the unknowns."""
        return tuple(map(arb, self.center, self.radii))


def in_words(center: Iterable[float]) -> str:
    """A point in few digits."""
    return ", ".join(f"{x:.6g}" for x in center)


def halves(box: Box, order: Sequence[int], smallest: Sequence[float]) -> tuple[Box, Box] | None:
    """Two boxes that cover a box, halved in the first unknown in which it may be; None when it is
    too small.
    """
    for k in order:
        m, r = box[0][k], box[1][k]
        half, low, high = r / 2, m - r / 2, m + r / 2
        if m - low != half or high - m != half:
            # without this, doubles would leave a gap between the halves, or beside them
            half += 2.0**-51 * (abs(m) + r)
        if r >= smallest[k] and half <= 0.75 * r:
            return _with(box, k, low, half), _with(box, k, high, half)
    return None


def _with(box: Box, k: int, middle: float, half: float) -> Box:
    m, r = box
    return (*m[:k], middle, *m[k + 1 :]), (*r[:k], half, *r[k + 1 :])


def difference_of(x: float, y: float, circle: bool) -> arb:
    """The difference of two numbers, less the whole turns that are next to it."""
    difference = arb(x) - arb(y)
    turns = round((x - y) / (2 * pi)) if circle else 0
    return difference - 2 * turns * arb.pi() if turns else difference


def within(one: Floats, other: Floats, radii: Sequence[float], circles: Sequence[bool]) -> bool:
    """Whether two points are surely nearer than the radii in all unknowns."""
    return all(
        bool(abs(difference_of(x, y, circle)) < radius)
        for x, y, radius, circle in zip(one, other, radii, circles, strict=True)
    )


def inside(box: Box, zero: Zero, circles: Sequence[bool]) -> bool:
    """Whether the box is within that in which a solution is alone."""
    room = [(alone - r) * (1 - 2.0**-50) for alone, r in zip(zero.alone, box[1], strict=True)]
    return min(room) > 0 and within(box[0], zero.center, room, circles)


def disjoint(one: Zero, two: Zero, circles: Sequence[bool]) -> bool:
    """Whether the boxes of two solutions are surely disjoint."""
    full = 2 * arb.pi()
    for x, y, r, s, circle in zip(
        one.center, two.center, one.radii, two.radii, circles, strict=True
    ):
        difference, reach = difference_of(x, y, circle), arb(r) + arb(s)
        if all(abs(difference + k * full) > reach for k in ((-1, 0, 1) if circle else (0,))):
            return True
    return False


def is_same(one: Zero, two: Zero, circles: Sequence[bool]) -> bool:
    """Whether a solution lies where another one is alone.

    Raises
    ------
    Unproved
        When it may or may not be the other one.
    """
    if inside((one.center, one.radii), two, circles):
        return True
    if disjoint(one, two, circles):
        return False
    raise Unproved("a stored box may have one of two solutions")


def size(x: arb, y: arb) -> arb:
    """An upper bound of a vector's length."""
    a, b = x.abs_upper(), y.abs_upper()
    return (a * a + b * b).sqrt().upper()
