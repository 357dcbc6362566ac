"""Whether the numbers by which the parts of a map refer to each other lead anywhere.

Guarantee: after `check_numbers` every reference of a map has its target, and its samples are in the
window. Whether the map is true is `ptmcad.verify`'s question.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

from ptmcad.answer.regionmap import Cell, Region, RegionMap
from ptmcad.errors import ConfigError
from ptmcad.question.slice import check_names

MAX_EQUILIBRIA = 1000
"""Equilibria that a fill can tell; no mechanism of two angles and three springs has so many."""


def check_numbers(result: RegionMap) -> None:
    """Check the references among stacks, cells, regions, components and critical values.

    Raises
    ------
    ConfigError
        With the first reference that leads nowhere.
    """
    try:
        check_names(result.slice.model, result.slice.parameters)
    except ValueError as error:
        raise contradiction(str(error)) from error
    # each is looked at only when nothing was wrong before
    for problem in chain(_of_stacks(result), _of_cells(result), _of_regions(result)):
        raise contradiction(problem)


def _of_stacks(result: RegionMap) -> Iterator[str]:
    for s, stack in enumerate(result.stacks):
        yield from _outside(stack.cells, len(result.cells), f"stack {s}", "cell")
        yield from _outside(
            (w.component for w in stack.walls), len(result.components), f"stack {s}", "component"
        )
        ends = [end for end in (stack.left, stack.right) if end is not None]
        yield from _outside(ends, len(result.critical_values), f"stack {s}", "critical value")
        if len(stack.cells) != len(stack.walls) + 1:
            yield f"stack {s} has {len(stack.cells)} cells and {len(stack.walls)} walls"
        for wall in stack.walls:
            component = result.components[wall.component]
            if component.left_out or component.polynomial.degrees[1 - result.base] == 0:
                yield f"stack {s} has a wall on component {wall.component}, which has no graph there"
        for level, number in enumerate(stack.cells):
            if (result.cells[number].stack, result.cells[number].level) != (s, level):
                yield f"cell {number} is not at level {level} of stack {s}"
    if result.cover is not None:
        if (
            result.stacks
            or result.components
            or any(cell.stack is not None for cell in result.cells)
        ):
            yield "it has a cover, as certified maps have, and stacks or curves, as exact ones"
    elif sum(len(stack.cells) for stack in result.stacks) != len(result.cells):
        yield "not every cell is in one stack"


def _of_cells(result: RegionMap) -> Iterator[str]:
    for n, cell in enumerate(result.cells):
        yield from _outside((cell.region,), len(result.regions), f"cell {n}", "region")
        yield from _of_counts(cell, f"cell {n}")
        # where only stable equilibria are counted, a certified map has no boxes of the others
        expected = (
            (cell.total, cell.stable)
            if result.cover is not None and cell.total is None
            else (cell.total,)
        )
        if cell.solutions and len(cell.solutions) not in expected:
            yield f"cell {n} has {cell.total} equilibria and {len(cell.solutions)} boxes"
        region = result.regions[cell.region]
        if n not in region.cells:
            yield f"cell {n} is in region {cell.region}, which does not have it"
        for count in result.slice.count.kind.implied:
            if cell.number(count) != region.number(count):
                yield f"cell {n} and its region {cell.region} differ in their counts"
        if not all(
            axis.holds(value) for axis, value in zip(result.slice.axes, cell.sample, strict=True)
        ):
            yield f"the sample of cell {n} is not in the window"


def _of_regions(result: RegionMap) -> Iterator[str]:
    for n, region in enumerate(result.regions):
        numbers = (region.stable, region.total, *region.further.values(), *(region.index or ()))
        most = max((n for n in numbers if n), default=0)
        if region.area[0] > region.area[1]:
            yield f"region {n} has an area below its own lower bound"
        if most > MAX_EQUILIBRIA:
            yield f"region {n} counts {most} equilibria, more than {MAX_EQUILIBRIA}"
        yield from _outside(region.cells, len(result.cells), f"region {n}", "cell")
        yield from _of_counts(region, f"region {n}")
        if not region.cells:
            yield f"region {n} has no cells"
        if any(result.cells[number].region != n for number in region.cells):
            yield f"region {n} has a cell that is in another one"
    for n, value in enumerate(result.critical_values):
        if len(value.polynomial) < 2 or not value.polynomial[-1] or value.low > value.high:
            yield f"critical value {n} is no root in an interval"


def _of_counts(part: Cell | Region, place: str) -> Iterator[str]:
    """The Morse index has to add up to the other counts, as far as these are known."""
    if part.index is not None and (part.total, part.stable) != (
        sum(part.index),
        next(iter(part.index), None),
    ):
        yield f"{place} has index {part.index}, {part.total} equilibria and {part.stable} stable ones"


def _outside(numbers: Iterable[int], length: int, place: str, what: str) -> Iterator[str]:
    return (f"{place} names {what} {n}, which is not there" for n in numbers if not 0 <= n < length)


def contradiction(problem: str) -> ConfigError:
    """The error of a map whose parts contradict each other."""
    return ConfigError(f"the map contradicts itself: {problem}; check it with ptmcad verify")
