"""The exact engine: from a slice without free lengths to its region map, the stages in order, each timed.

Guarantee: the map is exact (`Status.EXACT`): no step decides anything by rounding without an error bound.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from time import perf_counter

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
)
from ptmcad.algebra.real_roots import simplest_between
from ptmcad.answer.regionmap import HARMLESS, Component, RegionMap, Status
from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.errors import DegenerateSliceError, GeometryError, InfiniteSolutionsError, LimitReached
from ptmcad.exact.assembly import assemble, with_areas
from ptmcad.exact.cad.adjacency import cross
from ptmcad.exact.cad.area import region_areas
from ptmcad.exact.cad.curves import Curve, curve
from ptmcad.exact.cad.projection import predicted_cost, project
from ptmcad.exact.cad.stacks import Avoided, lift
from ptmcad.exact.counting import DegeneratePoint, Equilibria, equilibria, solutions_at
from ptmcad.exact.models import ParametricSystem, system_of
from ptmcad.exact.models.elimination import elimination_system
from ptmcad.exact.models.text import system_text
from ptmcad.exact.plan import plan_of
from ptmcad.exact.variety import discriminant_variety
from ptmcad.question.domain import prove_slice
from ptmcad.question.slice import Slice, without_free_lengths
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
            raise LimitReached("the time limit was reached before the region map was complete")

    def report(self, stage: str, done: int, total: int) -> None:
        self.check()
        if self.progress is not None:
            self.progress(stage, done, total)

    def stage(self, name: str) -> None:
        now = perf_counter()
        self.seconds[name] = now - self.last
        self.last = now
        self.check()


def exact_map(
    slice: Slice,
    area_tolerance: Fraction = AREA_TOLERANCE,
    deadline: float | None = None,
    progress: Progress | None = None,
    without: frozenset[str] = frozenset(),
    partial: Callable[[RegionMap], None] | None = None,
    areas: bool = True,
) -> RegionMap:
    """The region map of a slice without free lengths.

    Parameters
    ----------
    area_tolerance : largest relative width of each region's area bounds.
    deadline : reading of `time.perf_counter` after which `LimitReached` is raised.
    progress : called as progress(stage, done, total).
    without : names of savings to switch off, of `ptmcad.question.savings`.
    partial : called with the map after each stage that improves it, the complete one included.
    areas : whether to enclose the regions' areas; without, they are known only to be at most the window's.

    Raises
    ------
    ConfigError
        When springs have a free length.
    HypothesisError
        When the slice is degenerate, has infinitely many equilibria, or leaves the domain of the geometry.
    LimitReached
        At the deadline, with what there is of the map as ``partial``.
    """
    without_free_lengths(slice.parameters, "an exact map is")
    now = perf_counter()
    clock = _Clock(progress, deadline, now, now, {})
    best: RegionMap | None = None
    try:
        for reached in _stages(slice, area_tolerance if areas else None, clock, without):
            best = reached
            if partial is not None:
                partial(reached)
    except LimitReached as stop:
        raise LimitReached(str(stop), partial=best) from stop
    assert best is not None
    return best


def slice_variety(slice: Slice, without: frozenset[str] = frozenset()) -> SliceVariety:
    """The discriminant variety of a slice, the first stage of `exact_map` alone.

    Parameters
    ----------
    without : names of savings to switch off, of `ptmcad.question.savings`.

    Raises
    ------
    ConfigError
        When springs have a free length: then the variety is out of algebra's reach.
    HypothesisError
        When the slice is degenerate, has infinitely many equilibria, or leaves the domain of the geometry.
    """
    without_free_lengths(slice.parameters, "the discriminant variety is")
    now = perf_counter()
    first = next(_stages(slice, AREA_TOLERANCE, _Clock(None, None, now, now, {}), without))
    system = system_of(slice.mechanism)
    parameters = {name: from_expression(slice.parameters[name]) for name in system.ring.parameters}
    return SliceVariety(
        slice,
        first.components,
        first.complex_solutions,
        elimination_system(system, parameters, slice.axis_names),
        first.versions,
    )


def _stages(slice: Slice, relative: Fraction | None, clock: _Clock, without: frozenset[str]) -> Iterator[RegionMap]:
    """The region map after the variety, after the counts, and complete; the first two are marked as partial.

    Parameters
    ----------
    relative : largest relative width of areas' bounds, None when they are not asked for.
    """
    prove_slice(slice)
    system = system_of(slice.mechanism)
    parameters = {name: from_expression(slice.parameters[name]) for name in system.ring.parameters}
    window = tuple((from_fraction(a.low), from_fraction(a.high)) for a in slice.axes)
    clock.report("variety", 0, 1)
    try:
        variety = discriminant_variety(
            system, parameters, (window[0], window[1]), domain_limits(system, parameters), without
        )
    except (DegenerateSliceError, InfiniteSolutionsError) as error:
        at = (simplest_between(*window[0]), simplest_between(*window[1]))
        raise type(error)(f"{error}; {_witness(slice, system, parameters, at)}") from error
    base, curves, verticals, costs = _choose_base(variety.components, without)
    started = RegionMap(
        slice=slice,
        status=Status.PARTIAL,
        system=system_text(system),
        base=base,
        complex_solutions=variety.complex_solutions,
        components=variety.components,
        critical_values=(),
        stacks=(),
        cells=(),
        adjacencies=(),
        non_adjacencies=(),
        regions=(),
        plan=plan_of(slice, variety.components, base, costs, without, relative is not None),
        undetermined=Fraction(1),
        versions={
            "ptmcad": __version__,
            "python": ".".join(map(str, sys.version_info[:2])),
            "python-flint": flint.__version__,
            "flint": flint.__FLINT_VERSION__,
        },
        precision={},
    )
    yield started
    clock.stage("variety")

    clock.report("projection", 0, 1)
    projection = project(curves, list(verticals.values()), window[base], window[1 - base], clock.check, without)
    clock.stage("projection")
    clock.report("stacks", 0, 1)
    avoided = avoided_by_samples(variety.components, base)
    stacks = lift(curves, projection.abscissae, window[base], window[1 - base], avoided)
    clock.stage("stacks")

    points = [
        (stack.sample, height) if base == 0 else (height, stack.sample) for stack in stacks for height in stack.heights
    ]
    counts = []
    for k, at in enumerate(points):
        clock.report("counts", k, len(points))
        counts.append(count_at(_where(slice, at), system, parameters, at))
    clock.stage("counts")

    crossings = []
    for k, (left, right) in enumerate(pairwise(stacks)):
        clock.report("adjacency", k, len(stacks) - 1)
        crossings.append(cross(curves, left, right, window[1 - base], clock.check))
    lines = {tuple(int(c) for c in p.coeffs()): n for n, p in verticals.items()}
    counted = assemble(started, projection, stacks, points, counts, crossings, lines)
    yield counted
    clock.stage("adjacency")
    if relative is None:
        times = {**clock.seconds, "total": perf_counter() - clock.started}
        yield replace(counted, status=Status.EXACT, timings=times)
        return

    clock.report("areas", 0, 1)
    cells_alone = "equal-counts" in without
    whole = (slice.axes[0].high - slice.axes[0].low) * (slice.axes[1].high - slice.axes[1].low)
    rows = [tuple(n if cells_alone else counted.cells[n].region for n in stack.cells) for stack in counted.stacks]
    bounds, bits = region_areas(stacks, rows, curves, window[base], window[1 - base], relative, clock.check)
    if cells_alone:
        bounds = tuple(_sum_of([bounds[n] for n in region.cells], whole) for region in counted.regions)
    clock.stage("areas")
    yield replace(
        with_areas(counted, bounds, bits),
        status=Status.EXACT,
        timings={**clock.seconds, "total": perf_counter() - clock.started},
    )


def _sum_of(areas: Sequence[tuple[Fraction, Fraction]], most: Fraction) -> tuple[Fraction, Fraction]:
    return sum((low for low, _ in areas), Fraction(0)), min(sum((high for _, high in areas), Fraction(0)), most)


def domain_limits(system: ParametricSystem, parameters: dict[str, Ratio]) -> list[Coefficient]:
    """What bounds the slice's domain: lengths and stiffnesses that vary, and the parameters' denominators."""
    names = (*system.positive, *system.nonnegative)
    limits = [*(parameters[name][0] for name in names), *(denominator for _, denominator in parameters.values())]
    return [limit for limit in limits if not limit.is_constant()]


def _seen_from(
    components: Sequence[Component], base: int, reason: str = ""
) -> tuple[list[Curve], dict[int, UnivariatePolynomial]]:
    """The components that are used, or left out for a reason: curves, and lines across the fibre by their numbers."""
    curves, lines = [], {}
    for n, c in enumerate(components):
        if c.left_out == reason:
            if c.polynomial.degrees[1 - base] > 0:
                curves.append(curve(n, from_plane(c.polynomial), base))
            else:
                lines[n] = coefficients_in(from_plane(c.polynomial), 1 - base)[0]
    return curves, lines


def avoided_by_samples(components: Sequence[Component], base: int) -> Avoided:
    """Where real solutions stay regular but complex ones are lost, and a fibre may not be finite."""
    curves, lines = _seen_from(components, base, HARMLESS)
    return Avoided(curves, list(lines.values()))


def _choose_base(
    components: Sequence[Component], without: frozenset[str]
) -> tuple[int, list[Curve], dict[int, UnivariatePolynomial], tuple[int, int]]:
    """The base axis of the cheaper decomposition, with the curves and lines as seen from it."""
    views = [_seen_from(components, base) for base in (0, 1)]
    costs = (predicted_cost(views[0][0]), predicted_cost(views[1][0]))
    base = 1 if costs[1] < costs[0] and "axis-order" not in without else 0
    return base, *views[base], costs


def _where(slice: Slice, at: tuple[fmpq, fmpq]) -> str:
    return ", ".join(f"{name} = {value}" for name, value in zip(slice.axis_names, at, strict=True))


def count_at(where: str, system: ParametricSystem, parameters: dict[str, Ratio], at: tuple[fmpq, fmpq]) -> Equilibria:
    """The equilibria at a sample point, after a check that the geometry exists there.

    Parameters
    ----------
    where : the point in words, for messages.

    Raises
    ------
    GeometryError
        When a length or stiffness is not positive there.
    DegenerateSliceError
        When some equilibrium is singular there.
    """
    values = point_values(parameters, at)
    for name in (*system.positive, *system.nonnegative):
        if values[name] < 0 or (values[name] == 0 and name in system.positive):
            raise GeometryError(
                f"{name} = {values[name]} at {where}, but it must be positive in the whole window; "
                f"narrow the range or change {name}"
            )
    try:
        return equilibria(system, values)
    except DegeneratePoint as error:
        raise DegenerateSliceError(
            f"{error}, a point that should lie off the variety: the slice has a whole area of singular equilibria"
        ) from error


def point_values(parameters: dict[str, Ratio], at: tuple[fmpq, fmpq]) -> dict[str, fmpq]:
    """The parameters at a point where their denominators do not vanish."""
    return {name: evaluate(a, *at) / evaluate(b, *at) for name, (a, b) in parameters.items()}


def _witness(slice: Slice, system: ParametricSystem, parameters: dict[str, Ratio], at: tuple[fmpq, fmpq]) -> str:
    """What is wrong at one point of a slice that is degenerate everywhere."""
    where = _where(slice, at)
    if any(evaluate(below, *at) == 0 for _, below in parameters.values()):
        return f"at {where} a parameter has a zero denominator"
    different, multiplicity = solutions_at(system, point_values(parameters, at))
    if different is None:
        return f"for example at {where} there are infinitely many solutions"
    return f"for example at {where} only {different} of {multiplicity} solutions are different"
