"""The error of a drawn map, defined once: share of the window that is wrong, regions missed,
distance of the boundary.

Guarantee: nothing is sampled, and figures are between their bounds as far as doubles go: they are
computed in floating point, with `ROUNDING` allowed for in areas and no proof that this is enough.
They are a benchmark's figures, and no count rests on them. docs/error.md has the definitions.

The truth is an exact map, whose walls between regions are within proved distances of polylines
(`ptmcad.exact.boundaries.polyline`). A drawn map is made of pieces, rectangles with the count that is shown:
pixels of a grid, or the parts of a certified map's window that its cover leaves. In a piece the
area of a region is the sum of the areas below the walls that the region is below, less those below
the walls that it is above; below a chord that is the integral of a clipped linear function.
Coordinates are shares of the window, along the map's base axis and its fibre.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import chain, pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.location import component_cells
from ptmcad.cover.subdivision import COVERED, FREE, repeated
from ptmcad.errors import LimitReached
from ptmcad.exact.boundaries.polyline import WallPolyline, chains, critical_shares
from ptmcad.exact.cad.decomposition import region_numbers
from ptmcad.text.numerals import decimal

Floats = NDArray[np.float64]
MAX_DISTANCE = Fraction(1, 2**19)
"""Of a wall from its polyline, as a share of the window's side, where it can be had."""
MAX_PIECES = 20_000
"""Of all polylines together: some slices have walls too steep for the measurement."""
ROUNDING = 1e-9
"""What is allowed for rounding to doubles in an area."""
COUNTS = ("stable", "total", "index")
"""The counts for which errors are reported."""
CODE = 100
Bounds = tuple[float, float]
Figures = dict[str, Any]
FIGURES = ("wrong", "undetermined", "wrong_centres", "regions", "missed", "faintest", "distance")
"""How far a drawn map is from the exact one, for one count, None where there is no such figure;
bounds are pairs. ``docs/bench.schema.json`` says what each is."""
DIGITS = 6
DENSITY = 8
"""Points on the side of a pixel."""
MAX_PIECE = 2.0**-11
"""Between points on the boundary of a certified map."""
UNKNOWN = 0.1
"""A wall whose distance is not proved to be less is left out of what distances are measured to."""


Wall = tuple[Floats, float, int, int]
"""A polyline of shape (k, 2), its distance from the wall, and the regions below and above it.

Over the topmost wall, which is the window's edge, there is no region: -1 is above.
"""


class Truth(NamedTuple):
    """What separates regions when they are distinguished by a count.

    Attributes
    ----------
    base : the number of the axis along the base.
    region_of : the region of each of the map's cells, numbered from 0.
    counts : of each region, see `shown_count`.
    walls : of all stacks, the window's upper edge among them.
    upright : walls along the fibre, as rows (u, low, high).
    """

    base: int
    region_of: Sequence[int]
    counts: Sequence[int]
    walls: Sequence[Wall]
    upright: Floats

    def doubts(self) -> Floats:
        """For each region the area in which walls may be, beside their polylines."""
        found = np.full(len(self.counts), ROUNDING)
        for points, apart, *sides in self.walls:
            found[sides] += apart * (points[-1, 0] - points[0, 0])
        return found


def shown_count(stable: Any, total: Any, count: str) -> Any:
    """One number for the count that is asked for, from numbers or arrays; for the index both in
    one.

    >>> shown_count(2, 6, "index")
    602
    """
    if count == "index":
        return None if total is None or stable is None else CODE * total + stable
    return stable if count == "stable" else total


def truths(result: RegionMap) -> dict[str, Truth] | None:
    """The truth for each of `COUNTS` that the map's cells have; None where walls are too steep.

    Raises
    ------
    ValueError
        When the map is not exact.
    """
    if result.status is not Status.EXACT:
        raise ValueError("errors are measured against an exact map")
    left = iter(range(MAX_PIECES))

    def check() -> None:
        if next(left, None) is None:
            raise LimitReached("the walls are too steep")

    try:
        lines = chains(result, MAX_DISTANCE, check)
    except LimitReached:
        return None
    ends = [0.0, *(float(sum(share)) / 2 for share in critical_shares(result)), 1.0]
    shown = {
        count: [shown_count(cell.stable, cell.total, count) for cell in result.cells]
        for count in COUNTS
    }
    return {
        count: truth(result, of_cells, lines, ends)
        for count, of_cells in shown.items()
        if None not in of_cells
    }


def truth(
    result: RegionMap,
    shown: list[int],
    lines: Sequence[Sequence[WallPolyline]],
    ends: Sequence[float],
) -> Truth:
    """What separates regions when each cell shows a number; `ends` are those of the stacks' parts
    of the base.
    """
    region_of = region_numbers(
        shown, [(a.first, a.second, a.component) for a in result.adjacencies]
    )
    counts = dict(zip(region_of, shown, strict=True))
    stacks = []
    for stack, of_stack, (left, right) in zip(result.stacks, lines, pairwise(ends), strict=True):
        here = [*(region_of[n] for n in stack.cells), -1]
        polylines = [
            (np.array(line.points, dtype=float), float(line.distance)) for line in of_stack
        ]
        polylines.append((np.array([[left, 1.0], [right, 1.0]]), 0.0))
        stacks.append(
            [
                (*line, below, above)
                for line, (below, above) in zip(polylines, pairwise(here), strict=True)
                if below != above
            ]
        )
    upright = [
        (at, *part)
        for at, (before, after) in zip(ends[1:-1], pairwise(stacks), strict=True)
        for part in _between(before, after)
    ]
    walls = list(chain.from_iterable(stacks))
    return Truth(
        result.base,
        region_of,
        [*counts.values()],
        walls,
        np.array(upright, dtype=float).reshape(-1, 3),
    )


def _between(left: Sequence[Wall], right: Sequence[Wall]) -> Iterator[tuple[float, float]]:
    """The parts of the fibre over a critical value on whose sides different regions are."""
    sides = [
        (walls, [float(points[end, 1]) for points, *_ in walls])
        for walls, end in ((left, -1), (right, 0))
    ]
    for low, high in pairwise(sorted({0.0, *sides[0][1], *sides[1][1]})):
        one, other = (
            walls[int(np.searchsorted(heights, (low + high) / 2))][2] for walls, heights in sides
        )
        if one != other:
            yield low, high


def figures(wrong: Bounds, undetermined: float, **more: Any) -> Figures:
    """The figures, see `FIGURES`."""
    return {**dict.fromkeys(FIGURES), "wrong": wrong, "undetermined": undetermined, **more}


def grid_error(truth: Truth, cells: np.ndarray, drawn: np.ndarray) -> Figures:
    """Of a grid.

    Parameters
    ----------
    cells : the exact map's cells at the centres, of shape (n, n), the first index along the slice's
        first axis; negative for none.
    drawn : the counts that are shown, of the same shape; negative where none is shown.
    """
    picture, there = (drawn, cells) if truth.base == 0 else (drawn.T, cells.T)
    n = len(picture)
    starts = np.ones((n, n + 1), dtype=bool)
    starts[:, 1:-1] = picture[:, 1:] != picture[:, :-1]
    column, row = np.nonzero(starts)
    run = np.flatnonzero(row < n)
    pieces = np.stack([column[run], column[run] + 1, row[run], row[run + 1]], axis=1) / n
    upright = np.argwhere(picture[1:] != picture[:-1])[:, [0, 0, 1, 1]] + [1, 1, 0, 1]
    level = np.argwhere(picture[:, 1:] != picture[:, :-1])[:, [0, 0, 1, 1]] + [0, 1, 1, 1]
    sides = np.concatenate([upright, level]) / n

    region = np.where(there >= 0, np.array(truth.region_of)[there], -1)
    right = (region >= 0) & (np.array(truth.counts)[region] == picture)
    found = _error(
        truth,
        pieces,
        picture[column[run], row[run]],
        (sides, 1 / n / DENSITY),
        float((drawn < 0).mean()),
    )
    wrong_centres = int((region >= 0).sum() - right.sum())
    return found | {
        "wrong_centres": wrong_centres,
        "missed": len(truth.counts) - len(np.unique(region[right])),
    }


def cover_error(truth: Truth, result: RegionMap, count: str) -> Figures | None:
    """Of a certified map of the same slice; None when its cells do not have this count.

    Raises
    ------
    ValueError
        When it is no certified map.
    """
    if result.cover is None:
        raise ValueError("an exact map has no cover")
    counts = [shown_count(cell.stable, cell.total, count) for cell in result.cells]
    if None in counts:
        return None
    complement, cells = component_cells(result)
    tree = complement.subdivision
    rectangles = tree.bounds / complement.cover.steps
    if truth.base:
        rectangles = rectangles[:, [2, 3, 0, 1]]
    free = tree.state == FREE
    pieces = rectangles[free]
    shown = np.array(
        [counts[cells[n]] if n in cells else -1 for n in complement.owner[free].tolist()],
        dtype=np.int64,
    )
    drawn = rectangles[tree.state == COVERED], MAX_PIECE
    found = _error(truth, pieces, shown, drawn, float(result.undetermined))
    return found | {"undetermined": outward(0, result.undetermined)[1]}


def _error(
    truth: Truth,
    pieces: Floats,
    shown: np.ndarray,
    drawn: tuple[Floats, float],
    least: float,
) -> Figures:
    """The figures of pieces that show a count.

    Parameters
    ----------
    drawn : the boundary between them, as of `distance`.
    least : the share that is undetermined.
    """
    right = shown_areas(truth, pieces, shown)
    areas = shown_areas(truth, np.array([[0.0, 1.0, 0.0, 1.0]]))
    doubts = truth.doubts()
    wrong, doubt = 1 - float(right.sum()), float(doubts.sum()) / 2 + ROUNDING
    bounds = (float(np.clip(x, least, 1.0)) for x in (wrong - doubt, wrong + doubt))
    with np.errstate(divide="ignore"):
        low = (right - doubts) / (areas + doubts)
        high = (right + doubts) / (areas - doubts).clip(0)
    return figures(
        outward(*bounds),
        least,
        regions=len(truth.counts),
        missed=int((right <= doubts).sum()),
        faintest=outward(*(float(np.clip(x.min(), 0.0, 1.0)) for x in (low, high))),
        distance=distance(truth, *drawn),
    )


def shown_areas(truth: Truth, pieces: Floats, shown: np.ndarray | None = None) -> Floats:
    """For each region the area in which pieces show its count, up to `Truth.doubts`; its area in
    all if none is shown.

    Parameters
    ----------
    pieces : disjoint rectangles as rows (left, right, bottom, top).
    """
    found = np.zeros(len(truth.counts))
    for points, _, below, above in truth.walls:
        for region, sign in ((below, 1), (above, -1)):
            if region >= 0:
                own = pieces if shown is None else pieces[shown == truth.counts[region]]
                found[region] += sign * _below(points, own)
    return found


def _below(points: Floats, pieces: Floats) -> float:
    """The area of pieces below a polyline, over the polyline."""
    u, v = points.T
    first = np.searchsorted(u[1:], pieces[:, 0], "right")
    number = (np.searchsorted(u[:-1], pieces[:, 1], "left") - first).clip(0)
    of, chord = repeated(number)
    chord += first[of]
    left, right = np.maximum(pieces[of, 0], u[chord]), np.minimum(pieces[of, 1], u[chord + 1])
    slope = (v[chord + 1] - v[chord]) / (u[chord + 1] - u[chord])
    across = np.stack([left, right]) - u[chord]
    ends = np.sort(v[chord] + across * slope - pieces[of, 2], axis=0)
    low, high = ends
    tall = pieces[of, 3] - pieces[of, 2]
    first, last = np.clip(ends, 0, tall)
    risen = (last - first) * (first + last) / 2
    whole = (high - np.maximum(low, tall)).clip(0) * tall
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(high > low, (risen + whole) / (high - low), first)
    return float(((right - left).clip(0) * mean).sum())


def distance(truth: Truth, drawn: Floats, spacing: float) -> Bounds | None:
    """The Hausdorff distance between the true walls and rectangles that are drawn, in the unit
    square.

    Parameters
    ----------
    drawn : rectangles as rows (left, right, bottom, top), which may be sides of no width.

    Returns
    -------
    None when just one of the two is empty.
    """
    walls = [w for w in truth.walls if w[3] >= 0 and w[1] < UNKNOWN]
    chords = [np.concatenate([points[:-1], points[1:]], axis=1) for points, *_ in walls]
    upright = truth.upright[:, [0, 1, 0, 2]]
    segments = np.concatenate([*chords, upright])
    if not len(segments) or not len(drawn):
        return (0.0, 0.0) if not len(segments) and not len(drawn) else None
    apart = max((w[1] for w in walls), default=0.0)
    low_ends, high_ends = drawn[:, ::2], drawn[:, 1::2]
    size, centre = high_ends - low_ends, (low_ends + high_ends) / 2
    along = np.eye(2)[size.argmax(axis=1)] * size / 2
    middle_lines = np.concatenate([centre - along, centre + along], axis=1)
    true, of_wall = _points(segments, spacing, np.zeros(len(segments)))
    shown, of_drawn = _points(middle_lines, spacing, size.min(axis=1) / 2)

    from scipy.spatial import cKDTree

    to_shown, to_true = cKDTree(shown).query(true)[0], cKDTree(true).query(shown)[0]
    low = max(float(to_shown.max() - of_drawn.max()), float(to_true.max() - of_wall.max()))
    high = max(float((to_shown + of_wall).max()), float((to_true + of_drawn).max()))
    return outward(max(0.0, low - apart), high + apart)


def _points(segments: Floats, spacing: float, thick: Floats) -> tuple[Floats, Floats]:
    """Points on segments (u0, v0, u1, v1), and how far from each what it stands for may be."""
    start, way = segments[:, :2], segments[:, 2:] - segments[:, :2]
    length = np.hypot(way[:, 0], way[:, 1])
    pieces = np.maximum(1, np.ceil(length / spacing)).astype(np.int64)
    of, within = repeated(pieces)
    share = (within + 0.5) / pieces[of]
    return start[of] + share[:, None] * way[of], np.hypot(length / pieces / 2, thick)[of]


def outward(low: float | Fraction, high: float | Fraction) -> Bounds:
    """Both bounds in six digits, the lower rounded down and the upper rounded up."""
    first, last = (
        decimal(Fraction(x), up=up, digits=DIGITS) for x, up in ((low, False), (high, True))
    )
    return float(first), float(last)
