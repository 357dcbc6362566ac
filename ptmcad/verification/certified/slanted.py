"""What a cover with slanted pieces leaves free, found by a sweep: gaps, blocks and frames, strip by strip.

Guarantee: what is said to be connected is so, and bounds of areas hold. Tubes are polynomials in powers here, which
are put together from the controls' differences; that they are in order and pass the sides of their frames once is
proved by Sturm sequences, where the engine looks at the controls.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import comb

from flint import arb, arb_poly, fmpq, fmpq_poly

from ptmcad.cover.rectangles import Cover, Patch
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.verification.certified.sweep import Sets
from ptmcad.verification.report import Violation
from ptmcad.verification.sturm import roots_between

ONE = fmpq(1)
_FINER = 2**20
"""Parts of a lattice step to which the place is found where a tube passes a side of its frame."""
Part = tuple[Fraction | int, Fraction | int, bool, int]
"""Of a side: its ends, whether it is open, and the number of what has it."""


class Frame:
    """A patch with its polynomials in s, which goes from 0 to 1 along the frame.

    Raises
    ------
    Violation
        When the tubes do not part the frame as they should.
    """

    def __init__(self, patch: Patch, number: int) -> None:
        self.patch, self.name = patch, f"slanted piece {number}"
        a = patch.along
        self.low, self.high = patch.frame[2 * a], patch.frame[2 * a + 1]
        self.bottom, self.top = patch.frame[2 - 2 * a], patch.frame[3 - 2 * a]
        self.centers = [_in_powers(tube.controls) for tube in patch.tubes]
        self.halves = [tube.half for tube in patch.tubes]
        if not patch.tubes or min(self.halves) <= 0:
            raise Violation(f"{self.name} has no tube, or one without width")
        for below, above in pairwise(range(len(self.centers))):
            gap = self.centers[above] - self.centers[below] - (self.halves[above] + self.halves[below])
            if not _positive(gap):
                raise Violation(f"tubes of {self.name} are not ascending and disjoint")
        self.turns = [self._direction(center, half) for center, half in zip(self.centers, self.halves, strict=True)]

    def _direction(self, center: fmpq_poly, half: int) -> int:
        """1 or -1 where the tube ascends or descends, 0 where it stays within the frame.

        Raises
        ------
        Violation
            Where it does neither.
        """
        if _positive(center - half - self.bottom) and _positive(self.top - center - half):
            return 0
        slope = center.derivative()
        if slope.degree() < 0 or roots_between(slope.numer(), fmpq(0), ONE) or slope(fmpq(1, 2)) == 0:
            raise Violation(f"a tube of {self.name} passes a side of its frame, and turns back")
        return 1 if slope(fmpq(1, 2)) > 0 else -1

    def place(self, u: Fraction, v: Fraction) -> int | None:
        """How many tubes are below a point of the frame; None in a tube. u is along the tubes."""
        s = from_fraction((u - self.low) / (self.high - self.low))
        for k, (center, half) in enumerate(zip(self.centers, self.halves, strict=True)):
            away = from_fraction(v) - center(s)
            if away <= half:
                return k if away < -half else None
        return len(self.centers)

    def side(self, axis: int, end: int) -> Sequence[tuple[Fraction | int, Fraction | int, bool, int]]:
        """The parts of a side across an axis, the lower (0) or the upper (1) one; numbers of parts or of tubes."""
        key = (axis, end)
        if key not in self._sides:
            self._sides[key] = list(self._end(end) if axis == self.patch.along else self._long(end))
        return self._sides[key]

    @cached_property
    def _sides(self) -> dict[tuple[int, int], Sequence[tuple[Fraction | int, Fraction | int, bool, int]]]:
        return {}

    def _end(self, end: int) -> Iterator[Part]:
        at: Fraction | int = self.bottom
        number = 0
        for k, (center, half) in enumerate(zip(self.centers, self.halves, strict=True)):
            value = center(fmpq(end))
            first, last = to_fraction(value - half).__floor__(), to_fraction(value + half).__ceil__()
            if last < self.bottom:
                number = k + 1
                continue
            if first > self.top:
                break
            if first > at:
                yield at, first, True, k
            yield max(first, self.bottom), min(last, self.top), False, k
            at, number = max(last, at), k + 1
        if at < self.top:
            yield at, self.top, True, number

    def _long(self, end: int) -> Iterator[Part]:
        height = (self.bottom, self.top)[end]
        blocks = []
        for k in range(len(self.centers)):
            passed = self._passing(k, height)
            if passed is not None:
                blocks.append((*passed, k))
        at = Fraction(self.low)
        for first, last, k in [*sorted(blocks), (Fraction(self.high), Fraction(self.high), -1)]:
            if first > at:
                number = self.place((at + first) / 2, Fraction(height))
                if number is not None:
                    yield at, first, True, number
            if k >= 0:
                yield first, last, False, k
            at = max(at, last)

    def _passing(self, k: int, height: int) -> tuple[Fraction, Fraction] | None:
        """An interval on lattice points that holds all places at which a tube is at a height."""
        turn = self.turns[k]
        if turn == 0:
            return None
        ends = sorted(self._reached(k, height - sign * turn * self.halves[k]) for sign in (1, -1))
        if ends[1] < self.low or ends[0] > self.high:
            return None
        first, last = Fraction(ends[0].__floor__()), Fraction((ends[1] + Fraction(1, _FINER)).__ceil__())
        return max(first, Fraction(self.low)), min(last, Fraction(self.high))

    def _reached(self, k: int, level: int) -> Fraction:
        """Where a center that ascends or descends reaches a level, at most 1/_FINER more; beyond the frame if not."""
        center, turn = self.centers[k], self.turns[k]
        width = self.high - self.low
        if turn * (center(fmpq(0)) - level) > 0:
            return Fraction(self.low - 1)
        if turn * (center(ONE) - level) < 0:
            return Fraction(self.high + 1)
        a, b = 0, width * _FINER
        while b - a > 1:
            middle = (a + b) // 2
            if turn * (center(fmpq(middle, width * _FINER)) - level) < 0:
                a = middle
            else:
                b = middle
        return self.low + Fraction(a, _FINER)

    @cached_property
    def parts(self) -> list[Fraction]:
        """Upper bounds of the areas of the parts between the tubes, from below."""
        width = self.high - self.low
        edges: list[tuple[Fraction, Fraction]] = [(Fraction(self.bottom * width),) * 2]
        for k in range(len(self.centers)):
            edges += [self._cut(k, -self.halves[k]), self._cut(k, self.halves[k])]
        edges.append((Fraction(self.top * width),) * 2)
        return [max(Fraction(0), edges[k + 1][1] - edges[k][0]) for k in range(0, len(edges), 2)]

    def _cut(self, k: int, shift: int) -> tuple[Fraction, Fraction]:
        """Bounds of the integral of a shifted center, cut off at the frame's heights."""
        center, turn, width = self.centers[k] + shift, self.turns[k], self.high - self.low
        primitive = center.integral()
        if turn == 0:
            value = to_fraction(primitive(ONE) * width)
            return value, value
        marks = [Fraction(0)]
        for level in (self.bottom, self.top)[::turn]:
            at = self._reached(k, level - shift)
            marks.append(min(max((at - self.low) / width, Fraction(0)), Fraction(1)))
        marks.append(Fraction(1))
        before, after = (self.bottom, self.top)[::turn]
        middle = to_fraction(primitive(from_fraction(marks[2])) - primitive(from_fraction(marks[1])))
        total = width * (before * marks[1] + middle + after * (1 - marks[2]))
        # outside of the frame, or from one end of it to the other, nothing was rounded
        rounded = not {marks[1], marks[2]} <= {Fraction(0), Fraction(1)}
        slack = Fraction(2 * (self.top - self.bottom) + 2, _FINER) if rounded else Fraction(0)
        return total - slack, total + slack

    def avoids(self, low: tuple[Fraction, Fraction], high: tuple[Fraction, Fraction]) -> bool:
        """Whether a rectangle surely meets no tube inside the frame."""
        a, width = self.patch.along, self.high - self.low
        start = (max(low[a], Fraction(self.low)) - self.low) / width
        end = (min(high[a], Fraction(self.high)) - self.low) / width
        s = arb(from_fraction((start + end) / 2), arb(from_fraction((end - start) / 2)).upper())
        for center, half in zip(self.centers, self.halves, strict=True):
            value = arb_poly(center)(s)
            if not (value - half > arb(from_fraction(high[1 - a])) or value + half < arb(from_fraction(low[1 - a]))):
                return False
        return True


def _in_powers(controls: Sequence[int]) -> fmpq_poly:
    """The polynomial with these coefficients in Bernstein's basis: its j-th power has binomial(n, j) times the j-th
    forward difference."""
    n, coefficients, differences = len(controls) - 1, [], list(controls)
    for j in range(n + 1):
        coefficients.append(comb(n, j) * differences[0])
        differences = [b - a for a, b in pairwise(differences)]
    return fmpq_poly(coefficients)


def _positive(p: fmpq_poly) -> bool:
    """Whether a polynomial is positive on [0, 1]."""
    if p(fmpq(0)) <= 0 or p(ONE) <= 0:
        return False
    return p.degree() < 1 or roots_between(p.numer(), fmpq(0), ONE) == 0


@dataclass(frozen=True, slots=True)
class _Item:
    """Something of a strip from left to right: a gap or a block with its node, or a frame."""

    left: int
    right: int
    free: bool
    node: int
    frame: int = -1


@dataclass(frozen=True, slots=True)
class SlantedSweep:
    """The same as `ptmcad.verification.certified.sweep.Sweep`, for a cover with slanted pieces.

    Attributes
    ----------
    areas : of components, at most; cluster_areas : at least.
    """

    steps: int
    lines: tuple[int, ...]
    rows: tuple[tuple[_Item, ...], ...]
    frames: tuple[Frame, ...]
    component_of: tuple[int, ...]
    first_part: tuple[int, ...]
    areas: dict[int, Fraction]
    cluster_areas: dict[int, Fraction]
    touching: frozenset[tuple[int, int]]

    def locate(self, u: Fraction, v: Fraction) -> int | None:
        """The component of a point of the open window; None where it is in the cover, or on a frame's side."""
        found = {self._at(item, u, v) for item in self._items((u, v), (u, v))}
        return found.pop() if len(found) == 1 else None

    def _at(self, item: _Item, u: Fraction, v: Fraction) -> int | None:
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

    def _items(self, low: tuple[Fraction, Fraction], high: tuple[Fraction, Fraction]) -> Iterator[_Item]:
        """What of the strips a closed rectangle meets."""
        first, last = bisect_left(self.lines, low[1]) - 1, bisect_right(self.lines, high[1])
        for row in self.rows[max(first, 0) : max(last, 0)]:
            k = max(bisect_left(row, low[0], key=_right), 0)
            while k < len(row) and row[k].left <= high[0]:
                yield row[k]
                k += 1


def _right(item: _Item) -> Fraction:
    return Fraction(item.right)


def slanted_sweep(cover: Cover) -> SlantedSweep:
    """Sweep the window from below.

    Raises
    ------
    Violation
        When a patch is none, or a frame meets something else.
    """
    frames = tuple(Frame(patch, k) for k, patch in enumerate(cover.patches))
    begin: dict[int, list[tuple[int, int, int]]] = defaultdict(list)
    end: dict[int, list[tuple[int, int, int]]] = defaultdict(list)
    pieces = [(r, -1) for r in cover.rectangles] + [(patch.frame, k) for k, patch in enumerate(cover.patches)]
    for (left, right, bottom, top), number in pieces:
        begin[bottom].append((left, right, number))
        end[top].append((left, right, number))
    lines = sorted({0, cover.steps, *begin, *end})
    free, areas, sets = list[bool](), list[Fraction](), Sets([])

    def node(is_free: bool, area: Fraction | int) -> int:
        free.append(is_free)
        areas.append(Fraction(area))
        return sets.add()

    first_part, first_tube = [], []
    for frame in frames:
        first_part.append(len(free))
        for area in frame.parts:
            node(True, area)
        first_tube.append(len(free))
        rest = (frame.high - frame.low) * (frame.top - frame.bottom) - sum(frame.parts)
        for k in range(len(frame.centers)):
            # all of what no part has is the first one's: where tubes are not in one cluster the rest is at least 0
            node(False, max(rest, 0) if k == 0 and len(frame.centers) == 1 else Fraction(0))
    pairs = {
        (part, tube + k)
        for frame, first, tube in zip(frames, first_part, first_tube, strict=True)
        for k in range(len(frame.centers))
        for part in (first + k, first + k + 1)
        if areas[part] >= 1
    }

    def meet(below: Iterator[Part], above: Iterator[Part], low: Fraction | int, high: Fraction | int) -> None:
        others = list(above)
        for a, b, open_one, one in below:
            for c, d, open_two, two in others:
                start, stop = max(a, c, low), min(b, d, high)
                if open_one and open_two:
                    if start < stop:
                        sets.join(one, two)
                elif start <= stop:
                    if open_one == open_two:
                        sets.join(one, two)
                    else:
                        pairs.add((one, two) if open_one else (two, one))

    def parts(item: _Item, axis: int, side: int, ends: tuple[int, int]) -> Iterator[Part]:
        if item.frame < 0:
            yield *ends, item.free, item.node
            return
        for a, b, is_open, number in frames[item.frame].side(axis, side):
            yield a, b, is_open, (first_part if is_open else first_tube)[item.frame] + number

    rows: list[tuple[_Item, ...]] = []
    active: list[tuple[int, int, int]] = []
    for low, high in pairwise(lines):
        for entry in end[low]:
            del active[bisect_left(active, entry)]
        for entry in begin[low]:
            insort(active, entry)
        row = []
        for left, right, is_free, frame_number in _row(active, cover.steps):
            n = -1 if frame_number >= 0 else node(is_free, Fraction((right - left) * (high - low)))
            row.append(_Item(left, right, is_free, n, frame_number))
        for one, two in pairwise(row):
            meet(parts(one, 0, 1, (low, high)), parts(two, 0, 0, (low, high)), low, high)
        if rows:
            for one, two in _touching(rows[-1], row):
                # what a frame that goes on across the line meets there, it meets along its upright sides in one strip
                if _ends(one, frames, low, 3) and _ends(two, frames, low, 2):
                    span = max(one.left, two.left), min(one.right, two.right)
                    meet(parts(one, 1, 1, (one.left, one.right)), parts(two, 1, 0, (two.left, two.right)), *span)
        rows.append(tuple(row))
    component_of = tuple(sets.top(n) for n in range(len(free)))
    found: tuple[dict[int, Fraction], dict[int, Fraction]] = defaultdict(Fraction), defaultdict(Fraction)
    for n, is_free in enumerate(free):
        found[not is_free][component_of[n]] += areas[n]
    return SlantedSweep(
        cover.steps, tuple(lines), tuple(rows), frames, component_of, tuple(first_part),
        {n: area for n, area in found[0].items() if area > 0}, dict(found[1]),
        frozenset((component_of[a], component_of[b]) for a, b in pairs),
    )  # fmt: skip


def _ends(item: _Item, frames: Sequence[Frame], line: int, side: int) -> bool:
    """Whether an item has its bottom (side 2) or its top (3) on the line between two strips."""
    return item.frame < 0 or frames[item.frame].patch.frame[side] == line


def _row(active: list[tuple[int, int, int]], steps: int) -> Iterator[tuple[int, int, bool, int]]:
    """Gaps, blocks and frames of a strip: left, right, whether it is free, the frame's number or -1.

    Raises
    ------
    Violation
        When a frame overlaps something.
    """
    at = 0
    block: tuple[int, int] | None = None
    for left, right, number in [*active, (steps, steps, -2)]:
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


def _touching(below: Sequence[_Item], above: Sequence[_Item]) -> Iterator[tuple[_Item, _Item]]:
    """Pairs of items of neighbouring strips whose closed intervals meet."""
    j = 0
    for one in below:
        while j < len(above) and above[j].right < one.left:
            j += 1
        k = j
        while k < len(above) and above[k].left <= one.right:
            yield one, above[k]
            k += 1
