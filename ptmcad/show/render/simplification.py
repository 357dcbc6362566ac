"""Polygons and polylines with fewer corners, for drawing.

Guarantee: every corner that is left out is within the tolerance of the side that takes its place, and none is moved.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ptmcad.show.render.view import Floats


def simplified(points: Floats, tolerance: float) -> Floats:
    """A closed polygon with fewer corners, all of them its own, from which it departs by at most the tolerance.

    Method: Ramer, Douglas and Peucker; the two halves are those between the first corner and the one farthest from it.
    """
    points = points[(points != np.roll(points, 1, axis=0)).any(axis=1)]
    n = len(points)
    if n < 4:
        return points
    closed = np.concatenate([points, points[:1]])
    return closed[:-1][_kept(closed, [0, int(np.argmax(((points - points[0]) ** 2).sum(axis=1))), n], tolerance)[:-1]]


def simplified_line(points: Floats, tolerance: float) -> Floats:
    """A polyline from the same end to the same end with fewer corners, by the same method."""
    return points if len(points) < 3 else points[_kept(points, [0, len(points) - 1], tolerance)]


def _kept(line: Floats, at_first: list[int], tolerance: float) -> NDArray[np.bool_]:
    """Which points of a polyline are kept, among them those at first and its ends."""
    kept = np.zeros(len(line), dtype=np.bool_)
    kept[at_first] = True
    # all pieces are halved at once: `inner` are the corners whose piece may still depart too far
    inner = np.flatnonzero(~kept)
    while len(inner):
        ends = np.flatnonzero(kept)
        piece = np.searchsorted(ends, inner) - 1
        away = _distances(line[inner], line[ends[piece]], line[ends[piece + 1]])
        starts = np.flatnonzero(np.diff(piece, prepend=-1))
        group = np.cumsum(np.diff(piece, prepend=-1) != 0) - 1
        farthest = np.maximum.reduceat(away, starts)
        halved = farthest > tolerance
        at = np.flatnonzero((away == farthest[group]) & halved[group])
        kept[inner[at[np.diff(group[at], prepend=-1) != 0]]] = True  # one of them, where several are farthest
        inner = inner[halved[group]]
        inner = inner[~kept[inner]]
    return kept


def _distances(points: Floats, a: Floats, b: Floats) -> Floats:
    """From each point to its own segment, from a to b; all of shape (k, 2)."""
    along, offset = b - a, points - a
    square = (along * along).sum(axis=1)
    share = np.divide((offset * along).sum(axis=1), square, out=np.zeros(len(points)), where=square > 0)
    offset = offset - np.clip(share, 0.0, 1.0)[:, None] * along
    distances: Floats = np.hypot(offset[:, 0], offset[:, 1])
    return distances
