"""True alterations: other numbers, samples, segments, boxes, bounds, words, or another question."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import partial

from support.counting import system_of
from support.replacing import replace

from forger.consistency import (
    NO_AREAS,
    Alteration,
    changed,
    put,
    renumbered_components,
    window_area,
    with_plan,
)
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.exact.models.system import on_axes
from ptmcad.exact.stages import count_at
from ptmcad.question.slice import Count, Point
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.verification.claims import Claims, bracket


def regions_in_another_order(r: RegionMap) -> Iterator[Alteration]:
    last = len(r.regions) - 1
    cells = tuple(replace(c, region=last - c.region) for c in r.cells)
    yield partial(replace, r, cells=cells, regions=r.regions[::-1])


def components_in_another_order(r: RegionMap) -> Iterator[Alteration]:
    number = len(r.components)
    for order in ([*range(number)][::-1], [*range(1, number), 0]):
        yield partial(_in_order, r, order)


def _in_order(r: RegionMap, order: list[int]) -> RegionMap:
    found = with_plan(renumbered_components(r, order))
    return found


def tables_in_another_order(r: RegionMap) -> Iterator[Alteration]:
    yield partial(replace, r, adjacencies=r.adjacencies[::-1])
    yield partial(replace, r, non_adjacencies=r.non_adjacencies[::-1])
    yield partial(replace, r, cells=tuple(replace(c, solutions=c.solutions[::-1]) for c in r.cells))


def other_segments(r: RegionMap) -> Iterator[Alteration]:
    """Half as wide on each side of the critical value."""
    for k, a in enumerate(r.adjacencies):
        if a.segment is None:
            continue
        value = r.critical_values[r.cells[a.first].stack or 0]
        width = min(abs(value.low - a.segment[0]), abs(a.segment[1] - value.high)) / 4
        low, high = (
            bracket(value, from_fraction(width))
            if width
            else (from_fraction(value.low), from_fraction(value.high))
        )
        u, w = (to_fraction(low) + a.segment[0]) / 2, (to_fraction(high) + a.segment[1]) / 2
        yield partial(replace, r, adjacencies=put(r.adjacencies, k, segment=(u, w, a.segment[2])))


def other_samples(r: RegionMap) -> Iterator[Alteration]:
    """Of the cells of a stack, elsewhere over the same abscissa, with new boxes."""
    for s in range(len(r.stacks)):
        yield partial(_sampled, r, s)


def _sampled(r: RegionMap, s: int) -> RegionMap:
    on = on_axes(system_of(r.slice.mechanism), r.slice.parameters)
    cells = list(r.cells)
    claims = Claims(r)
    other = r.slice.axes[1 - r.base]
    for level, n in enumerate(r.stacks[s].cells):
        cell = cells[n]
        u, v = cell.sample[r.base], cell.sample[1 - r.base]
        by = (other.high - v) / 7
        while claims.level(from_fraction(u), from_fraction(v + by)) != level or any(
            c.over(from_fraction(u))(from_fraction(v + by)) == 0 for c in claims.curves
        ):
            by /= 2
        at = (u, v + by) if r.base == 0 else (v + by, u)
        found = count_at("a sample", on, (from_fraction(at[0]), from_fraction(at[1])))
        cells[n] = replace(cell, sample=Point(r.slice.axis_names, *at), solutions=found.solutions)
    return _sampled_regions(replace(r, cells=tuple(cells)))


def _sampled_regions(r: RegionMap) -> RegionMap:
    return replace(
        r, regions=tuple(replace(g, sample=r.cells[g.cells[-1]].sample) for g in r.regions)
    )


def samples_of_other_cells(r: RegionMap) -> Iterator[Alteration]:
    """The sample of a region is that of another one of its cells."""
    yield partial(_sampled_regions, r)


def refined_critical_values(r: RegionMap) -> Iterator[Alteration]:
    for k, v in enumerate(r.critical_values):
        if v.low < v.high:
            low, high = (to_fraction(q) for q in bracket(v, from_fraction((v.high - v.low) / 100)))
            yield partial(replace, r, critical_values=put(r.critical_values, k, low=low, high=high))


def refined_boxes(r: RegionMap) -> Iterator[Alteration]:
    """Half as large again where they stay apart from each other."""
    for n, cell in enumerate(r.cells):
        wider = tuple(replace(s, radius=s.radius * Fraction(3, 2)) for s in cell.solutions)
        apart = all(
            any(abs(x - y) > a.radius + b.radius for x, y in zip(a.center, b.center, strict=True))
            for k, a in enumerate(wider)
            for b in wider[:k]
        )
        if apart and all(s.radius <= 1 for s in wider):
            yield partial(replace, r, cells=put(r.cells, n, solutions=wider))


def wider_areas(r: RegionMap) -> Iterator[Alteration]:
    whole = window_area(r)
    if NO_AREAS in r.plan:
        return
    for share in (Fraction(1, 1000), Fraction(1, 3), Fraction(1)):
        wide = tuple(
            replace(g, area=(g.area[0] * (1 - share), g.area[1] + (whole - g.area[1]) * share))
            for g in r.regions
        )
        yield partial(replace, r, regions=wide)


def lopsided_areas(r: RegionMap) -> Iterator[Alteration]:
    """Bounds of which one is as near as ever and the other one far away."""
    whole = window_area(r)
    if NO_AREAS in r.plan:
        return
    for k in (0, 1):
        yield partial(
            replace, r,
            regions=tuple(replace(g, area=(Fraction(0), g.area[1]) if k else (g.area[0], whole)) for g in r.regions),
        )  # fmt: skip


def partial_status(r: RegionMap) -> Iterator[Alteration]:
    yield partial(replace, r, status=Status.PARTIAL)


def another_question(r: RegionMap) -> Iterator[Alteration]:
    """The map by another count; the areas of regions that were not there before are said to be
    unknown.
    """
    for kind in (Count.STABLE, Count.TOTAL, Count.INDEX):
        yield partial(changed, replace(r, slice=replace(r.slice, count=kind)))


def other_units_of_force(r: RegionMap) -> Iterator[Alteration]:
    """All stiffnesses and loads are three times as large; only where none of them is an axis."""
    names = {"k", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x"}
    text = {n: f"3*({t})" if n in names and "k" not in t else t for n, t in r.slice.text.items()}
    if names & set(r.slice.axis_names) or set(r.slice.axis_names) - set(r.slice.parameters):
        return
    parameters = {n: e * 3 if n in names else e for n, e in r.slice.parameters.items()}
    yield partial(replace, r, slice=replace(r.slice, parameters=parameters, text=text))


def other_words(r: RegionMap) -> Iterator[Alteration]:
    yield partial(replace, r, slice=replace(r.slice, title="another title", name="another"))
    yield partial(
        replace, r, slice=replace(r.slice, text={n: f"({t})" for n, t in r.slice.text.items()})
    )
    s = r.system
    yield partial(replace, r, system=replace(s, gradient=tuple(_turned(g) for g in s.gradient)))
    yield partial(replace, r, versions={}, precision={}, timings={})


def _turned(text: str) -> str:
    """A sum with its first term last."""
    first, _, rest = text.partition(" ")
    if not rest:
        return text
    sign, tail = rest[0], rest[2:]
    first = f"- {first[1:]}" if first.startswith("-") else f"+ {first}"
    return f"{'-' if sign == '-' else ''}{tail} {first}"


KINDS = (
    regions_in_another_order, components_in_another_order, tables_in_another_order, other_segments, other_samples,
    samples_of_other_cells, refined_critical_values, refined_boxes, wider_areas, lopsided_areas, partial_status,
    another_question, other_units_of_force, other_words,
)  # fmt: skip
