"""What a cover leaves free, found by a sweep: gaps, blocks and frames of slanted pieces, strip by
strip.

Guarantee: what is said to be connected is so, and bounds of areas hold; without slanted pieces they
are exact. All coordinates are integers or rationals.

From strip to strip gaps and blocks go on, but in zones in which rectangles begin or end, with what
touches these: what is new there is joined with what was there. Beside frames all begin anew, as
frames' sides change with the height.

The engine finds the same by subdivision of the window.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from ptmcad.cover.rectangles import Cover
from ptmcad.verification.certified.slantedframes import Part, SlantedFrame
from ptmcad.verification.report import Violation

Entry = tuple[int, int, int]
"""Of a rectangle or a frame: left, right, and the frame's number; -1 for a rectangle."""


@dataclass(frozen=True, slots=True)
class Item:
    """Something of a strip from left to right: a gap or a block with its node, or a frame."""

    left: int
    right: int
    free: bool
    node: int
    frame: int = -1


@dataclass(frozen=True, slots=True)
class CoverSweep:
    """The strips from below with what is in them, from the left.

    Attributes
    ----------
    lines : heights of the edges; strip k lies between lines k and k + 1.
    component_of : of each node its component or, of closed ones, its cluster: what closed blocks
        that meet are together.
    first_part : of each frame the node of the part below its tubes.
    areas : of components, at most; cluster_areas : at least.
    touching : pairs (component, cluster) that share boundary points.
    """

    steps: int
    lines: tuple[int, ...]
    rows: tuple[tuple[Item, ...], ...]
    frames: tuple[SlantedFrame, ...]
    component_of: tuple[int, ...]
    first_part: tuple[int, ...]
    areas: dict[int, Fraction]
    cluster_areas: dict[int, Fraction]
    touching: frozenset[tuple[int, int]]

    def locate(self, u: Fraction, v: Fraction) -> int | None:
        """The component of a point of the open window; None where it is in the cover, or on a
        frame's side.
        """
        found = {self._at(item, u, v) for item in self._items((u, v), (u, v))}
        return found.pop() if len(found) == 1 else None

    def _at(self, item: Item, u: Fraction, v: Fraction) -> int | None:
        if item.frame < 0:
            return self.component_of[item.node] if item.free else None
        frame = self.frames[item.frame]
        number = frame.place(u, v) if frame.patch.along == 0 else frame.place(v, u)
        return None if number is None else self.component_of[self.first_part[item.frame] + number]

    def free_around(self, u: Fraction, v: Fraction, half: Fraction) -> bool:
        """Whether the closed square of this half width around a point is free."""
        if min(u, v) < half or max(u, v) + half > self.steps:
            return False
        low, high = (u - half, v - half), (u + half, v + half)
        return all(
            item.free if item.frame < 0 else self.frames[item.frame].avoids(low, high)
            for item in self._items(low, high)
        )

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


def _right(item: Item) -> Any:
    return item.right


def sweep(cover: Cover) -> CoverSweep:
    """Sweep the window from below.

    Parameters
    ----------
    cover : whose rectangles lie in the window (`ptmcad.verification.certified.coverclaims` checks
        it).

    Raises
    ------
    Violation
        When a patch is none, or a frame meets something else.
    """
    begin: dict[int, list[Entry]] = defaultdict(list)
    end: dict[int, list[Entry]] = defaultdict(list)
    pieces = [(r, -1) for r in cover.rectangles] + [
        (patch.frame, k) for k, patch in enumerate(cover.patches)
    ]
    for (left, right, bottom, top), number in pieces:
        begin[bottom].append((left, right, number))
        end[top].append((left, right, number))
    lines = sorted({0, cover.steps, *begin, *end})
    found = _Strips(cover)
    active: list[Entry] = []
    for low, high in pairwise(lines):
        for entry in end[low]:
            del active[bisect_left(active, entry)]
        for entry in begin[low]:
            insort(active, entry)
        found.add(low, high, [*end[low], *begin[low]], active)
    return found.result(tuple(lines))


class _Strips:
    """The strips so far, and how what is in them hangs together: disjoint sets of gaps and blocks,
    which grow together, with what is known of their areas.
    """

    def __init__(self, cover: Cover) -> None:
        self._steps = cover.steps
        self._frames = tuple(SlantedFrame(patch, k) for k, patch in enumerate(cover.patches))
        self._parent: list[int] = []
        self._free: list[bool] = []
        self._areas: list[Fraction | int] = []
        self._first_part: list[int] = []
        self._first_tube: list[int] = []
        self._pairs: set[tuple[int, int]] = set()
        self._rows: list[tuple[Item, ...]] = []
        self._row: list[Item] = []
        for frame in self._frames:
            self._add_frame(frame)

    def _add_node(self, free: bool, area: Fraction | int) -> int:
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

    def _join(self, one: int, two: int) -> None:
        one, two = self._top(one), self._top(two)
        self._parent[max(one, two)] = min(one, two)

    def _add_frame(self, frame: SlantedFrame) -> None:
        first = len(self._free)
        for area in frame.parts:
            self._add_node(True, area)
        tube = len(self._free)
        self._first_part.append(first)
        self._first_tube.append(tube)
        rest = (frame.high - frame.low) * (frame.top - frame.bottom) - sum(frame.parts)
        for k in range(len(frame.centers)):
            # all of what no part has is the first one's: where tubes are not in one cluster the
            # rest is at least 0
            self._add_node(False, max(rest, 0) if k == 0 and len(frame.centers) == 1 else 0)
            for part in (first + k, first + k + 1):
                if self._areas[part] >= 1:
                    self._pairs.add((part, tube + k))

    def add(self, low: int, high: int, changed: Sequence[Entry], active: list[Entry]) -> None:
        """The strip between two lines.

        Parameters
        ----------
        changed : what ends or begins at the lower one.
        active : all that is in the strip, sorted.
        """
        row = self._row
        whole = self._frames or not row
        # from the right, so that the numbers of what is left of a zone stay
        for first, last in [(0, len(row))] if whole else reversed(_zones(changed, row)):
            old = row[first:last]
            bottom, top = (old[0].left, old[-1].right) if old else (0, self._steps)
            inner = active[bisect_left(active, (bottom,)) : bisect_left(active, (top,))]
            new = [self._new_item(entry, low) for entry in _row(inner, bottom, top)]
            self._grow(old, low)
            beside = [*row[max(first - 1, 0) : first], *new, *row[last : last + 1]]
            for one, two in pairwise(beside):
                ends = low, high
                self._meet(self._parts(one, 0, 1, ends), self._parts(two, 0, 0, ends), *ends)
            self._meet_below(old, new, low)
            row[first:last] = new
        self._rows.append(tuple(row))

    def _new_item(self, entry: tuple[int, int, bool, int], low: int) -> Item:
        left, right, free, number = entry
        node = -1 if number >= 0 else self._add_node(free, -(right - left) * low)
        return Item(left, right, free, node, number)

    def _meet_below(self, old: Sequence[Item], new: Sequence[Item], line: int) -> None:
        for one, two in _touching(old, new):
            # what a frame that goes on across the line meets there, it meets along its upright
            # sides in one strip
            if not self._frames or (
                _ends(one, self._frames, line, 3) and _ends(two, self._frames, line, 2)
            ):
                self._meet(
                    self._parts(one, 1, 1, (one.left, one.right)),
                    self._parts(two, 1, 0, (two.left, two.right)),
                    max(one.left, two.left),
                    min(one.right, two.right),
                )

    def _meet(
        self,
        below: Sequence[Part],
        above: Sequence[Part],
        low: Fraction | int,
        high: Fraction | int,
    ) -> None:
        for a, b, open_one, one in below:
            for c, d, open_two, two in above:
                start, stop = max(a, c, low), min(b, d, high)
                if open_one and open_two:
                    if start < stop:
                        self._join(one, two)
                elif start <= stop:
                    if open_one == open_two:
                        self._join(one, two)
                    else:
                        self._pairs.add((one, two) if open_one else (two, one))

    def _parts(self, item: Item, axis: int, side: int, ends: tuple[int, int]) -> Sequence[Part]:
        if item.frame < 0:
            return ((*ends, item.free, item.node),)
        return [
            (a, b, is_open, (self._first_part if is_open else self._first_tube)[item.frame] + n)
            for a, b, is_open, n in self._frames[item.frame].side(axis, side)
        ]

    def _grow(self, items: Sequence[Item], height: int) -> None:
        """What begins or ends at a line: of areas what is below the line is taken off, or added."""
        for item in items:
            if item.frame < 0:
                self._areas[item.node] += (item.right - item.left) * height

    def result(self, lines: tuple[int, ...]) -> CoverSweep:
        """All of it, once the last strip is there."""
        self._grow(self._row, self._steps)
        component_of = tuple(map(self._top, self._parent))
        areas: dict[int, Fraction] = defaultdict(Fraction)
        cluster_areas: dict[int, Fraction] = defaultdict(Fraction)
        for n, is_free in enumerate(self._free):
            (areas if is_free else cluster_areas)[component_of[n]] += self._areas[n]
        return CoverSweep(
            self._steps,
            lines,
            tuple(self._rows),
            self._frames,
            component_of,
            tuple(self._first_part),
            {n: area for n, area in areas.items() if area > 0},
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
        for left, right, _ in changed
    )
    for zone in sorted(met):
        before = found.pop() if found and zone[0] <= found[-1][1] else zone
        found.append((before[0], max(before[1], zone[1])))
    return found


def _left(item: Item) -> Any:
    return item.left


def _ends(item: Item, frames: Sequence[SlantedFrame], line: int, side: int) -> bool:
    """Whether an item has its bottom (side 2) or its top (3) on the line between two strips."""
    return item.frame < 0 or frames[item.frame].patch.frame[side] == line


def _row(active: list[Entry], bottom: int, top: int) -> Iterator[tuple[int, int, bool, int]]:
    """Gaps, blocks and frames of a part of a strip: left, right, whether it is free, the frame's
    number or -1.

    Raises
    ------
    Violation
        When a frame overlaps something.
    """
    at = bottom
    block: tuple[int, int] | None = None
    for left, right, number in [*active, (top, top, -2)]:
        if block is not None and (number != -1 or left > block[1]):
            yield *block, False, -1
            at, block = block[1], None
        if number == -1:
            if block is None and left < at:
                raise Violation("a slanted piece's frame meets a rectangle")
            if block is None and left > at:
                yield at, left, True, -1
            block = (left, right) if block is None else (block[0], max(block[1], right))
            continue
        if left < at:
            raise Violation("a slanted piece's frame meets another one, or a rectangle")
        if left > at:
            yield at, left, True, -1
        if number >= 0:
            yield left, right, False, number
        at = right


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
