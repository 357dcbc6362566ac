"""What a cover leaves free, found by a sweep: gaps and blocks, strip by strip.

Guarantee: exact. All coordinates are integers or rationals.

From strip to strip gaps and blocks go on, but in zones in which rectangles begin or end, with what
touches these: what is new there is joined with what was there.

The engine finds the same by subdivision of the window.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from operator import attrgetter

from ptmcad.cover.rectangles import Cover

Entry = tuple[int, int]
"""Of a rectangle: left, right."""


_left, _right = attrgetter("left"), attrgetter("right")


@dataclass(frozen=True, slots=True)
class Item:
    """A gap or a block of a strip, with its node."""

    left: int
    right: int
    free: bool
    node: int


@dataclass(frozen=True, slots=True)
class CoverSweep:
    """The strips from below with what is in them, from the left.

    Attributes
    ----------
    lines : heights of the edges; strip k lies between lines k and k + 1.
    component_of : of each node its component or, of closed ones, its cluster: what closed blocks
        that meet are together.
    areas, cluster_areas : of components and of clusters.
    touching : pairs (component, cluster) that share boundary points.
    """

    steps: int
    lines: tuple[int, ...]
    rows: tuple[tuple[Item, ...], ...]
    component_of: tuple[int, ...]
    areas: dict[int, int]
    cluster_areas: dict[int, int]
    touching: frozenset[tuple[int, int]]

    def locate(self, u: Fraction, v: Fraction) -> int | None:
        """The component of a point; None where it is in the cover, or not in the open window."""
        if min(u, v) <= 0 or max(u, v) >= self.steps:
            return None
        found = {
            self.component_of[item.node] if item.free else None
            for item in self._items((u, v), (u, v))
        }
        return found.pop() if len(found) == 1 else None

    def free_around(self, u: Fraction, v: Fraction, half: Fraction) -> bool:
        """Whether the closed square of this half width around a point is free."""
        if min(u, v) < half or max(u, v) + half > self.steps:
            return False
        return all(item.free for item in self._items((u - half, v - half), (u + half, v + half)))

    def _items(
        self, low: tuple[Fraction, Fraction], high: tuple[Fraction, Fraction]
    ) -> Iterator[Item]:
        """What of the strips a closed rectangle meets."""
        first, last = bisect_left(self.lines, low[1]) - 1, bisect_right(self.lines, high[1])
        for row in self.rows[max(first, 0) : max(last, 0)]:
            k = max(bisect_left(row, low[0], key=_right), 0)
            while k < len(row) and row[k].left <= high[0]:
                yield row[k]
                k += 1


def sweep(cover: Cover) -> CoverSweep:
    """Sweep the window from below.

    Parameters
    ----------
    cover : whose rectangles lie in the window (`ptmcad.verification.certified.coverclaims` checks
        it).
    """
    begin: dict[int, list[Entry]] = defaultdict(list)
    end: dict[int, list[Entry]] = defaultdict(list)
    for left, right, bottom, top in cover.rectangles:
        begin[bottom].append((left, right))
        end[top].append((left, right))
    lines = sorted({0, cover.steps, *begin, *end})
    found = _Strips(cover.steps)
    active: list[Entry] = []
    for low in lines[:-1]:
        for entry in end[low]:
            del active[bisect_left(active, entry)]
        for entry in begin[low]:
            insort(active, entry)
        found.add(low, [*end[low], *begin[low]], active)
    return found.result(tuple(lines))


class _Strips:
    """The strips so far, and their gaps and blocks as disjoint sets that grow together, with what is
    known of their areas.
    """

    def __init__(self, steps: int) -> None:
        self._steps = steps
        self._parent: list[int] = []
        self._free: list[bool] = []
        self._areas: list[int] = []
        self._pairs: set[tuple[int, int]] = set()
        self._rows: list[tuple[Item, ...]] = []
        self._row: list[Item] = []

    def add(self, low: int, changed: Sequence[Entry], active: list[Entry]) -> None:
        """The strip above a line.

        Parameters
        ----------
        changed : what ends or begins at the line.
        active : all that is in the strip, sorted.
        """
        row = self._row
        # from the right, so that the numbers of what is left of a zone stay
        for first, last in reversed(_zones(changed, row)) if row else [(0, 0)]:
            old = row[first:last]
            left, right = (old[0].left, old[-1].right) if old else (0, self._steps)
            inner = active[bisect_left(active, (left,)) : bisect_left(active, (right,))]
            new = [
                Item(a, b, free, self._added(free, -(b - a) * low))
                for a, b, free in _gaps_and_blocks(inner, left, right)
            ]
            self._grow(old, low)
            for one, two in pairwise(
                [*row[max(first - 1, 0) : first], *new, *row[last : last + 1]]
            ):
                self._meet(one, two, along=True)
            for one, two in _touching(old, new):
                self._meet(one, two, along=max(one.left, two.left) < min(one.right, two.right))
            row[first:last] = new
        self._rows.append(tuple(row))

    def _added(self, free: bool, area: int) -> int:
        self._parent.append(len(self._parent))
        self._free.append(free)
        self._areas.append(area)
        return len(self._parent) - 1

    def _top(self, n: int) -> int:
        parent = self._parent
        while parent[n] != n:
            parent[n] = parent[parent[n]]
            n = parent[n]
        return n

    def _meet(self, one: Item, two: Item, *, along: bool) -> None:
        """Two items touch: along an edge, or in a corner."""
        if one.free != two.free:
            self._pairs.add((one.node, two.node) if one.free else (two.node, one.node))
        elif along or not one.free:
            tops = self._top(one.node), self._top(two.node)
            self._parent[max(tops)] = min(tops)

    def _grow(self, items: Sequence[Item], height: int) -> None:
        """Items end at a line: their areas are those below it, less what is below their beginning."""
        for item in items:
            self._areas[item.node] += (item.right - item.left) * height

    def result(self, lines: tuple[int, ...]) -> CoverSweep:
        """All of it, once the last strip is there."""
        self._grow(self._row, self._steps)
        component_of = tuple(map(self._top, self._parent))
        areas: dict[int, int] = defaultdict(int)
        cluster_areas: dict[int, int] = defaultdict(int)
        for top, is_free, area in zip(component_of, self._free, self._areas, strict=True):
            (areas if is_free else cluster_areas)[top] += area
        return CoverSweep(
            self._steps,
            lines,
            tuple(self._rows),
            component_of,
            dict(areas),
            dict(cluster_areas),
            frozenset((component_of[a], component_of[b]) for a, b in self._pairs),
        )


def _zones(changed: Sequence[Entry], row: Sequence[Item]) -> list[tuple[int, int]]:
    """The items of a strip that changes meet, as disjoint parts: from which one to before which
    one, from the left.
    """
    found: list[tuple[int, int]] = []
    met = (
        (bisect_left(row, left, key=_right), bisect_right(row, right, key=_left))
        for left, right in changed
    )
    for zone in sorted(met):
        before = found.pop() if found and zone[0] <= found[-1][1] else zone
        found.append((before[0], max(before[1], zone[1])))
    return found


def _gaps_and_blocks(
    active: Sequence[Entry], start: int, end: int
) -> Iterator[tuple[int, int, bool]]:
    """A part of a strip from the left: ends, and whether it is free."""
    at = start
    block: Entry | None = None
    for left, right in active:
        if block is not None and left <= block[1]:
            block = block[0], max(block[1], right)
            continue
        if block is not None:
            yield *block, False
            at = block[1]
        if left > at:
            yield at, left, True
        block = left, right
    if block is not None:
        yield *block, False
        at = block[1]
    if at < end:
        yield at, end, True


def _touching(below: Sequence[Item], above: Sequence[Item]) -> Iterator[tuple[Item, Item]]:
    """Pairs of items of neighbouring strips whose closed intervals meet."""
    j = 0
    for one in below:
        while j < len(above) and above[j].right < one.left:
            j += 1
        k = j
        while k < len(above) and above[k].left <= one.right:
            yield one, above[k]
            k += 1
