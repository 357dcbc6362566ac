"""Where two certified maps of the same window differ.

Guarantee: exact. What is outside both covers falls into components in which neither count changes,
and whose areas are integers of lattice squares; what is in a cover may have any count, and is in
the upper bounds only.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ptmcad.answer.comparison import Bounds
from ptmcad.answer.counts import counted_by
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.location import component_cells
from ptmcad.cover import components
from ptmcad.cover.complement import Components, samples
from ptmcad.cover.rectangles import Cover
from ptmcad.cover.subdivision import FREE
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Point, Slice

Side = tuple[Components, dict[int, int]]
"""One of the maps: its components, and the region of each that has one."""
Pair = tuple[int, ...]
"""Numbers of the regions of both maps that hold a component."""


def side(result: RegionMap) -> Side:
    """A certified map made ready.

    Raises
    ------
    ConfigError
        When it contradicts itself.
    """
    assert result.cover is not None
    complement, cells = component_cells(result, result.cover)
    region_of = {
        place: result.cells[cell].region for place, cell in cells.items() if place is not None
    }
    if not all(region < len(result.regions) for region in region_of.values()):
        raise ConfigError(
            "the map contradicts itself (a cell is in no region); check it with ptmcad verify"
        )
    return complement, region_of


def overlaid(first: Side, second: Side) -> tuple[Components, dict[int, Pair]]:
    """The complement of both covers, and for each of its components, by descending area, the regions
    of both maps that hold it, where both have one.
    """
    covers = (first[0].cover, second[0].cover)
    steps = max(cover.steps for cover in covers)
    finer = {
        tuple(end * (steps // cover.steps) for end in rectangle)
        for cover in covers
        for rectangle in cover.rectangles
    }
    complement = components(Cover(steps, tuple(sorted(finer))))  # type: ignore[arg-type]
    corners = np.array(complement.rectangles, dtype=np.int64).reshape(-1, 4)
    found = []
    for own, region_of in (first, second):
        coarser = steps // own.cover.steps
        leaves = own.subdivision.leaves_right_above(
            corners[:, 0] // coarser, corners[:, 2] // coarser
        )
        # what is outside both covers is outside each of them
        assert (own.subdivision.state[leaves] == FREE).all()
        found.append([region_of.get(place) for place in own.owner[leaves].tolist()])
    pairs = enumerate(zip(*found, strict=True))
    return complement, {n: pair for n, pair in pairs if None not in pair}


def bounds_of(
    maps: Sequence[RegionMap],
    sides: Sequence[Side],
    complement: Components,
    counts: Mapping[int, tuple[tuple[int, ...], ...]],
) -> list[Bounds]:
    """Bounds of the area with each pair of counts: proved, and possible where each map has its count
    or is undetermined.

    Parameters
    ----------
    counts : of both maps, for each component.
    """
    steps, slice = complement.cover.steps, maps[0].slice
    certain = Counter[tuple[tuple[int, ...], ...]]()
    rest = Counter[tuple[int, ...]](), Counter[tuple[int, ...]]()
    for number, pair in counts.items():
        certain[pair] += complement.areas[number]
    for k, (result, (own, region_of)) in enumerate(zip(maps, sides, strict=True)):
        for component, region in region_of.items():
            area = own.areas[component] * (steps // own.cover.steps) ** 2
            rest[k][counted_by(result.regions[region], slice.count)] += area
        for pair, area in certain.items():
            rest[k][pair[k]] -= area
    neither = steps**2 - certain.total() - rest[0].total() - rest[1].total()
    square = slice.area / steps**2
    return [
        (square * sure, square * (sure + rest[0][pair[0]] + rest[1][pair[1]] + neither))
        for pair, sure in certain.items()
    ]


def points_in(slice: Slice, complement: Components, numbers: Iterable[int]) -> list[Point]:
    """A point of each of these components."""
    x, y = slice.axes
    window = ((x.low, x.high), (y.low, y.high))
    return [Point(slice.axis_names, *next(samples(complement, n, window))) for n in numbers]
