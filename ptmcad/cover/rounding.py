"""Boxes of floats rounded outward to a cover's lattice.

Guarantee: a rectangle holds its box and is less than two lattice steps longer on each side. A float
estimate with a bound on its error finds the step; only where floats overflow does rational
arithmetic.
"""

from __future__ import annotations

from fractions import Fraction
from math import isinf

import numpy as np
from numpy.typing import NDArray

from ptmcad.cover.rectangles import MAX_STEPS, Cover, Window

Integers = NDArray[np.int64]
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
