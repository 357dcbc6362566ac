"""From the engine's cells to the engine-neutral `RegionMap`.

Guarantee: nothing is decided here but the merging of cells; numbers are copied exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import fmpq

from ptmcad.algebra.polynomials import to_fraction
from ptmcad.answer.regionmap import (
    Adjacency,
    Cell,
    CriticalValue,
    Merge,
    NonAdjacency,
    Region,
    RegionMap,
    Segment,
    Solution,
    Stack,
    Wall,
)
from ptmcad.exact.cad.adjacency import Crossing, Separator
from ptmcad.exact.cad.projection import Projection
from ptmcad.exact.cad.stacks import StackData
from ptmcad.exact.counting import Counts, Equilibria
from ptmcad.exact.regions import Link, merge
from ptmcad.question.slice import Count, Point
from ptmcad.text.numerals import decimal, fraction_of


def assemble(
    started: RegionMap,
    projection: Projection,
    stacks: Sequence[StackData],
    points: Sequence[tuple[fmpq, fmpq]],
    found: Sequence[Equilibria],
    crossings: Sequence[Crossing],
    lines: dict[tuple[int, ...], int],
) -> RegionMap:
    """The map with cells, adjacencies and regions, whose areas are known only to lie within the window's.

    Parameters
    ----------
    started : the map with its slice and components.
    points, found : sample and equilibria of each cell, stack by stack from below.
    crossings : between neighbouring stacks.
    lines : the components that are lines across the fibre direction, by the coefficients of their polynomials.
    """
    names = started.slice.axis_names
    counts = [e.counts for e in found]
    keys = [count_key(c, started.slice.count) for c in counts]
    adjacencies = _adjacencies(stacks, crossings, projection, lines, keys)
    region_of = merge(keys, [Link(a.first, a.second, a.component) for a in adjacencies])
    samples = [Point(names, to_fraction(x), to_fraction(y)) for x, y in points]
    separating = {a.component for a in adjacencies if a.merge is Merge.SEPARATED}
    places = [(s, level) for s, stack in enumerate(stacks) for level in range(len(stack.heights))]
    first, second = started.slice.axes
    return replace(
        started,
        components=tuple(replace(c, separates=n in separating) for n, c in enumerate(started.components)),
        critical_values=tuple(
            CriticalValue(
                tuple(int(c) for c in r.polynomial.coeffs()),
                to_fraction(r.low),
                to_fraction(r.high),
                projection.origin(r.polynomial),
            )
            for r in projection.abscissae
        ),
        stacks=_stacks(stacks),
        cells=tuple(
            Cell(
                s,
                level,
                samples[n],
                region_of[n],
                counts[n].total,
                counts[n].stable,
                counts[n].index,
                _solutions(found[n]),
            )
            for n, (s, level) in enumerate(places)
        ),
        adjacencies=adjacencies,
        non_adjacencies=_non_adjacencies(stacks, crossings),
        regions=_regions(region_of, counts, samples, (first.high - first.low) * (second.high - second.low)),
        undetermined=Fraction(0),
        precision={"solutions": max(e.bits for e in found)},
    )


def with_areas(counted: RegionMap, areas: Sequence[tuple[Fraction, Fraction]], bits: int) -> RegionMap:
    """The map with the regions' areas, each bound written outwards in decimals.

    Parameters
    ----------
    bits : the precision that the areas needed.
    """
    bounds = [(fraction_of(decimal(low, up=False)), fraction_of(decimal(high, up=True))) for low, high in areas]
    return replace(
        counted,
        regions=tuple(replace(r, area=b) for r, b in zip(counted.regions, bounds, strict=True)),
        precision={**counted.precision, "areas": bits},
    )


def count_key(counts: Counts, count: Count) -> tuple[int, ...]:
    """The count by which regions are distinguished."""
    if count is Count.STABLE:
        return (counts.stable,)
    return (counts.total,) if count is Count.TOTAL else counts.index


def _adjacencies(
    stacks: Sequence[StackData],
    crossings: Sequence[Crossing],
    projection: Projection,
    vertical_components: dict[tuple[int, ...], int],
    keys: Sequence[tuple[int, ...]],
) -> tuple[Adjacency, ...]:
    found: list[Adjacency] = []

    def link(first: int, second: int, component: int | None, segment: Segment | None) -> None:
        if component is None:
            kind = Merge.PROVEN
        else:
            kind = Merge.EQUAL_COUNT if keys[first] == keys[second] else Merge.SEPARATED
        found.append(Adjacency(first, second, component, segment, kind))

    first = 0
    for s, stack in enumerate(stacks):
        for level, wall in enumerate(stack.walls):
            link(first + level, first + level + 1, wall.component, None)
        following = first + len(stack.heights)
        if s < len(crossings):
            line = tuple(int(c) for c in projection.abscissae[s].polynomial.coeffs())
            for p in crossings[s].separators:
                link(first + p.left, following + p.right, vertical_components.get(line), _segment(p))
        first = following
    return tuple(found)


def _segment(p: Separator) -> Segment:
    return (to_fraction(p.low), to_fraction(p.high), to_fraction(p.height))


def _non_adjacencies(stacks: Sequence[StackData], crossings: Sequence[Crossing]) -> tuple[NonAdjacency, ...]:
    found, first = [], 0
    for s, crossing in enumerate(crossings):
        following = first + len(stacks[s].heights)
        found += [
            NonAdjacency(
                critical_value=s,
                left=tuple(range(first + gap.left[0], first + gap.left[1] + 1)),
                right=tuple(range(following + gap.right[0], following + gap.right[1] + 1)),
                below=None if gap.below is None else _segment(gap.below),
                above=None if gap.above is None else _segment(gap.above),
                reason=gap.reason,
            )
            for gap in crossing.gaps
        ]
        first = following
    return tuple(found)


def _solutions(found: Equilibria) -> tuple[Solution, ...]:
    return tuple(
        Solution(
            tuple(to_fraction(x) for x in s.center),
            to_fraction(s.radius),
            "+" * (len(s.center) // 2 - s.negative) + "-" * s.negative,
        )
        for s in found.solutions
    )


def _stacks(stacks: Sequence[StackData]) -> tuple[Stack, ...]:
    result, first = [], 0
    for stack in stacks:
        cells = tuple(range(first, first + len(stack.heights)))
        walls = tuple(Wall(w.component, w.root) for w in stack.walls)
        result.append(Stack(stack.left.critical, stack.right.critical, to_fraction(stack.sample), walls, cells))
        first += len(cells)
    return tuple(result)


def _regions(
    region_of: Sequence[int],
    counts: Sequence[Counts],
    samples: Sequence[Point],
    whole: Fraction,
) -> tuple[Region, ...]:
    regions = []
    cells_of: list[list[int]] = [[] for _ in range(1 + max(region_of))]
    for n, number in enumerate(region_of):
        cells_of[number].append(n)
    for cells in map(tuple, cells_of):
        members = [counts[n] for n in cells]

        def common(values: list[Any]) -> Any:
            return values[0] if all(v == values[0] for v in values) else None

        regions.append(
            Region(
                stable=common([c.stable for c in members]),
                total=common([c.total for c in members]),
                index=common([c.index for c in members]),
                area=(Fraction(0), whole),
                cells=cells,
                sample=min((samples[n] for n in cells), key=_height),
            )
        )
    return tuple(regions)


def _height(point: Point) -> tuple[int, ...]:
    x, y = point[0], point[1]
    return (max(abs(x.numerator), x.denominator, abs(y.numerator), y.denominator), x.denominator, y.denominator)
