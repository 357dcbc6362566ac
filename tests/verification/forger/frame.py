"""False claims about the rest: slice, window, equations, areas, plan, status, and how tables refer
to each other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import partial
from itertools import combinations
from typing import Any

from support.replacing import replace

from forger.consistency import (
    NO_AREAS,
    Alteration,
    drop,
    put,
    settled,
    swapped,
    window_area,
    with_merges,
    with_plan,
)
from ptmcad.answer.regionmap import PlanStep, RegionMap, Status
from ptmcad.model import known_of
from ptmcad.question.slice import Count
from ptmcad.text.expressions import Expression, constant


def area_shifted(r: RegionMap) -> Iterator[Alteration]:
    """By a little more than the width of the bounds, either way."""
    for k, g in enumerate(r.regions):
        low, high = g.area
        for side in (-1, 1):
            by = side * ((high - low) * Fraction(101, 100) or Fraction(1, 10**9))
            if len(r.regions) > 1 or side < 0:
                yield partial(replace, r, regions=put(r.regions, k, area=(low + by, high + by)))


def area_known_exactly(r: RegionMap) -> Iterator[Alteration]:
    """Bounds without width, or nearly so; not about their middle, which may be the area itself."""
    for k, g in enumerate(r.regions):
        off = g.area[0] + (g.area[1] - g.area[0]) / 3
        if len(r.regions) > 1:
            yield partial(replace, r, regions=put(r.regions, k, area=(off, off)))
            yield partial(
                replace, r, regions=put(r.regions, k, area=(off, off * (1 + Fraction(1, 10**90))))
            )


def area_out_of_order(r: RegionMap) -> Iterator[Alteration]:
    """Bounds in the wrong order, below nothing, above the window."""
    for k, g in enumerate(r.regions):
        low, high = g.area
        whole = window_area(r)
        for area in ((high + whole / 100, low), (low - high - 1, high), (low, 2 * whole)):
            yield partial(replace, r, regions=put(r.regions, k, area=area))


def areas_exchanged(r: RegionMap) -> Iterator[Alteration]:
    for j, k in combinations(range(len(r.regions)), 2):
        one, two = r.regions[j].area, r.regions[k].area
        if one[1] < two[0] or two[1] < one[0]:
            yield partial(replace, r, regions=put(put(r.regions, j, area=two), k, area=one))


def area_moved_between_regions(r: RegionMap) -> Iterator[Alteration]:
    """The sum of all areas stays the window's."""
    for j in range(len(r.regions)):
        for k in range(len(r.regions)):
            one, two = r.regions[j].area, r.regions[k].area
            by = max(one[1] - one[0], two[1] - two[0]) * 2
            if j != k and two[0] > by:
                moved = put(r.regions, j, area=(one[0] + by, one[1] + by))
                yield partial(replace, r, regions=put(moved, k, area=(two[0] - by, two[1] - by)))


def window_moved(r: RegionMap) -> Iterator[Alteration]:
    """One of its edges further out or in by a quarter of its width, or both by its width; it may be
    empty.
    """
    for k in (0, 1):
        axis = r.slice.axes[k]
        width = axis.high - axis.low
        for low, high in ((axis.low - width / 4, axis.high), (axis.low, axis.high + width / 4),
                          (axis.low + width / 4, axis.high), (axis.low, axis.high - width / 4),
                          (axis.low + width, axis.high + width), (axis.high, axis.low)):  # fmt: skip
            axes = put(r.slice.axes, k, low=low, high=high)
            yield partial(replace, r, slice=replace(r.slice, axes=axes))


def _with_parameters(
    r: RegionMap, parameters: Mapping[str, Expression], text: Mapping[str, str]
) -> RegionMap:
    return with_plan(
        replace(r, slice=replace(r.slice, parameters=dict(parameters), text=dict(text)))
    )


def parameter_changed(r: RegionMap) -> Iterator[Alteration]:
    """One is a thousandth larger, or not zero any more, with its text and the plan to match."""
    axes = r.slice.axis_names
    for name, e in r.slice.parameters.items():
        if name in (*axes, "k"):
            continue
        for new in (e * Fraction(1001, 1000), e + constant(1)):
            if (new - e).numerator:
                text = {**r.slice.text, name: new.to_text(axes)}
                if "k" in text and not any("k" in text[n] for n in text if n != "k"):
                    continue
                yield partial(_with_parameters, r, {**r.slice.parameters, name: new}, text)


def text_of_a_parameter(r: RegionMap) -> Iterator[Alteration]:
    """The text alone is of something else, is none, is missing, explains itself, or is too much."""
    for name, text in r.slice.text.items():
        for new in (f"{text} + 1/1000", f"({text}", "", f"{name} + 0*{name}" if name not in r.slice.axis_names else "2",
                    "L9", "1/0"):  # fmt: skip
            yield partial(replace, r, slice=replace(r.slice, text={**r.slice.text, name: new}))
        fewer = {n: t for n, t in r.slice.text.items() if n != name}
        yield partial(replace, r, slice=replace(r.slice, text=fewer))
    more = replace(
        r.slice,
        text={**r.slice.text, "L9": "1"},
        parameters={**r.slice.parameters, "L9": constant(1)},
    )
    yield partial(replace, r, slice=more)
    if "k" not in r.slice.parameters or not any(
        "k" in t for n, t in r.slice.text.items() if n != "k"
    ):
        unused = {**r.slice.parameters, "k": constant(7)}
        yield partial(
            replace, r, slice=replace(r.slice, parameters=unused, text={**r.slice.text, "k": "7"})
        )


def parameters_exchanged(r: RegionMap) -> Iterator[Alteration]:
    """Two that differ, with their texts."""
    for one, two in combinations([n for n in r.slice.parameters if n != "k"], 2):
        a, b = r.slice.parameters[one], r.slice.parameters[two]
        if (a - b).numerator and not {one, two} & set(r.slice.axis_names):
            parameters = {**r.slice.parameters, one: b, two: a}
            text = {
                **r.slice.text,
                one: b.to_text(r.slice.axis_names),
                two: a.to_text(r.slice.axis_names),
            }
            yield partial(_with_parameters, r, parameters, text)


def axes_exchanged(r: RegionMap) -> Iterator[Alteration]:
    """The axes' names, or the axes, with all else as it was."""
    x, y = r.slice.axes
    for axes in (
        (replace(x, name=y.name), replace(y, name=x.name)),
        (y, x),
        (x, replace(y, name=x.name)),
    ):
        yield partial(replace, r, slice=replace(r.slice, axes=axes))


def parameter_missing(r: RegionMap) -> Iterator[Alteration]:
    for name in r.slice.parameters:
        if name != "k":
            fewer = {n: e for n, e in r.slice.parameters.items() if n != name}
            text = {n: t for n, t in r.slice.text.items() if n != name}
            yield partial(replace, r, slice=replace(r.slice, parameters=fewer, text=text))
    yield partial(replace, r, slice=replace(r.slice, model=known_of("other")))


def another_count(r: RegionMap) -> Iterator[Alteration]:
    """Regions of one count said to be those of another; or of one that an exact map does not have."""
    for kind in Count:
        other = replace(r, slice=replace(r.slice, count=kind))
        if kind is Count.ADMISSIBLE or with_merges(other) != other:
            yield partial(replace, other)


def admissible_counts(r: RegionMap) -> Iterator[Alteration]:
    for n in range(len(r.cells)):
        yield partial(replace, r, cells=put(r.cells, n, further={"admissible": 0}))
    for k in range(len(r.regions)):
        yield partial(replace, r, regions=put(r.regions, k, further={"admissible": 0}))


def _terms(text: str) -> Iterator[str]:
    """The text with one coefficient or sign changed, one term more, or none."""
    parts = text.split(" ")
    for k in range(0, len(parts), 2):
        other = list(parts)
        other[k] = "2*" + parts[k].lstrip("-")
        yield " ".join(other)
        other[k] = parts[k] + "*rho"
        yield " ".join(other)
        if k:
            yield " ".join([*parts[: k - 1], {"+": "-", "-": "+"}[parts[k - 1]], *parts[k:]])
    for head in ("0*", "L9*", "+", "1e9*"):
        yield head + text
    yield text + " + 1/1000000*L1*cos_th1"
    yield ""


def equations(r: RegionMap) -> Iterator[Alteration]:
    """Every term of potential, gradient and Hessian."""
    s = r.system

    def put_in(**changes: Any) -> Alteration:
        return partial(replace, r, system=replace(s, **changes))

    for text in _terms(s.potential):
        yield put_in(potential=text)
    for k, entry in enumerate(s.gradient):
        for text in _terms(entry):
            yield put_in(gradient=(*s.gradient[:k], text, *s.gradient[k + 1 :]))
    for i, row in enumerate(s.hessian):
        for j, entry in enumerate(row):
            for text in _terms(entry):
                new = (*row[:j], text, *row[j + 1 :])
                yield put_in(hessian=(*s.hessian[:i], new, *s.hessian[i + 1 :]))


def relations_and_unknowns(r: RegionMap) -> Iterator[Alteration]:
    """Exchanged, changed, missing."""
    s = r.system
    for j, k in combinations(range(len(s.unknowns)), 2):
        yield partial(replace, r, system=replace(s, unknowns=swapped(s.unknowns, j, k)))
    for first in s.relations[:1]:
        for relations in (s.relations[::-1], s.relations[1:], (first + " + 1", *s.relations[1:])):
            if relations != s.relations:
                yield partial(replace, r, system=replace(s, relations=relations))
    yield partial(replace, r, system=replace(s, hessian=s.hessian[1:]))
    yield partial(replace, r, system=replace(s, moments=s.gradient))
    yield partial(replace, r, system=replace(s, gradient=(*s.gradient[1:], s.gradient[0] + " + 1")))


def plan_step_dropped(r: RegionMap) -> Iterator[Alteration]:
    """Not that of areas on one half of the window: the file is true without it."""
    for k, step in enumerate(r.plan):
        if step.what.startswith("areas on one half"):
            continue
        yield partial(replace, r, plan=drop(r.plan, k))


def plan_step_invented(r: RegionMap) -> Iterator[Alteration]:
    """One that exists twice, or a new one, at every place."""
    new = (PlanStep("cells in the dark", False, "nobody sees them"),
           PlanStep("components without a point in the window", True, "kept", "no-real-points"), NO_AREAS)  # fmt: skip
    for k in range(len(r.plan) + 1):
        for step in (*new, *r.plan[k : k + 1]):
            yield partial(replace, r, plan=(*r.plan[:k], step, *r.plan[k:]))


def plan_step_flipped(r: RegionMap) -> Iterator[Alteration]:
    """Done, left out and the saving contradict the words."""
    for k, step in enumerate(r.plan):
        yield partial(replace, r, plan=put(r.plan, k, done=not step.done))


def plan_step_changed(r: RegionMap) -> Iterator[Alteration]:
    """Other words, another reason, another saving."""
    for k, step in enumerate(r.plan):
        for changes in ({"what": step.what + " "}, {"reason": "nobody asked"}, {"saving": "sloth"},
                        {"reason": "predicted cost 9 against 3"}, {"reason": "predicted cost +++ against 3"},
                        {"saving": "" if step.saving else "imports"}):  # fmt: skip
            yield partial(replace, r, plan=put(r.plan, k, **changes))


def plan_steps_exchanged(r: RegionMap) -> Iterator[Alteration]:
    for j, k in combinations(range(len(r.plan)), 2):
        if r.plan[j] != r.plan[k]:
            yield partial(replace, r, plan=swapped(r.plan, j, k))


def areas_not_asked_for(r: RegionMap) -> Iterator[Alteration]:
    """The plan says so, but areas are known; or only some are not."""
    if NO_AREAS in r.plan or len(r.regions) < 2:
        return
    k = next(k for k, step in enumerate(r.plan) if step.saving == "equal-counts")
    silent = replace(r, plan=(*r.plan[:k], NO_AREAS, *r.plan[k + 1 :]))
    yield partial(replace, silent)
    for n, g in enumerate(r.regions):
        unknown = tuple(replace(x, area=(Fraction(0), window_area(r))) for x in r.regions)
        yield partial(replace, silent, regions=put(unknown, n, area=(Fraction(0), g.area[1])))


def status_and_shares(r: RegionMap) -> Iterator[Alteration]:
    """Another status, an undetermined share, another number of complex solutions, another base
    axis.
    """
    for status in (Status.CERTIFIED, Status.UNDECIDED, Status.ON_VARIETY, Status.OUTSIDE):
        yield partial(replace, r, status=status)
    for share in (Fraction(1, 10**9), Fraction(1)):
        yield partial(replace, r, undetermined=share)
    for by in (-2, -1, 1, 2, 4):
        yield partial(replace, r, complex_solutions=r.complex_solutions + by)
    for base in (1 - r.base, 2, -1):
        yield partial(replace, r, base=base)


def tables_left_out(r: RegionMap) -> Iterator[Alteration]:
    """An empty map that is said to be exact, one that is not empty, and tables that are too short
    or too long.
    """
    nothing: dict[str, Any] = {"critical_values": (), "stacks": (), "cells": (), "adjacencies": (),
                               "non_adjacencies": (), "regions": ()}  # fmt: skip
    none = tuple(replace(c, separates=False) for c in r.components)
    empty = replace(r, **nothing, undetermined=Fraction(1), components=none)
    yield partial(replace, empty)
    for name in nothing:
        if getattr(r, name):
            yield partial(replace, empty, status=Status.PARTIAL, **{name: getattr(r, name)})
            yield partial(replace, r, **{name: ()})
            yield partial(replace, r, **{name: getattr(r, name)[:-1]})
    if any(c.separates for c in r.components):
        yield partial(replace, empty, status=Status.PARTIAL, components=r.components)
    if r.cells:
        yield partial(replace, r, cells=(*r.cells, r.cells[-1]))


def references(r: RegionMap) -> Iterator[Alteration]:
    """Stacks and cells that refer to others than they should."""
    for s, stack in enumerate(r.stacks):
        for changes in ({"left": s}, {"right": None if s + 1 < len(r.stacks) else s}, {"cells": stack.cells[::-1]},
                        {"cells": (*stack.cells, stack.cells[-1] + 1)}):  # fmt: skip
            if any(getattr(stack, name) != value for name, value in changes.items()):
                yield partial(replace, r, stacks=put(r.stacks, s, **changes))
    for n, cell in enumerate(r.cells):
        for more in (
            {"stack": None},
            {"stack": (cell.stack or 0) + 1},
            {"level": cell.level + 1},
            {"region": -1},
        ):
            yield partial(replace, r, cells=put(r.cells, n, **more))


def window_of_a_settled_map(r: RegionMap) -> Iterator[Alteration]:
    """A partial map whose areas are those of a smaller window."""
    for k, g in enumerate(r.regions):
        low = g.area[0]
        if len(r.regions) > 1 and low:
            smaller = put(r.regions, k, area=(low * Fraction(9, 10), low * Fraction(99, 100)))
            yield partial(settled, replace(r, status=Status.PARTIAL, regions=smaller))


KINDS = (
    area_shifted, area_known_exactly, area_out_of_order, areas_exchanged, area_moved_between_regions, window_moved,
    parameter_changed, text_of_a_parameter, parameters_exchanged, axes_exchanged, parameter_missing, another_count,
    admissible_counts, equations, relations_and_unknowns, plan_step_dropped, plan_step_invented, plan_step_flipped,
    plan_step_changed, plan_steps_exchanged, areas_not_asked_for, status_and_shares, tables_left_out, references,
    window_of_a_settled_map,
)  # fmt: skip
