"""The mesh of a family's boundary surface: between neighbouring members' walls, strips of
triangles.

Guarantee: every vertex is a point of `ptmcad.exact.boundaries.boundarystrips`, at a member's value. The walls of
members that are joined are cut at the same shares of their strips, so finely that chords of some of
the members' walls miss no middle by more than the tolerance, up to the depth of subdivision.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import chain, pairwise
from math import cos, hypot, pi

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.boundarysurface import Sheet
from ptmcad.exact.boundaries.boundarystrips import JUMP, BoundaryStrips, Key
from ptmcad.question.slice import Axes
from ptmcad.show.render.polylines import refined

Joined = list[tuple[Fraction, BoundaryStrips]]
"""Members with their values, in increasing order, whose boundaries have the same shape."""
_DEPTH = 5
_PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Where walls are cut at first."""
_FIRST, _NEXT = slice(None, -1), slice(1, None)
_CORNERS = ((_FIRST, _FIRST), (_FIRST, _NEXT), (_NEXT, _NEXT), (_NEXT, _FIRST))
"""Of a quadrilateral between neighbouring members and columns, in turn."""
_WELD = float(JUMP)
"""Of the window: ends of walls that are no further apart are one vertex."""


Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mesh = tuple[Floats, Integers, Integers, Integers, tuple[Sheet, ...]]
"""Vertices, triangles, each triangle's sheet, each vertex's member by its number among all values,
and the sheets: as of `BoundarySurface`.
"""
_Grid = tuple[tuple[Key, Key], Sequence[Fraction], Floats]
"""The counts on both sides of a sheet, the values of its members, and its points in the window's unit
square, shape (members, points, 2), in the axes' order.
"""


def mesh_of(runs: Sequence[Joined], axes: Axes, tolerance: Fraction) -> Mesh:
    """The mesh over all members that are joined.

    Parameters
    ----------
    tolerance : how far chords of walls may miss the walls' middles, as a share of the window.
    """
    heights = sorted({value for run in runs for value, _ in run})
    points: list[tuple[float, float]] = []
    member: list[int] = []
    ends: dict[int, list[int]] = {}

    def numbered(value: Fraction, row: list[tuple[float, float]]) -> Iterator[int]:
        """A member's vertices; at both ends those that are there already."""
        own = heights.index(value)
        known = ends.setdefault(own, [])
        for k, (x, y) in enumerate(row):
            is_end = k in (0, len(row) - 1)
            near = (n for n in known if hypot(points[n][0] - x, points[n][1] - y) < _WELD)
            number = next(near, len(points)) if is_end else len(points)
            if number == len(points):
                points.append((x, y))
                member.append(own)
                known += [number] * is_end
            yield number

    faces, sheets = [np.zeros((0, 3), dtype=np.int64)], []
    for run in runs:
        for counts, values, rows in chain(
            _walls(run, axes, float(tolerance)), _openings(run, axes)
        ):
            low, high = sorted(counts)
            sheets.append(Sheet((low, high), values[0], values[-1]))
            numbers = [list(numbered(*own)) for own in zip(values, rows.tolist(), strict=True)]
            faces.append(_triangles(np.array(numbers), rows))
    lows, widths = ([float(getattr(a, end)) for a in axes] for end in ("low", "width"))
    flat = np.array(points).reshape(-1, 2) * widths + lows
    above = np.array(list(map(float, heights)))[member]
    of_sheet = np.array([k for k, own in enumerate(faces[1:]) for _ in own], dtype=np.int64)
    vertices, of_vertex = np.column_stack([flat, above]), np.array(member, dtype=np.int64)
    return vertices, np.concatenate(faces), of_sheet, of_vertex, tuple(sheets)


def _walls(run: Joined, axes: Axes, tolerance: float) -> Iterator[_Grid]:
    """Cut at the same shares of their strips for all members: from 0 to 1, denser towards both ends."""
    values = [value for value, _ in run]
    some = [run[k][1] for k in (0, len(run) // 3, 2 * len(run) // 3, -1)]
    for number, strip in enumerate(run[0][1].strips):
        if len(strip.keys) == 1:
            continue

        def columns(place: float, of: Sequence[BoundaryStrips], number: int = number) -> Floats:
            share = (1 - cos(pi * place)) / 2 if 0 < place < 1 else place
            found = [(strips.base, strips.at(number, share)) for strips in of]
            return np.array(
                [[_placed(axes, b, at, v) for v in heights] for b, (at, *heights) in found]
            )

        places = refined(
            lambda place: columns(place, some).reshape(-1, 2), _PLACES, tolerance, _DEPTH
        )
        members = [strips for _, strips in run]
        points = np.array([columns(place, members) for place in places])
        for wall, counts in enumerate(pairwise(strip.keys)):
            yield counts, values, points[:, :, wall].swapaxes(0, 1)


def _openings(run: Joined, axes: Axes) -> Iterator[_Grid]:
    """Pieces of lines across the base that neighbouring members have alike."""
    for (low, before), (high, after) in pairwise(run):
        known = [{(o.place, o.keys): o for o in strips.openings} for strips in (before, after)]
        for place in sorted(known[0].keys() & known[1].keys()):
            both = (openings[place] for openings in known)
            points = [[_placed(axes, before.base, o.at, v) for v in (o.low, o.high)] for o in both]
            yield place[1], (low, high), np.array(points)


def _placed(axes: Axes, base: int, u: Fraction, v: Fraction) -> tuple[float, float]:
    first, second = axes
    x, y = (v, u) if base else (u, v)
    return float(first.share(x)), float(second.share(y))


def _triangles(numbers: Integers, points: Floats) -> Integers:
    """Two between each two columns of neighbouring members, parted along the shorter diagonal."""
    a, b, c, d = (numbers[at] for at in _CORNERS)
    p, q, r, s = (points[at] for at in _CORNERS)
    short = np.hypot(*(p - r).T).T <= np.hypot(*(q - s).T).T
    first = np.where(short, [a, b, c], [a, b, d])
    second = np.where(short, [a, c, d], [b, c, d])
    found: Integers = np.moveaxis(np.stack([first, second]), (0, 1), (2, 3)).reshape(-1, 3)
    return found
