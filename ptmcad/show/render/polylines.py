"""Polygons and polylines with fewer corners, and as the data of SVG paths in few characters.

Guarantee: every corner that is left out is within the tolerance of the side that takes its place,
and none is moved. In a path's data, whole steps of a grid from corner to corner, every corner is
within half a step of its place in each direction, and corners at one place are drawn alike:
browsers add the steps up in single precision, in which whole numbers of this size are exact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ptmcad.show.render.view import Floats

Integers = NDArray[np.int64]


_MAX_DEPTH = 32
"""Halvings of a piece, and corners of the shorter ones into which it is cut when it still departs
too far then.
"""


def simplified_polygon(corners: Floats, tolerance: float) -> Floats:
    """A closed polygon with fewer corners, its own, from which it departs by at most the tolerance.

    Method: Ramer, Douglas and Peucker; the two halves are those between the first corner and the
    one farthest from it.

    Parameters
    ----------
    corners : shape (n, 2).
    """
    corners = corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]
    if len(corners) < 4:
        return corners
    far = int(((corners - corners[0]) ** 2).sum(axis=1).argmax())
    line = np.vstack([corners, corners[:1]])
    few: Floats = line[_kept(line, np.array([0, far, len(corners)]), tolerance)][:-1]
    return few


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


def refined(
    column: Callable[[float], Floats], places: Sequence[float], tolerance: float, depth: int
) -> dict[float, Floats]:
    """Points of some curves at common places, in increasing order, so near to each other that no
    chord misses the middle of its curve by more than the tolerance, up to a depth of halvings.

    Parameters
    ----------
    column : the curves' points at a place, shape (curves, 2).
    places : those at first, increasing.
    """
    known = {place: column(place) for place in places}
    pending = list(pairwise(places))
    for _ in range(depth):
        following = []
        for a, b in pending:
            middle = (a + b) / 2
            known[middle] = column(middle)
            if _distances(known[middle], known[a], known[b]).max(initial=0.0) > tolerance:
                following += [(a, middle), (middle, b)]
        pending = following
    return dict(sorted(known.items()))


GRID = 20
"""Steps of the grid in one of the picture's units; what is drawn by such data is scaled down by as
much.
"""


def path_data(line: Floats, *, closed: bool = False) -> str:
    """The data of a polyline, or of a polygon.

    A line that is shorter than a step is drawn one step long: a browser leaves out one without
    length.

    >>> path_data(np.array([[0, 10], [2.5, 10], [3, 10], [3, 9.75], [2, 9.1], [1.5, 8.5]]))
    'M0 200l50 0 10 0 0-5-20-13-10-12'
    """
    corners = np.rint(line * GRID).astype(np.int64)
    steps = np.diff(corners, axis=0)
    steps = steps[steps.any(axis=1)]
    pairs = steps.tolist() or [[1, 0]]
    x, y = corners[0].tolist()
    text = f"M{x} {y}l" + " ".join(f"{dx} {dy}" for dx, dy in pairs)
    return text.replace(" -", "-") + "z" * closed
