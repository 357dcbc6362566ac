"""What a cover leaves free, found by a sweep: horizontal strips between the rectangles' edges and the gaps in them.

Guarantee: exact; all coordinates are integers or rationals. Two gaps in neighbouring strips are joined when the open
intervals overlap, because both strips' rectangles, being closed, block the line between the strips.

The engine finds the same by subdivision of the window.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from ptmcad.cover.rectangles import Cover, Rectangle

Interval = tuple[int, int]


@dataclass(slots=True)
class Sets:
    """Disjoint sets of numbers, which grow together."""

    parent: list[int]

    def add(self) -> int:
        self.parent.append(len(self.parent))
        return len(self.parent) - 1

    def top(self, n: int) -> int:
        while self.parent[n] != n:
            self.parent[n] = self.parent[self.parent[n]]
            n = self.parent[n]
        return n

    def join(self, one: int, two: int) -> None:
        one, two = self.top(one), self.top(two)
        self.parent[max(one, two)] = min(one, two)


@dataclass(frozen=True, slots=True)
class Sweep:
    """The strips from below with their gaps and blocks, both alternating and from the left.

    Attributes
    ----------
    lines : heights of the edges; strip k lies between lines k and k + 1.
    gaps : for each strip the open gaps (left, right, number), numbers being `top` ones of components.
    blocks : for each strip the closed blocks (left, right, number), numbers being those of clusters.
    areas : of the components.
    cluster_areas : of the clusters.
    touching : pairs (component, cluster) that share boundary points.
    """

    steps: int
    lines: tuple[int, ...]
    gaps: tuple[tuple[tuple[int, int, int], ...], ...]
    blocks: tuple[tuple[tuple[int, int, int], ...], ...]
    areas: dict[int, int]
    cluster_areas: dict[int, int]
    touching: frozenset[tuple[int, int]]

    def locate(self, u: Fraction, v: Fraction) -> int | None:
        """The component that a point of the open window lies in, None in a closed rectangle."""
        k = bisect_right(self.lines, v) - 1
        found = self._gap(k, u)
        if found is not None and v == self.lines[k] and k > 0:
            # on a line between strips: free only when it is in both
            return found if self._gap(k - 1, u) is not None else None
        return found

    def free_around(self, u: Fraction, v: Fraction, half: Fraction) -> bool:
        """Whether the closed square of this half width around a point is in one gap after the other."""
        if min(u, v) < half or max(u, v) + half > self.steps:
            return False
        first, last = bisect_left(self.lines, v - half), bisect_right(self.lines, v + half)
        # strips that the closed square meets, also along a line only
        for strip in range(max(first - 1, 0), min(last, len(self.gaps))):
            gaps = self.gaps[strip]
            k = bisect_left(gaps, u, key=_left) - 1
            if k < 0 or not (gaps[k][0] < u - half and u + half < gaps[k][1]):
                return False
        return True

    def _gap(self, strip: int, u: Fraction) -> int | None:
        gaps = self.gaps[strip]
        k = bisect_left(gaps, u, key=_left) - 1
        if k < 0:
            return None
        left, right, number = gaps[k]
        return number if left < u < right else None


def _left(gap: tuple[int, int, int]) -> Fraction:
    return Fraction(gap[0])


def sweep(cover: Cover) -> Sweep:
    """Sweep the window from below.

    Parameters
    ----------
    cover : whose rectangles lie in the window (`ptmcad.verification.certified.structure` checks it).
    """
    steps = cover.steps
    begin: dict[int, list[Rectangle]] = defaultdict(list)
    end: dict[int, list[Rectangle]] = defaultdict(list)
    for rectangle in cover.rectangles:
        begin[rectangle[2]].append(rectangle)
        end[rectangle[3]].append(rectangle)
    lines = sorted({0, steps, *begin, *end})
    free, full = Sets([]), Sets([])
    free_area: dict[int, int] = defaultdict(int)
    full_area: dict[int, int] = defaultdict(int)
    pairs: set[tuple[int, int]] = set()
    gap_rows: list[list[tuple[int, int, int]]] = []
    block_rows: list[list[tuple[int, int, int]]] = []
    active: list[Interval] = []
    for low, high in pairwise(lines):
        for left, right, _, _ in end[low]:
            del active[bisect_left(active, (left, right))]
        for left, right, _, _ in begin[low]:
            insort(active, (left, right))
        blocks = [(a, b, full.add()) for a, b in _merged(active)]
        gaps = [(a, b, free.add()) for a, b in _between(blocks, steps)]
        for a, b, n in gaps:
            free_area[n] = (b - a) * (high - low)
        for a, b, n in blocks:
            full_area[n] = (b - a) * (high - low)
        pairs.update(_meeting(gaps, blocks, closed=True))
        if gap_rows:
            for one, two in _meeting(gap_rows[-1], gaps, closed=False):
                free.join(one, two)
            for one, two in _meeting(block_rows[-1], blocks, closed=True):
                full.join(one, two)
            pairs.update(_meeting(gap_rows[-1], blocks, closed=True))
            pairs.update((gap, block) for block, gap in _meeting(block_rows[-1], gaps, closed=True))
        gap_rows.append(gaps)
        block_rows.append(blocks)
    areas: dict[int, int] = defaultdict(int)
    for n, area in free_area.items():
        areas[free.top(n)] += area
    cluster_areas: dict[int, int] = defaultdict(int)
    for n, area in full_area.items():
        cluster_areas[full.top(n)] += area
    return Sweep(
        steps,
        tuple(lines),
        tuple(tuple((a, b, free.top(n)) for a, b, n in row) for row in gap_rows),
        tuple(tuple((a, b, full.top(n)) for a, b, n in row) for row in block_rows),
        dict(areas),
        dict(cluster_areas),
        frozenset((free.top(gap), full.top(block)) for gap, block in pairs),
    )


def _merged(active: list[Interval]) -> Iterator[Interval]:
    """The union of sorted closed intervals, as disjoint ones."""
    current: Interval | None = None
    for left, right in active:
        if current is None:
            current = (left, right)
        elif left <= current[1]:
            current = (current[0], max(current[1], right))
        else:
            yield current
            current = (left, right)
    if current is not None:
        yield current


def _between(blocks: list[tuple[int, int, int]], steps: int) -> Iterator[Interval]:
    """The open intervals that blocks leave of (0, steps)."""
    edge = 0
    for left, right, _ in blocks:
        if left > edge:
            yield edge, left
        edge = right
    if edge < steps:
        yield edge, steps


def _meeting(
    one: list[tuple[int, int, int]], two: list[tuple[int, int, int]], closed: bool
) -> Iterator[tuple[int, int]]:
    """Pairs of numbers of intervals, sorted in both lists, that overlap; or have an end in common when ``closed``."""
    j = 0
    for a, b, n in one:
        while j < len(two) and (two[j][1] < a or (not closed and two[j][1] == a)):
            j += 1
        k = j
        while k < len(two) and (two[k][0] < b or (closed and two[k][0] == b)):
            yield n, two[k][2]
            k += 1
