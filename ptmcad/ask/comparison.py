"""Where two maps of the same window differ.

Guarantee: exact. The window is cut along the curves of both maps into cells in which neither count
changes; each cell's counts are those of both maps at its sample, and areas are integrated as a
map's own.

Certified maps have no curves. What is outside both covers falls into components in which neither
count changes, and whose areas are integers of lattice squares; what is in a cover may have any
count, and is in the upper bounds only.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np

from ptmcad.answer.comparison import Bounds, Change, Comparison
from ptmcad.answer.counts import counted_by
from ptmcad.answer.regionmap import HARMLESS, Cell, Component, Region, RegionMap, Status
from ptmcad.ask.location import component_cells, locate
from ptmcad.cover import components
from ptmcad.cover.complement import Components, samples
from ptmcad.cover.rectangles import Cover
from ptmcad.cover.subdivision import FREE
from ptmcad.errors import A_MAP, ConfigError, blamed, expect
from ptmcad.exact.areas.area import region_areas
from ptmcad.exact.areas.regionareas import region_stacks
from ptmcad.exact.cad.decomposition import cut_along, members, seen_from
from ptmcad.exact.mapassembly import critical_values_of, stacks_of_cells
from ptmcad.question.counts import Count
from ptmcad.question.slice import Point, Slice
from ptmcad.text.flint_numbers import interval_of

TOLERANCE = Fraction(1, 10**6)
"""Relative width of the areas' bounds."""
_Answer = TypeVar("_Answer")


def compare(first: RegionMap, second: RegionMap, tolerance: Fraction = TOLERANCE) -> Comparison:
    """The difference of two maps with the same axes, window and count, both exact or both
    certified.

    Raises
    ------
    ConfigError
        When they are not such maps; where one of them contradicts itself, the error's key is
        ``first`` or ``second``.
    """
    expect(second, RegionMap, "other", A_MAP)
    _check(first, second)
    return (_exact if first.cover is None else _certified)((first, second), tolerance)


_Maps = tuple[RegionMap, RegionMap]
_Pairs = Sequence[tuple[int, ...]]
"""For each cell of the decomposition the regions of both maps that hold it."""


def _exact(maps: _Maps, tolerance: Fraction) -> Comparison:
    components = _union([c for m in maps for c in m.components if c.separates])
    # at a sample both maps have to say what they count there
    others = [c._replace(left_out=HARMLESS) for m in maps for c in m.components if not c.separates]
    slice = maps[0].slice
    x, y = map(interval_of, slice.axes)
    cut = cut_along((x, y), seen_from([*components, *_union(others)]))
    points = cut.samples(slice.axis_names)
    regions = _of_each(maps, lambda result: [_region(result, at) for at in points])
    pairs = list(zip(*regions, strict=True))
    of_cell = _numbered(_counts(maps, pairs))
    bounds, _ = region_areas(region_stacks(cut, of_cell), tolerance)
    return _comparison(
        maps, pairs, bounds, cut.places, points,
        base=cut.variety.base, components=tuple(components),
        critical_values=critical_values_of(cut.projection), stacks=stacks_of_cells(cut),
        adjacencies=(), non_adjacencies=(),
    )  # fmt: skip


def _certified(maps: _Maps, _tolerance: Fraction) -> Comparison:
    sides = _of_each(maps, _side)
    complement, held = _overlaid(*sides)
    pairs = list(held.values())
    counts = dict(zip(held, _counts(maps, pairs), strict=True))
    places = [(None, k) for k in range(len(held))]
    return _comparison(
        maps, pairs, _cover_bounds(maps, sides, complement, counts), places,
        _points_in(maps[0].slice, complement, held),
        undetermined=1 - Fraction(sum(complement.areas[n] for n in held), complement.cover.steps**2),
        cover=complement.cover,
    )  # fmt: skip


def _counts(maps: _Maps, pairs: _Pairs) -> list[tuple[tuple[int, ...], ...]]:
    """The counts of both maps for each cell."""
    count = maps[0].slice.count
    return [
        tuple(counted_by(m.regions[r], count) for m, r in zip(maps, pair, strict=True))
        for pair in pairs
    ]


def _numbered(counts: Sequence[Hashable]) -> list[int]:
    numbers = {pair: n for n, pair in enumerate(dict.fromkeys(counts))}
    return [numbers[pair] for pair in counts]


def _comparison(
    maps: _Maps,
    pairs: _Pairs,
    bounds: Sequence[Bounds],
    places: Iterable[tuple[int | None, int]],
    points: Sequence[Point],
    **parts: Any,
) -> Comparison:
    """The changes, and the decomposition in the form that pictures read.

    Parameters
    ----------
    bounds : of the area of each pair of counts, in the order of their first cells.
    places : stack and level of each cell.
    parts : of the decomposition, in place of the first map's.
    """
    first, second = maps
    counts = _counts(maps, pairs)
    of_cell = _numbered(counts)
    cells = tuple(
        Cell(stack, level, at, region, None, None, None)
        for (stack, level), at, region in zip(places, points, of_cell, strict=True)
    )
    groups = zip(bounds, members(of_cell) if of_cell else (), strict=True)
    regions = tuple(Region(None, None, None, area, own, points[own[0]]) for area, own in groups)
    changes = []
    for number, region in enumerate(regions):
        before, after = pairs[region.cells[0]]
        if len(set(counts[region.cells[0]])) > 1:
            changes.append(Change(before, after, number, region.area))
    found = replace(first, cells=cells, regions=regions, plan=(), **parts)
    return Comparison(
        first,
        second,
        found,
        tuple(sorted(changes, key=lambda c: -c.area[0])),
        None if first.cover is None else first.slice.area * found.undetermined,
    )


def _of_each(maps: _Maps, answer: Callable[[RegionMap], _Answer]) -> list[_Answer]:
    """The answers of both maps; where one contradicts itself, the error's key names it."""
    found = []
    for which, result in zip(("first", "second"), maps, strict=True):
        try:
            with blamed(which):
                found.append(answer(result))
        except (ValueError, IndexError, ArithmeticError) as error:
            reason = f"the map contradicts itself ({error}); check it with ptmcad verify"
            raise ConfigError(reason, key=which) from error
    return found


def _check(first: RegionMap, second: RegionMap) -> None:
    if (first.cover is None) != (second.cover is None):
        raise ConfigError(
            "one map is exact and the other certified: classify the exact one again with --engine certified"
        )
    for result in (first, second):
        if not result.cells or (result.cover is None and result.status is not Status.EXACT):
            raise ConfigError(f"{result.slice.name} is no complete map; only such are compared")
    for what, one, other in (
        ("axes", first.slice.axes, second.slice.axes),
        ("count", first.slice.count, second.slice.count),
    ):
        if one != other:
            raise ConfigError(
                f"the maps have not the same {what}: {_shown(one)}, and {_shown(other)}"
            )
    ours, others = first.slice.units, second.slice.units
    if any(others.get(quantity, name) != name for quantity, name in ours.items()):
        raise ConfigError("the maps have not the same units: one window is not the other")


def _shown(what: Any) -> str:
    if isinstance(what, Count):
        return str(what.value)
    return ", ".join(f"{axis.name} from {axis.low} to {axis.high}" for axis in what)


def _union(components: Sequence[Component]) -> list[Component]:
    """Each curve once."""
    return list({c.polynomial: c for c in components}.values())


def _region(result: RegionMap, at: Point) -> int:
    found = locate(result, {name: at[name] for name in at.names}).region
    if found is None or found >= len(result.regions):
        raise ConfigError(
            f"the map {result.slice.name} contradicts itself; check it with ptmcad verify"
        )
    return found


_Side = tuple[Components, dict[int, int]]
"""One of the maps: its components, and the region of each that has one."""


def _side(result: RegionMap) -> _Side:
    """A certified map made ready.

    Raises
    ------
    ConfigError
        When it contradicts itself.
    """
    complement, cells = component_cells(result)
    region_of = {place: result.cells[cell].region for place, cell in cells.items()}
    if not all(region < len(result.regions) for region in region_of.values()):
        raise ConfigError(
            "the map contradicts itself (a cell is in no region); check it with ptmcad verify"
        )
    return complement, region_of


def _overlaid(first: _Side, second: _Side) -> tuple[Components, dict[int, tuple[int, ...]]]:
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


def _cover_bounds(
    maps: Sequence[RegionMap],
    sides: Sequence[_Side],
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


def _points_in(slice: Slice, complement: Components, numbers: Iterable[int]) -> list[Point]:
    """A point of each of these components."""
    x, y = slice.axes
    window = ((x.low, x.high), (y.low, y.high))
    return [Point(slice.axis_names, *next(samples(complement, n, window))) for n in numbers]
