"""What a cover leaves free, found by a sweep: gaps and blocks, strip by strip.

Guarantee: exact. All coordinates are integers or rationals.

From strip to strip gaps and blocks go on, but between the first and the last rectangle that begins
or ends: what is new there is joined with what was there.

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
from typing import NamedTuple

from ptmcad.cover.rectangles import Cover

Entry = tuple[int, int]
"""Of a rectangle: left, right."""
Span = tuple[int, int, bool]
"""Of a gap or a block: left, right, and whether it is free."""

_left, _right = attrgetter("left"), attrgetter("right")


class Item(NamedTuple):
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
    sets, touching = _Sets(), set[tuple[int, int]]()
    active, rows = list[Entry](), list[tuple[Item, ...]]()
    row: tuple[Item, ...] = ()
    ends: list[tuple[tuple[Item, ...], int]] = []
    for low in lines[:-1]:
        for entry in end[low]:
            del active[bisect_left(active, entry)]
        for entry in begin[low]:
            insort(active, entry)
        if row:
            changed = [*end[low], *begin[low]]
            first, last = _meeting(row, min(changed)[0], max(right for _, right in changed))
            left, right = row[first].left, row[last - 1].right
        else:
            first, last, left, right = 0, 0, 0, cover.steps
        inner = active[bisect_left(active, (left,)) : bisect_left(active, (right,))]
        new = tuple(Item(*span, sets.added()) for span in _gaps_and_blocks(inner, left, right))
        old, row = row[first:last], row[:first] + new + row[last:]
        ends += [(old, low), (new, -low)]
        rows.append(row)
        met = [*pairwise(row[max(first - 1, 0) : first + len(new) + 1])]
        for one in new:
            met += [(one, two) for two in old[slice(*_meeting(old, one.left, one.right))]]
        for one, two in met:
            if one.free != two.free:
                touching.add((one.node, two.node) if one.free else (two.node, one.node))
            elif not one.free or max(one.left, two.left) < min(one.right, two.right):
                sets.join(one.node, two.node)
    component_of = tuple(map(sets.top, range(len(sets.parent))))
    free_areas: dict[int, int] = defaultdict(int)
    cluster_areas: dict[int, int] = defaultdict(int)
    # below its upper end, less below its lower one
    for items, height in (*ends, (row, cover.steps)):
        for item in items:
            areas = free_areas if item.free else cluster_areas
            areas[component_of[item.node]] += (item.right - item.left) * height
    return CoverSweep(
        cover.steps,
        tuple(lines),
        tuple(rows),
        component_of,
        dict(free_areas),
        dict(cluster_areas),
        frozenset((component_of[a], component_of[b]) for a, b in touching),
    )


class _Sets:
    """Disjoint sets of numbers that grow together."""

    def __init__(self) -> None:
        self.parent: list[int] = []

    def added(self) -> int:
        self.parent.append(len(self.parent))
        return len(self.parent) - 1

    def top(self, n: int) -> int:
        parent = self.parent
        while parent[n] != n:
            parent[n] = parent[parent[n]]
            n = parent[n]
        return n

    def join(self, one: int, two: int) -> None:
        tops = self.top(one), self.top(two)
        self.parent[max(tops)] = min(tops)


def _meeting(row: Sequence[Item], left: int, right: int) -> tuple[int, int]:
    """The items of a strip that meet a closed interval: from which one to before which one."""
    return bisect_left(row, left, key=_right), bisect_right(row, right, key=_left)


def _gaps_and_blocks(active: Sequence[Entry], start: int, end: int) -> Iterator[Span]:
    """A part of a strip from the left."""
    blocks: list[list[int]] = []
    for left, right in active:
        if blocks and left <= blocks[-1][1]:
            blocks[-1][1] = max(blocks[-1][1], right)
        else:
            blocks.append([left, right])
    at = start
    for left, right in blocks:
        if left > at:
            yield at, left, True
        yield left, right, False
        at = right
    if at < end:
        yield at, end, True
