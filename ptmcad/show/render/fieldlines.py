"""Lines over a field: contours within each region and branch, and the edges where the branch
changes.

Guarantee: no contour line crosses an edge of `Field.jumps`, nor the border of a region; none stands
where an angle goes from 180 to -180 degrees. Edges are sides of pixels.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.field import Field
from ptmcad.show.render.view import Floats

MIN_RING, MIN_PIECE = 16.0, 1.0
"""Pixels of the field: shorter rings, which pixels alone make along a ridge just above a level, and
shorter lines are left out.
"""
HALF_TURN = 180.0
"""Degrees by which neighbours of one branch differ where their angle is written with another turn.
"""

Flags = NDArray[np.bool_]
Segment = tuple[tuple[float, float], tuple[float, float]]


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
    columns, rows = _sides(field.values.shape, extent)
    pixel = np.array([columns[1] - columns[0], rows[1] - rows[0]])
    whole = np.where(_before_a_jump(field), np.nan, field.values)
    found: dict[float, list[Floats]] = {float(level): [] for level in levels}
    for region in np.unique(field.region[field.region >= 0]):
        own = np.where(field.region == region, whole, np.nan)
        if (
            (~np.isnan(own)).sum() > 3
            and np.nanmin(own) < levels[-1]
            and np.nanmax(own) > levels[0]
        ):
            traced = axes.contour(
                columns[:-1] + pixel[0] / 2, rows[:-1] + pixel[1] / 2, own, levels=levels
            )
            for level, path in zip(traced.levels, traced.get_paths(), strict=True):
                lines = [np.asarray(line) for line in path.to_polygons(closed_only=False)]
                found[float(level)].extend(line for line in lines if _is_long(line / pixel))
            traced.remove()
    return dict(sorted(found.items()))


def _before_a_jump(field: Field) -> Flags:
    """The pixels whose neighbour at the right or above is of another branch, or has its angle written
    with another turn.
    """
    found = np.zeros(field.values.shape, np.bool_)
    right, above = found[:, :-1], found[:-1]
    if field.jumps is not None:
        right |= field.jumps[0]
        above |= field.jumps[1]
    if field.quantity.startswith("angle:"):
        right |= np.abs(np.diff(field.values, axis=1)) > HALF_TURN
        above |= np.abs(np.diff(field.values, axis=0)) > HALF_TURN
    return found


def _is_long(line: Floats) -> bool:
    """Whether a line, in units of pixels, is drawn."""
    ring = bool((line[0] == line[-1]).all())
    length = float(np.hypot(*np.diff(line, axis=0).T).sum())
    return length >= (MIN_RING if ring else MIN_PIECE)


def _sides(shape: tuple[int, ...], extent: Sequence[float]) -> tuple[Floats, Floats]:
    """Where columns and rows of pixels begin and end."""
    left, right, bottom, top = extent
    return np.linspace(left, right, shape[1] + 1), np.linspace(bottom, top, shape[0] + 1)


def pixel_edges(right: Flags, above: Flags, extent: Sequence[float]) -> list[Segment]:
    """The sides of pixels, in the units of the extent, which part a pixel from that at its right, or
    from that above.
    """
    x, y = (side.tolist() for side in _sides((len(right), above.shape[1]), extent))
    upright = [((x[c + 1], y[r]), (x[c + 1], y[r + 1])) for r, c in np.argwhere(right)]
    level = [((x[c], y[r + 1]), (x[c + 1], y[r + 1])) for r, c in np.argwhere(above)]
    return [*upright, *level]
