"""The error of a drawn map, defined once: share of the window that is wrong, regions missed, distance of the boundary.

Guarantee: shares and distances are between their bounds; nothing is sampled. docs/error.md has the
definitions.

A drawn map is made of pieces, rectangles with the count that is shown: pixels of a grid, or the
parts of a certified map's window that its cover leaves. In a piece the area of a region is the sum
of the areas below the walls that the region is below, less those below the walls that it is above;
below a chord that is the integral of a clipped linear function. A wall is within its proved
distance of its chords, and that is all that is not known.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from ptmcad.answer.regionmap import RegionMap
from ptmcad.cover import components, slanted
from ptmcad.cover.subdivision import COVERED, FREE
from ptmcad.studies.bench.truth import UNKNOWN, Counts, Floats, Truth, shown_count
from ptmcad.text.numerals import decimal

Bounds = tuple[float, float]
Figures = dict[str, Any]
"""As of `figures`, by their names."""
DIGITS = 6
DENSITY = 8
"""Points on the side of a pixel, and on the whole window's side for a certified map."""
MAX_PIECE = 2.0**-11
NARROW = 2**15
"""Slanted pieces of a cover are in rectangles that are narrower than this part of the window."""


def figures(
    wrong: Bounds,
    undetermined: float,
    wrong_centres: int | None = None,
    regions: int | None = None,
    missed: int | None = None,
    faintest: Bounds | None = None,
    distance: Bounds | None = None,
) -> Figures:
    """How far a drawn map is from the exact one, for one count; None where there is no such figure.

    Parameters
    ----------
    wrong : bounds of the share of the window's area that shows a wrong count or none.
    undetermined : share that shows none.
    wrong_centres : pixels whose centre shows a wrong count.
    regions : of the exact map.
    missed : regions in which no pixel that is centred there, or no part, shows the region's count.
    faintest : bounds of the smallest share of a region's own area that shows its count.
    distance : bounds of the Hausdorff distance between the drawn boundary and the true one.
    """
    return {
        "wrong": wrong, "undetermined": undetermined, "wrong_centres": wrong_centres, "regions": regions,
        "missed": missed, "faintest": faintest, "distance": distance,
    }  # fmt: skip


def exact_error(truth: Truth) -> Figures:
    """Of an exact map: nothing is wrong, and its boundary is the true curves themselves."""
    zero = (0.0, 0.0)
    return figures(zero, 0.0, None, len(truth.counts), 0, (1.0, 1.0), zero)


def grid_error(truth: Truth, cells: np.ndarray, drawn: Counts) -> Figures:
    """Of a grid.

    Parameters
    ----------
    cells : of the centres, see `ptmcad.studies.bench.truth.cells_at_centres`.
    drawn : the counts that are shown, of shape (n, n), the first index along the slice's first axis;
        negative where none is shown.
    """
    picture = drawn if truth.result.base == 0 else drawn.T
    n = len(picture)
    starts = np.ones((n, n + 1), dtype=bool)
    starts[:, 1:-1] = picture[:, 1:] != picture[:, :-1]
    column, row = np.nonzero(starts)
    run = np.flatnonzero(row < n)
    pieces = np.stack([column[run], column[run] + 1, row[run], row[run + 1]], axis=1) / n
    shown = picture[column[run], row[run]]

    upright = np.argwhere(picture[1:] != picture[:-1])[:, [0, 0, 1, 1]] + [1, 1, 0, 1]
    level = np.argwhere(picture[:, 1:] != picture[:, :-1])[:, [0, 0, 1, 1]] + [0, 1, 1, 1]
    sides = np.concatenate([upright, level]) / n

    counts = np.array(truth.counts)
    region = np.where(cells >= 0, np.array(truth.region_of)[cells], -1)
    right = (region >= 0) & (counts[region] == picture)
    seen = np.unique(region[right])
    undetermined = float((drawn < 0).mean())
    wrong, by_region = _wrong(truth, pieces, shown, undetermined)
    return figures(
        wrong,
        undetermined,
        int((region >= 0).sum() - right.sum()),
        len(counts),
        len(counts) - len(seen),
        _faintest(truth, by_region),
        distance(truth, sides, 1 / n / DENSITY),
    )


def cover_error(truth: Truth, result: RegionMap, count: str) -> Figures | None:
    """Of a certified map of the same slice; None when its cells do not have this count.

    Raises
    ------
    ValueError
        When it is no certified map.
    """
    cover = result.cover
    if cover is None:
        raise ValueError("an exact map has no cover")
    if any(shown_count(cell.stable, cell.total, count) is None for cell in result.cells):
        return None
    parts = components(cover)
    number = {}
    for cell in result.cells:
        at = zip(result.slice.axes, (cell.sample[0], cell.sample[1]), strict=True)
        place = ((x - axis.low) / (axis.high - axis.low) * cover.steps for axis, x in at)
        number[parts.locate(*place)] = int(shown_count(cell.stable, cell.total, count))
    parts = slanted.shown(parts, NARROW)
    tree = parts.subdivision
    leaves = np.flatnonzero((tree.state == FREE) & (parts.owner >= 0))
    pieces = tree.bounds[leaves] / cover.steps
    shown = np.array([number.get(n, -1) for n in parts.owner[leaves].tolist()], dtype=np.int64)
    drawn = tree.bounds[tree.state == COVERED] / cover.steps
    undetermined = float(result.undetermined)
    loose = 1 - float(_areas(pieces).sum()) - undetermined
    base = truth.result.base
    wrong, by_region = _wrong(truth, _turned(pieces, base), shown, undetermined, max(loose, 0.0))
    return figures(
        wrong,
        _up(result.undetermined),
        None,
        len(truth.counts),
        int((by_region <= truth.doubts).sum()),
        _faintest(truth, by_region, max(loose, 0.0)),
        distance(truth, _turned(drawn, base), MAX_PIECE),
    )


def _areas(rectangles: Floats) -> Floats:
    return (rectangles[:, 1] - rectangles[:, 0]) * (rectangles[:, 3] - rectangles[:, 2])


def _turned(rectangles: Floats, base: int) -> Floats:
    return rectangles if base == 0 else rectangles[:, [2, 3, 0, 1]]


def _wrong(truth: Truth, pieces: Floats, shown: np.ndarray, least: float, loose: float = 0.0) -> tuple[Bounds, Floats]:
    """Bounds of the share that is wrong, and the areas in which regions show their counts.

    Parameters
    ----------
    least : the share that is undetermined.
    loose : the share that no piece holds though something is shown there.
    """
    by_region = shown_areas(truth, pieces, shown)
    wrong = 1 - float(by_region.sum())
    low, high = wrong - truth.doubt - loose, wrong + truth.doubt
    return outward(max(low, least), min(max(high, least), 1.0)), by_region


def shown_areas(truth: Truth, pieces: Floats, shown: np.ndarray) -> Floats:
    """For each region the area in which pieces show its count, up to `Truth.doubts`.

    Parameters
    ----------
    pieces : disjoint rectangles as rows (left, right, bottom, top).
    """
    found = np.zeros(len(truth.counts))
    for left, right, region in truth.tops:
        part = pieces[shown == truth.counts[region]]
        width = np.minimum(part[:, 1], right) - np.maximum(part[:, 0], left)
        found[region] += (width.clip(0) * (part[:, 3] - part[:, 2])).sum()
    for wall in truth.walls:
        for region, sign in ((wall.below, 1), (wall.above, -1)):
            found[region] += sign * _below(wall.points, pieces[shown == truth.counts[region]])
    return found


def _below(points: Floats, pieces: Floats) -> float:
    """The area of pieces below a polyline, over the polyline."""
    u, v = points.T
    first = np.searchsorted(u[1:], pieces[:, 0], "right")
    number = (np.searchsorted(u[:-1], pieces[:, 1], "left") - first).clip(0)
    of, chord = _numbered(number)
    chord += first[of]
    left, right = np.maximum(pieces[of, 0], u[chord]), np.minimum(pieces[of, 1], u[chord + 1])
    slope = (v[chord + 1] - v[chord]) / (u[chord + 1] - u[chord])
    ends = np.sort([v[chord] + (left - u[chord]) * slope, v[chord] + (right - u[chord]) * slope], axis=0)
    low, high = ends - pieces[of, 2]
    tall = pieces[of, 3] - pieces[of, 2]
    inside = np.clip(ends - pieces[of, 2], 0, tall)
    risen = (inside[1] - inside[0]) * (inside[0] + inside[1]) / 2
    whole = (high - np.maximum(low, tall)).clip(0) * tall
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(high > low, (risen + whole) / (high - low), inside[0])
    return float(((right - left).clip(0) * mean).sum())


def _numbered(number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For items that are repeated so many times: each repetition's item, and its number within it."""
    of = np.repeat(np.arange(len(number)), number)
    return of, np.arange(len(of)) - np.repeat(np.cumsum(number) - number, number)


def _faintest(truth: Truth, by_region: Floats, loose: float = 0.0) -> Bounds:
    """Bounds of the smallest share of a region that is shown with its count."""
    with np.errstate(divide="ignore", invalid="ignore"):
        low = np.nan_to_num((by_region - truth.doubts) / truth.areas[:, 1])
        high = np.nan_to_num((by_region + truth.doubts + loose) / truth.areas[:, 0], nan=1.0)
    return outward(max(0.0, float(low.min())), min(1.0, max(0.0, float(high.min()))))


def distance(truth: Truth, drawn: Floats, spacing: float) -> Bounds | None:
    """The Hausdorff distance between the true walls and rectangles that are drawn, in the unit square.

    Parameters
    ----------
    drawn : rectangles as rows (left, right, bottom, top), which may be sides of no width.

    Returns
    -------
    None when just one of the two is empty.
    """
    walls = [w for w in truth.walls if w.distance < UNKNOWN]
    chords = [np.concatenate([w.points[:-1], w.points[1:]], axis=1) for w in walls]
    upright = truth.upright[:, [0, 1, 0, 2]]
    segments = np.concatenate([*chords, upright])
    if not len(segments) or not len(drawn):
        return (0.0, 0.0) if not len(segments) and not len(drawn) else None
    apart = max((w.distance for w in walls), default=0.0)
    left, right, bottom, top = drawn.T
    wide = right - left > top - bottom
    across, up = (left + right) / 2, (bottom + top) / 2
    middles = np.where(
        wide[:, None],
        np.stack([left, up, right, up], axis=1),
        np.stack([across, bottom, across, top], axis=1),
    )
    thick = np.minimum(right - left, top - bottom) / 2
    true, of_wall = _points(segments, spacing, np.zeros(len(segments)))
    shown, of_drawn = _points(middles, spacing, thick)

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
    of, within = _numbered(pieces)
    share = (within + 0.5) / pieces[of]
    return start[of] + share[:, None] * way[of], np.hypot(length / pieces / 2, thick)[of]


def outward(low: float | Fraction, high: float | Fraction) -> Bounds:
    """Both bounds in six digits, the lower rounded down and the upper rounded up."""
    return float(decimal(Fraction(low), up=False, digits=DIGITS)), _up(high)


def _up(value: float | Fraction) -> float:
    return float(decimal(Fraction(value), up=True, digits=DIGITS))
