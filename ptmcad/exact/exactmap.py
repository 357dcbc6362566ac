"""The exact engine: from a slice without free lengths to its region map, the stages in order, each
timed.

| stage      | function                         | result                                  |
|------------|----------------------------------|-----------------------------------------|
|            | `stages.problem_of`              | `SliceProblem`                          |
| variety    | `stages.variety_of`              | `decomposition.Variety`                 |
| projection | `decomposition.projection_of`    | `cad.projection.Projection`             |
| stacks     | `decomposition.stacks_of`        | `Decomposition`                         |
| counts     | `stages.counts_of`               | `SampleCounts`                          |
| adjacency  | `decomposition.crossings_of`     | a `cad.crossings.Crossing` per abscissa |
|            | `decomposition.neighbours_of`    | `Neighbours`, regions included          |
| areas      | `regionareas.areas_of`           | `stages.Areas`                          |
|            | `mapassembly.assemble`           | `answer.regionmap.RegionMap`            |

With `Options.sparing` adjacency comes before counts, and `stages.counts_of_parts` makes these.

Guarantee: the map is exact (`Status.EXACT`): no step decides anything by rounding without an error
bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from time import perf_counter

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.errors import LimitReached
from ptmcad.exact.areas.regionareas import areas_of
from ptmcad.exact.cad.crossings import Crossing
from ptmcad.exact.cad.decomposition import (
    crossings_of,
    joined_cells,
    neighbours_of,
    projection_of,
    stacks_of,
)
from ptmcad.exact.discriminant_variety import Known
from ptmcad.exact.mapassembly import PartialMap, assemble
from ptmcad.exact.stages import (
    Cells,
    SliceProblem,
    counts_of,
    counts_of_parts,
    problem_without_free_lengths,
    variety_of,
)
from ptmcad.options import DEFAULTS, Options
from ptmcad.question.slice import Slice

AREA_TOLERANCE = Fraction(1, 10_000)


class _Clock:
    """Stage times, the deadline, and the caller's progress report.

    The limit is checked where a stage begins and within it, never at its end: what is finished
    counts.
    """

    def __init__(self, options: Options) -> None:
        self.options = options
        self.started = self.last = perf_counter()
        self.seconds: dict[str, float] = {}

    def check(self) -> None:
        if self.options.deadline is not None and perf_counter() > self.options.deadline:
            raise LimitReached("the time limit was reached before the region map was complete")

    def report(self, stage: str, done: int = 0, total: int = 1) -> None:
        self.check()
        if self.options.progress is not None:
            self.options.progress(stage, done, total)

    def stage(self, name: str) -> None:
        """The end of a stage, and the beginning of the next one."""
        now = perf_counter()
        self.seconds[name] = now - self.last
        self.last = now

    def resume(self) -> None:
        """The beginning of a stage after a pause, in which the caller had the map so far."""
        self.last = perf_counter()

    def times(self) -> dict[str, float]:
        """The seconds of each stage, and of all with the pauses."""
        return {**self.seconds, "total": perf_counter() - self.started}


def exact_map(slice: Slice, options: Options = DEFAULTS, known: Known | None = None) -> RegionMap:
    """The region map of a slice without free lengths.

    Parameters
    ----------
    options : of which ``deadline`` counts, not ``timeout``.
    known : what is known of the equations from a family that the slice is of; the map does not
        depend on it.

    Raises
    ------
    ConfigError
        When springs have a free length.
    HypothesisError
        When the slice is degenerate, has infinitely many equilibria, or leaves the domain of the
        geometry.
    LimitReached
        At the deadline, with what there is of the map as ``partial``.
    """
    clock = _Clock(options)
    problem = problem_without_free_lengths(slice, "an exact map is")._replace(known=known)
    reached: PartialMap | None = None
    try:
        for reached in _stages(problem, options, clock):
            if options.partial is not None and reached.areas is None:
                options.partial(assemble(problem, options, reached))
    except LimitReached as stop:
        raise LimitReached(
            str(stop), partial=None if reached is None else assemble(problem, options, reached)
        ) from stop
    assert reached is not None
    result = assemble(problem, options, reached, Status.EXACT, clock.times())
    if options.partial is not None:
        options.partial(result)
    return result


def _stages(problem: SliceProblem, options: Options, clock: _Clock) -> Iterator[PartialMap]:
    """What there is after the variety, after the counts, and with areas if they are asked for."""
    without = options.without
    clock.report("variety")
    variety = variety_of(problem, without)
    clock.stage("variety")
    yield PartialMap(variety)
    clock.resume()
    clock.report("projection")
    projection = projection_of(problem.window, variety, without, clock.check)
    clock.stage("projection")
    clock.report("stacks")
    cut = stacks_of(problem.window, variety, projection)
    clock.stage("stacks")
    crossings: tuple[Crossing, ...] = ()
    for stage in ("adjacency", "counts") if options.sparing else ("counts", "adjacency"):
        report = partial(clock.report, stage)
        if stage == "adjacency":
            crossings = crossings_of(cut, report, clock.check)
        elif options.sparing:
            counts = counts_of_parts(problem, cut, joined_cells(cut, crossings), report)
        else:
            counts = counts_of(problem, cut, report)
        clock.stage(stage)
    cells = Cells(cut, counts, neighbours_of(cut, counts.keys, crossings))
    yield PartialMap(cut.variety, cells)
    clock.resume()
    if options.areas:
        clock.report("areas")
        tolerance = options.area_tolerance or AREA_TOLERANCE
        areas = areas_of(problem, cells, tolerance, without, clock.check)
        clock.stage("areas")
        yield PartialMap(cut.variety, cells, areas)
