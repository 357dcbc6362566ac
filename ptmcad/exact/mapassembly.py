"""From what the engine's stages have found to the engine-neutral `RegionMap`, made anew after the
variety, the counts and the areas, of as much as there is.

Guarantee: no number is computed here; numbers are copied exactly.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import flint

from ptmcad.answer.counts import Counts
from ptmcad.answer.plan import half_step
from ptmcad.answer.regionmap import (
    Cell,
    CriticalValue,
    Merge,
    NonAdjacency,
    Region,
    RegionMap,
    Stack,
    Status,
)
from ptmcad.exact.cad.crossings import Crossing
from ptmcad.exact.cad.decomposition import Decomposition, Variety, members, segment_of
from ptmcad.exact.cad.projection import Projection
from ptmcad.exact.exactplan import plan_of
from ptmcad.exact.models.modelsystem import system_text
from ptmcad.exact.stages import Areas, Cells, SliceProblem
from ptmcad.options import Options
from ptmcad.question.slice import Point
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.version import __version__


class PartialMap(NamedTuple):
    """What the stages have found so far, from which any map is made; None is not there yet."""

    variety: Variety
    cells: Cells | None = None
    areas: Areas | None = None


def assemble(
    problem: SliceProblem,
    options: Options,
    reached: PartialMap,
    status: Status = Status.PARTIAL,
    timings: Mapping[str, float] | None = None,
) -> RegionMap:
    """The map of what was reached; areas that are not known lie within the window's."""
    variety, cells, areas = reached.variety, reached.cells, reached.areas
    adjacencies = () if cells is None else cells.neighbours.adjacencies
    separating = {a.component for a in adjacencies if a.merge is Merge.SEPARATED}
    precision: dict[str, int] = {}
    if cells is not None:
        precision["solutions"] = max(e.bits for e in cells.counts.found)
    if areas is not None:
        precision["areas"] = areas.bits
    samples = () if cells is None else cells.cut.samples(problem.slice.axis_names)
    return RegionMap(
        slice=problem.slice,
        status=status,
        system=system_text(problem.system),
        base=variety.base,
        complex_solutions=variety.complex_solutions,
        components=variety.components
        if cells is None
        else tuple(c._replace(separates=n in separating) for n, c in enumerate(variety.components)),
        critical_values=() if cells is None else critical_values_of(cells.cut.projection),
        stacks=() if cells is None else stacks_of_cells(cells.cut),
        cells=() if cells is None else tuple(_cells(problem, cells, samples)),
        adjacencies=adjacencies,
        non_adjacencies=()
        if cells is None
        else _non_adjacencies(cells.cut, cells.neighbours.crossings),
        regions=() if cells is None else _regions(problem, cells, samples, areas),
        plan=(
            *plan_of(
                problem.slice,
                variety.components,
                variety.base,
                variety.costs,
                options.without,
                options.areas,
            ),
            *half_step("areas on", None if areas is None else areas.change, problem.slice),
        ),
        undetermined=Fraction(1 if cells is None else 0),
        versions=versions(),
        precision=precision,
        timings=timings or {},
    )


def versions() -> dict[str, str]:
    """Of what a result rests on."""
    return {
        "ptmcad": __version__,
        "python": ".".join(map(str, sys.version_info[:2])),
        "python-flint": flint.__version__,
        "flint": flint.__FLINT_VERSION__,
    }


def critical_values_of(projection: Projection) -> tuple[CriticalValue, ...]:
    return tuple(
        CriticalValue(
            tuple(int(c) for c in r.polynomial.coeffs()),
            to_fraction(r.low),
            to_fraction(r.high),
            projection.origin(r.polynomial),
        )
        for r in projection.abscissae
    )


def _further(problem: SliceProblem, key: tuple[int, ...]) -> dict[str, int]:
    """Where a count is by a predicate, how many solutions this holds at, from what tells regions
    apart.
    """
    count = problem.slice.count
    return {} if count.kind.predicate is None else {count.value: key[0]}


def _cells(problem: SliceProblem, cells: Cells, samples: Sequence[Point]) -> Iterator[Cell]:
    for (s, level), sample, region, found, key in zip(
        cells.cut.places,
        samples,
        cells.neighbours.region_of,
        cells.counts.found,
        cells.counts.keys,
        strict=True,
    ):
        counts = found.counts
        further = _further(problem, key)
        yield Cell(
            s,
            level,
            sample,
            region,
            counts.total,
            counts.stable,
            counts.index,
            found.solutions,
            further,
        )


def _non_adjacencies(cut: Decomposition, crossings: Sequence[Crossing]) -> tuple[NonAdjacency, ...]:
    found = []
    firsts = cut.first_cells
    for s, crossing in enumerate(crossings):
        for gap in crossing.gaps:
            # `cross` ends only when it knows the reason of every gap
            assert gap.reason is not None
            found.append(
                NonAdjacency(
                    critical_value=s,
                    left=_cells_between(firsts[s], gap.left),
                    right=_cells_between(firsts[s + 1], gap.right),
                    below=None if gap.below is None else segment_of(gap.below),
                    above=None if gap.above is None else segment_of(gap.above),
                    reason=gap.reason,
                )
            )
    return tuple(found)


def _cells_between(first: int, levels: tuple[int, int]) -> tuple[int, ...]:
    """The cells from one level of a stack to another, both included."""
    return tuple(range(first + levels[0], first + levels[1] + 1))


def stacks_of_cells(cut: Decomposition) -> tuple[Stack, ...]:
    return tuple(
        Stack(
            stack.left.critical,
            stack.right.critical,
            to_fraction(stack.sample),
            stack.walls,
            tuple(range(first, following)),
        )
        for stack, (first, following) in zip(cut.stacks, pairwise(cut.first_cells), strict=True)
    )


def _regions(
    problem: SliceProblem, cells: Cells, samples: Sequence[Point], areas: Areas | None
) -> tuple[Region, ...]:
    """The cells merged, in the order of the regions' numbers."""
    merged = members(cells.neighbours.region_of)
    bounds = ((Fraction(0), problem.slice.area),) * len(merged) if areas is None else areas.bounds
    return tuple(
        replace(
            _region(numbers, [cells.counts.found[n].counts for n in numbers], samples, area),
            further=_further(problem, cells.counts.keys[numbers[0]]),
        )
        for numbers, area in zip(merged, bounds, strict=True)
    )


def _region(
    cells: tuple[int, ...],
    counts: Sequence[Counts],
    samples: Sequence[Point],
    area: tuple[Fraction, Fraction],
) -> Region:
    def common(values: list[Any]) -> Any:
        return values[0] if all(v == values[0] for v in values) else None

    return Region(
        stable=common([c.stable for c in counts]),
        total=common([c.total for c in counts]),
        index=common([c.index for c in counts]),
        area=area,
        cells=cells,
        sample=min((samples[n] for n in cells), key=_simplicity),
    )


def _simplicity(point: Point) -> tuple[int, ...]:
    x, y = point[0], point[1]
    return (
        max(abs(x.numerator), x.denominator, abs(y.numerator), y.denominator),
        x.denominator,
        y.denominator,
    )
