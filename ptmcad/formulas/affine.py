"""A tape run on a box in affine arithmetic: each node as a linear function of the unknowns, with a
bounded error.

Guarantee: after a run that returns True, at every point of the box at which the operands of all
meets are equal, the k-th node's value is forms[k, CENTER] + the sum over j of forms[k, FIRST + j]
e_j + d with |d| <= forms[k, ERROR], and it lies in [low[k], high[k]]; e_j in [-1, 1] is the j-th
unknown's distance from ``AffineFrame.middle`` over ``AffineFrame.radius``. A run that returns False
has proved that there is no such point. (Lemma 24 of docs/soundness.md.)

Linear terms that cancel, as they do in the equations of equilibrium and in determinants, cancel
here; what is left of nonlinear ones is of second order. Nothing is differentiated: formulas that
hold at solutions only have forms, too.

The functions for single operations write to one row without a branch around it or a second way out:
numba counts references to arrays otherwise, which takes four times as long as the arithmetic.

References
----------
Stolfi & de Figueiredo, Self-Validated Numerical Methods and Applications (1997), chapter 3.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from ptmcad.formulas.compilation import compiled
from ptmcad.formulas.intervalarithmetic import (
    ADD,
    CONSTANT,
    COSINE,
    DIRECTION,
    INVERSE_LENGTH,
    LENGTH,
    MEET,
    MULTIPLY,
    NEGATE,
    SINE,
    SQUARE,
    SUBTRACT,
    VARIABLE,
)
from ptmcad.formulas.rounding import MAX_ANGLE, SINE_ERROR, sine_cosine
from ptmcad.formulas.tape import Floats, Indices, Program

Place = int
"""Of a node; compiled code is given numbers without a sign, see `Places`."""
LANES = 6
"""Slopes in a form: as many unknowns as a system may have here. Loops of a known length are written
out.
"""
POLAR = (DIRECTION, LENGTH, INVERSE_LENGTH)
CENTER, ERROR, REACH, FIRST = 0, 1, 2, 3
"""Columns of a form: its value at the middle, the error, how far it is from the center at most, and
the slopes.
"""
ROUNDING = 2.0**-52
"""Twice the largest relative error of an operation."""
SLACK = 1 + 2.0**-48
"""Makes up for the rounding of a sum of some terms that are not negative."""
FLOOR = 1e-150
"""... and for that of numbers too small for a relative error; it keeps errors and reaches from
being zero.
"""
LARGE, SMALL_SQUARE, SMALL = 1e140, 1e-200, 1e-140
"""Beyond these nothing is claimed."""
MAX_TURN = 0.9
"""Of the distance of (x, y) from zero in its form, the largest part that it may vary by."""


class AffineFrame(NamedTuple):
    """The box that forms are written for.

    Attributes
    ----------
    middle, radius : of each variable, shape (v,): it lies between middle - radius and
        middle + radius.
    lane : the number of the slope of each variable, or -1 for one that is no unknown.
    """

    middle: Floats
    radius: Floats
    lane: Indices


@compiled
def frame_for(unknowns: Indices, variables: int) -> AffineFrame:
    """Space for the frames of a system with these unknowns."""
    lane = np.full(variables, -1)
    for j in range(len(unknowns)):
        lane[unknowns[j]] = j
    return AffineFrame(np.empty(variables), np.empty(variables), lane)


@compiled
def set_frame(frame: AffineFrame, box_low: Floats, box_high: Floats) -> None:
    """Lay the frame around a box."""
    for k in range(len(box_low)):
        middle = 0.5 * (box_low[k] + box_high[k])
        radius = max(middle - box_low[k], box_high[k] - middle)
        frame.middle[k] = middle
        frame.radius[k] = radius + (ROUNDING * radius + FLOOR)


@compiled
def _set_range(forms: Floats, k: Place, low: Floats, high: Floats) -> bool:
    """Give the form its reach; where intervals know more, the interval; False when both have
    nothing in common.
    """
    reach, center = forms[k, ERROR], forms[k, CENTER]
    for j in range(FIRST, FIRST + LANES):
        reach += abs(forms[k, j])
    reach = reach * SLACK + FLOOR
    margin = ROUNDING * (abs(center) + reach) + FLOOR
    u, v, error = low[k], high[k], forms[k, ERROR]
    known = reach < LARGE and abs(center) < LARGE
    bottom, top = center - reach - margin, center + reach + margin
    u = u if u >= bottom or not known else bottom
    v = v if v <= top or not known else top
    low[k], high[k] = u, v
    kept = known and error <= 0.5 * (v - u)
    middle = 0.5 * (u + v)
    half = max(middle - u, v - middle)
    half += ROUNDING * half + FLOOR
    finite = abs(middle) < LARGE and half < LARGE
    middle, half = (middle if finite else 0.0), (half if finite else inf)
    for j in range(FIRST, FIRST + LANES):
        slope = forms[k, j]
        forms[k, j] = slope if kept else 0.0
    forms[k, CENTER] = center if kept else middle
    forms[k, ERROR] = error if kept else half
    forms[k, REACH] = reach if kept else half
    return not u > v


@compiled
def _multiply(forms: Floats, k: Place, a: Place, b: Place) -> None:
    """(a0 + A + r)(b0 + B + s) = a0 b0 + a0 B + b0 A + ..., where e_j^2 = 1/2 up to 1/2 in A B."""
    a0, b0 = forms[a, CENTER], forms[b, CENTER]
    center = a0 * b0
    for j in range(FIRST, FIRST + LANES):
        forms[k, j] = a0 * forms[b, j] + b0 * forms[a, j]
    r, s = forms[a, REACH], forms[b, REACH]
    a0, b0 = abs(a0), abs(b0)
    error = a0 * forms[b, ERROR] + b0 * forms[a, ERROR] + r * s
    forms[k, CENTER] = center
    forms[k, ERROR] = (error + 8 * ROUNDING * ((a0 + r) * (b0 + s))) * SLACK + FLOOR


@compiled
def _square(forms: Floats, k: Place, a: Place) -> None:
    """(a0 + A + r)^2 = a0^2 + 2 a0 (A + r) + (A + r)^2, the last one between 0 and the reach's
    square.
    """
    a0, reach = forms[a, CENTER], forms[a, REACH]
    half = 0.5 * reach * reach
    size = a0 * a0 + half
    for j in range(FIRST, FIRST + LANES):
        forms[k, j] = 2 * a0 * forms[a, j]
        size += abs(forms[k, j])
    forms[k, CENTER] = a0 * a0 + half
    forms[k, ERROR] = (2 * abs(a0) * forms[a, ERROR] + half + 8 * ROUNDING * size) * SLACK + FLOOR


@compiled
def _add(forms: Floats, k: Place, a: Place, b: Place, sign: float) -> None:
    """a + b, or a - b if the sign is -1."""
    center = forms[a, CENTER] + sign * forms[b, CENTER]
    size = abs(center)
    for j in range(FIRST, FIRST + LANES):
        slope = forms[a, j] + sign * forms[b, j]
        forms[k, j] = slope
        size += abs(slope)
    forms[k, CENTER] = center
    forms[k, ERROR] = (forms[a, ERROR] + forms[b, ERROR] + ROUNDING * size) * SLACK + FLOOR


@compiled
def _sine(forms: Floats, k: Place, a: Place, cosine: bool) -> None:
    """sin(m + d) = sin m cos d + cos m sin d, with 1 - d^2/2 <= cos d <= 1 and |sin
    d - d| <= |d|^3/6.
    """
    m, reach, error = forms[a, CENTER], forms[a, REACH], forms[a, ERROR]
    usable = abs(m) < MAX_ANGLE and reach < 4
    s, c = sine_cosine(m if usable else 0.0)
    s, c = (c, -s) if cosine else (s, c)
    bend = 0.25 * reach * reach
    for j in range(FIRST, FIRST + LANES):
        forms[k, j] = c * forms[a, j]
    forms[k, CENTER] = s * (1 - bend)
    error = abs(c) * error + abs(s) * bend + abs(c) * reach * bend * (2 / 3)
    error = (error + (8 * ROUNDING + 2 * SINE_ERROR) * (1 + reach + bend)) * SLACK + FLOOR
    forms[k, ERROR] = error if usable else inf


@compiled
def _polar(forms: Floats, k: Place, a: Place, b: Place, operation: int) -> None:
    """x/l, l or 1/l of z = x + iy, l = |z|.

    With z = z0 (1 + p + iq), z0 the center: l = |z0| |1 + p + iq|, and z/l is z0/|z0| turned by an
    angle t with cos t = (1 + p)/|1 + p + iq|, sin t = q/|1 + p + iq|.
    """
    x, y, error_x, error_y = forms[a, CENTER], forms[b, CENTER], forms[a, ERROR], forms[b, ERROR]
    square = x * x + y * y
    usable = square > SMALL_SQUARE and forms[a, REACH] < LARGE and forms[b, REACH] < LARGE
    l0 = sqrt(square if usable else 1.0)
    r0 = 1 / l0
    ux, uy = x * r0, y * r0
    # the slopes of the result are combinations of those of p and q
    by_p = 0.0 if operation == DIRECTION else l0 if operation == LENGTH else -r0
    by_q = -uy if operation == DIRECTION else 0.0
    most_p = most_q = size = 0.0
    for j in range(FIRST, FIRST + LANES):
        s, t = forms[a, j] * r0, forms[b, j] * r0
        p, q = ux * s + uy * t, ux * t - uy * s
        most_p += abs(p)
        most_q += abs(q)
        size += abs(s) + abs(t)
        forms[k, j] = by_p * p + by_q * q
    rounding = 16 * ROUNDING * size
    error_p = ((abs(ux) * error_x + abs(uy) * error_y) * r0 + rounding) * SLACK + FLOOR
    error_q = ((abs(ux) * error_y + abs(uy) * error_x) * r0 + rounding) * SLACK + FLOOR
    most_p, most_q = (most_p + error_p) * SLACK, (most_q + error_q) * SLACK
    usable = usable and most_p < MAX_TURN
    near = 1 / (1 - (most_p if usable else 0.0)) * SLACK
    square_q = most_q * most_q
    if operation == DIRECTION:
        # cos t is between 1 - q^2/(2 (1 + p)^2) and 1; sin t = q/|1 + p + iq|, and that inverse is
        # near 1
        bend = 0.25 * square_q * near * near
        off = max(near - 1, most_p + 0.5 * square_q)
        center = ux * (1 - bend)
        error = (
            abs(ux) * bend
            + abs(uy) * (error_q + most_q * off)
            + 16 * ROUNDING * (1 + bend + most_q)
        )
    elif operation == LENGTH:
        # between 1 + p and 1 + p + q^2/(2 (1 + p))
        bend = 0.25 * square_q * near
        center = l0 * (1 + bend)
        error = l0 * (error_p + bend + 16 * ROUNDING * (2 + bend + size))
    else:
        # between 1/(1 + p) - q^2/(2 (1 + p)^3) and 1/(1 + p) = 1 - p + p^2/(1 + p)
        more, less = most_p * most_p * near, 0.5 * square_q * near * near * near
        center = r0 * (1 + 0.5 * (more - less))
        error = r0 * (error_p + 0.5 * (more + less) + 16 * ROUNDING * (2 + size + more + less))
    forms[k, CENTER] = center
    forms[k, ERROR] = error * SLACK + FLOOR if usable else inf


@compiled
def _reciprocal(forms: Floats, k: Place, b: Place, low: float, high: float) -> None:
    """1/x for x in [low, high], which has not 0: for x > 0 and any p > 0, 2 sqrt p <= 1/x + p x,
    largest at an end.
    """
    usable = (low > SMALL or high < -SMALL) and forms[b, REACH] < LARGE and high - low < LARGE
    sign = -1.0 if high < 0 else 1.0
    u, v = min(abs(low), abs(high)), max(abs(low), abs(high))
    u, v = (u if usable else 1.0), (v if usable else 1.0)
    p = 1 / (u * v)
    least = 2 * sqrt(p) * (1 - 4 * ROUNDING)
    most = max(1 / u + p * u, 1 / v + p * v) * (1 + 4 * ROUNDING)
    reach = 0.0
    for j in range(FIRST, FIRST + LANES):
        slope = -p * forms[b, j]
        forms[k, j] = slope
        reach += abs(slope)
    linear = p * forms[b, CENTER]
    error = 0.5 * (most - least) + p * forms[b, ERROR] + 8 * ROUNDING * (abs(linear) + reach + most)
    error = error * SLACK + FLOOR if usable else inf
    forms[k, CENTER] = sign * 0.5 * (least + most) - linear
    forms[k, ERROR] = error
    forms[k, REACH] = (reach + error) * SLACK + FLOOR


@compiled
def _variable(forms: Floats, k: Place, middle: float, radius: float, lane: int) -> None:
    """An unknown, which is all slope, or another variable, which is all error."""
    forms[k, CENTER] = middle
    forms[k, ERROR] = radius if lane < 0 else 0.0
    forms[k, REACH] = radius
    for j in range(LANES):
        forms[k, FIRST + j] = radius if j == lane else 0.0


@compiled
def run_affine(
    program: Program, frame: AffineFrame, low: Floats, high: Floats, forms: Floats, end: int
) -> bool:
    """Run the nodes before ``end``, which have been run in intervals on the frame's box or on one
    around it.

    Parameters
    ----------
    low, high : made narrower, where forms know more.
    forms : shape (n + 1, FIRST + LANES), for a tape of n nodes.
    """
    operations, first, second, _, _ = program
    scratch: int = np.uint64(len(operations))  # type: ignore[assignment]
    possible = True
    for i in range(np.uint64(0), np.uint64(end)):
        operation, a, b = operations[i], first[i], second[i]
        if operation == VARIABLE:
            _variable(forms, i, frame.middle[a], frame.radius[a], frame.lane[a])
            continue
        if operation == MULTIPLY:
            _multiply(forms, i, a, b)
        elif operation == ADD:
            _add(forms, i, a, b, 1.0)
        elif operation == SUBTRACT:
            _add(forms, i, a, b, -1.0)
        elif operation == NEGATE:
            forms[i, CENTER], forms[i, ERROR] = -forms[a, CENTER], forms[a, ERROR]
            for j in range(FIRST, FIRST + LANES):
                forms[i, j] = -forms[a, j]
        elif operation == SQUARE:
            _square(forms, i, a)
        elif operation == CONSTANT:
            forms[i, ERROR] = inf  # no form of its own: `_set_range` makes that of the interval
        elif operation == SINE:
            _sine(forms, i, a, False)
        elif operation == COSINE:
            _sine(forms, i, a, True)
        elif operation in POLAR:
            _polar(forms, i, a, b, operation)
        elif operation == MEET:
            low[i], high[i] = max(low[a], low[b]), min(high[a], high[b])
            better = a if forms[a, ERROR] <= forms[b, ERROR] else b
            for j in range(FIRST + LANES):
                forms[i, j] = forms[better, j]
        else:
            _reciprocal(forms, scratch, b, low[b], high[b])
            _multiply(forms, i, a, scratch)
        if not _set_range(forms, i, low, high):
            possible = False
            break
    return possible
