"""Slivers: regions too thin to be seen at a drawing's resolution, and the views in which they are seen clearly.

Guarantee: a region of which no square of three pixels' side fits into the drawing is reported; its view shows a square
of it with at least a tenth of the view's sides, or as much as `STEPS` halvings of the view reach.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ptmcad.regionmap import RegionMap
from ptmcad.render.outline import Interval, Outline, View, outline

STEPS = 60
_PIXELS = 60
_CLEAR = 2
"""A square of 2 * _CLEAR + 1 pixels of the view's _PIXELS is seen clearly."""

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Sliver:
    """A thin region.

    Attributes
    ----------
    outline : of the zoomed view.
    at : a point in the thick of it, in the axes' order.
    """

    region: int
    outline: Outline
    at: tuple[Fraction, Fraction]


def slivers(whole: Outline, pixels: int) -> tuple[Sliver, ...]:
    """The regions that are thinner than three of the drawing's pixels everywhere, in the order of their numbers.

    Parameters
    ----------
    pixels : of the drawing's side.
    """
    image = whole.raster(pixels, pixels)
    thin = [n for n in range(len(whole.result.regions)) if not _eroded(image == n).any()]
    return tuple(_zoom(whole, n) for n in thin)


def _zoom(whole: Outline, region: int) -> Sliver:
    view, seen = whole.view, whole
    window = whole.view
    for _ in range(STEPS):
        box = _bounding_box(seen, region)
        if box is None or min(box[1] - box[0], box[3] - box[2]) > 0.3:
            break
        view = View(_stretched(view.x, box[:2], window.x), _stretched(view.y, box[2:], window.y))
        seen = outline(whole.result, view)
    for _ in range(STEPS):
        depth, at = _thick(seen, region)
        if depth >= _CLEAR:
            break
        view = View(_halved(view.x, at[0], window.x), _halved(view.y, at[1], window.y))
        seen = outline(whole.result, view)
    return Sliver(region, seen, _thick(seen, region)[1])


def _bounding_box(seen: Outline, region: int) -> tuple[float, float, float, float] | None:
    """The visible part of the region: left, right, bottom, top in the view's coordinates."""
    parts = [np.clip(polygon, 0.0, 1.0) for polygon in seen.polygons(region)]
    if not parts:
        return None
    points = np.concatenate(parts)
    (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
    return float(left), float(right), float(bottom), float(top)


def _stretched(shown: Interval, part: Sequence[float], window: Interval) -> Interval:
    """The interval of the axis for the part, with a margin, if the part is short; else as it is."""
    low, high = part
    if high - low > 0.3:
        return shown
    margin = max(0.25 * (high - low), 2.0**-14)
    width = shown[1] - shown[0]
    return (
        max(window[0], shown[0] + width * Fraction(low - margin)),
        min(window[1], shown[0] + width * Fraction(high + margin)),
    )


def _halved(shown: Interval, at: Fraction, window: Interval) -> Interval:
    """An interval half as long around a point, within the window."""
    quarter = (shown[1] - shown[0]) / 4
    low = max(window[0], min(at - quarter, window[1] - 2 * quarter))
    return low, low + 2 * quarter


def _thick(seen: Outline, region: int) -> tuple[int, tuple[Fraction, Fraction]]:
    """Half the side, in pixels, of the largest square within the region in the view (-1: none), and its centre."""
    mask = seen.raster(_PIXELS, _PIXELS) == region
    depth = -1
    while mask.any():
        depth, last = depth + 1, mask
        mask = _eroded(mask)
    if depth < 0:
        return depth, _inside(seen, region)
    rows, columns = np.nonzero(last)
    middle = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
    x, y = (Fraction(2 * int(k[middle]) + 1, 2 * _PIXELS) for k in (columns, rows))
    view = seen.view
    return depth, (view.x[0] + (view.x[1] - view.x[0]) * x, view.y[0] + (view.y[1] - view.y[0]) * y)


def _inside(seen: Outline, region: int) -> tuple[Fraction, Fraction]:
    """A sample point of the region, one in the view if there is any."""
    (left, right), (bottom, top) = seen.view.x, seen.view.y
    result: RegionMap = seen.result
    samples = [result.cells[n].sample for n in result.regions[region].cells]
    visible = [p for p in samples if left < p[0] < right and bottom < p[1] < top]
    return (visible or samples)[0]


def _eroded(mask: Mask) -> Mask:
    """The pixels whose eight neighbours are all in the mask; outside of it there is nothing."""
    rows = mask[1:-1] & mask[:-2] & mask[2:]
    inner = rows[:, 1:-1] & rows[:, :-2] & rows[:, 2:]
    return np.pad(inner, 1)
