"""Whether the numbers by which the parts of a map refer to each other lead anywhere.

Guarantee: after `check_numbers` every reference of a map has its target, and its samples are in the window. Whether the
map is true is `ptmcad.verify`'s question.
"""

from __future__ import annotations

from collections.abc import Iterable

from ptmcad.errors import ConfigError
from ptmcad.regionmap import RegionMap

MOST = 1000
"""Equilibria that a fill can tell; no mechanism of two angles and three springs has so many."""


def check_numbers(result: RegionMap) -> None:
    """Check the references among stacks, cells, regions, components and critical values.

    Raises
    ------
    ConfigError
        With the first reference that leads nowhere.
    """
    base = result.base
    for s, stack in enumerate(result.stacks):
        _within(stack.cells, len(result.cells), f"stack {s}", "cell")
        _within((w.component for w in stack.walls), len(result.components), f"stack {s}", "component")
        ends = [end for end in (stack.left, stack.right) if end is not None]
        _within(ends, len(result.critical_values), f"stack {s}", "critical value")
        if len(stack.cells) != len(stack.walls) + 1:
            raise _fault(f"stack {s} has {len(stack.cells)} cells and {len(stack.walls)} walls")
        for wall in stack.walls:
            component = result.components[wall.component]
            if component.left_out or component.polynomial.degrees[1 - base] == 0:
                raise _fault(f"stack {s} has a wall on component {wall.component}, which has no graph there")
        for level, number in enumerate(stack.cells):
            if (result.cells[number].stack, result.cells[number].level) != (s, level):
                raise _fault(f"cell {number} is not at level {level} of stack {s}")
    if sum(len(stack.cells) for stack in result.stacks) != len(result.cells):
        raise _fault("not every cell is in one stack")
    for n, cell in enumerate(result.cells):
        _within((cell.region,), len(result.regions), f"cell {n}", "region")
        if not all(axis.low < value < axis.high for axis, value in zip(result.slice.axes, cell.sample, strict=True)):
            raise _fault(f"the sample of cell {n} is not in the window")
    for n, region in enumerate(result.regions):
        most = max((count for count in (region.stable, region.total, *(region.index or ())) if count), default=0)
        if region.area[0] > region.area[1]:
            raise _fault(f"region {n} has an area below its own lower bound")
        if most > MOST:
            raise _fault(f"region {n} counts {most} equilibria, more than {MOST}")
        _within(region.cells, len(result.cells), f"region {n}", "cell")
    for n, value in enumerate(result.critical_values):
        if len(value.polynomial) < 2 or not value.polynomial[-1] or value.low > value.high:
            raise _fault(f"critical value {n} is no root in an interval")


def _within(numbers: Iterable[int], length: int, place: str, what: str) -> None:
    for number in numbers:
        if not 0 <= number < length:
            raise _fault(f"{place} names {what} {number}, which is not there")


def _fault(problem: str) -> ConfigError:
    return ConfigError(f"the map contradicts itself: {problem}; check it with ptmcad verify")
