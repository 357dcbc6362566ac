"""Strips: what a small box's linearised equations say of the curve's projection to the window, as
thin rectangles.

Guarantee: the projection of each solution in a box lies in the box's strip, and so in one of the
strip's pieces. (Lemma 16 of docs/soundness.md.)

Along a smooth curve a box's rectangle is as thick as it is long, but the strip is only as thick as
the curve is bent: its thickness goes with the square of its length. So pieces of strips cover as
little as the boxes of several more levels of the search, for the price of a few multiplications
each.
"""

from __future__ import annotations

from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.branchandprune import Boxes
from ptmcad.certified.contraction import (
    Workspace,
    linearise,
    precondition,
    row_coefficient,
    row_rest,
    workspace,
)
from ptmcad.certified.equationsystem import Arguments
from ptmcad.formulas.compilation import ONE, ZERO, compiled, inlined
from ptmcad.formulas.rounding import down, multiply, reciprocal, up
from ptmcad.formulas.tape import Floats

Strips = NDArray[np.float64]
"""Shape (k, 11): left, bottom, right, top of a box's projection; v, the coordinate (0 or 1) that is
enclosed when the other one, u, is known, or -1 where neither is; mu, mv; enclosures of c and q in
v = mv + c + q (u - mu)."""
NONE: Strips = np.empty((0, 11))
_V, _MU, _MV, _C, _Q = 4, 5, 6, 7, 9
MAX_PIECES = 256
MIN_PIECE_RISE = 0.25
"""A piece need not rise less along its strip than this part of the strip's thickness."""


@compiled
def strips(system: Arguments, boxes: Boxes) -> Strips:
    """The strips of boxes of a curve; boxes that turn out to hold no solution are left out.

    Parameters
    ----------
    boxes : shape (k, 2v); variables 0 and 1 are those of the plane, and the first two unknowns.
    """
    variables = boxes.shape[1] // 2
    m, n = system.jacobian.shape
    work = workspace(system, variables)
    widths = np.empty(n)
    result = np.empty((boxes.shape[0], 11))
    found = 0
    low, high = np.empty(variables), np.empty(variables)
    for k in range(boxes.shape[0]):
        for i in range(variables):
            low[i], high[i] = boxes[k, i], boxes[k, variables + i]
        usable = linearise(system, low, high, work)
        if usable < 0:
            continue
        strip = result[found]
        found += 1
        for i in range(len(strip)):
            strip[i] = 0.0
        strip[0], strip[1], strip[2], strip[3] = low[0], low[1], high[0], high[1]
        strip[_V] = -1
        if usable == 0:
            continue
        # eliminate all unknowns but the plane's: columns without width are not chosen
        for j in range(n):
            widths[j] = work.radius[j] if j > 1 else 0.0
        precondition(work, widths)
        thinnest = inf
        for i in range(m):
            if work.pivots[i] < 0:
                thinnest = min(thinnest, _solved(system, i, low, high, work, strip, thinnest))
    return result[:found].copy()


@inlined
def _solved(
    system: Arguments,
    i: int,
    low: Floats,
    high: Floats,
    work: Workspace,
    strip: Floats,
    thinnest: float,
) -> float:
    """Row i as a strip, if that is thinner than the thinnest so far; its thickness."""
    middle, radius = work.middle_low, work.radius
    c_low, c_high = row_rest(i, (ZERO, ONE), system, low, high, work)
    a_low, a_high = row_coefficient(i, ZERO, work)
    b_low, b_high = row_coefficient(i, ONE, work)
    dependent = 1
    if abs(a_low + a_high) * radius[0] > abs(b_low + b_high) * radius[1]:
        dependent = 0
        a_low, a_high, b_low, b_high = b_low, b_high, a_low, a_high
    # c + a (u - mu) + b (v - mv) = 0
    if not (b_low > 0 or b_high < 0):
        return inf
    u, v = reciprocal(b_low, b_high)
    c_low, c_high = multiply(-c_high, -c_low, u, v)
    q_low, q_high = multiply(-a_high, -a_low, u, v)
    thickness: float = (c_high - c_low) + (q_high - q_low) * radius[1 - dependent]
    if thickness < thinnest:
        strip[_V] = dependent
        strip[_MU], strip[_MV] = middle[1 - dependent], middle[dependent]
        strip[_C], strip[_C + 1] = c_low, c_high
        strip[_Q], strip[_Q + 1] = q_low, q_high
    return thickness


@inlined
def _shape(strip: NDArray[np.float64], v: int) -> tuple[float, float, float]:
    """How long a strip is in u, how steep, and how thick."""
    along = strip[3 - v] - strip[1 - v]
    slope = 0.5 * abs(strip[_Q] + strip[_Q + 1])
    return along, slope, (strip[_C + 1] - strip[_C]) + (strip[_Q + 1] - strip[_Q]) * along


@compiled
def _number_of_pieces(strip: NDArray[np.float64], area: float) -> int:
    """Into how many pieces a strip is cut if each may cover about ``area`` for being a step instead
    of slanted.
    """
    if strip[_V] < 0:
        return 1
    v = int(strip[_V])
    along, slope, thickness = _shape(strip, v)
    rise = along * slope
    wanted: float = min(
        sqrt(along * rise / area) if area > 0 else inf, rise / (MIN_PIECE_RISE * thickness + 1e-300)
    )
    if thickness > strip[2 + v] - strip[v]:
        return 1
    return ceil(min(max(wanted, 1.0), float(MAX_PIECES)))


@compiled
def numbers_of_pieces(strips: Strips, area: float) -> NDArray[np.int64]:
    """For each strip the number of its `pieces`, at most."""
    result = np.empty(strips.shape[0], np.int64)
    for k in range(strips.shape[0]):
        result[k] = _number_of_pieces(strips[k], area)
    return result


@compiled
def areas_of_pieces(strips: Strips, area: float) -> NDArray[np.float64]:
    """For each strip the sum of its `pieces`' areas, about."""
    result = np.empty(strips.shape[0])
    for k in range(strips.shape[0]):
        strip = strips[k]
        result[k] = (strip[2] - strip[0]) * (strip[3] - strip[1])
        v = int(strip[_V])
        if v >= 0:
            along, slope, thickness = _shape(strip, v)
            steps = along * slope / _number_of_pieces(strip, area)
            result[k] = min(result[k], along * (thickness + steps))
    return result


@compiled
def pieces(strips: Strips, area: float) -> Boxes:
    """Rectangles (left, bottom, right, top) that cover the strips, each of about ``area`` more than
    the strip.
    """
    numbers = numbers_of_pieces(strips, area)
    room = 0
    for k in range(len(numbers)):
        room += numbers[k]
    result = np.empty((room, 4))
    found = 0
    for k in range(strips.shape[0]):
        strip = strips[k]
        number = numbers[k]
        if strip[_V] < 0:
            for i in range(4):
                result[found, i] = strip[i]
            found += 1
            continue
        v = int(strip[_V])
        start = strip[1 - v]
        for s in range(number):
            end = strip[3 - v] if s == number - 1 else start + (strip[3 - v] - start) / (number - s)
            # u in [start, end], both of them floats that neighbouring pieces share
            low, high = multiply(
                strip[_Q], strip[_Q + 1], down(start - strip[_MU]), up(end - strip[_MU])
            )
            low = down(strip[_MV] + down(strip[_C] + low))
            high = up(strip[_MV] + up(strip[_C + 1] + high))
            # a number that is not one, from an overflow, says nothing
            low = low if low > strip[v] else strip[v]
            high = high if high < strip[2 + v] else strip[2 + v]
            if low <= high:
                result[found, 1 - v], result[found, 3 - v] = start, end
                result[found, v], result[found, 2 + v] = low, high
                found += 1
            start = end
    return result[:found].copy()
