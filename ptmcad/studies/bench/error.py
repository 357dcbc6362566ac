"""The error of a drawn map, defined once: share of the window that is wrong, regions missed, distance of the boundary.

Guarantee: shares and numbers of regions are exact up to the bounds that are given with them; nothing is sampled.
See docs/error.md for the definitions.

A grid's map is the union of its n x n pixels, each of which shows the count that the grid has at its centre. Over a
place u of the base let v_1 < ... < v_m be the walls and c_0, ..., c_m the true counts between them. With G_c(u, v), the
length of what is below v and does not show c, the wrong length over u is

    G_{c_m}(u, 1) + sum_k [G_{c_{k-1}}(u, v_k) - G_{c_k}(u, v_k)].

The bracket, and either of its terms, changes by at most as much as v_k, so a chord in the place of a wall brings an
error of at most its distance times its width. Along a chord G is piecewise linear: its integral is a rational number.
Each term belongs to one region, so that what is wrong is known for each region too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from ptmcad.studies.bench.distance import Distances, distances, grid_boundary
from ptmcad.studies.bench.reference import Column, Reference, Walls, regions
from ptmcad.text.flint_numbers import from_fraction, to_fraction

Counts = NDArray[np.int16]
Bounds = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class MapError:
    """How far a drawn map is from the exact one, for one count.

    Attributes
    ----------
    wrong : bounds of the share of the window's area that shows a wrong count or none.
    undetermined : exact share that shows none.
    wrong_centres : pixels whose centre shows a wrong count; None when the map has no pixels.
    regions : of the exact map.
    missed : regions in which no pixel that is centred there, or no part that is decided, shows the region's count.
    faintest : bounds of the smallest share of a region's own area that shows its count.
    distance : between the drawn boundary and the true one; None when one of them is empty and the other is not.
    """

    wrong: Bounds
    undetermined: Fraction
    wrong_centres: int | None
    regions: int
    missed: int
    faintest: Bounds
    distance: Distances | None


def exact_error(walls: Walls) -> MapError:
    """Of an exact map: by construction nothing is wrong, and its boundary is the true curves themselves."""
    zero, one = Fraction(0), Fraction(1)
    return MapError((zero, zero), zero, None, len(walls.counts), 0, (one, one), Distances((0.0, 0.0), (0.0, 0.0)))


def grid_error(exact: Reference, walls: Walls, columns: tuple[Column, ...], drawn: Counts, count: str) -> MapError:
    """Of a grid.

    Parameters
    ----------
    walls : of the exact map, for the count.
    columns : where the pixels' centres lie, see `ptmcad.studies.bench.reference.centres`.
    drawn : the counts that are shown, of shape (n, n), the first index along the slice's first axis; negative where
        none is shown.
    """
    picture = drawn if exact.result.base == 0 else drawn.T
    wrong, by_region = wrong_areas(walls, picture)
    centres, missed = _centres(regions(exact.result, count), walls, columns, picture)
    return MapError(
        wrong=wrong,
        undetermined=Fraction(int((drawn < 0).sum()), drawn.size),
        wrong_centres=centres,
        regions=len(walls.counts),
        missed=missed,
        faintest=faintest(walls, by_region),
        distance=distances(walls, grid_boundary(picture), Fraction(1, len(picture))),
    )


def faintest(walls: Walls, wrong: Sequence[Bounds]) -> Bounds:
    """The smallest share of a region that is shown with its count, from the areas that are not."""
    shares = [
        (max(1 - high / area[0], Fraction(0)) if area[0] else Fraction(0), 1 - low / area[1])
        for area, (low, high) in zip(walls.areas, wrong, strict=True)
    ]
    return min(low for low, _ in shares), max(Fraction(0), min(high for _, high in shares))


def _centres(region_of: tuple[int, ...], walls: Walls, columns: tuple[Column, ...], picture: Counts) -> tuple[int, int]:
    """Centres with a wrong count, and regions that no centre in them shows."""
    wrong, seen = 0, set()
    for k, runs in enumerate(columns):
        for cell, first, end in runs:
            region = region_of[cell]
            right = int((picture[k, first:end] == walls.counts[region]).sum())
            wrong += end - first - right
            if right:
                seen.add(region)
    return wrong, len(walls.counts) - len(seen)


def wrong_areas(walls: Walls, picture: Counts) -> tuple[Bounds, tuple[Bounds, ...]]:
    """The share of the window where the picture does not show the true count, in all and in each region.

    Parameters
    ----------
    picture : shape (n, n), the first index along the base.
    """
    n = len(picture)
    sums = {c: _sums(picture, c) for c in set(walls.counts)}
    parts = [fmpq(0)] * len(walls.counts)
    doubt = sum((from_fraction(gap[1] - gap[0]) for gap in walls.gaps), fmpq(0))
    doubts = [doubt] * len(walls.counts)
    for low_end, high_end, top in walls.tops:
        below = sums[walls.counts[top]][:, n]
        columns = _columns(from_fraction(low_end), from_fraction(high_end), n)
        parts[top] += sum(((b - a) * int(below[k]) for k, a, b in columns), fmpq(0)) / n
    for chord, lower, upper in walls.chords:
        left, right = from_fraction(chord.left), from_fraction(chord.right)
        at_left = from_fraction(chord.at_left)
        blurred = from_fraction(chord.distance) * (right - left)
        doubt += blurred
        doubts[lower] += blurred
        doubts[upper] += blurred
        rise = (from_fraction(chord.at_right) - at_left) / (right - left)
        for k, a, b in _columns(left, right, n):
            ends = (at_left + (a - left) * rise, at_left + (b - left) * rise)
            low, high = min(ends) * n, max(ends) * n
            parts[lower] += (b - a) * _mean(sums[walls.counts[lower]][k], low, high, n) / n
            parts[upper] -= (b - a) * _mean(sums[walls.counts[upper]][k], low, high, n) / n
    return _around(sum(parts, fmpq(0)), doubt), tuple(map(_around, parts, doubts))


def _around(value: fmpq, doubt: fmpq) -> Bounds:
    return max(to_fraction(value - doubt), Fraction(0)), min(to_fraction(value + doubt), Fraction(1))


def _sums(picture: Counts, count: int) -> Any:
    """For each column and 0 <= j <= n, how many of its lowest j pixels do not show the count."""
    n = len(picture)
    sums = np.zeros((n, n + 1), dtype=np.int32)
    np.cumsum(picture != count, axis=1, out=sums[:, 1:])
    return sums


def _columns(left: fmpq, right: fmpq, n: int) -> list[tuple[int, fmpq, fmpq]]:
    """The parts of an interval in the columns of a grid."""
    first, end = int((left * n).floor()), int((right * n).ceil())
    return [(k, max(left, fmpq(k, n)), min(right, fmpq(k + 1, n))) for k in range(first, end)]


def _mean(sums: Any, low: fmpq, high: fmpq, n: int) -> fmpq:
    """The mean of n G over the heights from low to high, which are in pixels; G is linear in each pixel."""
    first = min(int(low.floor()), n - 1)
    last = min(max(int(high.ceil()) - 1, first), n - 1)

    def at(j: int, height: fmpq) -> fmpq:
        below = int(sums[j])
        return below + (height - j) * (int(sums[j + 1]) - below)

    if first == last:
        return at(first, (low + high) / 2)
    total = fmpq(0)
    for j in range(first, last + 1):
        a, b = max(low, fmpq(j)), min(high, fmpq(j + 1))
        total += (b - a) * at(j, (a + b) / 2)
    return total / (high - low)
