"""Slivers: regions too thin to be seen at a drawing's resolution, and the views in which they are
seen clearly.

Guarantee: a region of which no square of three pixels' side fits into the drawing is reported; the
view for it shows a square of it with at least a twelfth of the view's sides, or as much as `STEPS`
steps of shortening the view reach.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.regionmap import Cell, Region, RegionMap
from ptmcad.answer.remembered import remembered
from ptmcad.exact.cad.decomposition import members, region_numbers
from ptmcad.show.render.colours import INK
from ptmcad.show.render.inches import text_width
from ptmcad.show.render.labels import Label, around, place, polyline
from ptmcad.show.render.view import Interval, Point, Shapes, View
from ptmcad.show.style import Size
from ptmcad.show.table import count_text

STEPS = 100
MAX_ZOOMS = 12
_FRAME = 1.5
_PIXELS = 60
_CLEAR = 2
"""A square of 2 * _CLEAR + 1 pixels of the view's _PIXELS is seen clearly."""

Mask = NDArray[np.bool_]
Part = tuple[float, float]
_WHOLE = (0.0, 1.0)
"""Of a view along an axis."""


@dataclass(frozen=True, slots=True)
class Sliver:
    """A thin region and a point in the thick of it, in the axes' order.

    ``cell`` is one of its cells where it is a thin part of a larger region, in which only the
    counts of unstable solutions differ.
    """

    region: int
    at: Point
    cell: int | None = None


Zoom: TypeAlias = "tuple[Shapes, tuple[Sliver, ...]]"
"""A view that shows some slivers clearly."""


def thin_regions(whole: Shapes, pixels: int) -> tuple[int, ...]:
    """The regions that are thinner than three of the drawing's pixels everywhere.

    Parameters
    ----------
    pixels : of the drawing's side.
    """
    image = whole.raster(pixels, pixels)
    return tuple(n for n in range(len(whole.result.regions)) if not _eroded(image == n).any())


def unstable_zooms(whole: Shapes, pixels: int, most: int) -> tuple[Zoom, ...]:
    """Views of parts of regions that are too thin to be seen and differ by unstable solutions only.

    Of the map that tells such parts from each other thin regions are found and zoomed as of any;
    what is shown then is the map itself, with the thin curve around that part.
    """
    result = whole.result
    if result.cover is not None or not result.slice.count.is_of_stable:
        return ()
    finer = told_apart(result)
    in_parts = replace(whole, result=finer)

    def part(region: int) -> Cell:
        return result.cells[finer.regions[region].cells[0]]

    parts = [
        n
        for n in thin_regions(in_parts, pixels)
        if len(finer.regions[n].cells) < len(result.regions[part(n).region].cells)
    ]
    return tuple(
        (
            whole.in_view(seen.view),
            tuple(
                Sliver(part(s.region).region, s.at, finer.regions[s.region].cells[0])
                for s in slivers
            ),
        )
        for seen, slivers in zooms(in_parts, parts, most)
    )


def seen_thin_walls(whole: Shapes, sides: Size) -> bool:
    """Whether a wall that separates nothing is further than a line's width from the frame of a
    picture somewhere; of solutions that are not isolated there is a line of another kind.

    Parameters
    ----------
    sides : of the picture, in points.
    """
    x, y = (_FRAME / side for side in sides)
    continua = whole.result.continua
    return any(
        not separates
        and component not in continua
        and (
            (x < line[:, 0]) & (line[:, 0] < 1 - x) & (y < line[:, 1]) & (line[:, 1] < 1 - y)
        ).any()
        for component, separates, line in whole.walls()
    )


@remembered(32)
def told_apart(result: RegionMap) -> RegionMap:
    """An exact map whose regions are joined only where all counts of both cells are equal."""
    keys = [(cell.stable, cell.total, cell.index) for cell in result.cells]
    numbers = region_numbers(keys, [(a.first, a.second, 0) for a in result.adjacencies])
    nothing = (Fraction(0), Fraction(0))
    regions = tuple(
        Region(*keys[own[0]], nothing, own, result.cells[own[0]].sample) for own in members(numbers)
    )
    cells = tuple(replace(cell, region=n) for cell, n in zip(result.cells, numbers, strict=True))
    return replace(result, cells=cells, regions=regions)


def zooms(whole: Shapes, thin: Sequence[int], most: int = MAX_ZOOMS) -> tuple[Zoom, ...]:
    """Views that show the thin regions clearly, each as many of them as it happens to; at most so
    many views.
    """
    waiting = list(thin)
    found: list[Zoom] = []
    while waiting and len(found) < most:
        seen = _zoom(whole, waiting[0])
        thick = {n: _thick(seen, n) for n in waiting}
        shown = [n for n, (depth, _) in thick.items() if depth >= _CLEAR or n == waiting[0]]
        found.append((seen, tuple(Sliver(n, thick[n][1]) for n in shown)))
        waiting = [n for n in waiting if n not in shown]
    return tuple(found)


def _zoom(whole: Shapes, region: int) -> Shapes:
    """A view around the region, shortened until the region is clearly seen."""
    seen = whole
    for _ in range(STEPS):
        depth, at = _thick(seen, region)
        parts = [_part(ends) for ends in _extent(seen, region)]
        if all(part == _WHOLE for part in parts):
            if depth >= _CLEAR:
                break
            half = 1 / 32 if depth < 0 else 1 / 4
            parts = [(c - half, c + half) for c in seen.view.approximate_position(at)]
        intervals = (seen.view.x, seen.view.y), (whole.view.x, whole.view.y)
        seen = whole.in_view(View(*map(_nearer, parts, *intervals)))
    return seen


def _extent(seen: Shapes, region: int) -> list[Part]:
    """From where to where the region is seen along each axis, as shares of the view."""
    parts = [np.clip(polygon, 0.0, 1.0) for polygon in seen.polygons()[region]]
    if not parts:
        return [_WHOLE]
    points = np.concatenate(parts)
    return list(zip(points.min(axis=0).tolist(), points.max(axis=0).tolist(), strict=True))


def _part(ends: Part) -> Part:
    """With a margin, if it is short; else all of the view."""
    low, high = ends
    margin = max(0.25 * (high - low), 2.0**-14)
    return _WHOLE if high - low > 0.3 else (low - margin, high + margin)


def _nearer(part: Part, shown: Interval, window: Interval) -> Interval:
    """A part of what is shown of an axis, within the window."""
    low, high = (shown[0] + (shown[1] - shown[0]) * Fraction(share) for share in part)
    return max(window[0], low), min(window[1], high)


def _thick(seen: Shapes, region: int) -> tuple[int, Point]:
    """Half the side, in pixels, of the largest square within the region in the view (-1: none), and
    its centre.
    """
    depth, *place = innermost(seen.raster(_PIXELS, _PIXELS) == region)
    if depth < 0:
        return depth, inside(seen, region)
    x, y = (Fraction(2 * k + 1, 2 * _PIXELS) for k in place)
    view = seen.view
    return depth, (view.x[0] + (view.x[1] - view.x[0]) * x, view.y[0] + (view.y[1] - view.y[0]) * y)


def inside(seen: Shapes, region: int) -> Point:
    """A sample point of the region, one in the view if there is any, in the axes' order."""
    (left, right), (bottom, top) = seen.view.x, seen.view.y
    result: RegionMap = seen.result
    samples = [result.cells[n].sample for n in result.regions[region].cells]
    visible = [p for p in samples if left < p[0] < right and bottom < p[1] < top]
    return (visible or samples)[0]


def innermost(mask: Mask) -> tuple[int, int, int]:
    """How often a mask can be eroded, and column and row of a pixel that is left then; -1 first of
    an empty one.
    """
    depth, last = -1, mask
    while mask.any():
        depth, last = depth + 1, mask
        mask = _eroded(mask)
    if depth < 0:
        return -1, -1, -1
    rows, columns = np.nonzero(last)
    middle = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
    return depth, int(columns[middle]), int(rows[middle])


def _eroded(mask: Mask) -> Mask:
    """The pixels whose eight neighbours are all in the mask; outside of it there is nothing."""
    rows = mask[1:-1] & mask[:-2] & mask[2:]
    inner = rows[:, 1:-1] & rows[:, :-2] & rows[:, 2:]
    return np.pad(inner, 1)


# ----------------------------------------------------------------------------------- arrows to slivers


RESOLVED = 42
"""What is thinner than three pixels of this many to the inch (5 points) is taken for hidden by the
walls around it.
"""
RIMMED = 126
"""The same where it has a rim of its own colour instead of walls (1.7 points)."""
_DISTANCES = (34, 50, 70, 95, 125, 160, 200, 20, 10)
_SIDE = 331.2
"""Points of the picture's side, for these; on a smaller one they are shorter."""
_TIP, _EDGE, _ROUGHLY = 6.0, 2.0, 0.01
"""Points around an arrow's tip, and from the picture's edge to a label; and how far curves may be from
their places, as a share of the picture.
"""


Arrow = tuple[Sliver, bool, dict[str, Any]]
"""An arrow with a label to a sliver: whether it is clear of everything, and what `draw_arrows`
draws, its places being fractions of the picture's sides.
"""


def ranked(whole: Shapes, slivers: Sequence[Sliver], thin: Sequence[int]) -> list[Sliver]:
    """First the largest region of each count that is seen nowhere else, then by size.

    Parameters
    ----------
    thin : the numbers of all regions that are not seen.
    """
    regions, count = whole.result.regions, whole.result.slice.count
    known = {count_text(region, count) for n, region in enumerate(regions) if n not in thin}
    first: list[Sliver] = []
    by_size = sorted(slivers, key=lambda sliver: -regions[sliver.region].area[0])
    for sliver in by_size:
        text = count_text(regions[sliver.region], count)
        if text not in known:
            known.add(text)
            first.append(sliver)
    return [*first, *(sliver for sliver in by_size if sliver not in first)]


def arrows(
    whole: Shapes,
    named: Sequence[tuple[Sliver, str]],
    sides: Size,
    size: float,
    skip: bool = True,
) -> list[Arrow]:
    """Arrows with these names to slivers, from labels towards the picture's middle that cover no border
    between counts if there is room.

    Parameters
    ----------
    named : slivers and what their labels say.
    sides : width and height of the picture, in points.
    size : of the texts, in points.
    skip : whether labels that are not clear are not to be drawn.
    """
    tips = [whole.view.approximate_position(sliver.at) for sliver, _ in named]
    points = [(x * sides[0], y * sides[1]) for x, y in tips]
    scale = min(*sides, _SIDE) / _SIDE
    labels = []
    for (_, name), (x, y) in zip(named, points, strict=True):
        half = (36 * text_width(name, size) + 0.25 * size + 1, 0.85 * size + 1)
        inwards = (sides[0] / 2 - x or 1.0, sides[1] / 2 - y or 1.0)
        labels.append(Label(name, (x, y), half, inwards, across=False))
    bounds = (_EDGE, _EDGE, sides[0] - _EDGE, sides[1] - _EDGE)
    around_tips = [around(point, (_TIP, _TIP)) for point in points]
    borders = whole.borders(_ROUGHLY) if labels else ()
    strokes = (s for line in borders for s in polyline((line * sides).tolist(), 0.5))
    placed = place(labels, strokes, around_tips, bounds, [scale * d for d in _DISTANCES], skip)
    return [
        (
            sliver, one.clear,
            {
                "text": one.text, "xy": tip, "xytext": (one.center[0] / sides[0], one.center[1] / sides[1]),
                "fontsize": size, "gid": f"arrow-{sliver.region}",
            },
        )
        for (sliver, _), tip, one in zip(named, tips, placed, strict=True)
    ]  # fmt: skip


def arrows_of(
    whole: Shapes, sides: Size, dpi: int, size: float, names: Sequence[str] | None = None
) -> tuple[list[Arrow], int]:
    """The arrows of a map in a drawing of its own, without insets, and how many thin regions have
    none.

    Parameters
    ----------
    sides : of the drawing, in inches.
    size : of the labels, in points.
    names : of the regions, in their order, empty for those that need no mark; else their counts.
        Regions with names are drawn with rims of their own colour, so that thinner ones are seen.
    """
    resolved, said = RIMMED, names
    if said is None:
        count = whole.result.slice.count
        resolved, said = RESOLVED, [count_text(region, count) for region in whole.result.regions]
    thin = [n for n in thin_regions(whole, round(min(sides) * min(dpi, resolved))) if said[n]]
    slivers = ranked(whole, [Sliver(n, inside(whole, n)) for n in thin], thin)
    named = [(sliver, said[sliver.region]) for sliver in slivers]
    points = (72 * sides[0], 72 * sides[1])
    found = [arrow for arrow in arrows(whole, named, points, size) if arrow[1]]
    return found, len(thin) - len(found)


def draw_arrows(axes: Any, found: Iterable[Arrow], scale: float) -> None:
    """The arrows and their labels."""
    for _, _, own in found:
        axes.annotate(
            xycoords="axes fraction", textcoords="axes fraction", ha="center", va="center", color=INK, zorder=6,
            annotation_clip=False, **own,
            bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": INK, "linewidth": 0.5},
            arrowprops={
                "arrowstyle": "-|>", "color": INK, "linewidth": 0.9 * scale, "mutation_scale": 8 * scale,
                "shrinkA": 0, "shrinkB": 0,
            },
        )  # fmt: skip
