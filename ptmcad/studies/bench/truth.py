"""The exact map that errors are measured against: walls as polylines, and the cells of pixels' centres.

Guarantee: walls are within their proved distances of their polylines (`ptmcad.exact.cad.chains`),
up to the rounding of coordinates to doubles; what is said of a centre is exact, and one within 2^-40
of a pixel of a wall, or over a critical value, is said to be in no cell.

Coordinates are shares of the window, from 0 to 1, along the map's base axis and along its fibre.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from ptmcad.algebra.real_roots import refine
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.exact.cad.chains import Chain, chains, critical_shares
from ptmcad.exact.cad.curves import curves_of
from ptmcad.exact.cad.polyline import from_share
from ptmcad.exact.cad.stacks import roots_over
from ptmcad.exact.regions import Link, merge
from ptmcad.text.flint_numbers import from_fraction

Floats = NDArray[np.float64]
Counts = NDArray[np.int16]
MAX_DISTANCES = Fraction(1, 2**19), Fraction(1, 2**12)
"""Of a wall from its polyline, as a share of the window's side; the second where the first cannot be had."""
MAX_PIECES = 20_000
"""Of all polylines together: some slices have walls too steep for the measurement."""
UNKNOWN = 0.1
"""A wall whose distance is not proved to be less is left out of what distances are measured to."""
ROUNDING = 1e-9
"""What rounding to doubles may do to an area, very much rounded up."""
_NEAR = fmpq(1, 2**40)
COUNTS = ("stable", "total", "index")
"""The counts for which errors are reported."""
CODE = 100


@dataclass(frozen=True, slots=True)
class Wall:
    """A polyline of shape (k, 2), its distance from the wall, and the regions below and above it."""

    points: Floats
    distance: float
    below: int
    above: int


@dataclass(frozen=True, slots=True)
class Truth:
    """What separates regions when they are distinguished by a count.

    Attributes
    ----------
    region_of : the region of each of the map's cells, numbered from 0.
    counts : of each region, see `shown_count`.
    areas : bounds of each region's share of the window's area, shape (regions, 2).
    tops : for each stack its part of the base and the region of its topmost cell.
    upright : walls along the fibre, as rows (u, low, high).
    doubt, doubts : the area in which walls may be, beside their polylines: of all, and by region.
    """

    result: RegionMap
    region_of: Sequence[int]
    counts: tuple[int, ...]
    areas: Floats
    walls: tuple[Wall, ...]
    tops: tuple[tuple[float, float, int], ...]
    upright: Floats
    doubt: float
    doubts: Floats


def shown_count(stable: Any, total: Any, count: str) -> Any:
    """One number for the count that is asked for, from numbers or arrays; for the index both in one.

    >>> shown_count(2, 6, "index")
    602
    """
    if count == "index":
        return None if total is None or stable is None else CODE * total + stable
    return stable if count == "stable" else total


class _TooSteepError(Exception):
    """More pieces of walls than the measurement may take."""


def truths(result: RegionMap) -> dict[str, Truth] | None:
    """The truth for each of `COUNTS` that the map's cells have; None where walls are too steep.

    Raises
    ------
    ValueError
        When the map is not exact.
    """
    if result.status is not Status.EXACT:
        raise ValueError("errors are measured against an exact map")
    pieces = 0

    def check() -> None:
        nonlocal pieces
        pieces += 1
        if pieces > MAX_PIECES:
            raise _TooSteepError

    try:
        lines = chains(result, MAX_DISTANCES[0], check)
        if any(wall.distance > MAX_DISTANCES[0] for walls in lines for wall in walls):
            coarse = chains(result, MAX_DISTANCES[1], check)
            lines = tuple(
                tuple(min(pair, key=lambda wall: wall.distance) for pair in zip(*walls, strict=True))
                for walls in zip(lines, coarse, strict=True)
            )
    except _TooSteepError:
        return None
    has = {name: all(getattr(cell, name) is not None for cell in result.cells) for name in ("total", "stable")}
    known = {**has, "index": all(has.values())}
    ends = [0.0, *(float(sum(share)) / 2 for share in critical_shares(result)), 1.0]
    return {count: _truth(result, count, lines, ends) for count in COUNTS if known[count]}


def _truth(result: RegionMap, count: str, lines: Sequence[Sequence[Chain]], ends: Sequence[float]) -> Truth:
    shown = [int(shown_count(cell.stable, cell.total, count)) for cell in result.cells]
    region_of = merge(shown, [Link(a.first, a.second, a.component) for a in result.adjacencies])
    counts = dict(zip(region_of, shown, strict=True))
    first, second = result.slice.axes
    window = (first.high - first.low) * (second.high - second.low)
    areas = np.zeros((len(counts), 2))
    for part in result.regions:
        areas[region_of[part.cells[0]]] += [float(end / window) for end in part.area]
    walls, tops, profiles = [], [], []
    for stack, chain_of, span in zip(result.stacks, lines, pairwise(ends), strict=True):
        here = [region_of[n] for n in stack.cells]
        tops.append((*span, here[-1]))
        own = [
            Wall(np.array(chain.points, dtype=float), float(chain.distance), below, above)
            for chain, (below, above) in zip(chain_of, pairwise(here), strict=True)
            if below != above
        ]
        walls += own
        profiles.append((own, here[0]))
    upright = [
        (at, *part)
        for at, (left, right) in zip(ends[1:-1], pairwise(profiles), strict=True)
        for part in _between(left, right)
    ]
    doubts = np.full(len(counts) + 1, ROUNDING)
    for w in walls:
        doubts[[w.below, w.above, -1]] += w.distance * (w.points[-1, 0] - w.points[0, 0])
    return Truth(
        result,
        region_of,
        tuple(counts[n] for n in range(len(counts))),
        areas,
        tuple(walls),
        tuple(tops),
        np.array(upright, dtype=float).reshape(-1, 3),
        float(doubts[-1]),
        doubts[:-1],
    )


def _between(left: Any, right: Any) -> list[tuple[float, float]]:
    """The parts of the fibre over a critical value on whose sides different regions are."""
    profiles = []
    for (walls, lowest), end in ((left, -1), (right, 0)):
        heights = [0.0, *(float(w.points[end, 1]) for w in walls)]
        profiles.append((heights, [lowest, *(w.above for w in walls)]))
    cuts = sorted({*profiles[0][0], *profiles[1][0], 1.0})
    regions = [
        [own[np.searchsorted(heights, (low + high) / 2) - 1] for low, high in pairwise(cuts)]
        for heights, own in profiles
    ]
    return [part for part, a, b in zip(pairwise(cuts), *regions, strict=True) if a != b]


def cells_at_centres(result: RegionMap, n: int) -> NDArray[np.int32]:
    """The map's cell at each centre of n x n pixels, the first index along the base; -1 for none."""
    axes = result.slice.axes[result.base], result.slice.axes[1 - result.base]
    base, fibre = ((from_fraction(a.low), from_fraction(a.high)) for a in axes)
    curves = curves_of(result.components, result.base)
    critical = critical_shares(result)
    found = np.full((n, n), -1, dtype=np.int32)
    for k in range(n):
        share = Fraction(2 * k + 1, 2 * n)
        if any(low <= share <= high for low, high in critical):
            continue
        cells = result.stacks[sum(high < share for _, high in critical)].cells
        roots = roots_over(curves, from_share(share, base), fibre)
        first = 0
        for cell, (_, root) in zip(cells[:-1], roots, strict=True):
            near = refine(root, (fibre[1] - fibre[0]) * _NEAR / n)
            low, high = ((end - fibre[0]) / (fibre[1] - fibre[0]) * n for end in (near.low, near.high))
            found[k, first : int((low + fmpq(1, 2)).ceil()) - 1] = cell
            first = int((high + fmpq(1, 2)).floor())
        found[k, first:] = cells[-1]
    return found
