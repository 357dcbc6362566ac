"""What a cover leaves free, found by a sweep: horizontal strips between the rectangles' edges and the gaps in them.

Guarantee: exact; all coordinates are integers or rationals. Two gaps in neighbouring strips are joined when the open
intervals overlap, because both strips' rectangles, being closed, block the line between the strips.

From strip to strip gaps and blocks go on, each with its number, but in zones of blocks that beginning or ending
rectangles meet, with the gaps on both sides of these: what is new there is joined with what was there.

The engine finds the same by subdivision of the window.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.cover.rectangles import Cover, Rectangle

Interval = tuple[int, int]
Part = tuple[int, int, int]
"""A gap or a block: left, right, and its number."""


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
    """The strips from below with their gaps, from the left.

    Attributes
    ----------
    lines : heights of the edges; strip k lies between lines k and k + 1.
    gaps : for each strip the open gaps (left, right, number), numbers being `top` ones of components.
    areas : of the components.
    cluster_areas : of the clusters, which are what closed blocks that meet are together.
    touching : pairs (component, cluster) that share boundary points.
    """

    steps: int
    lines: tuple[int, ...]
    gaps: tuple[tuple[Part, ...], ...]
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


def _left(gap: Part) -> Fraction:
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
    free, full, pairs = _Parts(), _Parts(), set[tuple[int, int]]()
    rows: list[list[Part]] = []
    gaps: list[Part] = []
    blocks: list[Part] = []
    active: list[Interval] = []
    for low in lines[:-1]:
        for left, right, _, _ in end[low]:
            del active[bisect_left(active, (left, right))]
        for left, right, _, _ in begin[low]:
            insort(active, (left, right))
        changed = [(left, right) for left, right, _, _ in (*end[low], *begin[low])]
        # from the right, so that the numbers of what is left of a zone stay
        for first, last in reversed(_zones(changed, blocks) if low else [(0, 0)]):
            sides = blocks[max(first - 1, 0) : first], blocks[last : last + 1]
            bottom = max((b for _, b, _ in sides[0]), default=0)
            top = min((a for a, _, _ in sides[1]), default=steps)
            inner = active[bisect_right(active, (bottom, steps)) if sides[0] else 0 : bisect_left(active, (top,))]
            at = slice(bisect_left(gaps, (bottom,)), bisect_left(gaps, (top,)))
            new_blocks = full.begin(_merged(inner), low)
            new_gaps = free.begin(_between(new_blocks, bottom, top), low)
            # a gap that ends at a block which goes on is joined with the old one that ended there
            pairs.update(_meeting(new_gaps, new_blocks, closed=True))
            old_blocks, old_gaps = blocks[first:last], gaps[at]
            full.end(old_blocks, low)
            free.end(old_gaps, low)
            for one, two in _meeting(old_gaps, new_gaps, closed=False):
                free.sets.join(one, two)
            for one, two in _meeting(old_blocks, new_blocks, closed=True):
                full.sets.join(one, two)
            pairs.update(_meeting(old_gaps, new_blocks, closed=True))
            pairs.update((gap, block) for block, gap in _meeting(old_blocks, new_gaps, closed=True))
            blocks[first:last], gaps[at] = new_blocks, new_gaps
        rows.append(list(gaps))
    full.end(blocks, steps)
    free.end(gaps, steps)
    top_of = [free.sets.top(n) for n in range(len(free.sets.parent))]
    return Sweep(
        steps,
        tuple(lines),
        tuple(tuple((a, b, top_of[n]) for a, b, n in row) for row in rows),
        free.areas_of_sets(),
        full.areas_of_sets(),
        frozenset((top_of[gap], full.sets.top(block)) for gap, block in pairs),
    )


class _Parts:
    """Gaps, or blocks, that go on through strips as long as nothing next to them changes."""

    def __init__(self) -> None:
        self.sets = Sets([])
        self._areas: list[int] = []

    def begin(self, intervals: Iterable[Interval], low: int) -> list[Part]:
        """New ones, from a line on; what is counted of an area is below the line so far."""
        found = [(a, b, self.sets.add()) for a, b in intervals]
        self._areas += [-(b - a) * low for a, b, _ in found]
        return found

    def end(self, some: Iterable[Part], high: int) -> None:
        """They end at a line."""
        for a, b, n in some:
            self._areas[n] += (b - a) * high

    def areas_of_sets(self) -> dict[int, int]:
        """Areas by the sets' `top` numbers, when all have ended."""
        found: dict[int, int] = defaultdict(int)
        for n, area in enumerate(self._areas):
            found[self.sets.top(n)] += area
        return dict(found)


def _zones(changed: Iterable[Interval], blocks: list[Part]) -> list[Interval]:
    """Of blocks in their order the parts that changes meet: from which one to before which one, from the left.

    Between two of them is a block that meets none. A part is empty where rectangles begin in a gap.
    """
    met = sorted(
        (bisect_left(blocks, left, key=_end), bisect_right(blocks, right, key=_begin)) for left, right in changed
    )
    return list(_merged(met))


def _begin(part: Part) -> int:
    return part[0]


def _end(part: Part) -> int:
    return part[1]


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


def _between(blocks: list[Part], bottom: int, top: int) -> Iterator[Interval]:
    """The open intervals that blocks leave of (bottom, top)."""
    edge = bottom
    for left, right, _ in blocks:
        if left > edge:
            yield edge, left
        edge = right
    if edge < top:
        yield edge, top


def _meeting(one: list[Part], two: list[Part], closed: bool) -> Iterator[tuple[int, int]]:
    """Pairs of numbers of intervals, sorted in both lists, that overlap; or have an end in common when ``closed``."""
    j = 0
    for a, b, n in one:
        while j < len(two) and (two[j][1] < a or (not closed and two[j][1] == a)):
            j += 1
        k = j
        while k < len(two) and (two[k][0] < b or (closed and two[k][0] == b)):
            yield n, two[k][2]
            k += 1
