"""What the affine forms of a system's formulas say together of a box: linear equations with bounded
errors.

Guarantee: `contract_linear` discards a box only if it holds no solution, and leaves every solution
in the box that it shrinks. (Lemma 25 of docs/soundness.md.)
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from ptmcad.certified.equationsystem import Arguments
from ptmcad.formulas.affine import (
    CENTER,
    ERROR,
    FIRST,
    FLOOR,
    LANES,
    LARGE,
    ROUNDING,
    SLACK,
    AffineFrame,
    frame_for,
    run_affine,
    set_frame,
)
from ptmcad.formulas.compilation import compiled
from ptmcad.formulas.rounding import down, up
from ptmcad.formulas.tape import Floats, Indices

MIN_GAIN = 0.5
"""A row is solved for an unknown if its slope is at least this part of its error."""
SHRINKAGE = 0.8
"""A width that is at most this part of what it was is worth another sweep."""
MIN_SLOPE = 1e-100
ROUNDS = 2


class _Rows(NamedTuple):
    """_Rows: the sum over j of slopes[i, j] e_j, plus centers[i], plus a number of at most
    errors[i], is zero; in the last rows, of formulas that are not negative, at least zero.

    Attributes
    ----------
    slopes, centers, errors : shapes (m, n), (m,) and (m,).
    pivots : the unknown that a row has been solved for, or -1.
    low, high : what is known of each e_j, shape (n,).
    """

    slopes: Floats
    centers: Floats
    errors: Floats
    pivots: Indices
    low: Floats
    high: Floats


Linear = tuple[Floats, AffineFrame, _Rows]
"""Forms, their frame, and rows: space that a search uses again for every box."""


@compiled
def space_for(system: Arguments, variables: int) -> Linear:
    """For boxes of this system."""
    n = len(system.unknowns)
    m = len(system.cheap) + len(system.rest) + len(system.costly) + len(system.nonnegative)
    forms = np.zeros((len(system.program.operations) + 1, FIRST + LANES))
    pivots = np.empty(m, np.int64)
    rows = _Rows(np.empty((m, n)), np.empty(m), np.empty(m), pivots, np.empty(n), np.empty(n))
    return forms, frame_for(system.unknowns, variables), rows


@compiled
def contract_linear(
    system: Arguments, box_low: Floats, box_high: Floats, low: Floats, high: Floats, space: Linear
) -> int:
    """Shrink the box in place around the solutions in it: -1 there are none, 1 it is much narrower,
    0 else.

    Parameters
    ----------
    low, high : of the tape's nodes before the Jacobian, run in intervals on the box or on one
        around it.
    """
    forms, frame, rows = space
    set_frame(frame, box_low, box_high)
    if not run_affine(system.program, frame, low, high, forms, system.stages[2]):
        return -1
    equal = _take(rows, 0, system.cheap, forms)
    equal = _take(rows, equal, system.rest, forms)
    equal = _take(rows, equal, system.costly, forms)
    count = _take(rows, equal, system.nonnegative, forms)
    n = len(rows.low)
    for j in range(n):
        rows.low[j], rows.high[j] = -1.0, 1.0
    for i in range(count):
        if not _bound(rows, i, i >= equal):
            return -1
    for _ in range(min(n, equal)):
        if not _eliminate(rows, equal, count):
            break
    for _ in range(ROUNDS):
        for i in range(count):
            if not _bound(rows, i, i >= equal):
                return -1
    return _shrink(system.unknowns, box_low, box_high, frame, rows)


@compiled
def _take(rows: _Rows, count: int, places: Indices, forms: Floats) -> int:
    """Append the forms of these nodes that have a bounded error; returns how many rows there are."""
    for place in places:
        if forms[place, ERROR] < LARGE:
            for j in range(rows.slopes.shape[1]):
                rows.slopes[count, j] = forms[place, FIRST + j]
            rows.centers[count], rows.errors[count] = forms[place, CENTER], forms[place, ERROR]
            rows.pivots[count] = -1
            count += 1
    return count


@compiled
def _eliminate(rows: _Rows, equal: int, count: int) -> bool:
    """Solve one more row for the unknown that it knows best, and put that into all others; False if
    none is left.
    """
    slopes, centers, errors, pivots = rows.slopes, rows.centers, rows.errors, rows.pivots
    n = slopes.shape[1]
    best, row, column = MIN_GAIN, -1, -1
    for i in range(equal):
        for j in range(n):
            # of unknowns that have been solved for nothing is left in the other rows
            gain = abs(slopes[i, j]) / errors[i]
            if gain > best and pivots[i] < 0:
                best, row, column = gain, i, j
    if row < 0:
        return False
    pivots[row] = column
    for i in range(count):
        if i == row or slopes[i, column] == 0:
            continue
        factor = slopes[i, column] / slopes[row, column]
        size = 0.0
        for j in range(n):
            change = factor * slopes[row, j]
            size += abs(slopes[i, j]) + abs(change)
            slopes[i, j] -= change
        change = factor * centers[row]
        size += abs(centers[i]) + abs(change)
        centers[i] -= change
        slopes[i, column] = 0.0
        errors[i] = (errors[i] + abs(factor) * errors[row] + 2 * ROUNDING * size) * SLACK + FLOOR
    return True


@compiled
def _bound(rows: _Rows, i: int, nonnegative: bool) -> bool:
    """What row i, zero or not negative, says of each unknown where the others are bounded; False if
    it cannot hold.
    """
    slopes, low, high = rows.slopes, rows.low, rows.high
    center, error = rows.centers[i], rows.errors[i]
    least = most = size = 0.0
    for j in range(len(low)):
        u, v = slopes[i, j] * low[j], slopes[i, j] * high[j]
        least += min(u, v)
        most += max(u, v)
        size += max(abs(u), abs(v))
    error = (error + 8 * ROUNDING * (size + abs(center))) * SLACK + FLOOR
    if not error < LARGE:
        return True
    possible = not (center + most < -error or (center + least > error and not nonnegative))
    for j in range(len(low)):
        slope = abs(slopes[i, j])
        # slope e_j or its negative is at least `bottom` and at most `top`
        u, v = slopes[i, j] * low[j], slopes[i, j] * high[j]
        bottom = -(center + (most - max(u, v))) - error
        top = inf if nonnegative else -(center + (least - min(u, v))) + error
        bottom, top = (bottom, top) if slopes[i, j] > 0 else (-top, -bottom)
        if slope > MIN_SLOPE:
            if bottom > slope * low[j]:
                low[j] = max(low[j], down(bottom / slope))
            if top < slope * high[j]:
                high[j] = min(high[j], up(top / slope))
        possible = possible and low[j] <= high[j]
    return possible


@compiled
def _shrink(
    unknowns: Indices, box_low: Floats, box_high: Floats, frame: AffineFrame, rows: _Rows
) -> int:
    """Carry the bounds of each e_j over to the box; returns what `contract_linear` does."""
    result = 0
    for j in range(len(unknowns)):
        x = unknowns[j]
        if rows.low[j] > -1 or rows.high[j] < 1:
            middle, radius, before = frame.middle[x], frame.radius[x], box_high[x] - box_low[x]
            box_low[x] = max(box_low[x], down(middle + down(radius * rows.low[j])))
            box_high[x] = min(box_high[x], up(middle + up(radius * rows.high[j])))
            if box_low[x] > box_high[x]:
                result = -1
            elif box_high[x] - box_low[x] < SHRINKAGE * before and result == 0:
                result = 1
    return result
