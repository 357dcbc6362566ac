"""The error of a drawn map, defined once: share of the window that is wrong, regions missed, distance of the boundary.

Guarantee: shares and numbers of regions are exact up to the bounds that are given with them; nothing is sampled.
See docs/error.md for the definitions.

A grid's map is the union of its n x n pixels, each of which shows the count that the grid has at its centre. Over a
place u of the base let v_1 < ... < v_m be the walls and c_0, ..., c_m the true counts between them. With G_c(u, v), the
length of what is below v and does not show c, the wrong length over u is

    G_{c_m}(u, 1) + sum_k [G_{c_{k-1}}(u, v_k) - G_{c_k}(u, v_k)].

The bracket changes by at most as much as v_k, so a chord in the place of a wall brings an error of at most its distance
times its width; and along a chord the bracket is piecewise quadratic, so its integral is a rational number.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.bench.distance import Distances, distances, grid_boundary
from ptmcad.bench.reference import Column, Reference, Walls, count_of, regions

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
    missed : regions of the exact map of which nothing is shown with their count.
    regions : of the exact map.
    distance : from the drawn boundary to the true one and back; None when one of them is empty and the other is not.
    """

    wrong: Bounds
    undetermined: Fraction
    wrong_centres: int | None
    missed: int
    regions: int
    distance: Distances | None


NO_DISTANCE = Distances((0.0, 0.0), (0.0, 0.0))


def exact_error(exact: Reference, count: str) -> MapError:
    """Of an exact map: by construction nothing is wrong, and its boundary is the true curves themselves."""
    return MapError((Fraction(0),) * 2, Fraction(0), None, 0, 1 + max(regions(exact.result, count)), NO_DISTANCE)


def grid_error(
    exact: Reference, walls: Walls, columns: tuple[Column, ...], drawn: Counts, count: str
) -> MapError:
    """Of a grid.

    Parameters
    ----------
    walls : of the exact map, for the count.
    columns : where the pixels' centres lie, see `ptmcad.bench.reference.centres`.
    drawn : the counts that are shown, of shape (n, n), the first index along the slice's first axis; negative where
        none is shown.
    """
    picture = drawn if exact.result.base == 0 else drawn.T
    wrong_centres, missed, number = _centres(exact, columns, picture, count)
    return MapError(
        wrong=wrong_area(walls, picture),
        undetermined=Fraction(int((drawn < 0).sum()), drawn.size),
        wrong_centres=wrong_centres,
        missed=missed,
        regions=number,
        distance=distances(walls, grid_boundary(picture), Fraction(1, len(picture))),
    )


def _centres(exact: Reference, columns: tuple[Column, ...], picture: Counts, count: str) -> tuple[int, int, int]:
    """Centres with a wrong count, regions that no centre in them shows, and all regions."""
    region_of = regions(exact.result, count)
    truth = [count_of(cell, count) for cell in exact.result.cells]
    wrong, seen = 0, set()
    for k, runs in enumerate(columns):
        for cell, first, end in runs:
            right = int((picture[k, first:end] == truth[cell]).sum())
            wrong += end - first - right
            if right:
                seen.add(region_of[cell])
    return wrong, len(set(region_of) - seen), len(set(region_of))


def wrong_area(walls: Walls, picture: Counts) -> Bounds:
    """The share of the window where the picture shows another count than the true one.

    Parameters
    ----------
    picture : shape (n, n), the first index along the base.
    """
    n = len(picture)
    needed = {c for _, *sides in walls.chords for c in sides} | {c for *_, c in walls.tops}
    sums = {c: _sums(picture, c) for c in needed}
    total, doubt = Fraction(0), Fraction(0)
    for left, right, top in walls.tops:
        below = sums[top][:, n]
        total += sum((b - a) * int(below[k]) for k, a, b in _columns(left, right, n)) / n
    for chord, lower, upper in walls.chords:
        doubt += chord.apart * (chord.right - chord.left)
        rise = (chord.at_right - chord.at_left) / (chord.right - chord.left)
        for k, a, b in _columns(chord.left, chord.right, n):
            ends = (chord.at_left + (a - chord.left) * rise, chord.at_left + (b - chord.left) * rise)
            total += (b - a) * _mean(sums[lower][k], sums[upper][k], min(ends) * n, max(ends) * n, n) / n
    doubtful = sum((right - left for left, right, _ in walls.gaps), Fraction(0))
    return max(total - doubt, Fraction(0)), min(total + doubt + doubtful, Fraction(1))


def _sums(picture: Counts, count: int) -> Any:
    """For each column and 0 <= j <= n, how many of its lowest j pixels do not show the count."""
    n = len(picture)
    sums = np.zeros((n, n + 1), dtype=np.int32)
    np.cumsum(picture != count, axis=1, out=sums[:, 1:])
    return sums


def _columns(left: Fraction, right: Fraction, n: int) -> list[tuple[int, Fraction, Fraction]]:
    """The parts of an interval in the columns of a grid."""
    first, last = (left * n).__floor__(), -((-right * n).__floor__()) - 1
    return [
        (k, max(left, Fraction(k, n)), min(right, Fraction(k + 1, n))) for k in range(first, last + 1)
    ]


def _mean(lower: Any, upper: Any, low: Fraction, high: Fraction, n: int) -> Fraction:
    """The mean of n (G_lower - G_upper) over the heights from low to high, which are in pixels."""
    first, last = min(low.__floor__(), n - 1), min(max(-((-high).__floor__()) - 1, low.__floor__()), n - 1)

    def at(j: int, height: Fraction) -> Fraction:
        below = int(lower[j]) - int(upper[j])
        return below + (height - j) * (int(lower[j + 1]) - int(upper[j + 1]) - below)

    if first == last:
        return at(first, (low + high) / 2)
    total = Fraction(0)
    for j in range(first, last + 1):
        a, b = max(low, Fraction(j)), min(high, Fraction(j + 1))
        total += (b - a) * at(j, (a + b) / 2)
    return total / (high - low)
