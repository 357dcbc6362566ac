"""What every region map must satisfy, whatever the slice: checked from the stored map alone, with
exact numbers.
"""

from __future__ import annotations

from collections import defaultdict
from fractions import Fraction

from ptmcad import Count, RegionMap
from ptmcad.answer.regionmap import Cell, Merge, Status
from ptmcad.text.plane import PlanePolynomial


def key(cell: Cell, count: Count) -> object:
    return {Count.STABLE: cell.stable, Count.TOTAL: cell.total, Count.INDEX: cell.index}[count]


def check_structure(result: RegionMap) -> None:
    """Raise AssertionError when the map contradicts itself."""
    x, y = result.slice.axes
    assert result.status is Status.EXACT
    assert result.undetermined == 0
    cells = range(len(result.cells))
    _check_stacks(result)

    for cell in result.cells:
        assert cell.index is not None
        minima, saddles, maxima = cell.index
        assert minima - saddles + maxima == 0, "the Euler sum"
        assert (cell.total, cell.stable) == (minima + saddles + maxima, minima)
        assert (cell.total, cell.stable) in ((4, 1), (6, 1), (6, 2)), "theorem 1"

    # every cell belongs to exactly one region, which knows it
    members = [n for region in result.regions for n in region.cells]
    assert sorted(members) == list(cells)
    for number, region in enumerate(result.regions):
        assert {result.cells[n].region for n in region.cells} == {number}
        for name in ("stable", "total", "index"):
            values = {getattr(result.cells[n], name) for n in region.cells}
            assert getattr(region, name) == (values.pop() if len(values) == 1 else None)
        assert region.sample in [result.cells[n].sample for n in region.cells]
        assert result.locate(**region.sample).region == number

    # links: valid, once each, equal counts where the arc is off the variety, and signs as the
    # component says
    pairs = [(a.first, a.second) for a in result.adjacencies]
    assert all(a != b and a in cells and b in cells for a, b in pairs)
    assert len({frozenset(p) for p in pairs}) == len(pairs)
    joined: dict[int, set[int]] = defaultdict(set)
    separating = set()
    for a in result.adjacencies:
        first, second = result.cells[a.first], result.cells[a.second]
        equal = key(first, result.slice.count) == key(second, result.slice.count)
        assert equal == (first.region == second.region), (
            "a separating wall, or a merge that was missed"
        )
        assert a.merge is (
            Merge.PROVEN if a.component is None else Merge.EQUAL_COUNT if equal else Merge.SEPARATED
        )
        if a.component is None:
            assert first.index == second.index
        else:
            polynomial = result.components[a.component].polynomial
            assert not result.components[a.component].left_out
            assert polynomial(*first.sample) != 0 != polynomial(*second.sample)
        if equal:
            joined[a.first].add(a.second)
            joined[a.second].add(a.first)
        else:
            separating.add(a.component)
        _check_segment(result, a)
    assert {n for n, c in enumerate(result.components) if c.separates} == separating

    # regions are connected
    for region in result.regions:
        reached, frontier = {region.cells[0]}, [region.cells[0]]
        while frontier:
            for n in joined[frontier.pop()]:
                if n not in reached:
                    reached.add(n)
                    frontier.append(n)
        assert reached == set(region.cells)

    # areas
    window = (x.high - x.low) * (y.high - y.low)
    rounded_up = window * (1 + Fraction(1, 10**17))  # bounds are decimals of 18 digits
    assert all(0 <= region.area[0] <= region.area[1] <= rounded_up for region in result.regions)
    assert all(region.area[1] > 0 for region in result.regions)
    low, high = (sum(region.area[i] for region in result.regions) for i in (0, 1))
    assert low <= window <= high

    # samples lie in their cells
    for n in cells:
        found = result.locate(**result.cells[n].sample)
        assert (found.cell, found.region) == (n, result.cells[n].region)


def _check_stacks(result: RegionMap) -> None:
    number = 0
    axis = result.slice.axes[result.base]
    previous = axis.low
    for s, stack in enumerate(result.stacks):
        assert stack.left == (s - 1 if s else None)
        assert stack.right == (s if s < len(result.stacks) - 1 else None)
        assert len(stack.cells) == len(stack.walls) + 1
        assert stack.cells == tuple(range(number, number + len(stack.cells)))
        heights = [result.cells[n].sample[1 - result.base] for n in stack.cells]
        assert heights == sorted(set(heights))
        for level, n in enumerate(stack.cells):
            cell = result.cells[n]
            assert (cell.stack, cell.level) == (s, level)
            assert cell.sample[result.base] == stack.sample
            assert all(
                a.low < v < a.high for a, v in zip(result.slice.axes, cell.sample, strict=True)
            )
        number += len(stack.cells)
        high = result.critical_values[s].low if s < len(result.critical_values) else axis.high
        assert previous < stack.sample < high
        previous = result.critical_values[s].high if s < len(result.critical_values) else axis.high
    assert number == len(result.cells)
    assert len(result.critical_values) == len(result.stacks) - 1
    for value in result.critical_values:
        p = PlanePolynomial(tuple((i, 0, c) for i, c in enumerate(value.polynomial)))
        ends = p(value.low, Fraction(0)), p(value.high, Fraction(0))
        assert ends == (0, 0) if value.low == value.high else ends[0] * ends[1] < 0


def _check_segment(result: RegionMap, a) -> None:  # type: ignore[no-untyped-def]
    """Ends of a witness lie in its two cells; cells of one stack are neighbours and have none."""
    first, second = result.cells[a.first], result.cells[a.second]
    if a.segment is None:
        assert (second.stack, second.level) == (first.stack, first.level + 1)
        assert result.stacks[first.stack].walls[first.level].component == a.component
        return
    assert second.stack == first.stack + 1
    low, high, height = a.segment
    assert low < high
    names = result.slice.axis_names
    for cell, u in ((a.first, low), (a.second, high)):
        at = {names[result.base]: u, names[1 - result.base]: height}
        assert result.locate(**at).cell == cell
