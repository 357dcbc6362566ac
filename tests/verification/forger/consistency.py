"""What follows from the claims of an exact map: merges, regions, records of cells that are not
adjacent, and the plan.

An altered map is *settled* when all of these follow from its cells, walls, adjacencies and
components, be they true or not. The area of a region that the true map does not have is said to be
between nothing and the window's, which no check of areas can refute.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import count, pairwise
from typing import Any

from support.replacing import replace

from ptmcad.answer.regionmap import (
    Adjacency,
    Cell,
    Merge,
    NonAdjacency,
    PlanStep,
    Reason,
    Region,
    RegionMap,
    Stack,
)
from ptmcad.exact.exactplan import plan_of
from ptmcad.question.slice import Count

Alteration = Callable[[], RegionMap]
Kind = Callable[[RegionMap], Iterator[Alteration]]

KEYS = {Count.STABLE: "stable", Count.TOTAL: "total", Count.INDEX: "index"}
NO_AREAS = PlanStep("areas of the regions", False, "not asked for")


def put(items: Sequence[Any], k: int, **changes: object) -> tuple[Any, ...]:
    """The items with the k-th one altered."""
    return (*items[:k], replace(items[k], **changes), *items[k + 1 :])


def swapped(items: Sequence[Any], j: int, k: int) -> tuple[Any, ...]:
    """The items with two of them exchanged."""
    found = list(items)
    found[j], found[k] = found[k], found[j]
    return tuple(found)


def drop(items: Sequence[Any], k: int) -> tuple[Any, ...]:
    """The items without the k-th one."""
    return (*items[:k], *items[k + 1 :])


def window_area(r: RegionMap) -> Fraction:
    """The area of the window."""
    x, y = r.slice.axes
    return (x.high - x.low) * (y.high - y.low)


def settled(r: RegionMap) -> RegionMap:
    """The map with merges, regions, separating components, non-adjacencies and plan as the rest
    asks for.
    """
    return with_plan(with_regions(with_merges(with_non_adjacencies(r))))


def changed(r: RegionMap, **changes: Any) -> RegionMap:
    """The map with other entries, settled."""
    return settled(replace(r, **changes))


def with_merges(r: RegionMap) -> RegionMap:
    """The kind of each adjacency, and which components separate."""
    key = KEYS.get(r.slice.count, "stable")
    found, separating = [], set()
    for a in r.adjacencies:
        equal = getattr(r.cells[a.first], key) == getattr(r.cells[a.second], key)
        kind = (
            Merge.PROVEN if a.component is None else Merge.EQUAL_COUNT if equal else Merge.SEPARATED
        )
        if kind is Merge.SEPARATED:
            separating.add(a.component)
        found.append(replace(a, merge=kind))
    components = tuple(replace(c, separates=n in separating) for n, c in enumerate(r.components))
    return replace(r, adjacencies=tuple(found), components=components)


def labels_of(r: RegionMap) -> list[int]:
    """The region of each cell, numbered by their first cells."""
    label = list(range(len(r.cells)))

    def root(n: int) -> int:
        while label[n] != n:
            n = label[n]
        return n

    for a in r.adjacencies:
        if a.merge is not Merge.SEPARATED:
            one, two = sorted((root(a.first), root(a.second)))
            label[two] = one
    numbers: dict[int, int] = {}
    return [numbers.setdefault(root(n), len(numbers)) for n in range(len(r.cells))]


def with_regions(r: RegionMap, labels: Sequence[int] | None = None) -> RegionMap:
    """The partition that the adjacencies make, or a given one, with its counts; known areas for
    known regions.
    """
    labels = labels_of(r) if labels is None else labels
    areas = {
        frozenset(tuple(r.cells[n].sample) for n in g.cells if n < len(r.cells)): g.area
        for g in r.regions
    }
    regions = []
    for number in range(max(labels) + 1):
        cells = tuple(n for n, label in enumerate(labels) if label == number)
        members = [r.cells[n] for n in cells]
        key = frozenset(tuple(c.sample) for c in members)
        common: dict[str, Any] = {
            name: _common(members, name) for name in ("stable", "total", "index")
        }
        area = areas.get(key, (Fraction(0), window_area(r)))
        if NO_AREAS in r.plan:
            area = (Fraction(0), window_area(r))
        regions.append(Region(area=area, cells=cells, sample=members[0].sample, **common))
    labelled = tuple(replace(c, region=label) for c, label in zip(r.cells, labels, strict=True))
    return replace(r, cells=labelled, regions=tuple(regions))


def _common(members: Sequence[Cell], name: str) -> Any:
    values = {getattr(c, name) for c in members}
    return values.pop() if len(values) == 1 else None


def with_non_adjacencies(r: RegionMap) -> RegionMap:
    """The records that the stored pairs ask for: those that are there, and new ones with the reason
    that fits best.
    """
    known = {(a.critical_value, a.left, a.right): a for a in r.non_adjacencies}
    found = []
    for s in range(len(r.stacks) - 1):
        left, right = r.stacks[s].cells, r.stacks[s + 1].cells
        chain = sorted(
            (r.cells[a.first].level, r.cells[a.second].level, a.segment)
            for a in r.adjacencies
            if a.segment is not None and r.cells[a.first].stack == s
        )
        ends = [(0, 0, None), *chain, (len(left) - 1, len(right) - 1, None)]
        for (l0, r0, below), (l1, r1, above) in pairwise(ends):
            if (l0, r0) == (l1, r1) or l1 < l0 or r1 < r0:
                continue
            here, there = left[l0 : l1 + 1], right[r0 : r1 + 1]
            old = known.get((s, here, there))
            branches, edges = l1 - l0 + r1 - r0, (below is None) + (above is None)
            reason = Reason.PAIR if branches == 2 and not edges else Reason.POINT
            reason = Reason.EDGE if branches == 1 and edges == 1 else reason
            found.append(old or NonAdjacency(s, here, there, below, above, reason))
    return replace(r, non_adjacencies=tuple(found))


def with_plan(r: RegionMap) -> RegionMap:
    """The plan that goes with slice and components; the reason for the base axis is the true map's."""
    steps = plan_of(r.slice, r.components, r.base, (1, 2), frozenset(), NO_AREAS not in r.plan)
    old = next(
        (step.reason for step in r.plan if "predicted" in step.reason), "predicted cost 1 against 2"
    )
    return replace(
        r, plan=tuple(replace(s, reason=old) if "predicted" in s.reason else s for s in steps)
    )


def renumbered_cells(
    r: RegionMap, stacks: Sequence[Stack], kept_cells: Sequence[int | Cell]
) -> RegionMap:
    """The map with other stacks and cells, given as old numbers or new cells in the new order.

    Adjacencies between cells that are gone are gone; those of new cells have to be added.
    """
    new_of = {old: new for new, old in enumerate(kept_cells) if isinstance(old, int)}
    numbers, fresh, cells = count(), [], []
    for s, stack in enumerate(stacks):
        own = tuple(next(numbers) for _ in range(len(stack.walls) + 1))
        last = len(stacks) - 1
        fresh.append(
            replace(stack, cells=own, left=s - 1 if s else None, right=s if s < last else None)
        )
        for level, n in enumerate(own):
            source = kept_cells[n]
            cell = r.cells[source] if isinstance(source, int) else source
            cells.append(replace(cell, stack=s, level=level))
    adjacencies = tuple(
        replace(a, first=new_of[a.first], second=new_of[a.second])
        for a in r.adjacencies
        if a.first in new_of and a.second in new_of
    )
    return replace(
        r, stacks=tuple(fresh), cells=tuple(cells), adjacencies=adjacencies, non_adjacencies=()
    )


def renumbered_components(r: RegionMap, order: Sequence[int]) -> RegionMap:
    """The map with its components in another order; ``order`` holds their old numbers."""
    new_of = {old: new for new, old in enumerate(order)}
    return replace(
        r,
        components=tuple(r.components[old] for old in order),
        critical_values=tuple(
            replace(v, origin=_renamed(v.origin, new_of)) for v in r.critical_values
        ),
        stacks=tuple(
            replace(s, walls=tuple(replace(w, component=new_of[w.component]) for w in s.walls))
            for s in r.stacks
        ),
        adjacencies=tuple(
            a if a.component is None else replace(a, component=new_of[a.component])
            for a in r.adjacencies
        ),
    )


def _renamed(origin: str, new_of: Mapping[int, int]) -> str:
    """An origin with other numbers of components."""
    words = origin.split(" ")
    if words[0] == "component":
        return f"component {new_of[int(words[1][:-1])]}: {' '.join(words[2:])}"
    if words[0] == "components":
        one, two = sorted((new_of[int(words[1])], new_of[int(words[3])]))
        return f"components {one} and {two} meet"
    return origin


def composed(r: RegionMap, one: int, three: int, two: int) -> list[Adjacency]:
    """Pairs of cells of stacks one and three that have a neighbour in stack two, which is to go, in
    common.
    """
    found: dict[tuple[int, int], Adjacency] = {}
    across = [a for a in r.adjacencies if a.segment is not None]
    for a in across:
        for b in across:
            if (
                r.cells[a.first].stack == one
                and r.cells[b.second].stack == three
                and a.second == b.first
            ):
                assert a.segment is not None
                assert b.segment is not None
                assert r.cells[a.second].stack == two
                segment = (a.segment[0], b.segment[1], a.segment[2])
                found.setdefault((a.first, b.second), replace(a, second=b.second, segment=segment))
    return list(found.values())
