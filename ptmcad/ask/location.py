"""Where a rational point lies in a region map.

Guarantee: exact, however near the point is to a wall. The answer comes from the map's stored walls:
signs of the stored polynomials at the point and numbers of their real roots below it; in a
certified map from its cover, in integers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq

from ptmcad.algebra.polynomials import UnivariatePolynomial, coefficients_in, from_plane, univariate
from ptmcad.algebra.real_roots import (
    has_root_between,
    isolate,
    order,
    root_of,
    sign_at,
    squarefree_part,
)
from ptmcad.answer.consistency import contradiction
from ptmcad.answer.regionmap import Component, Kind, Location, RegionMap, Status
from ptmcad.answer.remembered import remembered
from ptmcad.answer.words import noun
from ptmcad.cover import components
from ptmcad.errors import ConfigError, DegenerateSliceError, expect
from ptmcad.exact.cad.projection import FibredCurve, curves_of
from ptmcad.exact.cad.stacks import level_at
from ptmcad.exact.models import system_from
from ptmcad.exact.models.system import on_axes
from ptmcad.exact.stages import count_at
from ptmcad.question.slice import Point
from ptmcad.text.flint_numbers import from_fraction, interval_of
from ptmcad.text.parsing import number_for

if TYPE_CHECKING:
    from ptmcad.cover.complement import Components


def locate(result: RegionMap, point: Any = None, /, **at: Any) -> Location:
    """The region of a rational point, exactly; names are the two axes, values numbers or text such
    as "7/10".

    A float stands for its shortest decimal: 0.1 is 1/10. The values may be given as one
    mapping instead, such as the sample of a cell.

    Raises
    ------
    ConfigError
        When the names are not the two axes, a value is not an exact number, or the map contradicts
        itself.
    """
    given = at if point is None else point
    names = result.slice.axis_names
    expect(
        given,
        (Mapping, Point),
        "point",
        f"the values of {names[0]} and {names[1]} by name, or a mapping of them",
    )
    place = _point(result, given)
    inside = all(axis.holds(value) for axis, value in zip(result.slice.axes, place, strict=True))
    if not inside:  # of the open window, which is what a map is of
        on_edge = all(
            axis.low <= value <= axis.high
            for axis, value in zip(result.slice.axes, place, strict=True)
        )
        return Location(Status.ON_EDGE if on_edge else Status.OUTSIDE)
    if result.cover is not None:
        return _locate_outside_cover(result, place)
    if not result.cells:
        return Location(Status.UNDECIDED)
    base = result.base
    u, v = from_fraction(place[base]), from_fraction(place[1 - base])
    met = [c for c in result.components if not c.left_out and c.polynomial(*place) == 0]
    if met:
        return _on_curves(result, met, (u, v))
    number = _cell_at(result, u, v)
    cell = result.cells[number]
    # in a map that was stopped before its areas were known, the counts are exact all the same
    status = Status.EXACT if result.status is Status.PARTIAL else result.status
    return Location(status, cell.region, number, cell.total, cell.stable, cell.index, cell.further)


def _cell_at(result: RegionMap, u: fmpq, v: fmpq) -> int:
    """The number of the cell that holds a point, by its coordinates along the base and across it,
    on no curve.
    """
    curves = _curves(result)
    stack, on_critical = stack_over(result, u)
    if stack >= len(result.stacks):
        raise contradiction(f"there is no stack {stack}")
    if on_critical:
        # the point lies on an artefact of the decomposition: step to the stack at its left along a
        # free segment
        u = _step_left(result, curves, u, v, stack)
    below = level_at(curves, u, v, interval_of(result.slice.axes[1 - result.base]))
    try:
        number = result.stacks[stack].cells[below]
        result.cells[number]
    except IndexError as error:
        raise contradiction(f"stack {stack} has no cell above {below} walls") from error
    return number


_ON_REGULAR = (
    "on a curve of the variety; counted at the point itself, where all solutions are regular"
)


def _on_curves(result: RegionMap, met: Sequence[Component], at: tuple[fmpq, fmpq]) -> Location:
    """A point on curves of the variety: with the counts there, where solutions are regular and no
    count changes.
    """
    many = next((c.continuum for c in met if c.continuum is not None), None)
    remark = "" if many is None else f"{many.value} {noun(result.slice.model)}"
    # a margin of a predicate may be zero on a critical curve, too
    is_predicate = result.slice.count.kind.predicate is not None
    if remark or is_predicate or any(c.separates or c.kind is Kind.BOUNDARY for c in met):
        return Location(Status.ON_VARIETY, remark=remark)
    slice = result.slice
    on = on_axes(system_from(slice.model), slice.parameters)
    try:
        counts = count_at("the point", on, at if result.base == 0 else at[::-1]).counts
    except DegenerateSliceError:
        return Location(Status.ON_VARIETY)
    cell = next((result.cells[number] for number in _cells_beside(result, at)), None)
    if cell is None or any(
        there not in (None, here)
        for there, here in ((cell.total, counts.total), (cell.stable, counts.stable))
    ):
        return Location(Status.ON_VARIETY)
    return Location(
        Status.EXACT,
        cell.region,
        None,
        counts.total,
        counts.stable,
        counts.index,
        remark=_ON_REGULAR,
    )


def _cells_beside(result: RegionMap, at: tuple[fmpq, fmpq]) -> Iterator[int]:
    """Cells beside a point on curves, each reached along a segment that meets no other point of the
    curves.
    """
    curves = [from_plane(c.polynomial) for c in result.components if not c.left_out]
    for direction, varying in enumerate((result.base, 1 - result.base)):
        traces = [univariate(coefficients_in(p, varying), at[1 - direction]) for p in curves]
        if all(traces):  # no curve runs in this direction through the point
            step = (from_fraction(result.slice.axes[varying].high) - at[direction]) / 2
            while any(_meets(p, at[direction], step) for p in traces):
                step = step / 2
            yield _cell_at(
                result, *((at[0] + step, at[1]) if direction == 0 else (at[0], at[1] + step))
            )


def _meets(p: UnivariatePolynomial, start: fmpq, step: fmpq) -> bool:
    """Whether a polynomial has a root after the start, up to the end of a step."""
    return sign_at(p, start + step) == 0 or bool(isolate(squarefree_part(p), start, start + step))


_KEPT = 4
"""Maps of which what locates points is kept for the next one: many points may be asked of some maps
in turn.
"""


@remembered(_KEPT)
def _curves(result: RegionMap) -> list[FibredCurve]:
    """The curves over the map's base."""
    return curves_of(result.components, result.base)


def _locate_outside_cover(result: RegionMap, point: Sequence[Fraction]) -> Location:
    complement, cells = component_cells(result)
    u, v = (
        axis.share(x) * complement.cover.steps
        for axis, x in zip(result.slice.axes, point, strict=True)
    )
    component = complement.locate(u, v)
    if component not in cells:
        return Location(Status.UNDECIDED)
    number = cells[component]
    cell = result.cells[number]
    return Location(
        Status.CERTIFIED, cell.region, number, cell.total, cell.stable, cell.index, cell.further
    )


@remembered(_KEPT)
def component_cells(result: RegionMap) -> tuple[Components, dict[int, int]]:
    """The components outside a certified map's cover, and which cell each of them is.

    Raises
    ------
    ConfigError
        When a cell's sample is in no component of its own.
    """
    assert result.cover is not None
    complement = components(result.cover)
    x, y = ((axis.low, axis.high) for axis in result.slice.axes)
    try:
        return complement, complement.numbered((cell.sample for cell in result.cells), (x, y))
    except ValueError as error:
        raise contradiction(str(error)) from error


def _point(result: RegionMap, at: Mapping[str, Any]) -> tuple[Fraction, Fraction]:
    names = result.slice.axis_names
    given = tuple(at.keys())
    if set(given) != set(names):
        raise ConfigError(
            f"a point of this map needs {names[0]} and {names[1]}, not {', '.join(map(str, given)) or 'nothing'}"
        )
    return number_for(names[0], at[names[0]]), number_for(names[1], at[names[1]])


def stack_over(result: RegionMap, u: fmpq) -> tuple[int, bool]:
    """The stack over u; or, when u is a critical value, the stack at its left and True."""
    for number, critical in enumerate(result.critical_values):
        side = order(u, root_of(critical.number))
        if side <= 0:
            return number, side == 0
    return len(result.critical_values), False


def _step_left(result: RegionMap, curves: list[FibredCurve], u: fmpq, v: fmpq, stack: int) -> fmpq:
    """An abscissa in the stack at the left of u from which the horizontal segment to (u, v) meets
    no curve.
    """
    width = u - from_fraction(result.stacks[stack].sample)
    while any(has_root_between(c.trace(v), u - width, u) for c in curves):
        width = width / 2
    return u - width
