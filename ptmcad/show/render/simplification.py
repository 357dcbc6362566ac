"""Polygons and polylines with fewer corners, for drawing.

Guarantee: every corner that is left out is within the tolerance of the side that takes its place,
and none is moved.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ptmcad.show.render.view import Floats

Integers = NDArray[np.int64]


_MAX_DEPTH = 32
"""Halvings of a piece, and corners of the shorter ones into which it is cut when it still departs
too far then.
"""


def distinct(corners: Integers) -> Integers:
    """Without corners that are where the one before them is."""
    kept: Integers = corners[np.concatenate([[True], (corners[1:] != corners[:-1]).any(axis=1)])]
    return kept


def simplified_polygons(points: Floats, sizes: Integers, tolerance: float) -> list[Floats]:
    """Closed polygons with fewer corners, their own, from which they depart by at most the
    tolerance.

    Many of them take little longer than one. Method: Ramer, Douglas and Peucker; the two halves are
    those between the first corner and the one farthest from it.

    Parameters
    ----------
    points : shape (n, 2), the corners of all of them, one polygon after the other.
    sizes : the number of corners of each.
    """
    number = np.repeat(np.arange(len(sizes)), sizes)
    filled = np.flatnonzero(sizes)
    ends = np.cumsum(sizes)[filled]
    before = np.arange(len(points)) - 1
    before[ends - sizes[filled]] = ends - 1
    distinct = (points != points[before]).any(axis=1)
    points, number = points[distinct], number[distinct]
    sizes = np.bincount(number, minlength=len(sizes))
    filled = np.flatnonzero(sizes)
    if not len(filled):
        return [points] * len(sizes)
    ends = np.cumsum(sizes)[filled]
    starts = ends - sizes[filled]
    group = np.repeat(np.arange(len(filled)), sizes[filled])
    reach = ((points - points[starts[group]]) ** 2).sum(axis=1)
    far = np.flatnonzero(reach == np.maximum.reduceat(reach, starts)[group])
    far = far[np.diff(group[far], prepend=-1) != 0]
    # all of them as one polyline, in which each goes back to its first corner; what joins two of
    # them has no corners
    line = points[np.insert(np.arange(len(points)), ends, starts)]
    shift = np.arange(len(filled))
    small = np.flatnonzero(sizes[number] < 4)
    kept = _kept(
        line,
        np.concatenate([starts + shift, far + shift, ends + shift, small + group[small]]),
        tolerance,
    )
    kept = np.delete(kept, ends + shift)
    left = np.bincount(number[kept], minlength=len(sizes))
    return np.split(points[kept], np.cumsum(left)[:-1])


def simplified_line(points: Floats, tolerance: float) -> Floats:
    """A polyline from the same end to the same end with fewer corners, by the same method."""
    return (
        points
        if len(points) < 3
        else points[_kept(points, np.array([0, len(points) - 1]), tolerance)]
    )


def _kept(line: Floats, at_first: Integers, tolerance: float) -> NDArray[np.bool_]:
    """Which points of a polyline are kept, among them those at first and its ends.

    Of a flight of stairs higher than the tolerance each halving splits off one stair only. After
    `_MAX_DEPTH` halvings such pieces are cut into short ones, by corners that would mostly be kept
    in any case.
    """
    kept = np.zeros(len(line), dtype=np.bool_)
    kept[at_first] = True
    # all pieces are halved at once: `inner` are the corners whose piece may still depart too far
    inner = np.flatnonzero(~kept)
    depth = 0
    while len(inner):
        if depth == _MAX_DEPTH:
            kept[inner[::_MAX_DEPTH]] = True
            inner = inner[~kept[inner]]
        depth += 1
        ends = np.flatnonzero(kept)
        piece = np.searchsorted(ends, inner) - 1
        away = _distances(line[inner], line[ends[piece]], line[ends[piece + 1]])
        fresh = np.diff(piece, prepend=-1) != 0
        starts, group = np.flatnonzero(fresh), np.cumsum(fresh) - 1
        farthest = np.maximum.reduceat(away, starts)
        halved = farthest > tolerance
        at = np.flatnonzero((away == farthest[group]) & halved[group])
        kept[inner[at[np.diff(group[at], prepend=-1) != 0]]] = (
            True  # one of them, where several are farthest
        )
        inner = inner[halved[group]]
        inner = inner[~kept[inner]]
    return kept


def _distances(points: Floats, a: Floats, b: Floats) -> Floats:
    """From each point to its own segment, from a to b; all of shape (k, 2)."""
    along, offset = b - a, points - a
    square = (along * along).sum(axis=1)
    share = np.divide(
        (offset * along).sum(axis=1), square, out=np.zeros(len(points)), where=square > 0
    )
    offset = offset - np.clip(share, 0.0, 1.0)[:, None] * along
    distances: Floats = np.hypot(offset[:, 0], offset[:, 1])
    return distances
