"""Where two maps of the same window differ.

Guarantee: exact. The window is cut along the curves of both maps into cells in which neither count
changes; each cell's counts are those of both maps at its sample, and areas are integrated as a
map's own. Certified maps have no curves: see `ptmcad.ask.coverdifference`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from typing import Any

from ptmcad.answer.comparison import Change, Comparison
from ptmcad.answer.counts import counted_by
from ptmcad.answer.regionmap import HARMLESS, Cell, Component, Region, RegionMap, Status
from ptmcad.ask.location import locate
from ptmcad.cover.rectangles import Cover
from ptmcad.errors import A_MAP, ConfigError, expect
from ptmcad.exact.areas.area import region_areas
from ptmcad.exact.areas.regionareas import region_stacks
from ptmcad.exact.cad.decomposition import Decomposition, cut_along, members, seen_from
from ptmcad.exact.mapassembly import critical_values_of, stacks_of_cells
from ptmcad.question.counts import Count
from ptmcad.question.slice import Point
from ptmcad.text.flint_numbers import interval_of

TOLERANCE = Fraction(1, 10**6)
"""Relative width of the areas' bounds."""


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
    if first.cover is not None and second.cover is not None:
        return _certified(first, first.cover, second, second.cover)
    components = _union([c for m in (first, second) for c in m.components if c.separates])
    # at a sample both maps have to say what they count there
    others = [
        replace(c, left_out=HARMLESS)
        for m in (first, second)
        for c in m.components
        if not c.separates
    ]
    x, y = map(interval_of, first.slice.axes)
    cut = cut_along((x, y), seen_from([*components, *_union(others)]))
    points, count = cut.samples(first.slice.axis_names), first.slice.count
    with _asked("first"):
        befores = [_region(first, at) for at in points]
        olds = [counted_by(first.regions[a], count) for a in befores]
    with _asked("second"):
        afters = [_region(second, at) for at in points]
        news = [counted_by(second.regions[b], count) for b in afters]
    pairs = list(zip(befores, afters, strict=True))
    keys = list(zip(olds, news, strict=True))
    numbers = {key: n for n, key in enumerate(dict.fromkeys(keys))}
    of_cell = [numbers[key] for key in keys]
    bounds, _ = region_areas(region_stacks(cut, of_cell), tolerance)
    changes = []
    for key, number in numbers.items():
        before, after = pairs[of_cell.index(number)]
        if key[0] != key[1]:
            changes.append(Change(before, after, number, bounds[number]))
    decomposition = _as_map(first, components, cut, points, (of_cell, bounds))
    return Comparison(
        first, second, decomposition, tuple(sorted(changes, key=lambda c: -c.area[0]))
    )


def _certified(first: RegionMap, one: Cover, second: RegionMap, other: Cover) -> Comparison:
    from ptmcad.ask.coverdifference import cover_difference, side  # brings numpy

    with _asked("first"):
        before = side(first, one)
    with _asked("second"):
        after = side(second, other)
    return cover_difference(before, after)


@contextmanager
def _asked(which: str) -> Iterator[None]:
    """What is asked of one of the maps: where it contradicts itself, the error's key says of which."""
    try:
        yield
    except ConfigError as error:
        raise ConfigError(error.message, key=which) from error
    except (ValueError, IndexError, ArithmeticError) as error:
        reason = f"the map contradicts itself ({error}); check it with ptmcad verify"
        raise ConfigError(reason, key=which) from error


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
    if found is None:
        raise ConfigError(
            f"the map {result.slice.name} contradicts itself; check it with ptmcad verify"
        )
    return found


def _as_map(
    first: RegionMap,
    components: Sequence[Component],
    cut: Decomposition,
    points: Sequence[Point],
    found: tuple[Sequence[int], Sequence[tuple[Fraction, Fraction]]],
) -> RegionMap:
    """The decomposition in the form that pictures read."""
    of_cell, bounds = found
    cells = tuple(
        Cell(s, level, at, region, None, None, None)
        for (s, level), at, region in zip(cut.places, points, of_cell, strict=True)
    )
    return replace(
        first,
        base=cut.variety.base,
        components=tuple(components),
        critical_values=critical_values_of(cut.projection),
        stacks=stacks_of_cells(cut),
        cells=cells,
        adjacencies=(),
        non_adjacencies=(),
        regions=tuple(
            Region(None, None, None, area, numbers, points[numbers[0]])
            for area, numbers in zip(bounds, members(of_cell), strict=True)
        ),
        plan=(),
    )
