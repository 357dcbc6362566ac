"""The mesh of a family's boundary surface: between neighbouring members' walls, strips of
triangles.

Guarantee: every vertex is a point of `ptmcad.exact.boundaries.boundarystrips`, at a member's value. The walls of
members that are joined are cut at the same shares of their strips, so finely that chords of some of
the members' walls miss no middle by more than the tolerance, up to the depth of subdivision.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import cos, hypot, pi

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.boundarysurface import Sheet
from ptmcad.exact.boundaries.boundarystrips import JUMP, BoundaryStrips, Key
from ptmcad.question.slice import Axes

Joined = list[tuple[Fraction, BoundaryStrips]]
"""Members with their values, in increasing order, whose boundaries have the same shape."""
_DEPTH = 5
_WELD = float(JUMP)
"""Of the window: ends of walls that are no further apart are one vertex."""


Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mesh = tuple[Floats, Integers, Integers, Integers, tuple[Sheet, ...]]
"""Vertices, triangles, each triangle's sheet, each vertex's member by its number among all values,
and the sheets: as of `BoundarySurface`.
"""


def mesh_of(runs: Sequence[Joined], axes: Axes, tolerance: Fraction) -> Mesh:
    """The mesh over all members that are joined.

    Parameters
    ----------
    tolerance : how far chords of walls may miss the walls' middles, as a share of the window.
    """
    numbers = {
        value: n for n, value in enumerate(sorted({value for run in runs for value, _ in run}))
    }
    builder = _Builder(axes, numbers)
    for run in runs:
        for number in range(len(run[0][1].strips)):
            _add_walls(builder, run, number, float(tolerance))
        _add_openings(builder, run)
    return builder.mesh()


def _add_walls(builder: _Builder, run: Joined, number: int, tolerance: float) -> None:
    keys = run[0][1].strips[number].keys
    if len(keys) == 1:
        return
    shares = _shares(builder, run, number, tolerance)
    for wall, counts in enumerate(pairwise(keys)):
        sheet = builder.sheet(counts, run)
        rows = []
        for value, strips in run:
            columns = [strips.at(number, share) for share in shares]
            points = [builder.point(strips.base, at, heights[wall]) for at, *heights in columns]
            rows.append(builder.row(value, points))
        for first, second in pairwise(rows):
            builder.band(sheet, first, second)


def _add_openings(builder: _Builder, run: Joined) -> None:
    """Pieces of lines across the base that neighbouring members have alike."""
    openings = [{(o.place, o.keys): o for o in strips.openings} for _, strips in run]
    for k, (before, after) in enumerate(pairwise(openings)):
        for place in sorted(before.keys() & after.keys()):
            sheet = builder.sheet(place[1], run[k : k + 2])
            rows = []
            for (value, strips), opening in zip(
                run[k : k + 2], (before[place], after[place]), strict=True
            ):
                ends = [
                    builder.point(strips.base, opening.at, height)
                    for height in (opening.low, opening.high)
                ]
                rows.append(builder.row(value, ends))
            builder.band(sheet, *rows)


def _shares(builder: _Builder, run: Joined, number: int, tolerance: float) -> list[float]:
    """Where the walls of a strip are cut, the same for all members: from 0 to 1, denser towards
    both ends.
    """
    some = [strips for _, strips in (run[0], run[len(run) // 3], run[2 * len(run) // 3], run[-1])]

    def columns(place: float) -> Floats:
        found = [(s.base, s.at(number, _share(place))) for s in some]
        return np.array(
            [[builder.point(base, at, h) for h in heights] for base, (at, *heights) in found]
        )

    known = {place: columns(place) for place in (0.0, 0.25, 0.5, 0.75, 1.0)}
    pending = list(pairwise(sorted(known)))
    for _ in range(_DEPTH):
        following = []
        for a, b in pending:
            middle = (a + b) / 2
            known[middle] = columns(middle)
            if _deviation(known[a], known[middle], known[b]) > tolerance:
                following += [(a, middle), (middle, b)]
        pending = following
    return [_share(place) for place in sorted(known)]


def _share(place: float) -> float:
    return (1 - cos(pi * place)) / 2 if 0 < place < 1 else place


def _deviation(first: Floats, middle: Floats, last: Floats) -> float:
    """The largest distance of a middle point from its chord; arrays of points of the window's unit
    square.
    """
    chord, way = last - first, middle - first
    length = np.hypot(chord[..., 0], chord[..., 1])
    cross = np.abs(chord[..., 0] * way[..., 1] - chord[..., 1] * way[..., 0])
    return float(
        np.max(np.divide(cross, length, out=np.zeros_like(cross), where=length > 0), initial=0.0)
    )


class _Builder:
    """What there is of the mesh so far; points are of the window's unit square, in the axes' order."""

    def __init__(self, axes: Axes, numbers: dict[Fraction, int]) -> None:
        self.axes, self.numbers = axes, numbers
        self.points: list[tuple[float, float, int]] = []
        self.faces: list[tuple[int, int, int]] = []
        self.of_sheet: list[int] = []
        self.sheets: list[Sheet] = []
        self.ends: dict[int, list[int]] = {}

    def point(self, base: int, u: Fraction, v: Fraction) -> tuple[float, float]:
        pair = (u, v) if base == 0 else (v, u)
        x, y = (float(a.share(c)) for c, a in zip(pair, self.axes, strict=True))
        return x, y

    def sheet(self, counts: tuple[Key, Key], run: Joined) -> int:
        """The number of a new one."""
        low, high = sorted(counts)
        self.sheets.append(Sheet((low, high), run[0][0], run[-1][0]))
        return len(self.sheets) - 1

    def row(self, value: Fraction, points: Sequence[tuple[float, float]]) -> list[int]:
        """The numbers of a member's vertices; at both ends those that are there already."""
        member = self.numbers[value]
        numbers = []
        for k, (x, y) in enumerate(points):
            if k in (0, len(points) - 1):
                numbers.append(self._end(x, y, member))
            else:
                self.points.append((x, y, member))
                numbers.append(len(self.points) - 1)
        return numbers

    def _end(self, x: float, y: float, member: int) -> int:
        ends = self.ends.setdefault(member, [])
        for n in ends:
            if hypot(self.points[n][0] - x, self.points[n][1] - y) < _WELD:
                return n
        self.points.append((x, y, member))
        ends.append(len(self.points) - 1)
        return ends[-1]

    def band(self, sheet: int, lower: Sequence[int], upper: Sequence[int]) -> None:
        """Two triangles between each two columns, parted along the shorter diagonal."""
        for (a, b), (d, c) in zip(pairwise(lower), pairwise(upper), strict=True):
            halves = (
                ((a, b, c), (a, c, d))
                if self._apart(a, c) <= self._apart(b, d)
                else ((a, b, d), (b, c, d))
            )
            self.faces += halves
            self.of_sheet += [sheet] * 2

    def _apart(self, m: int, n: int) -> float:
        return hypot(self.points[m][0] - self.points[n][0], self.points[m][1] - self.points[n][1])

    def mesh(self) -> Mesh:
        values = np.array([float(value) for value in self.numbers])
        found = np.array(self.points, dtype=float).reshape(-1, 3)
        member = found[:, 2].astype(np.int64)
        scaled = [float(a.low) + found[:, k] * float(a.width) for k, a in enumerate(self.axes)]
        heights = values[member] if len(member) else np.zeros(0)
        vertices = np.column_stack([*scaled, heights])
        faces = np.array(self.faces, dtype=np.int64).reshape(-1, 3)
        return vertices, faces, np.array(self.of_sheet, dtype=np.int64), member, tuple(self.sheets)
