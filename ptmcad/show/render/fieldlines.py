"""Lines over a field: contours within each region and branch, and the edges where the branch
changes.

Guarantee: no contour line crosses an edge of `Field.jumps`, nor the border of a region; none stands
where an angle goes from 180 to -180 degrees.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.field import Field
from ptmcad.show.render.view import Floats

MIN_LINE = 16.0
"""Pixels of the field: shorter rings, and lines from side to side of the picture, are left out."""
MIN_PIECE = 2.0
"""The same of lines that end at the border of a region: they go on beyond it where the branch does.
"""
HALF_TURN = 180.0
"""Degrees by which neighbours of one branch differ where their angle is written with another turn.
"""

Flags = NDArray[np.bool_]
Node = tuple[int, int]


def contour_lines(
    axes: Any, field: Field, extent: Sequence[float], number: int
) -> dict[float, list[Floats]]:
    """About so many lines of equal value, at round values: polylines in the units of the extent, by
    their values.

    A value whose lines are all too short has none.

    Parameters
    ----------
    axes : matplotlib's, in which they are traced; nothing is left there.
    extent : left, right, bottom, top of the field.
    """
    from matplotlib.ticker import MaxNLocator

    known = field.known
    if number < 1 or min(field.values.shape) < 2 or not known.size or not known.min() < known.max():
        return {}
    levels = [v for v in MaxNLocator(nbins=number + 1).tick_values(known.min(), known.max())
              if known.min() < v < known.max()]  # fmt: skip
    if not levels:
        return {}
    rows, columns = field.values.shape
    pixel, origin = _pixels(field, extent)
    broken = _broken(field)
    found: dict[float, list[Floats]] = {float(level): [] for level in levels}
    for region in np.unique(field.region[field.region >= 0]):
        own = np.where(field.region == region, field.values, np.nan)
        if (
            (~np.isnan(own)).sum() > 3
            and np.nanmin(own) < levels[-1]
            and np.nanmax(own) > levels[0]
        ):
            # in units of pixels, from the first one's centre
            traced = axes.contour(np.arange(columns), np.arange(rows), own, levels=levels)
            for level, path in zip(traced.levels, traced.get_paths(), strict=True):
                # along a ridge just above a level there are chains of rings, which pixels alone
                # make
                lines = [np.asarray(line) for line in path.to_polygons(closed_only=False)]
                lines = [
                    line
                    for line in lines
                    if _length(line) >= (MIN_PIECE if _goes_on(line, own.shape) else MIN_LINE)
                ]
                kept = (
                    part
                    for line in lines
                    for part in _cut(line, broken)
                    if _length(part) >= MIN_PIECE
                )
                found[float(level)].extend(part * pixel + origin for part in kept)
            traced.remove()
    return dict(sorted(found.items()))


def _pixels(field: Field, extent: Sequence[float]) -> tuple[Floats, Floats]:
    """Their sides, and the centre of the first one."""
    left, right, bottom, top = extent
    pixel = np.array([right - left, top - bottom]) / field.values.shape[::-1]
    return pixel, np.array([left, bottom]) + pixel / 2


def _broken(field: Field) -> Flags:
    """The squares between four pixels' centres of which two neighbours are of different branches."""
    right, above = (np.diff(field.values, axis=axis) for axis in (1, 0))
    with np.errstate(invalid="ignore"):
        apart = [np.abs(step) > HALF_TURN if field.quantity.startswith("angle:") else np.zeros(step.shape, np.bool_)
                 for step in (right, above)]  # fmt: skip
    if field.jumps is not None:
        apart = [a | jump for a, jump in zip(apart, field.jumps, strict=True)]
    found: Flags = apart[0][:-1] | apart[0][1:] | apart[1][:, :-1] | apart[1][:, 1:]
    return found


def _cut(line: Floats, broken: Flags) -> list[Floats]:
    """The parts of a line, in units of pixels from the first one's centre, outside of some squares.

    Each of its pieces lies in one square, as contours are traced.
    """
    if not broken.any() or len(line) < 2:
        return [line]
    middle = (line[:-1] + line[1:]) / 2
    column, row = (
        np.clip(np.floor(middle[:, k]).astype(int), 0, broken.shape[1 - k] - 1) for k in (0, 1)
    )
    away = broken[row, column]
    ends = [0, *(np.nonzero(np.diff(away.astype(int)))[0] + 1), len(away)]
    return [line[a : b + 1] for a, b in pairwise(ends) if b > a and not away[a]]


def _goes_on(line: Floats, shape: tuple[int, ...]) -> bool:
    """Whether a line, in units of pixels, ends within the picture: no ring, and none from side to
    side.
    """
    last = np.array([shape[1] - 1, shape[0] - 1])
    ends = line[[0, -1]]
    within = ((ends > 0) & (ends < last)).all(axis=1)
    return bool(within.any() and (ends[0] != ends[1]).any())


def _length(points: Floats) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def branch_edges(field: Field, extent: Sequence[float]) -> list[Floats]:
    """Polylines in the units of the extent between pixels of different branches, through the
    middles between centres.

    They end at the border of a region, within a pixel of it.
    """
    if field.jumps is None:
        return []
    pixel, origin = _pixels(field, extent)
    return [_smooth(np.array(chain) / 2) * pixel + origin for chain in _chains(*field.jumps)]


def _smooth(points: Floats) -> Floats:
    """The middles between neighbours instead of the points, and the ends: within half a pixel, and
    no stairs.
    """
    return np.vstack([points[:1], (points[:-1] + points[1:]) / 2, points[-1:]])


def _chains(right: Flags, above: Flags) -> list[list[Node]]:
    """The edges as chains of nodes, in half pixels from the first pixel's centre.

    In a square between four pixels' centres two sides that an edge crosses are joined, or more with
    the middle; in a square with one such side the edge ends at the middle.
    """
    rows, columns = above.shape[0], right.shape[1]
    sides = {(2 * c + 1, 2 * r) for r, c in np.argwhere(right).tolist()}
    sides |= {(2 * c, 2 * r + 1) for r, c in np.argwhere(above).tolist()}
    squares = {
        square
        for x, y in sides
        for square in (((x, y - 1), (x, y + 1)) if x % 2 else ((x - 1, y), (x + 1, y)))
    }
    links: dict[Node, set[Node]] = {}
    for x, y in squares:
        own = [node for node in ((x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)) if node in sides]
        inside = 0 < x < 2 * columns and 0 < y < 2 * rows
        pairs = [(own[0], own[1])] if len(own) == 2 and inside else [(node, (x, y)) for node in own]
        for a, b in pairs:
            links.setdefault(a, set()).add(b)
            links.setdefault(b, set()).add(a)
    return list(_walked(links))


def _walked(links: dict[Node, set[Node]]) -> list[list[Node]]:
    """Every link once, in chains that are as long as they can be from the ends, then rings."""
    found = []
    for start in sorted(links, key=lambda node: (len(links[node]) == 2, node)):
        while links[start]:
            chain = [start]
            while links[chain[-1]]:
                node = min(links[chain[-1]])
                links[chain[-1]].discard(node)
                links[node].discard(chain[-1])
                chain.append(node)
                if len(links[node]) > 1:
                    break
            found.append(chain)
    return found
