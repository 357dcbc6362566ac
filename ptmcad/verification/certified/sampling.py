"""Checks of the free area of a certified map: at random points, that counts are what they should be
and stay so nearby.

Guarantee: over each box that is counted as proved, every equilibrium that the map counts persists
with nonzero determinant of its Hessian, and there are no others; so no curve at which the count
changes enters the box. A point where this was not proved is counted apart, and never as proved.

Points are drawn by area, whatever the rectangles are: the window is a grid of squares (in lattice
steps), and each has one, uniform in what of its area is in cells. A part of the window with false
counts and the share s_i of the i-th square's cells escapes with probability prod(1 - s_i), at most
(1 - mean)^n. Further points are beside rectangles, spread over the same squares, and within one
over the length of the rectangles' edges, so that many small rectangles draw no more of them than a
few large ones. Half of the boxes are at points of either kind; at the other points it is the count
alone that is looked at, which costs less. The boxes do not meet the cover.
"""

from __future__ import annotations

import random
from bisect import bisect_right
from collections.abc import Iterator
from fractions import Fraction
from itertools import accumulate, product
from math import ceil, isqrt
from typing import NamedTuple

from ptmcad.cover.rectangles import Rectangle
from ptmcad.verification.certified.cellsamples import HOPELESS
from ptmcad.verification.certified.counted import CountedPoint, stored
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.report import Unchecked, Violation, Within, share

FIRST_BOX_PARTS = 512
"""The first box tried has at most this part of the window's width on each side of its middle."""
ATTEMPTS = 9
POINTS_PER_BOX = Fraction(32, 5)
"""Points by area for each box that is asked for."""
MIN_WINDOW_PARTS = 2**30
"""Parts of the window's width in which points are drawn, at least: a cover may have a coarse
lattice.
"""
_MAX_TRIALS = 400
"""Random points looked at for one that is free."""
_FIRST_TRIALS = 40
"""The same for points beside rectangles, of which others will do."""
Edge = tuple[int, int, int, int]
"""A side of a rectangle within a square: left, right, bottom, top, one pair of them equal; in
lattice steps times the number of squares side by side, in which squares begin and end at whole
numbers."""


class _SampleBox(NamedTuple):
    """A box in lattice steps, within one cell: its middle and half its width (0 where there is no
    room).
    """

    u: Fraction
    v: Fraction
    half: Fraction
    cell: int


def check_boxes(
    claims: CertifiedClaims,
    seed: str,
    number: int,
    report: Within = lambda *_: None,
) -> str:
    """Try so many random boxes, and more points; what was found, and for how many points nothing
    was proved.

    Parameters
    ----------
    report : called with the numbers of points that are done, and of all.
    """
    if not claims.result.cells:
        return "there are no cells"
    if number <= 0:
        return Unchecked("no points were asked for")
    rng = random.Random(seed)
    by_area, without = _by_area(claims, rng, number)
    beside = _beside(claims, rng, number)
    # boxes where there are points: half of them beside rectangles, if there are any
    near = min(len(beside), number // 2)
    far = min(len(by_area), number - near)
    proved = points = missing = 0
    area = Fraction(0)
    for k, box in enumerate([*by_area, *beside]):
        report(k, len(by_area) + len(beside))
        if not points and missing == HOPELESS:
            return Unchecked(f"none of the first {missing} points could be decided; seed {seed}")
        there = check_point(claims, box.cell, box.u, box.v)
        points += there is not None
        if not (k < far or 0 <= k - len(by_area) < near):
            missing += there is None
            continue
        half = Fraction(0) if there is None else _constant_over(claims, box, there)
        if half:
            proved += 1
            area += (2 * half / claims.sweep.steps) ** 2
            continue
        # where constancy is not proved, a change of the count would show in a corner
        for one, two in product((-1, 1), repeat=2):
            check_point(claims, box.cell, box.u + one * box.half, box.v + two * box.half)
        missing += 1
    text = f"{proved} boxes, {100 * float(area):.2g} % of the window, {points} points; seed {seed}"
    if missing:
        text += f"; {missing} point{'s' * (missing != 1)} not checked"
    if without:
        text += f"; nothing free met with in {without} of {_side(number) ** 2} squares"
    return Unchecked(text) if missing or not points else text


def _side(number: int) -> int:
    """How many squares of the grid are side by side, for so many boxes."""
    return isqrt(ceil(POINTS_PER_BOX * number) - 1) + 1


def _by_area(
    claims: CertifiedClaims, rng: random.Random, number: int
) -> tuple[list[_SampleBox], int]:
    """A point in each square of the grid, in random order; and the number of squares in which none
    was met with.
    """
    found, without = [], 0
    side = _side(number)
    width = Fraction(claims.sweep.steps, side)
    for i, j in product(range(side), repeat=2):
        for _ in range(_MAX_TRIALS):
            u, v = (i + share(rng)) * width, (j + share(rng)) * width
            box = _free(claims, u, v)
            if box is not None:
                found.append(box)
                break
        else:
            without += 1
    rng.shuffle(found)
    return found, without


def _beside(claims: CertifiedClaims, rng: random.Random, number: int) -> list[_SampleBox]:
    """Points beside rectangles, as many as boxes: from one square of the grid after the other, in
    random order.
    """
    edges = _edges(claims.cover.rectangles, claims.sweep.steps, _side(number))
    order = sorted(edges)
    rng.shuffle(order)
    totals = {
        k: list(accumulate(right - left + top - bottom for left, right, bottom, top in edges[k]))
        for k in order
    }
    found: list[_SampleBox] = []
    while order and len(found) < number:
        for k in list(order):
            if len(found) == number:
                break
            for _ in range(_FIRST_TRIALS):
                chosen = edges[k][bisect_right(totals[k], totals[k][-1] * share(rng))]
                u, v = _off(chosen, claims.sweep.steps, rng)
                box = _free(claims, u / _side(number), v / _side(number))
                if box is not None:
                    found.append(box)
                    break
            else:
                # hardly anything is free beside its rectangles
                order.remove(k)
    return found


def _edges(
    rectangles: tuple[Rectangle, ...], steps: int, side: int
) -> dict[tuple[int, int], list[Edge]]:
    """The rectangles' sides, cut by the squares of the grid."""
    found: dict[tuple[int, int], list[Edge]] = {}
    for rectangle in rectangles:
        left, right, bottom, top = (side * x for x in rectangle)
        for height in (bottom, top):
            if 0 < height < side * steps:
                for i, low, high in _cut(left, right, steps):
                    found.setdefault((i, height // steps), []).append((low, high, height, height))
        for across in (left, right):
            if 0 < across < side * steps:
                for j, low, high in _cut(bottom, top, steps):
                    found.setdefault((across // steps, j), []).append((across, across, low, high))
    return found


def _cut(low: int, high: int, width: int) -> Iterator[tuple[int, int, int]]:
    """The parts of an interval in the grid's columns of this width, and their numbers."""
    for k in range(low // width, (high - 1) // width + 1):
        yield k, max(low, k * width), min(high, (k + 1) * width)


def _off(edge: Edge, width: int, rng: random.Random) -> tuple[Fraction, Fraction]:
    """A point off a rectangle's side, on either side of it, and as likely twice as far away as half
    as far.
    """
    left, right, bottom, top = edge
    away = width * Fraction(2 ** rng.uniform(-14, 0)) * rng.choice((-1, 1))
    u, v = left + (right - left) * share(rng), bottom + (top - bottom) * share(rng)
    return (u + away, v) if left == right else (u, v + away)


def _free(claims: CertifiedClaims, u: Fraction, v: Fraction) -> _SampleBox | None:
    """The box around a point, or one next to it that is shorter to write; None when it is not in a
    cell.
    """
    steps = claims.sweep.steps
    scale = max(1, MIN_WINDOW_PARTS // steps)
    u, v = Fraction(round(u * scale), scale), Fraction(round(v * scale), scale)
    if (cell := claims.cell_at(u, v)) is None:
        return None
    half = claims.room(u, v, Fraction(steps, FIRST_BOX_PARTS), Fraction(steps, MIN_WINDOW_PARTS))
    return _SampleBox(u, v, half, cell)


def check_point(
    claims: CertifiedClaims,
    number: int,
    u: Fraction,
    v: Fraction,
    reason: str = "",
) -> CountedPoint | None:
    """The counts at a point are those of the cell; its equilibria, None if they were not proved.

    Parameters
    ----------
    number : of the cell.
    reason : to look there, in words that are added to what is wrong.

    Raises
    ------
    Violation
    """
    x, y = claims.lattice.off(u, v)
    cell = claims.result.cells[number]
    try:
        there = claims.counting.at(x, y)
    except Unproved:
        return None
    if stored(cell) != there.counts:
        raise Violation(
            f"at {claims.place(x, y)} in cell {number}, which is said to have {stored(cell)}, there are "
            f"{there.counts}{reason}"
        )
    return there


def _constant_over(claims: CertifiedClaims, box: _SampleBox, there: CountedPoint) -> Fraction:
    """Half the width of the box over which the cell's counts are proved; 0 when none was small
    enough.
    """
    half = box.half
    for _ in range(ATTEMPTS if half else 0):
        try:
            u, v = ((at - half, at + half) for at in (box.u, box.v))
            true = claims.counting.over(u, v, there)
        except Unproved:  # the box is too large, or the counts change in it
            half /= 4
            continue
        assert stored(claims.result.cells[box.cell]) == true, (
            "the box holds its middle, whose counts are the cell's"
        )
        return half
    return Fraction(0)
