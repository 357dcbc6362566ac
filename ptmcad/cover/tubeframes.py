"""Tubes in their frames, exactly: on which side of them a point is, where they meet the frame's
sides, and areas.

Guarantee: exact, or rounded to the side that is said. All numbers are integers or rationals.

The polynomial with controls c_0, ..., c_n over [a, b] is the sum of binomial(n, k) t^k
(1 - t)^(n - k) c_k with t = (u - a)/(b - a). It lies between the least and the largest control,
ascends strictly if they ascend and are not all equal, and its integral over the interval is the
mean of the controls times b - a.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import accumulate, pairwise
from math import comb
from typing import NamedTuple

from ptmcad.cover.rectangles import Patch, Tube

Controls = tuple[int, ...]


class Piece(NamedTuple):
    """A part of a frame's side: from low to high along it; ``tube`` says whether a tube has it,
    closed, or none.

    ``number`` is that of the tube, or of the open part of the frame: the number of tubes below it.
    """

    low: int
    high: int
    tube: bool
    number: int


def scaled_value(controls: Controls, a: int, d: int) -> int:
    """d^n times the polynomial at t = a/d."""
    n, b = len(controls) - 1, d - a
    total, power = 0, 1
    for k, c in enumerate(controls):
        total += comb(n, k) * c * power * b ** (n - k)
        power *= a
    return total


def side_of(patch: Patch, tube: Tube, u: Fraction, v: Fraction) -> int:
    """1 above the tube, -1 below it, 0 in it; u is within the frame."""
    low, high = patch.ends
    t = (u - low) / (high - low)
    d = t.denominator ** (len(tube.controls) - 1)
    away = v.numerator * d - v.denominator * scaled_value(tube.controls, t.numerator, t.denominator)
    reach = tube.half * v.denominator * d
    return 0 if -reach <= away <= reach else (1 if away > 0 else -1)


def place(patch: Patch, u: Fraction, v: Fraction) -> int | None:
    """In which open part of a frame a point inside of it is, by the number of tubes below; None in
    a tube.

    Parameters
    ----------
    u, v : along the tubes, and across them.
    """
    for number, tube in enumerate(patch.tubes):
        side = side_of(patch, tube, u, v)
        if side <= 0:
            return number if side < 0 else None
    return len(patch.tubes)


def flaw(patch: Patch, steps: int) -> str:
    """What keeps a patch from being one; empty when nothing does."""
    left, right, bottom, top = patch.frame
    if not (0 <= left < right <= steps and 0 <= bottom < top <= steps):
        return "its frame is not a rectangle of the window"
    if patch.along not in (0, 1) or not patch.tubes:
        return "it has no tubes along an axis"
    low, high = patch.heights
    for tube in patch.tubes:
        c, h = tube.controls, tube.half
        if h <= 0 or len(c) < 2 or len(c) != len(patch.tubes[0].controls):
            return "a tube's half width is not positive, or its polynomial has another degree"
        within = min(c) - h > low and max(c) + h < high
        if not within and not slope(c):
            return "a tube neither stays inside of its frame nor ascends or descends"
    for one, two in pairwise(patch.tubes):
        if not all(
            b - a > one.half + two.half for a, b in zip(one.controls, two.controls, strict=True)
        ):
            return "its tubes are not ascending and disjoint"
    return ""


def slope(controls: Controls) -> int:
    """1 if the controls ascend, -1 if they descend, 0 if neither."""
    if controls[0] == controls[-1]:
        return 0
    sign = 1 if controls[-1] > controls[0] else -1
    return sign if all(sign * (b - a) >= 0 for a, b in pairwise(controls)) else 0


def side(patch: Patch, axis: int, end: int) -> list[Piece]:
    """The pieces of a side of the frame: of the lower (0) or the upper (1) one across an axis; in
    order.

    A tube's piece is rounded outward to the lattice, and so are parts in between inward.
    """
    if axis == patch.along:
        low, high = patch.heights
        reaches = [
            (tube.controls[-end] - tube.half, tube.controls[-end] + tube.half)
            for tube in patch.tubes
        ]
        blocks = [
            (max(least, low), min(most, high), number)
            for number, (least, most) in enumerate(reaches)
            if least <= high and most >= low
        ]
        below = sum(most < low for _, most in reaches)
        return _between(low, high, blocks, [below + k for k in range(len(blocks) + 1)])
    low, high = patch.ends
    height = patch.heights[end]
    blocks, above = [], []
    for number, tube in enumerate(patch.tubes):
        first, last = crossing(patch, tube, height)
        if first <= last:
            blocks.append((first, last, number))
    blocks.sort()
    for a, b in pairwise([low, *(x for block in blocks for x in block[:2]), high]):
        above.append((a, b))
    numbers = []
    for a, b in above[::2]:
        at = place(patch, Fraction(a + b, 2), Fraction(height)) if a < b else None
        numbers.append(-1 if at is None else at)
    return _between(low, high, blocks, numbers)


def _between(
    low: int, high: int, blocks: Sequence[tuple[int, int, int]], numbers: Sequence[int]
) -> list[Piece]:
    found, at = [], low
    for (first, last, tube), part in zip(blocks, numbers, strict=False):
        if first > at:
            found.append(Piece(at, first, False, part))
        found.append(Piece(first, last, True, tube))
        at = max(at, last)
    if at < high:
        found.append(Piece(at, high, False, numbers[-1]))
    return found


def crossing(patch: Patch, tube: Tube, height: int) -> tuple[int, int]:
    """The least lattice interval along the tube with all points at which it has this height; (1, 0)
    if there is none.

    Where the tube is at this height its controls ascend or descend.
    """
    if min(tube.controls) - tube.half > height or max(tube.controls) + tube.half < height:
        return 1, 0
    low, high = patch.ends
    sign = slope(tube.controls)
    c = tube.controls if sign > 0 else tuple(-x for x in tube.controls)
    level = sign * height
    # where c + half >= level begins, and where c - half <= level ends
    first = _first(c, low, high, level - tube.half)
    last = _first(c, low, high, level + tube.half, beyond=True)
    return (max(first - 1, low), min(last, high)) if first <= high else (1, 0)


def _first(controls: Controls, low: int, high: int, level: int, beyond: bool = False) -> int:
    """The first lattice point from low to high at which an ascending polynomial is at least level,
    or above it; else high + 1."""
    width = high - low
    if controls[-1] < level + beyond:
        return high + 1
    reach = level * width ** (len(controls) - 1) + beyond
    a, b = low - 1, high
    if controls[0] >= level + beyond:
        return low
    guess = low + int(width * _guess(controls, level))
    for distance in (2, 2**10, 2**20):
        x, y = max(low, guess - distance), min(high, guess + distance)
        if scaled_value(controls, x - low, width) < reach <= scaled_value(controls, y - low, width):
            a, b = x, y
            break
    while b - a > 1:
        middle = (a + b) // 2
        if middle >= low and scaled_value(controls, middle - low, width) >= reach:
            b = middle
        else:
            a = middle
    return b


def _guess(controls: Controls, level: int) -> float:
    """About where an ascending polynomial has a value, from 0 to 1: nothing depends on it but time."""
    n = len(controls) - 1
    values = [float(c - level) for c in controls]
    factors = [comb(n, k) * value for k, value in enumerate(values)]
    a, b = 0.0, 1.0
    for _ in range(50):
        t = 0.5 * (a + b)
        s, value, power = 1 - t, 0.0, 1.0
        for k, factor in enumerate(factors):
            value += factor * power * s ** (n - k)
            power *= t
        a, b = (a, t) if value >= 0 else (t, b)
    return a


def part_areas(patch: Patch) -> list[int]:
    """Areas of the frame's open parts from below, in squares of the lattice, each rounded down."""
    low, high = patch.heights
    width = patch.ends[1] - patch.ends[0]
    floors = [Fraction(low * width)]
    roofs = []
    for tube in patch.tubes:
        roofs.append(_clamped(patch, tuple(c - tube.half for c in tube.controls))[0])
        floors.append(_clamped(patch, tuple(c + tube.half for c in tube.controls))[1])
    roofs.append(Fraction(high * width))
    return [max(0, (roof - floor).__floor__()) for floor, roof in zip(floors, roofs, strict=True)]


def _clamped(patch: Patch, controls: Controls) -> tuple[Fraction, Fraction]:
    """Bounds of the integral of a polynomial that is cut off at the frame's heights."""
    low, high = patch.heights
    a, b = patch.ends
    width = b - a
    if min(controls) >= low and max(controls) <= high:
        whole = Fraction(sum(controls) * width, len(controls))
        return whole, whole
    if max(controls) <= low:
        return Fraction(low * width), Fraction(low * width)
    if min(controls) >= high:
        return Fraction(high * width), Fraction(high * width)
    if slope(controls) < 0:
        controls = controls[::-1]  # the mirror image has the same integral
    # below `low` up to `first`, above `high` from `last`: both are met within a step before
    first, last = _first(controls, a, b, low), min(_first(controls, a, b, high), b + 1)
    start, end = first, max(first, last - 1)
    inner = _integral(controls, a, b, end) - _integral(controls, a, b, start)
    before, after = max(start - a - 1, 0), max(b - end - 1, 0)
    edges = (start > a) + (end < b)
    rest = Fraction(before * low + after * high) + inner
    # within each of the one or two steps that are left it is between the cut-off values at the
    # step's ends
    least, most = Fraction(0), Fraction(0)
    for here in ([start - 1] if start > a else []) + ([end] if end < b else []):
        one, two = (_cut(Fraction(scaled_value(controls, x - a, width), width ** (len(controls) - 1)), low, high)
                    for x in (here, here + 1))  # fmt: skip
        least, most = least + one, most + two
    assert before + after + edges + end - start == width
    return rest + least, rest + most


def _cut(value: Fraction, low: int, high: int) -> Fraction:
    return min(max(value, Fraction(low)), Fraction(high))


def _integral(controls: Controls, a: int, b: int, end: int) -> Fraction:
    """From a to ``end``."""
    sums = (0, *accumulate(controls))
    n, width = len(controls), b - a
    return Fraction(scaled_value(sums, end - a, width), n * width ** (n - 1))


def bounds_between(controls: Controls, start: Fraction, end: Fraction) -> tuple[Fraction, Fraction]:
    """The least and the largest control of the polynomial over a part of its interval, from
    t = start to t = end.
    """
    part = (
        _split(_split([Fraction(c) for c in controls], end)[0], start / end)[1]
        if end
        else [Fraction(controls[0])]
    )
    return min(part), max(part)


def halved(row: Sequence[int]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """De Casteljau's subdivision at the middle, times 2^degree."""
    degree = len(row) - 1
    left, right, sums = [row[0] << degree], [row[-1] << degree], list(row)
    for step in range(1, degree + 1):
        sums = [a + b for a, b in pairwise(sums)]
        left.append(sums[0] << (degree - step))
        right.append(sums[-1] << (degree - step))
    return tuple(left), tuple(reversed(right))


def bounds_by_halving(controls: Controls, halvings: int) -> list[tuple[int, int]]:
    """Bounds of the polynomial over 2^halvings equal parts of its interval: their controls, rounded
    outward.
    """
    n, parts = len(controls) - 1, [tuple(controls)]
    for _ in range(halvings):
        parts = [half for row in parts for half in halved(row)]
    scale = 2 ** (n * halvings)
    return [(min(row) // scale, -(-max(row) // scale)) for row in parts]


def _split(controls: list[Fraction], t: Fraction) -> tuple[list[Fraction], list[Fraction]]:
    """Controls over [0, t] and over [t, 1] (de Casteljau)."""
    first, last = [controls[0]], [controls[-1]]
    while len(controls) > 1:
        controls = [a + t * (b - a) for a, b in pairwise(controls)]
        first.append(controls[0])
        last.append(controls[-1])
    return first, last[::-1]
