"""The error of a certified map: what its cover leaves undetermined, and whether the rest is right.

Guarantee: the share that is wrong is bounded without trusting the certified engine. The window without its cover and
without boxes around the true walls falls into components; each lies in one certified cell and in one true region, and
one exactly located point shows whether their counts agree. What the boxes add to the cover is the bounds' distance.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.regionmap import Cell, RegionMap
from ptmcad.cover import components, union_area
from ptmcad.cover.complement import Components
from ptmcad.cover.rectangles import Cover
from ptmcad.cover.subdivision import FREE
from ptmcad.exact.cad.polyline import UNPROVED
from ptmcad.studies.bench.distance import Distances, chord_points
from ptmcad.studies.bench.error import Bounds, MapError, faintest
from ptmcad.studies.bench.reference import Reference, Walls, regions, shown_count

Integers = NDArray[np.int64]
MIN_BOX_SHARE = 2.0**-16
"""Share of the window's side below which the boxes around walls are not made smaller."""
MAX_PARTS = 200
"""Components that are located; the area of any others counts as doubtful."""


def cover_error(exact: Reference, walls: Walls, result: RegionMap, count: str) -> MapError | None:
    """Of a certified map of the same slice; None when its cells do not have this count.

    Raises
    ------
    ValueError
        When it is no certified map.
    """
    cover = result.cover
    if cover is None:
        raise ValueError("an exact map has no cover")
    if any(cell.total is None or cell.stable is None for cell in result.cells):
        return None
    whole = cover.steps**2
    open_area = union_area(cover)
    shown = components(cover)
    boxes = _outside(shown, _boxes(walls, exact.result.base, cover.steps))
    more = replace(cover, rectangles=(*cover.rectangles, *boxes))
    parts = components(more)  # by descending area
    doubt = union_area(more) - open_area
    cells = {shown.locate(*_steps(result, cover, cell)): cell for cell in result.cells}
    region_of = regions(exact.result, count)
    agreed = [0] * len(walls.counts)
    wrong = unshown = 0
    for n, area in enumerate(parts.areas):
        if n >= MAX_PARTS:
            doubt += area
            continue
        place = _inside(parts, n)
        cell = cells.get(shown.locate(*place))
        if cell is None:
            unshown += area
            continue
        region = _region(exact, region_of, place, cover.steps)
        if region is None:  # the point is on a wall: this part is left in doubt
            doubt += area
        elif walls.counts[region] == shown_count(cell.stable, cell.total, count):
            agreed[region] += area
        else:
            wrong += area
    undetermined = Fraction(open_area + unshown, whole)
    low = undetermined + Fraction(wrong, whole)
    by_region: list[Bounds] = [
        (max(area[0] - Fraction(a + doubt, whole), Fraction(0)), area[1] - Fraction(a, whole))
        for a, area in zip(agreed, walls.areas, strict=True)
    ]
    return MapError(
        wrong=(low, low + Fraction(doubt, whole)),
        undetermined=undetermined,
        wrong_centres=None,
        regions=len(walls.counts),
        missed=sum(a == 0 for a in agreed),
        faintest=faintest(walls, by_region),
        distance=_distances(walls, cover, boxes, exact.result.base),
    )


def _steps(result: RegionMap, cover: Cover, cell: Cell) -> tuple[Fraction, Fraction]:
    u, v = (
        (x - axis.low) / (axis.high - axis.low) * cover.steps
        for axis, x in zip(result.slice.axes, (cell.sample[0], cell.sample[1]), strict=True)
    )
    return u, v


def _inside(parts: Components, n: int) -> tuple[Fraction, Fraction]:
    """A point of a component, off the middle of its rectangle, where symmetric slices have their walls."""
    left, right, bottom, top = parts.rectangles[n]
    return left + Fraction(right - left) * Fraction(19, 37), bottom + Fraction(top - bottom) * Fraction(20, 41)


def _region(exact: Reference, region_of: tuple[int, ...], place: tuple[Fraction, Fraction], steps: int) -> int | None:
    axes = exact.result.slice.axes
    at = {a.name: a.low + (a.high - a.low) * x / steps for a, x in zip(axes, place, strict=True)}
    cell = exact.result.locate(**at).cell
    return None if cell is None else region_of[cell]


def _boxes(walls: Walls, base: int, steps: int) -> NDArray[np.float64]:
    """Chords as rows (u0, v0, u1, v1, apart) in lattice steps along the slice's first and second axis, and the gaps."""
    rows = [[c.left, c.at_left, c.right, c.at_right, c.distance] for c, _, _ in walls.chords]
    for left, right, parts in walls.gaps:
        rows += [[left, (low + high) / 2, right, (low + high) / 2, (high - low) / 2] for low, high in parts]
    array = np.array([[float(x) for x in row] for row in rows]).reshape(-1, 5) * steps
    return array if base == 0 else array[:, [1, 0, 3, 2, 4]] * np.array([1, 1, 1, 1, -1])


def _outside(shown: Components, chords: NDArray[np.float64]) -> tuple[tuple[int, int, int, int], ...]:
    """Boxes around the chords with their walls, but those that the cover holds; large ones are cut smaller first.

    A negative distance is one along the first axis. Boxes are a step larger than the floats say.
    """
    tree, steps = shown.subdivision, shown.cover.steps
    found: list[Integers] = []
    while len(chords):
        ends = np.stack([chords[:, [0, 2]], chords[:, [1, 3]]], axis=1)
        apart = np.stack([np.maximum(-chords[:, 4], 0), np.maximum(chords[:, 4], 0)], axis=1)
        low = np.clip(np.floor(ends.min(axis=2) - apart).astype(np.int64) - 1, 0, steps)
        high = np.clip(np.ceil(ends.max(axis=2) + apart).astype(np.int64) + 1, 0, steps)
        boxes = np.stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]], axis=1)
        box, leaf = tree.meeting(boxes, closed=False)
        poking = np.unique(box[tree.state[leaf] == FREE])
        size = np.abs(ends[poking, :, 1] - ends[poking, :, 0]).max(axis=1)
        small = size <= MIN_BOX_SHARE * steps
        found.append(boxes[poking[small]])
        longer = chords[poking[~small]]
        middle = (longer[:, :2] + longer[:, 2:4]) / 2
        chords = np.concatenate(
            [
                np.concatenate([longer[:, :2], middle, longer[:, 4:]], axis=1),
                np.concatenate([middle, longer[:, 2:4], longer[:, 4:]], axis=1),
            ]
        )
    rows: list[list[int]] = np.concatenate(found).tolist() if found else []
    return tuple((a, b, c, d) for a, b, c, d in rows if a < b and c < d)


def _distances(walls: Walls, cover: Cover, boxes: Any, base: int) -> Distances | None:
    """How far the cover reaches from the true walls; and these from the cover, which holds them but for the boxes."""
    known = [c for c, _, _ in walls.chords if c.distance < UNPROVED]
    if not known or not cover.rectangles:
        return Distances((0.0, 0.0), (0.0, 0.0)) if not known and not cover.rectangles else None
    from scipy.spatial import cKDTree

    points, near = chord_points(known, 2.0**-13)
    tree = cKDTree(points if base == 0 else points[:, ::-1])
    r = np.array(cover.rectangles, dtype=float) / cover.steps
    corners = np.concatenate([r[:, [i, j]] for i in (0, 1) for j in (2, 3)])
    low = float(tree.query(corners)[0].max()) - near
    middles, half = (
        np.stack([r[:, 0] + r[:, 1], r[:, 2] + r[:, 3]], axis=1) / 2,
        np.hypot(r[:, 1] - r[:, 0], r[:, 3] - r[:, 2]) / 2,
    )
    high = float((tree.query(middles)[0] + half).max()) + near
    stray = 0.0
    if boxes:
        b = np.array(boxes, dtype=float) / cover.steps
        centre = np.stack([b[:, 0] + b[:, 1], b[:, 2] + b[:, 3]], axis=1) / 2
        reach = np.hypot(b[:, 1] - b[:, 0], b[:, 3] - b[:, 2]) / 2
        stray = float((cKDTree(np.concatenate([corners, middles])).query(centre)[0] + reach).max())
    return Distances((0.0, stray), (max(0.0, low), high))
