"""The verification accepts every shipped result, and rejects what has been altered so that it is false."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

import ptmcad
from ptmcad.plane import PlanePolynomial
from ptmcad.regionmap import Kind, Merge, RegionMap
from ptmcad.slice import Point

CONFIGS = sorted(p.stem for p in (Path(__file__).parent.parent / "configs").glob("*.yaml"))


def stored(result: RegionMap) -> RegionMap:
    """What a reader of the file has."""
    return RegionMap.from_json(result.to_json())


@pytest.mark.parametrize("name", CONFIGS)
def test_shipped_results_are_accepted(name: str, shipped: Callable[..., RegionMap]) -> None:
    report = ptmcad.verify(stored(shipped(name)))
    assert report.ok, report.violation
    assert report.violation is None
    assert {c.passed for c in report.checks if c.name != "provenance"} == {True}
    assert "not checked" in report.table()


def put(items: tuple, k: int, **changes: object) -> tuple:  # type: ignore[type-arg]
    """The items with the k-th one altered."""
    return (*items[:k], replace(items[k], **changes), *items[k + 1 :])


def drop(items: tuple, k: int) -> tuple:  # type: ignore[type-arg]
    return (*items[:k], *items[k + 1 :])


Mutation = Callable[[RegionMap, random.Random], RegionMap]


def count(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.randrange(len(r.cells))
    name = rng.choice(["total", "stable"])
    return replace(r, cells=put(r.cells, n, **{name: getattr(r.cells[n], name) + rng.choice([-2, -1, 1, 2])}))


def morse_index(r: RegionMap, rng: random.Random) -> RegionMap:
    """Consistent in itself, with a zero Euler sum, and false; with the region's counts changed too."""
    n = rng.randrange(len(r.cells))
    index = r.cells[n].index
    assert index is not None
    new = (index[0] + 1, index[1] + 1, index[2])
    return replace(r, cells=put(r.cells, n, index=new, total=sum(new), stable=new[0]))


def swapped_index(r: RegionMap, rng: random.Random) -> RegionMap:
    """Minima and maxima exchanged, where they differ."""
    n = rng.choice([k for k, c in enumerate(r.cells) if c.index is not None and c.index[0] != c.index[2]])
    a, b, c = r.cells[n].index or (0, 0, 0)
    return replace(r, cells=put(r.cells, n, index=(c, b, a), stable=c))


def sample_of_another_cell(r: RegionMap, rng: random.Random) -> RegionMap:
    n, m = rng.sample(range(len(r.cells)), 2)
    return replace(r, cells=put(r.cells, n, sample=r.cells[m].sample))


def sample_beyond_a_wall(r: RegionMap, rng: random.Random) -> RegionMap:
    s = rng.choice([k for k, stack in enumerate(r.stacks) if stack.walls])
    n = rng.choice(r.stacks[s].cells[1:])
    return replace(r, cells=put(r.cells, n, sample=r.cells[n - 1].sample))


def dropped_component(r: RegionMap, rng: random.Random) -> RegionMap:
    """The curve is gone, with all its numbers shifted as an honest program would write them."""
    k = rng.choice([n for n, c in enumerate(r.components) if c.kind is Kind.CRITICAL or c.kind is Kind.BOUNDARY])
    return replace(r, components=drop(r.components, k))


def changed_component(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.choice([n for n, c in enumerate(r.components) if c.kind is Kind.CRITICAL])
    terms = list(r.components[k].polynomial.terms)
    t = rng.randrange(len(terms))
    i, j, c = terms[t]
    terms[t] = (i, j, c + rng.choice([-1, 1]) * rng.choice([1, abs(c) // 1000 + 1]))
    return replace(r, components=put(r.components, k, polynomial=PlanePolynomial.of(terms)))


def component_left_out(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.choice([n for n, c in enumerate(r.components) if not c.left_out])
    return replace(r, components=put(r.components, k, left_out="no point in the window"))


def critical_kind(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.choice([n for n, c in enumerate(r.components) if c.kind is Kind.CRITICAL])
    return replace(r, components=put(r.components, k, kind=Kind.INFINITY))


def separates(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.components))
    return replace(r, components=put(r.components, k, separates=not r.components[k].separates))


def moved_critical_value(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.critical_values))
    v = r.critical_values[k]
    shift = max(v.high - v.low, Fraction(1, 10**6)) * rng.choice([-1, 1]) * rng.randint(2, 50)
    return replace(r, critical_values=put(r.critical_values, k, low=v.low + shift, high=v.high + shift))


def invented_critical_value(r: RegionMap, rng: random.Random) -> RegionMap:
    """A rational number near the true one, with its own polynomial."""
    k = rng.randrange(len(r.critical_values))
    v = r.critical_values[k]
    q = (v.low + v.high) / 2 + Fraction(rng.choice([-1, 1]), 10**9 + rng.randrange(10**6))
    polynomial = (-q.numerator, q.denominator)
    return replace(r, critical_values=put(r.critical_values, k, polynomial=polynomial, low=q, high=q))


def critical_polynomial(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.critical_values))
    p = list(r.critical_values[k].polynomial)
    p[0] += rng.choice([-1, 1])
    return replace(r, critical_values=put(r.critical_values, k, polynomial=tuple(p)))


def root_index(r: RegionMap, rng: random.Random) -> RegionMap:
    s = rng.choice([k for k, stack in enumerate(r.stacks) if stack.walls])
    walls = r.stacks[s].walls
    w = rng.randrange(len(walls))
    return replace(r, stacks=put(r.stacks, s, walls=put(walls, w, root=walls[w].root + rng.choice([-1, 1]))))


def wall_component(r: RegionMap, rng: random.Random) -> RegionMap:
    s = rng.choice([k for k, stack in enumerate(r.stacks) if stack.walls])
    walls = r.stacks[s].walls
    w = rng.randrange(len(walls))
    return replace(r, stacks=put(r.stacks, s, walls=put(walls, w, component=walls[w].component + 1)))


def stack_sample(r: RegionMap, rng: random.Random) -> RegionMap:
    s, t = rng.sample(range(len(r.stacks)), 2)
    return replace(r, stacks=put(r.stacks, s, sample=r.stacks[t].sample))


def adjacency_removed(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, adjacencies=drop(r.adjacencies, rng.randrange(len(r.adjacencies))))


def adjacency_added(r: RegionMap, rng: random.Random) -> RegionMap:
    """A copy between other cells of the same two stacks, with a segment that proves another pair."""
    known = {(a.first, a.second) for a in r.adjacencies}
    choices = []
    for k, a in enumerate(r.adjacencies):
        if a.segment is not None:
            first, second = (r.stacks[r.cells[n].stack].cells for n in (a.first, a.second))
            choices += [(k, i, j) for i in first for j in second if (i, j) not in known]
    k, i, j = rng.choice(choices)
    new = replace(r.adjacencies[k], first=i, second=j)
    return replace(r, adjacencies=(*r.adjacencies, new))


def adjacency_component(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.adjacencies))
    new = None if r.adjacencies[k].component is not None else 0
    return replace(r, adjacencies=put(r.adjacencies, k, component=new))


def segment_end(r: RegionMap, rng: random.Random) -> RegionMap:
    """The segment no longer reaches the other stack."""
    k = rng.choice([n for n, a in enumerate(r.adjacencies) if a.segment is not None])
    low, high, height = r.adjacencies[k].segment or (Fraction(0),) * 3
    return replace(r, adjacencies=put(r.adjacencies, k, segment=(low, low + (high - low) / 10**30, height)))


def merge_kind(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.adjacencies))
    new = rng.choice([m for m in Merge if m is not r.adjacencies[k].merge])
    return replace(r, adjacencies=put(r.adjacencies, k, merge=new))


def area_bound(r: RegionMap, rng: random.Random) -> RegionMap:
    """One region takes from another what the enclosure's width does not hide: 0.1 % of the window."""
    x, y = r.slice.axes
    amount = (x.high - x.low) * (y.high - y.low) / 1000
    n, m = rng.sample(range(len(r.regions)), 2)
    if r.regions[m].area[0] < amount:
        n, m = m, n
    move = {n: amount, m: -amount}
    regions = tuple(
        replace(region, area=(region.area[0] + move.get(k, 0), region.area[1] + move.get(k, 0)))
        for k, region in enumerate(r.regions)
    )
    return replace(r, regions=regions)


def area_order(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.choice([k for k, region in enumerate(r.regions)])
    low, high = r.regions[n].area
    return replace(r, regions=put(r.regions, n, area=(high + Fraction(1, 100), low)))


def region_number(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.randrange(len(r.cells))
    new = rng.choice([k for k in range(len(r.regions)) if k != r.cells[n].region])
    return replace(r, cells=put(r.cells, n, region=new))


def region_cells(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.choice([k for k, region in enumerate(r.regions)])
    cells = r.regions[n].cells
    return replace(r, regions=put(r.regions, n, cells=drop(cells, rng.randrange(len(cells)))))


def region_count(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.randrange(len(r.regions))
    return replace(r, regions=put(r.regions, n, stable=(r.regions[n].stable or 0) + 1))


def region_sample(r: RegionMap, rng: random.Random) -> RegionMap:
    n, m = rng.sample(range(len(r.regions)), 2)
    return replace(r, regions=put(r.regions, n, sample=r.regions[m].sample))


def complex_solutions(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, complex_solutions=r.complex_solutions + rng.choice([-2, -1, 1, 2]))


def undetermined(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, undetermined=Fraction(1, rng.randint(2, 100)))


def base_axis(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, base=1 - r.base)


def another_slice(r: RegionMap, rng: random.Random) -> RegionMap:
    """All claims of one slice, said of another: one parameter that is not an axis differs by a thousandth."""
    constants = [n for n, e in r.slice.parameters.items() if n != "k" and e.is_constant and e.constant() != 0]
    name = rng.choice(constants)
    parameters = {**r.slice.parameters, name: r.slice.parameters[name] * Fraction(1001, 1000)}
    return replace(r, slice=replace(r.slice, parameters=parameters))


def window(r: RegionMap, rng: random.Random) -> RegionMap:
    """The same claims for a window that is a little larger."""
    x, y = r.slice.axes
    k = rng.randrange(2)
    axes = [x, y]
    axes[k] = replace(axes[k], high=axes[k].high * Fraction(5, 4) if axes[k].high else Fraction(1, 4))
    return replace(r, slice=replace(r.slice, axes=(axes[0], axes[1])))


MUTATIONS: tuple[Mutation, ...] = (
    count, morse_index, swapped_index, sample_of_another_cell, sample_beyond_a_wall, dropped_component,
    changed_component,
    component_left_out, critical_kind, separates, moved_critical_value, invented_critical_value, critical_polynomial,
    root_index, wall_component, stack_sample, adjacency_removed, adjacency_added, adjacency_component, segment_end,
    merge_kind, area_bound, area_order, region_number, region_cells, region_count, region_sample, complex_solutions,
    undetermined, base_axis, another_slice, window,
)  # fmt: skip


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda m: m.__name__)
@pytest.mark.parametrize(
    ("name", "seeds"),
    [("fig2", 3), ("fig3", 1), *(pytest.param(n, 6, marks=pytest.mark.slow) for n in ("fig3", "rods", "fig4"))],
)
def test_false_alterations_are_rejected(
    name: str, seeds: int, mutation: Mutation, shipped: Callable[..., RegionMap]
) -> None:
    true = stored(shipped(name))
    for seed in range(seeds):
        rng = random.Random(f"{name} {mutation.__name__} {seed}")
        report = ptmcad.verify(mutation(true, rng))
        assert not report.ok, f"seed {seed}"
        assert report.violation


@pytest.mark.xfail(reason="an area is enclosed to about 1e-4 of the window only", strict=True)
def test_a_tiny_change_of_an_area_is_rejected(shipped: Callable[..., RegionMap]) -> None:
    true = stored(shipped("fig4", area_tolerance="1e-9"))
    low, high = true.regions[1].area
    shift = Fraction(1, 10**7)
    first = replace(true.regions[0], area=(true.regions[0].area[0] - shift, true.regions[0].area[1] - shift))
    second = replace(true.regions[1], area=(low + shift, high + shift))
    assert not ptmcad.verify(replace(true, regions=(first, second))).ok


@pytest.mark.xfail(reason="the texts that say whence a critical value comes are not checked", strict=True)
def test_another_origin_is_rejected(shipped: Callable[..., RegionMap]) -> None:
    true = stored(shipped("fig4"))
    values = put(true.critical_values, 0, origin="component 0: crosses the window's edge")
    assert not ptmcad.verify(replace(true, critical_values=values)).ok


def test_the_report_names_the_claim_and_a_witness(shipped: Callable[..., RegionMap]) -> None:
    true = stored(shipped("fig2"))
    report = ptmcad.verify(replace(true, cells=put(true.cells, 0, stable=2)))
    assert report.violation is not None
    assert report.violation.startswith("counts: cell 0 is said to have 4 equilibria, 2 stable")
    assert "L2=" in report.violation
    assert "FALSE" in report.table()
    assert "not reached" in report.table()


def test_a_true_alteration_is_accepted(shipped: Callable[..., RegionMap]) -> None:
    """Wider bounds, and a sample elsewhere in the same cell, are as true as before."""
    true = stored(shipped("fig2"))
    low, high = true.regions[0].area
    wide = replace(true, regions=put(true.regions, 0, area=(low * Fraction(9, 10), high + Fraction(1, 10))))
    assert ptmcad.verify(wide).ok
    assert ptmcad.verify(true, seed=7).ok
    assert isinstance(true.cells[0].sample, Point)
