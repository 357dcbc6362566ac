"""From a slice to its region map: the stages in order, each timed.

Guarantee: the map is exact (`Status.EXACT`): no step decides anything by rounding without an error bound.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from time import perf_counter
from typing import Any

import flint
from flint import fmpq

from ptmcad.algebra.polynomials import (
    Coefficient,
    Ratio,
    UnivariatePolynomial,
    coefficients_in,
    evaluate,
    from_expression,
    from_fraction,
    from_plane,
    to_fraction,
)
from ptmcad.algebra.real_roots import simplest_between
from ptmcad.cad.adjacency import Passage, passages
from ptmcad.cad.area import region_areas
from ptmcad.cad.curves import Curve, curve
from ptmcad.cad.projection import Projection, predicted_cost, project
from ptmcad.cad.stacks import StackData, lift
from ptmcad.counting import Counts, DegeneratePoint, count_by_isolation, solutions_at
from ptmcad.errors import ConfigError, DegenerateSliceError, GeometryError, InfiniteSolutionsError, LimitReached
from ptmcad.expressions import rational
from ptmcad.models import ParametricSystem, system_of
from ptmcad.plan import plan_of
from ptmcad.regionmap import (
    Adjacency,
    Cell,
    Component,
    CriticalValue,
    Merge,
    Region,
    RegionMap,
    Stack,
    Status,
    Wall,
    decimal,
)
from ptmcad.regions import Link, merge
from ptmcad.slice import Count, Point, Slice
from ptmcad.variety import discriminant_variety
from ptmcad.version import __version__

AREA_TOLERANCE = Fraction(1, 10_000)

Progress = Callable[[str, int, int], None]


@dataclass(slots=True)
class _Clock:
    """Stage times, the deadline, and the caller's progress report."""

    progress: Progress | None
    deadline: float | None
    started: float
    last: float
    seconds: dict[str, float]

    def check(self) -> None:
        if self.deadline is not None and perf_counter() > self.deadline:
            raise LimitReached("the time limit was reached before the region map was complete; nothing was decided")

    def report(self, stage: str, done: int, total: int) -> None:
        self.check()
        if self.progress is not None:
            self.progress(stage, done, total)

    def stage(self, name: str) -> None:
        now = perf_counter()
        self.seconds[name] = now - self.last
        self.last = now
        self.check()


def classify(
    slice: Slice,
    engine: str = "auto",
    count: Count | str | None = None,
    timeout: float | None = None,
    tolerance: Fraction | float | None = None,
    area_tolerance: Fraction | float | str | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
    keep: frozenset[str] = frozenset(),
) -> RegionMap:
    """The region map of a slice.

    Parameters
    ----------
    engine : ``"auto"`` or ``"exact"``.
    count : which count tells regions apart; the slice's own when None.
    timeout : seconds after which `LimitReached` is raised.
    tolerance : for engines that leave area undetermined; the exact engine leaves none.
    area_tolerance : largest relative width of each region's area bounds, 1e-4 when None.
    jobs : number of processes; the exact engine uses one.
    progress : called as progress(stage, done, total).
    keep : names of savings to switch off, see `ptmcad.plan`.

    Raises
    ------
    ConfigError
        For an unknown engine, count or tolerance.
    HypothesisError
        When the slice is degenerate, has infinitely many equilibria, or leaves the domain of the geometry.
    LimitReached
        After ``timeout`` seconds.
    """
    if engine not in ("auto", "exact"):
        raise ConfigError(f"the engine {engine!r} is not available: choose auto or exact", key="engine")
    try:
        slice = slice if count is None else replace(slice, count=Count(count))
        relative = AREA_TOLERANCE if area_tolerance is None else Fraction(area_tolerance)
    except (ValueError, TypeError) as error:
        raise ConfigError(str(error)) from error
    if not 0 < relative < 1:
        raise ConfigError(f"{area_tolerance} is not between 0 and 1", key="area_tolerance")
    now = perf_counter()
    clock = _Clock(progress, None if timeout is None else now + timeout, now, now, {})

    system = system_of(slice.mechanism)
    parameters = {name: from_expression(slice.parameters[name]) for name in system.ring.parameters}
    window = tuple((from_fraction(a.low), from_fraction(a.high)) for a in slice.axes)
    clock.report("variety", 0, 1)
    try:
        variety = discriminant_variety(system, parameters, (window[0], window[1]), _limits(system, parameters), keep)
    except (DegenerateSliceError, InfiniteSolutionsError) as error:
        at = (simplest_between(*window[0]), simplest_between(*window[1]))
        raise type(error)(f"{error}; {_witness(slice, system, parameters, at)}") from error
    clock.stage("variety")

    base, curves, verticals, costs = _choose_base(variety.components, keep)
    clock.report("projection", 0, 1)
    projection = project(curves, verticals, window[base], window[1 - base], clock.check)
    clock.stage("projection")
    stacks = lift(curves, projection.abscissae, window[base], window[1 - base])
    clock.stage("stacks")

    points = [
        (stack.sample, height) if base == 0 else (height, stack.sample) for stack in stacks for height in stack.heights
    ]
    counts = []
    for k, at in enumerate(points):
        clock.report("counts", k, len(points))
        counts.append(_count(slice, system, parameters, at))
    clock.stage("counts")

    crossings = []
    for k, (left, right) in enumerate(pairwise(stacks)):
        clock.report("adjacency", k, len(stacks) - 1)
        crossings.append(passages(curves, left, right, window[1 - base], clock.check))
    vertical_components = {
        tuple(int(c) for c in line.coeffs()): n for n, line in _vertical_lines(variety.components, base).items()
    }
    clock.stage("adjacency")

    keys = [_key(c, slice.count) for c in counts]
    adjacencies = _adjacencies(stacks, crossings, projection, vertical_components, keys)
    region_of = merge(keys, [Link(a.first, a.second, a.component) for a in adjacencies])
    rows, start = [], 0
    for stack in stacks:
        rows.append(region_of[start : start + len(stack.heights)])
        start += len(stack.heights)
    clock.report("areas", 0, 1)
    areas = region_areas(stacks, rows, curves, window[base], window[1 - base], relative, clock.check)
    clock.stage("areas")

    names = slice.axis_names
    samples = [Point(names, to_fraction(x), to_fraction(y)) for x, y in points]
    separating = {a.component for a in adjacencies if a.merge is Merge.SEPARATED}
    components = tuple(replace(c, separates=n in separating) for n, c in enumerate(variety.components))
    seconds = dict(clock.seconds)
    seconds["total"] = perf_counter() - clock.started
    return RegionMap(
        slice=slice,
        status=Status.EXACT,
        base=base,
        complex_solutions=variety.complex_solutions,
        components=components,
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
            Cell(s, level, samples[n], region_of[n], counts[n].total, counts[n].stable, counts[n].index)
            for n, (s, level) in enumerate((s, i) for s, stack in enumerate(stacks) for i in range(len(stack.heights)))
        ),
        adjacencies=adjacencies,
        regions=_regions(region_of, counts, samples, areas),
        plan=plan_of(slice, components, names[base], costs, keep),
        undetermined=Fraction(0),
        versions={
            "ptmcad": __version__,
            "python": ".".join(map(str, sys.version_info[:2])),
            "python-flint": flint.__version__,
            "flint": flint.__FLINT_VERSION__,
        },
        timings=seconds,
    )


def _limits(system: ParametricSystem, parameters: dict[str, Ratio]) -> list[Coefficient]:
    """Numerators of the parameters that have to be positive and vary over the window."""
    names = (*system.positive, *system.nonnegative)
    return [parameters[name][0] for name in names if not parameters[name][0].is_constant()]


def _vertical_lines(components: Sequence[Component], base: int) -> dict[int, UnivariatePolynomial]:
    """The components that are lines across the fibre direction, as polynomials in the base coordinate."""
    lines = {}
    for n, c in enumerate(components):
        if not c.left_out and c.polynomial.degrees[1 - base] == 0:
            lines[n] = coefficients_in(from_plane(c.polynomial), 1 - base)[0]
    return lines


def _choose_base(
    components: Sequence[Component], keep: frozenset[str]
) -> tuple[int, list[Curve], list[UnivariatePolynomial], tuple[int, int]]:
    """The base axis of the cheaper decomposition, with the curves and lines as seen from it."""
    views = []
    for base in (0, 1):
        curves = [
            curve(n, from_plane(c.polynomial), base)
            for n, c in enumerate(components)
            if not c.left_out and c.polynomial.degrees[1 - base] > 0
        ]
        views.append((predicted_cost(curves), base, curves))
    costs = (views[0][0], views[1][0])
    chosen = views[1] if costs[1] < costs[0] else views[0]
    if "axis-order" in keep:
        chosen = views[0]
    _, base, curves = chosen
    return base, curves, list(_vertical_lines(components, base).values()), costs


def _count(slice: Slice, system: ParametricSystem, parameters: dict[str, Ratio], at: tuple[fmpq, fmpq]) -> Counts:
    """The counts at a sample point, after a check that the geometry exists there."""
    values = point_values(parameters, at)
    where = ", ".join(f"{name} = {value}" for name, value in zip(slice.axis_names, at, strict=True))
    for name in (*system.positive, *system.nonnegative):
        if values[name] < 0 or (values[name] == 0 and name in system.positive):
            raise GeometryError(
                f"{name} = {values[name]} at {where}, but it must be positive in the whole window; "
                f"narrow the range or change {name}"
            )
    try:
        return count_by_isolation(system, values)
    except DegeneratePoint as error:
        raise DegenerateSliceError(
            f"{error}, a point that should lie off the variety: the slice has a whole area of singular equilibria"
        ) from error


def point_values(parameters: dict[str, Ratio], at: tuple[fmpq, fmpq]) -> dict[str, fmpq]:
    """The parameters at a point where their denominators do not vanish."""
    return {name: evaluate(a, *at) / evaluate(b, *at) for name, (a, b) in parameters.items()}


def _witness(slice: Slice, system: ParametricSystem, parameters: dict[str, Ratio], at: tuple[fmpq, fmpq]) -> str:
    """What is wrong at one point of a slice that is degenerate everywhere."""
    where = ", ".join(f"{name} = {value}" for name, value in zip(slice.axis_names, at, strict=True))
    if any(evaluate(below, *at) == 0 for _, below in parameters.values()):
        return f"at {where} a parameter has a zero denominator"
    different, multiplicity = solutions_at(system, point_values(parameters, at))
    if different is None:
        return f"for example at {where} there are infinitely many solutions"
    return f"for example at {where} only {different} of {multiplicity} solutions are different"


def _key(counts: Counts, count: Count) -> tuple[int, ...]:
    if count is Count.STABLE:
        return (counts.stable,)
    return (counts.total,) if count is Count.TOTAL else counts.index


def _adjacencies(
    stacks: Sequence[StackData],
    crossings: Sequence[Sequence[Passage]],
    projection: Projection,
    vertical_components: dict[tuple[int, ...], int],
    keys: Sequence[tuple[int, ...]],
) -> tuple[Adjacency, ...]:
    found: list[Adjacency] = []

    def link(
        first: int, second: int, component: int | None, segment: tuple[Fraction, Fraction, Fraction] | None
    ) -> None:
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
            for p in crossings[s]:
                segment = (to_fraction(p.low), to_fraction(p.high), to_fraction(p.height))
                link(first + p.left, following + p.right, vertical_components.get(line), segment)
        first = following
    return tuple(found)


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
    areas: Sequence[tuple[Fraction, Fraction]],
) -> tuple[Region, ...]:
    regions = []
    for number, area in enumerate(areas):
        cells = tuple(n for n, r in enumerate(region_of) if r == number)
        members = [counts[n] for n in cells]

        def common(values: list[Any]) -> Any:
            return values[0] if all(v == values[0] for v in values) else None

        regions.append(
            Region(
                stable=common([c.stable for c in members]),
                total=common([c.total for c in members]),
                index=common([c.index for c in members]),
                area=(rational(decimal(area[0], up=False)), rational(decimal(area[1], up=True))),
                cells=cells,
                sample=min((samples[n] for n in cells), key=_height),
            )
        )
    return tuple(regions)


def _height(point: Point) -> tuple[int, ...]:
    x, y = point[0], point[1]
    return (max(abs(x.numerator), x.denominator, abs(y.numerator), y.denominator), x.denominator, y.denominator)
