"""Covers on a lattice of the window: of boxes of floats, rounded outward, and of fewer rectangles.

Guarantee: a rectangle holds its box and is less than two lattice steps longer on each side. A float
estimate with a bound on its error finds the step; only where floats overflow does rational
arithmetic. `combined` covers the same points as before; `gathered` covers them and more.
"""

from __future__ import annotations

from fractions import Fraction
from math import isinf

import numpy as np
from numpy.typing import NDArray

from ptmcad.cover.rectangles import MAX_STEPS, Cover, Window
from ptmcad.cover.subdivision import (
    COVERED,
    Integers,
    Subdivision,
    rectangle_array,
    subdivide,
)

Floats = NDArray[np.float64]
_ERROR = 2.0**-50
"""Eight units of rounding: bound of the estimate's error, relative to the sizes of what is
subtracted ...
"""
_MIN_ERROR = 2.0**-60
"""... and where the window's end is subnormal."""
_USUAL = 10**250
"""Beyond it estimates could overflow."""


def from_boxes(window: Window, low: Floats, high: Floats, steps: int) -> Cover:
    """The cover of boxes that floats bound: each is rounded outward to the lattice and clipped to
    the window.

    Parameters
    ----------
    low, high : shape (k, 2), the ends along the two axes, in the axes' own units; infinite ends are
        allowed.

    Raises
    ------
    ValueError
        When an end is not a number, or low > high.

    Guarantee
    ---------
    Every point of the open window that lies in a closed box lies in a rectangle.
    """
    if not 0 < steps <= MAX_STEPS:
        raise ValueError(f"a cover's lattice has 1 to {MAX_STEPS} steps, not {steps}")
    low, high = (
        np.asarray(low, dtype=np.float64).reshape(-1, 2),
        np.asarray(high, dtype=np.float64).reshape(-1, 2),
    )
    if not (low <= high).all():
        raise ValueError("a box has a low end that is not at most its high end")
    sides = []
    kept = np.ones(len(low), dtype=np.bool_)
    for axis in (0, 1):
        first = rounded_down(low[:, axis], *window[axis], steps)
        last = -rounded_down(-high[:, axis], -window[axis][1], -window[axis][0], steps) + steps
        kept &= (first < steps) & (last > 0)
        # a box without width on a line of the lattice: the step after the line, which is in the
        # window, holds it
        last = np.where(first == last, last + 1, last)
        sides += [np.clip(first, 0, steps), np.clip(last, 0, steps)]
    array = np.stack(sides, axis=1)[kept]
    return cover_of(array, steps)


def cover_of(array: Integers, steps: int) -> Cover:
    """The cover of rectangles in an array of shape (k, 4)."""
    rows = array[np.lexsort(array.T[::-1])]
    if len(rows):
        rows = rows[np.concatenate([[True], (rows[1:] != rows[:-1]).any(axis=1)])]
    return Cover(steps, tuple(zip(*rows.T.tolist(), strict=True)))


def rounded_down(values: Floats, low: Fraction, high: Fraction, steps: int) -> Integers:
    """floor((value - low) steps / (high - low)), but -1 and steps stand for all that is outside.

    A value that is so near above a line of the lattice that floats cannot tell gets the step below
    that line.
    """
    width = high - low
    if max(abs(low), 1 / width, width) > _USUAL:
        return np.array(
            [_exactly(value, low, width, steps) for value in values.tolist()], dtype=np.int64
        )
    start, scale = float(low), float(steps / width)
    with np.errstate(over="ignore", invalid="ignore"):
        estimate = (values - start) * scale
        margin = (np.abs(values) + abs(start)) * scale * _ERROR + _MIN_ERROR
        below = np.clip(np.floor(estimate - margin), -1, steps)
    unsure = np.isnan(below)
    result = np.where(unsure, 0.0, below).astype(np.int64)
    result[unsure] = [_exactly(value, low, width, steps) for value in values[unsure].tolist()]
    return result


def _exactly(value: float, low: Fraction, width: Fraction, steps: int) -> int:
    if isinf(value):
        return steps if value > 0 else -1
    return min(max((Fraction(value) - low) * steps // width, -1), steps)


def combined(cover: Cover) -> Cover:
    """A cover of the same points by at most as many rectangles, found at small cost."""
    return cover_of(_merged(_outermost(_merged(rectangle_array(cover)))), cover.steps)


def gathered(cover: Cover, most: int) -> Cover:
    """A cover of more, by at most so many rectangles: boxes around what the cover has in each
    square of a grid.

    The grid is the finest that needs no more of them; a cover of no more rectangles stays as it is.
    """
    array, steps = rectangle_array(cover), cover.steps
    found, across = array, 1
    tree = subdivide(array, steps)
    while len(array) > most and across <= steps:
        boxes = _in_squares(tree, across)
        if len(boxes) > most:
            break
        found, across = boxes, 2 * across
    return cover_of(found, steps)


def _in_squares(tree: Subdivision, across: int) -> Integers:
    """Boxes around what is covered in each square of a grid of so many squares along each axis."""
    size = tree.steps // across
    x, y = size * np.indices((across, across)).reshape(2, -1)
    squares = np.stack([x, x + size, y, y + size], axis=1)
    square, leaf = tree.meeting(squares)
    held = tree.state[leaf] == COVERED
    square, bounds = square[held], tree.bounds[leaf[held]]
    boxes = np.tile([tree.steps, 0, tree.steps, 0], (len(squares), 1))
    for k, (inner, outer) in enumerate(((np.maximum, np.minimum), (np.minimum, np.maximum)) * 2):
        outer.at(boxes[:, k], square, inner(bounds[:, k], squares[square, k]))
    return boxes[boxes[:, 1] > 0]


def _outermost(array: Integers) -> Integers:
    """Rectangles without most of those that lie in a single other one; the union stays.

    For each size there is a grid with squares of that size, and rectangles of the size meet four of
    its squares at most. In each square the largest of them is compared with all smaller ones that
    have their lower left corner there.
    """
    sides = array[:, (1, 3)] - array[:, (0, 2)]
    sizes = np.array([int(side).bit_length() for side in sides.max(axis=1, initial=0)])
    areas = sides[:, 0].astype(float) * sides[:, 1]
    for size in np.unique(sizes)[::-1].tolist():
        own = np.flatnonzero(sizes == size)
        if not len(own):  # all of them were in larger ones
            continue
        first, last = array[own][:, (0, 2)] >> size, (array[own][:, (1, 3)] - 1) >> size
        corners = [
            np.where(end, last, first)
            for end in ((False, False), (False, True), (True, False), (True, True))
        ]
        # squares in the order in which complex numbers are sorted, the largest rectangle of each
        # first
        square = np.concatenate([corner[:, 0] + 1j * corner[:, 1] for corner in corners])
        holder = np.tile(own, 4)
        order = np.lexsort((-areas[holder], square.imag, square.real))
        square, starts = np.unique(square[order], return_index=True)
        holder = holder[order][starts]
        smaller = np.flatnonzero(sizes <= size)
        corner = (array[smaller, 0] >> size) + 1j * (array[smaller, 2] >> size)
        place = np.minimum(np.searchsorted(square, corner), len(square) - 1)
        there = array[holder[place]]
        inside = (there[:, (0, 2)] <= array[smaller][:, (0, 2)]) & (
            there[:, (1, 3)] >= array[smaller][:, (1, 3)]
        )
        lost = (square[place] == corner) & inside.all(axis=1) & (holder[place] != smaller)
        kept = np.ones(len(array), dtype=np.bool_)
        kept[smaller[lost]] = False
        array, sizes, areas = array[kept], sizes[kept], areas[kept]
    return array


def _merged(array: Integers) -> Integers:
    """Rectangles of which none share two ends along one axis and meet along the other; the union
    stays.
    """
    before, other = len(array) + 1, [2, 3, 0, 1]
    while 0 < len(array) < before:
        before = len(array)
        array = _merged_along(_merged_along(array[:, other]))[:, other]
    return array


def _merged_along(array: Integers) -> Integers:
    """Rectangles with equal ends in the first two columns joined where they overlap or touch in the
    others, which come first then.
    """
    array = array[np.lexsort(array.T[::-1])]
    rows = (array[1:, :2] != array[:-1, :2]).any(axis=1)
    group = np.concatenate([[0], np.cumsum(rows)])
    # the farthest end so far within the group: groups are lifted above each other, so that one
    # running maximum does
    ends, ranks = np.unique(array[:, 3], return_inverse=True)
    farthest = ends[np.maximum.accumulate(ranks + group * len(ends)) - group * len(ends)]
    fresh = np.concatenate([[True], rows | (array[1:, 2] > farthest[:-1])])
    starts = np.flatnonzero(fresh)
    joined = array[starts]
    joined[:, 3] = np.maximum.reduceat(array[:, 3], starts)
    return joined[:, [2, 3, 0, 1]]
