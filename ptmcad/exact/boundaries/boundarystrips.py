"""The boundary between a slice's regions over strips of the base, in each of which the same walls
separate the same regions.

Guarantee: every point of the boundary that is given lies on a curve of the variety that separates
two regions, to within `ACCURACY` of the window's height; at the ends of strips it is one just inside
of them.

A strip is made of neighbouring stacks of the decomposition, joined where only curves begin or end at
which no count changes, and no wall has a corner. So two slices whose strips are the same have
boundaries of the same shape, with the same corners, whatever other curves they have. Corners are
found in floating point: they decide where strips are cut, not which regions their walls separate.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import atan2
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.real_roots import Interval, RealRoot, refine
from ptmcad.answer.boundarysurface import ACCURACY
from ptmcad.answer.regionmap import Wall
from ptmcad.exact.cad.projection import by_component
from ptmcad.exact.slicearrangement import Picture
from ptmcad.text.flint_numbers import from_fraction, simplest_between, to_fraction

JUMP = Fraction(1, 2**12)
"""Of the window's height: walls on both sides of a critical abscissa that end no further apart are
one wall, and openings that are no higher are none."""
CORNER = 0.2
"""In radians, seen in a square window: walls that turn by more in a point have a corner there, at
which strips end.
"""
_BESIDE = fmpq(1, 2**10)
"""Of the narrower stack's width: how far from a point the directions in which walls leave it are
taken.
"""
_FINE = Fraction(1, 2**44)
"""Of the window's height: how well points are known where directions are taken."""
_NEAR = fmpq(1, 2**48)
"""Of a stack's width: how near to its ends heights are taken; a square root's error is then 2^-24
of its size.
"""

Key = tuple[int, ...]
"""The count that distinguishes regions."""


class _StackPart(NamedTuple):
    """A stack between rational abscissae just inside of it, with the walls that part regions, from
    below.
    """

    low: fmpq
    high: fmpq
    walls: tuple[Wall, ...]
    regions: tuple[int, ...]


class BoundaryStrip(NamedTuple):
    """A part of the base over which the same walls part the same regions.

    Attributes
    ----------
    parts : the stacks, from left to right.
    keys : of the regions from below; one more than there are walls.
    """

    parts: tuple[_StackPart, ...]
    keys: tuple[Key, ...]

    @property
    def low(self) -> fmpq:
        return self.parts[0].low

    @property
    def high(self) -> fmpq:
        return self.parts[-1].high


class BoundaryOpening(NamedTuple):
    """A piece of a line across the base that parts two regions, between the walls of the strips
    beside it.

    Attributes
    ----------
    place : (number of the strip at its left, level there, level in the next strip).
    keys : of the regions at its left and right.
    at : the abscissa.
    low, high : its ends.
    """

    place: tuple[int, int, int]
    keys: tuple[Key, Key]
    at: Fraction
    low: Fraction
    high: Fraction


Column = tuple[Fraction, ...]
"""The points of the boundary over an abscissa: that, and then the heights of the walls, from below.
"""


Shape = tuple[int, tuple[tuple[Key, ...], ...]]
"""The base axis, and the counts over each strip from below: what two slices with the same boundary
have in common.
"""


class BoundaryStrips:
    """The boundary of a slice's regions.

    Attributes
    ----------
    base : 0 or 1, the axis that is cut into strips.
    strips : from left to right.
    """

    def __init__(self, picture: Picture) -> None:
        self.base = picture.cut.variety.base
        self._curves = by_component(picture.cut.variety.curves)
        self._base_range: Interval = picture.cut.base
        self._fibre: Interval = picture.cut.fibre
        self._keys = picture.arrangement.keys
        self._known: dict[tuple[int, float], Column] = {}
        self.strips = self._joined(self._parts(picture))
        self.openings = tuple(self._openings())

    @property
    def shape(self) -> Shape:
        return self.base, tuple(strip.keys for strip in self.strips)

    def at(self, number: int, share: float) -> Column:
        """The walls of a strip over a share of its width, from 0 to 1."""
        if (number, share) not in self._known:
            strip = self.strips[number]
            u = _abscissa(strip, share)
            part = next((p for p in strip.parts if u <= p.high), strip.parts[-1])
            u = max(u, part.low)
            self._known[number, share] = (to_fraction(u), *self._heights(part, u))
        return self._known[number, share]

    def _heights(
        self, part: _StackPart, u: fmpq, accuracy: Fraction = ACCURACY
    ) -> tuple[Fraction, ...]:
        width = (self._fibre[1] - self._fibre[0]) * from_fraction(accuracy)
        roots = {
            c: self._curves[c].roots_over(u, self._fibre) for c in {w.component for w in part.walls}
        }
        return tuple(
            to_fraction(refine(roots[w.component][w.root], width).middle) for w in part.walls
        )

    def _parts(self, picture: Picture) -> list[_StackPart]:
        found = []
        rows = picture.cut.rows(picture.neighbours.region_of)
        for stack, row in zip(picture.cut.stacks, rows, strict=True):
            kept = [k for k, (a, b) in enumerate(pairwise(row)) if a != b]
            low, high = (_inner(end.root, stack.sample) for end in (stack.left, stack.right))
            regions = (row[0], *(row[k + 1] for k in kept))
            found.append(_StackPart(low, high, tuple(stack.walls[k] for k in kept), regions))
        return found

    def _joined(self, parts: Sequence[_StackPart]) -> tuple[BoundaryStrip, ...]:
        groups: list[list[_StackPart]] = []
        for part in parts:
            if groups and self._goes_on(groups[-1][-1], part):
                groups[-1].append(part)
            else:
                groups.append([part])
        return tuple(
            BoundaryStrip(tuple(g), tuple(self._keys[r] for r in g[0].regions)) for g in groups
        )

    def _goes_on(self, left: _StackPart, right: _StackPart) -> bool:
        if left.regions != right.regions:
            return False
        ends = list(
            zip(self._heights(left, left.high), self._heights(right, right.low), strict=True)
        )
        return all(abs(a - b) <= self._jump for a, b in ends) and not self._has_corner(left, right)

    def _has_corner(self, left: _StackPart, right: _StackPart) -> bool:
        """Whether a wall turns by more than `CORNER` where two parts meet; seen in the window's
        unit square.
        """
        near = min(left.high - left.low, right.high - right.low) * _BESIDE
        scale = [float(to_fraction(b - a)) for a, b in (self._base_range, self._fibre)]
        places = (
            (left, left.high - near),
            (left, left.high),
            (right, right.low),
            (right, right.low + near),
        )
        columns = (
            [float(v) / scale[1] for v in self._heights(part, u, _FINE)] for part, u in places
        )
        across = float(to_fraction(near)) / scale[0]
        return any(
            abs(atan2(d - c, across) - atan2(b - a, across)) > CORNER
            for a, b, c, d in zip(*columns, strict=True)
        )

    @property
    def _jump(self) -> Fraction:
        return to_fraction(self._fibre[1] - self._fibre[0]) * JUMP

    def _openings(self) -> list[BoundaryOpening]:
        bottom, top = map(to_fraction, self._fibre)
        found = []
        for k, (left, right) in enumerate(pairwise(self.strips)):
            a, b = left.parts[-1], right.parts[0]
            levels = [
                (bottom, *self._heights(part, u), top) for part, u in ((a, a.high), (b, b.low))
            ]
            at = to_fraction((a.high + b.low) / 2)
            for i, first in enumerate(a.regions):
                for j, second in enumerate(b.regions):
                    low, high = (
                        max(levels[0][i], levels[1][j]),
                        min(levels[0][i + 1], levels[1][j + 1]),
                    )
                    if first != second and high - low > self._jump:
                        keys = self._keys[first], self._keys[second]
                        found.append(BoundaryOpening((k, i, j), keys, at, low, high))
        return found


def _abscissa(strip: BoundaryStrip, share: float) -> fmpq:
    """An abscissa of a strip with few digits, very near to the one at a share of it."""
    low, high = strip.low, strip.high
    if share in (0, 1):
        return high if share else low
    u = low + (high - low) * from_fraction(Fraction(share))
    near = min(u - low, high - u) / 2**12
    return simplest_between(u - near, u + near)


def _inner(end: RealRoot, sample: fmpq) -> fmpq:
    """A rational abscissa just inside of a stack."""
    near = abs(sample - end.middle) * _NEAR
    root = refine(end, near)
    return root.high + near if root.high < sample else root.low - near
