"""False claims about cells: their counts, the boxes of their solutions, their adjacencies, and why
some are not.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from itertools import combinations, permutations

from support.replacing import replace

from forger.consistency import (
    Alteration,
    changed,
    composed,
    drop,
    put,
    renumbered_cells,
    settled,
    with_merges,
    with_plan,
    with_regions,
)
from ptmcad.answer.regionmap import Adjacency, Merge, NonAdjacency, Reason, RegionMap, Solution

CIRCLES = tuple((Fraction(a, c), Fraction(b, c)) for a, b, c in (
    (3, 4, 5), (-5, 12, 13), (-8, -15, 17), (7, 24, 25), (-20, 21, 29), (9, -40, 41),
))  # fmt: skip


def fake(r: RegionMap, k: int) -> tuple[Fraction, ...]:
    """A configuration that is no solution but by an accident that did not happen, by a number."""
    model = r.slice.model
    turned = [
        x
        for i, _ in enumerate(model.angles)
        for x in CIRCLES[(k // (1 + 3 * i) + 3 * i) % len(CIRCLES)]
    ]
    return (*turned, *(Fraction(7 + k, 3) for _ in model.reals))


def signs_of(size: int, negative: int) -> str:
    """Of the eigenvalues of a Hessian, for an index of so many entries."""
    return "+" * (size - 1 - negative) + "-" * negative


def _recounted(r: RegionMap, cells: tuple[int, ...], by: tuple[int, ...], boxes: bool) -> RegionMap:
    """The cells with other indices, everything else following; with boxes to match where asked for."""
    found = list(r.cells)
    for n in cells:
        old = found[n].index
        assert old is not None
        index = tuple(a + b for a, b in zip(old, by, strict=True))
        solutions = found[n].solutions
        for negative, more in enumerate(by) if boxes else ():
            signs = signs_of(len(by), negative)
            for _ in range(max(0, more)):
                solutions = (
                    *solutions,
                    Solution(fake(r, len(solutions)), Fraction(1, 2**60), signs),
                )
            for _ in range(max(0, -more)):
                k = max(k for k, s in enumerate(solutions) if s.signs == signs)
                solutions = drop(solutions, k)
        found[n] = replace(
            found[n], index=index, total=sum(index), stable=index[0], solutions=solutions
        )
    return settled(replace(r, cells=tuple(found)))


def _possible(r: RegionMap, cells: tuple[int, ...], by: tuple[int, ...]) -> bool:
    return all(
        all(old + b >= 0 for old, b in zip(r.cells[n].index or (), by, strict=True)) for n in cells
    )


PAIRS = ((1, 1, 0), (0, 1, 1), (-1, -1, 0), (0, -1, -1))
CHANGES = (*PAIRS, (1, 0, -1), (-1, 0, 1), (1, 0, 0), (0, -1, 0), (2, 2, 0))


def _fitting(r: RegionMap, changes: tuple[tuple[int, ...], ...]) -> list[tuple[int, ...]]:
    """The changes of an index of the map's length; none where solutions have none."""
    size = len(r.cells[0].index or ())
    if not size:
        return []
    return [
        (*by, *(0 for _ in range(size - len(by))))
        for by in dict.fromkeys(by[:size] for by in changes)
        if any(by)
    ]


def counts_of_a_cell(r: RegionMap) -> Iterator[Alteration]:
    """More, fewer or other equilibria, by pairs or not, without boxes."""
    for n in range(len(r.cells)):
        for by in _fitting(r, CHANGES):
            if _possible(r, (n,), by):
                yield partial(_recounted, r, (n,), by, False)


def counts_and_boxes_of_a_cell(r: RegionMap) -> Iterator[Alteration]:
    """The same with boxes invented and left out, so that their number and signs are right."""
    for n in range(len(r.cells)):
        for by in _fitting(r, CHANGES):
            if _possible(r, (n,), by):
                yield partial(_recounted, r, (n,), by, True)


def counts_of_a_region(r: RegionMap) -> Iterator[Alteration]:
    """All cells of a region are said to have another pair of equilibria."""
    for region in r.regions:
        for by in _fitting(r, PAIRS):
            if _possible(r, region.cells, by):
                yield partial(_recounted, r, region.cells, by, True)


def counts_of_the_whole_map(r: RegionMap) -> Iterator[Alteration]:
    """Every cell has two equilibria more."""
    for by in _fitting(r, PAIRS[:2]):
        yield partial(_recounted, r, tuple(range(len(r.cells))), by, True)


def one_count_alone(r: RegionMap) -> Iterator[Alteration]:
    """Total or stable contradict the index."""
    for n, cell in enumerate(r.cells):
        for name in (name for name in ("total", "stable") if getattr(cell, name) is not None):
            for by in (-1, 1, 2):
                yield partial(changed, r, cells=put(r.cells, n, **{name: getattr(cell, name) + by}))
        if cell.index is not None:
            yield partial(changed, r, cells=put(r.cells, n, index=None))


def _with_solutions(r: RegionMap, n: int, solutions: tuple[Solution, ...]) -> RegionMap:
    return replace(r, cells=put(r.cells, n, solutions=solutions))


def box_moved(r: RegionMap) -> Iterator[Alteration]:
    """By three of its radii in one coordinate, or to a point that is no solution."""
    for n, cell in enumerate(r.cells):
        for k, s in enumerate(cell.solutions):
            for axis in range(len(s.center)):
                center = tuple(x + 3 * s.radius if i == axis else x for i, x in enumerate(s.center))
                yield partial(_with_solutions, r, n, put(cell.solutions, k, center=center))
            yield partial(_with_solutions, r, n, put(cell.solutions, k, center=fake(r, k)))


def box_beside_the_solution(r: RegionMap) -> Iterator[Alteration]:
    """A part of the box, near its corner, in which the solution is not."""
    for n, cell in enumerate(r.cells):
        for k, s in enumerate(cell.solutions):
            for side in (-1, 1):
                center = tuple(x + side * s.radius * Fraction(19, 20) for x in s.center)
                small = put(cell.solutions, k, center=center, radius=s.radius / 10**9)
                yield partial(_with_solutions, r, n, small)


def box_stored_twice(r: RegionMap) -> Iterator[Alteration]:
    """In place of another one, with the other one's signs."""
    for n, cell in enumerate(r.cells):
        for j, k in permutations(range(len(cell.solutions)), 2):
            s = cell.solutions[j]
            for radius in (s.radius, s.radius * Fraction(9, 10)):
                yield partial(
                    _with_solutions, r, n, put(cell.solutions, k, center=s.center, radius=radius)
                )


def boxes_that_meet(r: RegionMap) -> Iterator[Alteration]:
    """A box so large that it has two solutions."""
    for n, cell in enumerate(r.cells):
        for (j, a), (_, b) in permutations(enumerate(cell.solutions), 2):
            reach = max(abs(x - y) for x, y in zip(a.center, b.center, strict=True))
            yield partial(_with_solutions, r, n, put(cell.solutions, j, radius=reach))


def box_of_nothing(r: RegionMap) -> Iterator[Alteration]:
    """Radii that are not positive, or too large; centers of another dimension, or off the torus."""
    for n, cell in enumerate(r.cells):
        for k, s in enumerate(cell.solutions):
            for changes in ({"radius": Fraction(0)}, {"radius": -s.radius}, {"radius": Fraction(3)},
                            {"center": s.center[:-1]}, {"center": tuple(3 + x for x in s.center)}):  # fmt: skip
                yield partial(_with_solutions, r, n, put(cell.solutions, k, **changes))


def signs_exchanged(r: RegionMap) -> Iterator[Alteration]:
    """Between two solutions of a cell, so that its index stays right."""
    for n, cell in enumerate(r.cells):
        for (j, a), (k, b) in combinations(enumerate(cell.solutions), 2):
            if a.signs != b.signs:
                both = put(put(cell.solutions, j, signs=b.signs), k, signs=a.signs)
                yield partial(_with_solutions, r, n, both)


def sign_of_a_solution(r: RegionMap) -> Iterator[Alteration]:
    """With counts of the cell, and all else, to match; or alone."""
    for n, cell in enumerate(r.cells):
        for k, s in enumerate(cell.solutions):
            size = len(cell.index or ())
            other = {"-": "+", "+": "-"}.get(s.signs[:1], "+") + s.signs[1:]
            for signs in (
                (*(signs_of(size, negative) for negative in range(size)), "") if size else (other,)
            ):
                if signs == s.signs:
                    continue
                solutions = put(cell.solutions, k, signs=signs)
                yield partial(_with_solutions, r, n, solutions)
                if not size:
                    continue
                index = tuple(
                    sum(x.signs == signs_of(size, m) for x in solutions) for m in range(size)
                )
                new = put(
                    r.cells, n, solutions=solutions, index=index, total=sum(index), stable=index[0]
                )
                yield partial(changed, r, cells=new)


def solutions_of_another_cell(r: RegionMap) -> Iterator[Alteration]:
    """With the same index, where they are other points."""
    for (n, c), (_, d) in permutations(enumerate(r.cells), 2):
        if (c.total, c.index) == (d.total, d.index) and not all(
            any(_inside(b, a) for a in c.solutions) for b in d.solutions
        ):
            yield partial(_with_solutions, r, n, d.solutions)


def _inside(b: Solution, a: Solution) -> bool:
    return all(abs(x - y) <= a.radius for x, y in zip(a.center, b.center, strict=True))


def _across(r: RegionMap) -> Iterator[tuple[int, Adjacency]]:
    for k, a in enumerate(r.adjacencies):
        if a.segment is not None:
            yield k, a


def adjacency_across_dropped(r: RegionMap) -> Iterator[Alteration]:
    """One pair of neighbouring stacks' cells; regions, areas and non-adjacencies follow."""
    for k, _ in _across(r):
        yield partial(changed, r, adjacencies=drop(r.adjacencies, k))


def all_adjacencies_across_dropped(r: RegionMap) -> Iterator[Alteration]:
    """All pairs over one critical value."""
    for s in range(len(r.stacks) - 1):
        left = tuple(a for a in r.adjacencies if a.segment is None or r.cells[a.first].stack != s)
        yield partial(changed, r, adjacencies=left)
    if len(r.stacks) > 1:
        yield partial(changed, r, adjacencies=tuple(a for a in r.adjacencies if a.segment is None))


def adjacency_in_a_stack_dropped(r: RegionMap) -> Iterator[Alteration]:
    for k, a in enumerate(r.adjacencies):
        if a.segment is None:
            yield partial(changed, r, adjacencies=drop(r.adjacencies, k))


def adjacency_twice(r: RegionMap) -> Iterator[Alteration]:
    for a in r.adjacencies:
        yield partial(replace, r, adjacencies=(*r.adjacencies, a))


def adjacency_invented(r: RegionMap) -> Iterator[Alteration]:
    """Of cells of neighbouring stacks, with the segment of another pair, or of one stack or of
    distant ones.
    """
    known = {(a.first, a.second) for a in r.adjacencies}
    for _, a in _across(r):
        first, second = (r.stacks[r.cells[n].stack or 0].cells for n in (a.first, a.second))
        for i in first:
            for j in second:
                if (i, j) not in known:
                    more = (*r.adjacencies, replace(a, first=i, second=j))
                    yield partial(changed, r, adjacencies=more)
        for i, j in ((a.first, a.first), (a.second, a.first), (a.first, len(r.cells) - 1)):
            if (i, j) not in known:
                more = (*r.adjacencies, replace(a, first=i, second=j))
                yield partial(_with_pairs_of_any_cells, r, more)
    for stack in r.stacks:
        for i, j in permutations(stack.cells, 2):
            if (i, j) not in known:
                more = (
                    *r.adjacencies,
                    Adjacency(i, j, stack.walls[0].component, None, Merge.PROVEN),
                )
                yield partial(changed, r, adjacencies=more)


def adjacency_with_other_ends(r: RegionMap) -> Iterator[Alteration]:
    """A true pair replaced by another pair of the same stacks, or by cells that do not exist."""
    known = {(a.first, a.second) for a in r.adjacencies}
    for k, a in _across(r):
        for j in r.stacks[r.cells[a.second].stack or 0].cells:
            if (a.first, j) not in known:
                other = put(r.adjacencies, k, second=j)
                yield partial(changed, r, adjacencies=other)
        yield partial(replace, r, adjacencies=put(r.adjacencies, k, second=len(r.cells) + 3))
        yield partial(replace, r, adjacencies=put(r.adjacencies, k, first=-1))


def segment_elsewhere(r: RegionMap) -> Iterator[Alteration]:
    """Short of the critical value, at the height of another pair, beyond the stacks, or outside of
    the window.
    """
    axis, other = r.slice.axes[r.base], r.slice.axes[1 - r.base]
    for k, a in _across(r):
        assert a.segment is not None
        u, w, v = a.segment
        others = [b.segment[2] for _, b in _across(r)
                  if b.segment and (b.first, b.second) != (a.first, a.second)
                  and r.cells[b.first].stack == r.cells[a.first].stack]  # fmt: skip
        for segment in ((u, u + (w - u) / 10**30, v), (w - (w - u) / 10**30, w, v), (w, u, v),
                        (u, axis.high + 1, v), (axis.low - 1, w, v), (u, w, other.high + 1),
                        (u, w, other.low), *((u, w, height) for height in others)):  # fmt: skip
            yield partial(replace, r, adjacencies=put(r.adjacencies, k, segment=segment))


def component_of_an_adjacency(r: RegionMap) -> Iterator[Alteration]:
    """None for a wall, another curve, or a curve where there is none; merges and regions follow."""
    for k, a in enumerate(r.adjacencies):
        for n in (None, *range(len(r.components))):
            if n != a.component:
                yield partial(changed, r, adjacencies=put(r.adjacencies, k, component=n))
        yield partial(replace, r, adjacencies=put(r.adjacencies, k, component=len(r.components)))


def merge_kind(r: RegionMap) -> Iterator[Alteration]:
    """Joined where counts differ or parted where they do not; the regions follow."""
    for k, a in enumerate(r.adjacencies):
        for kind in Merge:
            if kind is not a.merge:
                other = replace(r, adjacencies=put(r.adjacencies, k, merge=kind))
                yield partial(with_regions, other)


def non_adjacency_dropped(r: RegionMap) -> Iterator[Alteration]:
    for k in range(len(r.non_adjacencies)):
        yield partial(replace, r, non_adjacencies=drop(r.non_adjacencies, k))


def non_adjacency_twice(r: RegionMap) -> Iterator[Alteration]:
    for a in r.non_adjacencies:
        yield partial(replace, r, non_adjacencies=(*r.non_adjacencies, a))


def non_adjacency_invented(r: RegionMap) -> Iterator[Alteration]:
    """Of a pair that is stored as adjacent, whose adjacency is there or dropped."""
    for k, a in _across(r):
        record = NonAdjacency(
            r.cells[a.first].stack or 0, (a.first,), (a.second,), None, None, Reason.POINT
        )
        yield partial(replace, r, non_adjacencies=(*r.non_adjacencies, record))
        yield partial(_with_records, r, drop(r.adjacencies, k), (*r.non_adjacencies, record))


def non_adjacency_reason(r: RegionMap) -> Iterator[Alteration]:
    """A pair of half-branches for a single one, and an edge where there is none.

    That there is only one point of the curves may be true as well.
    """
    for k, a in enumerate(r.non_adjacencies):
        branches, edges = len(a.left) + len(a.right) - 2, (a.below is None) + (a.above is None)
        for reason, holds in (
            (Reason.PAIR, branches == 2 and not edges),
            (Reason.EDGE, branches == 1 and edges == 1),
        ):
            if not holds:
                yield partial(replace, r, non_adjacencies=put(r.non_adjacencies, k, reason=reason))


def non_adjacency_of_other_cells(r: RegionMap) -> Iterator[Alteration]:
    """One cell more or less on a side, or another critical value."""
    for k, a in enumerate(r.non_adjacencies):
        for changes in (
            {"left": a.left[:-1]}, {"left": (*a.left, a.left[-1] + 1)}, {"right": a.right[1:]},
            {"right": (*a.right[::-1], 0)}, {"left": ()}, {"critical_value": a.critical_value + 1},
        ):  # fmt: skip
            yield partial(replace, r, non_adjacencies=put(r.non_adjacencies, k, **changes))


def segment_of_a_non_adjacency(r: RegionMap) -> Iterator[Alteration]:
    """Missing, short of the critical value, or the other one."""
    for k, a in enumerate(r.non_adjacencies):
        for name, other in (("below", a.above), ("above", a.below)):
            old = getattr(a, name)
            if old is None:
                continue
            short = (old[0], old[0] + (old[1] - old[0]) / 10**30, old[2])
            for new in (None, short, other):
                if new is None and other is None:
                    continue
                if new is None and a.reason is Reason.POINT:
                    continue  # the record of an end that is no segment can be true
                yield partial(replace, r, non_adjacencies=put(r.non_adjacencies, k, **{name: new}))


def critical_value_dropped(r: RegionMap) -> Iterator[Alteration]:
    """With the stack beyond it; its neighbours' pairs follow from the pairs with its cells."""
    for s in range(1, len(r.stacks)):
        yield partial(_without_stack, r, s)


def _without_stack(r: RegionMap, s: int) -> RegionMap:
    gone = set(r.stacks[s].cells)
    more = composed(r, s - 1, s + 1, s) if s + 1 < len(r.stacks) else []
    left = replace(
        r, adjacencies=(*r.adjacencies, *more), critical_values=drop(r.critical_values, s - 1)
    )
    cells = [n for n in range(len(r.cells)) if n not in gone]
    return settled(renumbered_cells(left, drop(r.stacks, s), cells))


def regions_merged(r: RegionMap) -> Iterator[Alteration]:
    """Two regions are said to be one, or one is said to be another's part; adjacencies stay as they
    are.
    """
    for i, j in combinations(range(len(r.regions)), 2):
        labels = [c.region - (c.region > j) if c.region != j else i for c in r.cells]
        yield partial(with_regions, r, labels)


def region_split(r: RegionMap) -> Iterator[Alteration]:
    """One cell, or all cells of a stack, are said to be a region of their own."""
    for n, cell in enumerate(r.cells):
        if len(r.regions[cell.region].cells) > 1:
            labels = [len(r.regions) if k == n else c.region for k, c in enumerate(r.cells)]
            yield partial(with_regions, r, labels)


def cell_in_another_region(r: RegionMap) -> Iterator[Alteration]:
    for n, cell in enumerate(r.cells):
        for other in range(len(r.regions) + 1):
            if other != cell.region:
                yield partial(replace, r, cells=put(r.cells, n, region=other))


def regions_exchanged(r: RegionMap) -> Iterator[Alteration]:
    """The counts of two regions, or their cells, are exchanged."""
    for i, j in combinations(range(len(r.regions)), 2):
        a, b = r.regions[i], r.regions[j]
        for names in (("stable", "total", "index"), ("cells",), ("sample",)):
            one, two = ({n: getattr(x, n) for n in names} for x in (a, b))
            if one != two:
                yield partial(replace, r, regions=put(put(r.regions, i, **two), j, **one))


def counts_of_a_stored_region(r: RegionMap) -> Iterator[Alteration]:
    """Of the region alone: others, or said to vary where they do not."""
    for k, g in enumerate(r.regions):
        for name in ("stable", "total", "index"):
            old = getattr(g, name)
            wrong = (0, 0, 0) if name == "index" else 97
            for new in (None, wrong) if old is not None else (wrong,):
                yield partial(replace, r, regions=put(r.regions, k, **{name: new}))


def region_dropped(r: RegionMap) -> Iterator[Alteration]:
    for k in range(len(r.regions)):
        yield partial(replace, r, regions=drop(r.regions, k))


def _with_records(
    r: RegionMap, adjacencies: tuple[Adjacency, ...], records: tuple[NonAdjacency, ...]
) -> RegionMap:
    return replace(changed(r, adjacencies=adjacencies), non_adjacencies=records)


def _with_pairs_of_any_cells(r: RegionMap, adjacencies: tuple[Adjacency, ...]) -> RegionMap:
    """Settled but for the non-adjacencies, which only pairs of neighbouring stacks have."""
    return with_plan(with_regions(with_merges(replace(r, adjacencies=adjacencies))))


def records_of_all_gaps_without_pairs(r: RegionMap) -> Iterator[Alteration]:
    """All pairs over a critical value are replaced by one record that says that there is none."""
    for s in range(len(r.stacks) - 1):
        left = tuple(a for a in r.adjacencies if a.segment is None or r.cells[a.first].stack != s)
        for reason in Reason:
            records = (
                NonAdjacency(s, r.stacks[s].cells, r.stacks[s + 1].cells, None, None, reason),
            )
            others = tuple(a for a in r.non_adjacencies if a.critical_value != s)
            yield partial(_with_records, r, left, (*others, *records))


KINDS = (
    counts_of_a_cell, counts_and_boxes_of_a_cell, counts_of_a_region, counts_of_the_whole_map, one_count_alone,
    box_moved, box_beside_the_solution, box_stored_twice, boxes_that_meet, box_of_nothing, signs_exchanged,
    sign_of_a_solution, solutions_of_another_cell, adjacency_across_dropped, all_adjacencies_across_dropped,
    adjacency_in_a_stack_dropped, adjacency_twice, adjacency_invented, adjacency_with_other_ends, segment_elsewhere,
    component_of_an_adjacency, merge_kind, non_adjacency_dropped, non_adjacency_twice, non_adjacency_invented,
    non_adjacency_reason, non_adjacency_of_other_cells, segment_of_a_non_adjacency, critical_value_dropped,
    regions_merged, region_split, cell_in_another_region, regions_exchanged, counts_of_a_stored_region, region_dropped,
    records_of_all_gaps_without_pairs,
)  # fmt: skip
