"""Where two maps of the same window differ.

Guarantee: exact. The window is cut along the curves of both maps into cells in which neither count changes; each cell's
counts are those of both maps at its sample, and areas are integrated as a map's own. Certified maps have no curves: see
`ptmcad.ask.coverdifference`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from flint import fmpq

from ptmcad.algebra.real_roots import Interval
from ptmcad.answer.comparison import Change, Comparison
from ptmcad.answer.counts import counted_by
from ptmcad.answer.regionmap import Cell, Component, Region, RegionMap, Status
from ptmcad.ask.location import locate
from ptmcad.cover.rectangles import Cover
from ptmcad.errors import A_MAP, ConfigError, expect
from ptmcad.exact.assembly import critical_values_of, stacks_of_cells
from ptmcad.exact.cad.area import RegionStacks, region_areas
from ptmcad.exact.cad.curves import curves_of, lines_of
from ptmcad.exact.cad.projection import Projection, predicted_cost, project
from ptmcad.exact.cad.stacks import Avoided, StackData, lift
from ptmcad.question.counts import Count
from ptmcad.question.slice import Point
from ptmcad.text.flint_numbers import from_fraction, to_fraction

TOLERANCE = Fraction(1, 10**6)
"""Relative width of the areas' bounds."""


@dataclass(frozen=True, slots=True)
class _Cut:
    """The window cut along some curves."""

    base: int
    projection: Projection
    stacks: Sequence[StackData]


def compare(first: RegionMap, second: RegionMap, tolerance: Fraction = TOLERANCE) -> Comparison:
    """The difference of two maps with the same axes, window and count, both exact or both certified.

    Raises
    ------
    ConfigError
        When they are not such maps; where one of them contradicts itself, the error's key is ``first`` or ``second``.
    """
    expect(second, RegionMap, "other", A_MAP)
    _check(first, second)
    if first.cover is not None and second.cover is not None:
        return _certified(first, first.cover, second, second.cover)
    components = _union([c for m in (first, second) for c in m.components if c.separates])
    others = _union([replace(c, left_out="") for m in (first, second) for c in m.components if not c.separates])
    x, y = ((from_fraction(a.low), from_fraction(a.high)) for a in first.slice.axes)
    cut = _cut(components, others, (x, y))
    points, count = _points(first, cut), first.slice.count
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
    rest = iter(of_cell)
    rows = [tuple(next(rest) for _ in stack.heights) for stack in cut.stacks]
    window = (x, y)
    parts = RegionStacks(cut.stacks, rows, curves_of(components, cut.base), window[cut.base], window[1 - cut.base])
    bounds, _ = region_areas(parts, tolerance)
    changes = []
    for key, number in numbers.items():
        before, after = pairs[of_cell.index(number)]
        if key[0] != key[1]:
            changes.append(Change(before, after, number, bounds[number]))
    decomposition = _as_map(first, components, cut, points, (of_cell, bounds))
    return Comparison(first, second, decomposition, tuple(sorted(changes, key=lambda c: -c.area[0])))


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
            raise ConfigError(f"the maps have not the same {what}: {_shown(one)}, and {_shown(other)}")
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


def _cut(components: Sequence[Component], others: Sequence[Component], window: tuple[Interval, Interval]) -> _Cut:
    costs = [predicted_cost(curves_of(components, base)) for base in (0, 1)]
    base = 1 if costs[1] < costs[0] else 0
    curves, lines = curves_of(components, base), list(lines_of(components, base).values())
    projection = project(curves, lines, window[base], window[1 - base])
    # at a sample both maps have to say what they count there
    avoided = Avoided(curves_of(others, base), list(lines_of(others, base).values()))
    return _Cut(base, projection, lift(curves, projection.abscissae, window[base], window[1 - base], avoided))


def _points(result: RegionMap, cut: _Cut) -> list[Point]:
    def point(u: fmpq, v: fmpq) -> Point:
        x, y = (to_fraction(u), to_fraction(v))[:: -1 if cut.base else 1]
        return Point(result.slice.axis_names, x, y)

    return [point(stack.sample, height) for stack in cut.stacks for height in stack.heights]


def _region(result: RegionMap, at: Point) -> int:
    found = locate(result, {name: at[name] for name in at.names}).region
    if found is None:
        raise ConfigError(f"the map {result.slice.name} contradicts itself; check it with ptmcad verify")
    return found


def _as_map(
    first: RegionMap,
    components: Sequence[Component],
    cut: _Cut,
    points: Sequence[Point],
    found: tuple[Sequence[int], Sequence[tuple[Fraction, Fraction]]],
) -> RegionMap:
    """The decomposition in the form that pictures read."""
    of_cell, bounds = found
    places = [(s, level) for s, stack in enumerate(cut.stacks) for level in range(len(stack.heights))]
    cells = tuple(
        Cell(s, level, at, region, None, None, None)
        for (s, level), at, region in zip(places, points, of_cell, strict=True)
    )
    members = [tuple(n for n, other in enumerate(of_cell) if other == region) for region in range(len(bounds))]
    return replace(
        first,
        base=cut.base,
        components=tuple(components),
        critical_values=critical_values_of(cut.projection),
        stacks=stacks_of_cells(cut.stacks),
        cells=cells,
        adjacencies=(),
        non_adjacencies=(),
        regions=tuple(
            Region(None, None, None, area, numbers, points[numbers[0]])
            for area, numbers in zip(bounds, members, strict=True)
        ),
        plan=(),
    )
