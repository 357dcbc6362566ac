"""Where two certified maps of the same window differ.

Guarantee: exact. What is outside both covers falls into components in which neither count changes,
and whose areas are integers of lattice squares; what is in a cover may have any count, and is in
the upper bounds only.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from ptmcad.answer.comparison import Bounds, Change, Comparison
from ptmcad.answer.counts import counted_by
from ptmcad.answer.regionmap import Cell, Region, RegionMap
from ptmcad.ask.location import component_cells
from ptmcad.cover import components
from ptmcad.cover.complement import Components, samples
from ptmcad.cover.rectangles import Cover
from ptmcad.cover.subdivision import FREE
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Point

Key = tuple[int, ...]
"""A count."""
Held = tuple[int, int]
"""Numbers of the regions of both maps that hold a component."""


@dataclass(frozen=True, slots=True)
class ComparedMap:
    """One of the maps: its components, and which region each of those that have one is in."""

    result: RegionMap
    complement: Components
    region_of: dict[int, int]

    def key(self, region: int) -> Key:
        """The count of a region."""
        return counted_by(self.result.regions[region], self.result.slice.count)

    def areas(self, steps: int) -> Counter[Key]:
        """How much is proved to have each count, in squares of a finer lattice."""
        finer = (steps // self.complement.cover.steps) ** 2
        found = Counter[Key]()
        for component, region in self.region_of.items():
            found[self.key(region)] += finer * self.complement.areas[component]
        return found


def side(result: RegionMap, cover: Cover) -> ComparedMap:
    """A certified map made ready.

    Raises
    ------
    ConfigError
        When it contradicts itself.
    """
    complement, cells = component_cells(result, cover)
    region_of = {
        place: result.cells[cell].region for place, cell in cells.items() if place is not None
    }
    if not all(region < len(result.regions) for region in region_of.values()):
        raise ConfigError(
            "the map contradicts itself (a cell is in no region); check it with ptmcad verify"
        )
    return ComparedMap(result, complement, region_of)


def cover_difference(first: ComparedMap, second: ComparedMap) -> Comparison:
    """The difference of two certified maps with the same axes, window and count."""
    covers = (first.complement.cover, second.complement.cover)
    steps = max(cover.steps for cover in covers)
    both = Cover(steps, tuple(sorted({r for cover in covers for r in _finer(cover, steps)})))
    complement = components(both)
    held = _held(complement, (first, second))
    certain: Counter[tuple[Key, Key]] = Counter()
    largest: dict[tuple[Key, Key], int] = {}
    for number, regions in held.items():
        pair = (first.key(regions[0]), second.key(regions[1]))
        certain[pair] += complement.areas[number]
        largest.setdefault(pair, number)  # components come by descending area
    possible = _possible(certain, (first.areas(steps), second.areas(steps)), steps**2)
    numbers = {pair: n for n, pair in enumerate(largest)}
    square = first.result.slice.area / steps**2
    bounds: dict[tuple[Key, Key], Bounds] = {
        p: (square * certain[p], square * possible(p)) for p in numbers
    }
    cells = [(n, numbers[first.key(a), second.key(b)]) for n, (a, b) in held.items()]
    decomposition = _as_map(first.result, complement, cells, list(bounds.values()))
    changes = [
        Change(*held[largest[pair]], number, bounds[pair])
        for pair, number in numbers.items()
        if pair[0] != pair[1]
    ]
    return Comparison(
        first.result,
        second.result,
        decomposition,
        tuple(sorted(changes, key=lambda c: -c.area[0])),
        square * (steps**2 - certain.total()),
    )


def _finer(cover: Cover, steps: int) -> list[tuple[int, int, int, int]]:
    """A cover's rectangles on a lattice with more steps."""
    by = steps // cover.steps
    return [
        (by * left, by * right, by * bottom, by * top)
        for left, right, bottom, top in cover.rectangles
    ]


def _held(complement: Components, sides: Sequence[ComparedMap]) -> dict[int, Held]:
    """For each component outside both covers the regions of both maps that hold it, where both have
    one.
    """
    corners = np.array(complement.rectangles, dtype=np.int64).reshape(-1, 4)
    found = []
    for of in sides:
        tree, coarser = (
            of.complement.subdivision,
            complement.cover.steps // of.complement.cover.steps,
        )
        leaves = tree.leaves_right_above(corners[:, 0] // coarser, corners[:, 2] // coarser)
        assert (
            tree.state[leaves] == FREE
        ).all()  # what is outside both covers is outside each of them
        found.append([of.region_of.get(place) for place in of.complement.owner[leaves].tolist()])
    return {
        n: (a, b)
        for n, (a, b) in enumerate(zip(*found, strict=True))
        if a is not None and b is not None
    }


def _possible(
    certain: Counter[tuple[Key, Key]], alone: tuple[Counter[Key], Counter[Key]], whole: int
) -> Callable[[tuple[Key, Key]], int]:
    """How much may have a pair of counts: where each map has its count or is undetermined."""
    before, after = Counter[Key](), Counter[Key]()
    for (a, b), area in certain.items():
        before[a] += area
        after[b] += area
    neither = whole - alone[0].total() - alone[1].total() + certain.total()

    def possible(pair: tuple[Key, Key]) -> int:
        a, b = pair
        return certain[pair] + (alone[0][a] - before[a]) + (alone[1][b] - after[b]) + neither

    return possible


def _as_map(
    first: RegionMap,
    complement: Components,
    cells: Sequence[tuple[int, int]],
    bounds: Sequence[Bounds],
) -> RegionMap:
    """The decomposition in the form that pictures read, from each cell's component and region."""
    x, y = first.slice.axes
    window = ((x.low, x.high), (y.low, y.high))
    points = [
        Point(first.slice.axis_names, *next(samples(complement, n, window))) for n, _ in cells
    ]
    members: list[list[int]] = [[] for _ in bounds]
    for cell, (_, region) in enumerate(cells):
        members[region].append(cell)
    return replace(
        first,
        cells=tuple(
            Cell(None, k, at, region, None, None, None)
            for k, ((_, region), at) in enumerate(zip(cells, points, strict=True))
        ),
        regions=tuple(
            Region(None, None, None, area, tuple(numbers), points[numbers[0]])
            for area, numbers in zip(bounds, members, strict=True)
        ),
        undetermined=1
        - Fraction(sum(complement.areas[n] for n, _ in cells), complement.cover.steps**2),
        plan=(),
        cover=complement.cover,
    )
