"""The boundaries of a map's regions as polylines, for other programs to draw.

Guarantee: each curve is within `Boundary.distance` of its polyline, as `ptmcad.exact.boundaries.polyline`
proves, and the distance is at most the tolerance unless it is said to be more; a certified map's
polylines are its cells' own outlines.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import inf, nextafter
from typing import Any

import numpy as np

from ptmcad.answer.boundaries import Boundary
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.location import component_cells
from ptmcad.cover.complement import outlines
from ptmcad.errors import ConfigError
from ptmcad.exact.boundaries.polyline import WallPolyline, chains, critical_shares, lines_across
from ptmcad.question.slice import within_doubles
from ptmcad.text.parsing import share_for

TOLERANCE = Fraction(1, 1000)

Share = tuple[Fraction, Fraction]
"""A point: shares of the window along the base and along the fibre."""


def boundaries(result: RegionMap, tolerance: Any = TOLERANCE) -> tuple[Boundary, ...]:
    """The boundaries between regions, and the variety's other curves, as polylines.

    No curve is further from its polyline than the tolerance, a share of the window's side, unless
    the polyline says so (`Boundary.distance`). A certified map gives the outlines of its cells,
    between which lies what is undetermined.

    Raises
    ------
    ConfigError
        When the tolerance is not between 0 and 1, or the map has no cells yet.

    >>> import ptmcad
    >>> curve = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho")).boundaries()[0]
    >>> curve.points.shape, curve.kind.value
    ((3, 2), 'critical')
    """
    wanted = share_for("tolerance", tolerance)
    if not result.cells:
        raise ConfigError(
            f"the map {result.slice.name} was stopped before it had cells: it has no boundaries"
        )
    with within_doubles(result.slice):
        if result.cover is not None:
            return tuple(_outlines(result))
        return tuple(_drawn(result, piece) for piece in _pieces(result, wanted))


@dataclass(frozen=True, slots=True)
class _Polyline:
    """A polyline; the regions are those below and above it, or before and behind a line across the
    base.
    """

    points: tuple[Share, ...]
    component: int
    regions: tuple[int, int]
    distance: Fraction
    across: bool = False


def _pieces(result: RegionMap, tolerance: Fraction) -> Iterator[_Polyline]:
    chained = chains(result, tolerance)
    pending: list[_Polyline] = []
    for k, (stack, walls) in enumerate(zip(result.stacks, chained, strict=True)):
        here = [result.cells[n].region for n in stack.cells]
        found = [
            _Polyline(c.points, w.component, sides, c.distance)
            for w, c, sides in zip(stack.walls, walls, pairwise(here), strict=True)
        ]
        if k:
            found, done = _joined(pending, found)
            yield from done
        pending = found
    yield from pending
    yield from _lines(result, chained)


def _joined(
    before: list[_Polyline], after: list[_Polyline]
) -> tuple[list[_Polyline], list[_Polyline]]:
    """Pieces that go on, where there is only one that they can be; with those that end."""
    joined, used = [], set()
    for piece in after:
        own = [k for k, other in enumerate(before) if _continues(other, piece)]
        if len(own) == 1 and sum(_continues(before[own[0]], other) for other in after) == 1:
            used.add(own[0])
            joined.append(_together(before[own[0]], piece))
        else:
            joined.append(piece)
    return joined, [piece for k, piece in enumerate(before) if k not in used]


def _together(left: _Polyline, right: _Polyline) -> _Polyline:
    # at the seam each has a height of its own, and its distance is proved for chords that begin or
    # end there
    points = (*left.points, *right.points[left.points[-1] == right.points[0] :])
    return _Polyline(points, right.component, right.regions, max(left.distance, right.distance))


def _continues(left: _Polyline, right: _Polyline) -> bool:
    near = abs(left.points[-1][1] - right.points[0][1]) <= left.distance + right.distance
    return near and (left.component, left.regions) == (right.component, right.regions)


def _lines(result: RegionMap, chained: tuple[tuple[WallPolyline, ...], ...]) -> Iterator[_Polyline]:
    """Lines across the base, from wall to wall."""
    spans = critical_shares(result)
    for component, k in lines_across(result):
        at, radius = (spans[k][0] + spans[k][1]) / 2, (spans[k][1] - spans[k][0]) / 2
        ends = [c.points[-1][1] for c in chained[k]], [c.points[0][1] for c in chained[k + 1]]
        cells = [[result.cells[n].region for n in result.stacks[k + j].cells] for j in (0, 1)]
        walls = [
            (h, c.distance) for j in (0, 1) for h, c in zip(ends[j], chained[k + j], strict=True)
        ]
        for low, high in pairwise(_apart(walls)):
            middle = (low + high) / 2
            left, right = (
                own[sum(h < middle for h in heights)]
                for own, heights in zip(cells, ends, strict=True)
            )
            points = ((at, low), (at, high))
            yield _Polyline(points, component, (left, right), radius, across=True)


def _apart(walls: list[tuple[Fraction, Fraction]]) -> list[Fraction]:
    """The window's edges and the heights at which walls end between them, of those that may be one
    point only one.
    """
    found: list[tuple[Fraction, Fraction]] = [(Fraction(0), Fraction(0))]
    for height, distance in sorted(walls):
        if height - found[-1][0] > distance + found[-1][1]:
            found.append((height, distance))
    if len(found) > 1 and 1 - found[-1][0] <= found[-1][1]:
        found.pop()
    return [*(height for height, _ in found), Fraction(1)]


def _drawn(result: RegionMap, piece: _Polyline) -> Boundary:
    """In the axes' order and units."""
    base = result.base
    axes = (result.slice.axes[base], result.slice.axes[1 - base])
    units = [
        [a.at(c) for c in column]
        for a, column in zip(axes, zip(*piece.points, strict=True), strict=True)
    ]
    points = np.array(
        [[float(v) for v in column] for column in (units if base == 0 else units[::-1])]
    ).T
    # along x what is above is at the left hand; along y what is at smaller x is
    below, above = piece.regions
    swapped = (base == 0) == piece.across
    left, right = (below, above) if swapped else (above, below)
    distance = piece.distance * axes[0 if piece.across else 1].width
    component = result.components[piece.component]
    return Boundary(points, left, right, piece.component, component.kind, _upper(distance))


def _upper(value: Fraction) -> float:
    """A float that is not smaller."""
    near = float(value)
    return near if Fraction(near) >= value else nextafter(near, inf)


def _outlines(result: RegionMap) -> Iterator[Boundary]:
    """The outlines of a certified map's cells."""
    complement, cells = component_cells(result)
    scale = [(a.width / complement.cover.steps, a.low) for a in result.slice.axes]
    for number, polygons in zip(cells.values(), outlines(complement, list(cells)), strict=True):
        region = result.cells[number].region
        for corners in polygons:
            closed = np.concatenate([corners, corners[:1]])
            points = [
                [float(low + step * int(c)) for c in closed[:, k]]
                for k, (step, low) in enumerate(scale)
            ]
            yield Boundary(np.array(points).T, region, None)
