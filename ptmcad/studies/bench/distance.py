"""How far the drawn boundary is from the true one, and the true one from the drawn: bounds of both.

Guarantee: the bounds hold. Points are taken along both boundaries, so densely that the bounds allow for what lies
between them; a wall's distance to its chord, and where it may run in the gaps, are added. Coordinates are doubles
between 0 and 1, whose rounding `ROUNDING` outweighs.

Distances are Euclidean in the window drawn as a unit square.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.exact.cad.polyline import UNPROVED, Chord
from ptmcad.studies.bench.reference import Walls

Points = NDArray[np.float64]
FloatBounds = tuple[float, float]
ROUNDING = 1e-12
DENSITY = 8
"""Points on the side of a pixel."""


@dataclass(frozen=True, slots=True)
class Distances:
    """Bounds of the two one-sided distances.

    Attributes
    ----------
    missed : how far a point of the true boundary may be from the drawn one.
    false : how far a point of the drawn boundary may be from the true one.
    """

    missed: FloatBounds
    false: FloatBounds

    @property
    def largest(self) -> FloatBounds:
        """The Hausdorff distance."""
        return max(self.missed[0], self.false[0]), max(self.missed[1], self.false[1])


def grid_boundary(picture: NDArray[np.int16]) -> Points:
    """The sides between pixels that show different counts, as rows (u0, v0, u1, v1) in shares of the window."""
    n = len(picture)
    i, j = np.nonzero(picture[1:, :] != picture[:-1, :])
    upright = np.stack([i + 1, j, i + 1, j + 1], axis=1)
    i, j = np.nonzero(picture[:, 1:] != picture[:, :-1])
    level = np.stack([i, j + 1, i + 1, j + 1], axis=1)
    sides: Points = np.concatenate([upright, level]) / n
    return sides


def distances(walls: Walls, sides: Points, pixel: Fraction) -> Distances | None:
    """Both distances between the true walls and segments that are drawn.

    Parameters
    ----------
    sides : rows (u0, v0, u1, v1).
    pixel : length of a side; points are taken at an eighth of it.

    Returns
    -------
    None when just one of the boundaries is empty.
    """
    spacing = float(pixel) / DENSITY
    known = [c for c, _, _ in walls.chords if c.distance < UNPROVED]
    segments = _segments(known)
    apart = np.array([float(c.distance) for c in known])
    vague = np.array(
        [[float(x) for x in (left, low, right, high)] for left, right, parts in walls.gaps for low, high in parts]
    ).reshape(-1, 4)
    if not len(segments) or not len(sides):
        return Distances((0.0, 0.0), (0.0, 0.0)) if not len(segments) and not len(sides) else None
    true, of, near = _points(segments, spacing)
    drawn, _, step = _points(sides, spacing)
    boxes, reach = (vague[:, :2] + vague[:, 2:]) / 2, np.hypot(*(vague[:, 2:] - vague[:, :2]).T) / 2

    from scipy.spatial import cKDTree

    to_drawn = _nearest(cKDTree(drawn), true)
    slack = apart[of]
    missed_low = float((to_drawn - slack).max() - step.max())
    missed_high = float((to_drawn + near + slack).max())
    if len(boxes):
        missed_high = max(missed_high, float((_nearest(cKDTree(drawn), boxes) + reach).max()))
    to_true = _nearest(cKDTree(true), drawn)
    false_high = float((to_true + step + slack.max()).max())
    least = to_true - near.max() - slack.max()
    if len(boxes):
        least = np.minimum(least, _nearest(cKDTree(boxes), drawn) - reach.max())
    return Distances(_outward(missed_low, missed_high), _outward(float(least.max()), false_high))


def chord_points(known: Sequence[Chord], spacing: float) -> tuple[Points, float]:
    """Points on chords, and a bound for the distance from any point of the walls to the nearest one and back."""
    points, _, near = _points(_segments(known), spacing)
    return points, float(near.max()) + max(float(c.distance) for c in known) + ROUNDING


def _segments(known: Sequence[Chord]) -> Points:
    return np.array([[float(x) for x in (c.left, c.at_left, c.right, c.at_right)] for c in known]).reshape(-1, 4)


def _points(segments: Points, spacing: float) -> tuple[Points, NDArray[np.int64], Points]:
    """Points on segments, the segment of each, and how far from it a point of its part of the segment may be."""
    start, way = segments[:, :2], segments[:, 2:] - segments[:, :2]
    length = np.hypot(way[:, 0], way[:, 1])
    pieces = np.maximum(1, np.ceil(length / spacing)).astype(np.int64)
    of = np.repeat(np.arange(len(segments)), pieces)
    within = np.arange(len(of)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    share = (within + 0.5) / pieces[of]
    return start[of] + share[:, None] * way[of], of, (length / pieces / 2)[of]


def _nearest(tree: Any, points: Points) -> Points:
    found: Points = tree.query(points)[0]
    return found


def _outward(low: float, high: float) -> FloatBounds:
    return max(0.0, low - ROUNDING), high + ROUNDING
