"""A tape run on a box in affine arithmetic: each node as a linear function of the unknowns, with a bounded error.

Guarantee: after a run that returns True, at every point of the box at which the operands of all meets are equal, the
k-th node's value is forms[k, CENTER] + sum over j of forms[k, FIRST + j] e_j + d with |d| <= forms[k, ERROR], where e_j
in [-1, 1] is the j-th unknown's distance from the box's middle over its radius; and it lies in [low[k], high[k]]. A run
that returns False has proved that there is no such point. (Lemma 24 of docs/soundness.md.)

References
----------
Stolfi & de Figueiredo, Self-Validated Numerical Methods and Applications (1997), chapter 3.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from ptmcad.certified.arithmetic import MAX_ANGLE, SINE_ERROR, TINY, down, sine_cosine, up
from ptmcad.certified.compiled import compiled, inlined
from ptmcad.certified.evaluation import (
    ADD, CONSTANT, COSINE, DIRECTION, DIVIDE, INVERSE_LENGTH, LENGTH, MEET, MULTIPLY, NEGATE, SINE, SQUARE, SUBTRACT,
    VARIABLE, Floats, Indices, Program,
)  # fmt: skip
from ptmcad.certified.system import Arguments

CENTER, ERROR, REACH, FIRST = 0, 1, 2, 3
"""Columns of a form: its value at the middle, the error, how far it is from the center at most, and the slopes."""
ROUNDING = 2.0**-52
"""Twice the largest relative error of an operation."""
SLACK = 1 + 2.0**-48
"""Makes up for the rounding of a sum of some ten numbers that are not negative."""
LARGE = 1e140


@inlined
def _set_range(forms: Floats, k: int, n: int, low: Floats, high: Floats) -> bool:
    """Give the form its reach; where intervals know more, the interval; False when both have nothing in common."""
    reach = forms[k, ERROR]
    for j in range(FIRST, FIRST + n):
        reach += abs(forms[k, j])
    reach = reach * SLACK + TINY
    forms[k, REACH] = reach
    center = forms[k, CENTER]
    if not (reach < LARGE and abs(center) < LARGE):
        _interval(forms, k, n, low[k], high[k])
        return True
    margin = ROUNDING * (abs(center) + reach) + TINY
    u, v = center - reach - margin, center + reach + margin
    if not low[k] >= u:
        low[k] = u
    if not high[k] <= v:
        high[k] = v
    if low[k] > high[k]:
        return False
    if forms[k, ERROR] > 0.5 * (high[k] - low[k]):
        _interval(forms, k, n, low[k], high[k])
    return True


@inlined
def _interval(forms: Floats, k: int, n: int, low: float, high: float) -> None:
    """The form of which only an interval is known."""
    for j in range(FIRST, FIRST + n):
        forms[k, j] = 0.0
    center = 0.5 * (low + high)
    reach = max(center - low, high - center)
    reach += ROUNDING * reach + TINY
    if not (abs(center) < LARGE and reach < LARGE):
        center, reach = 0.0, inf
    forms[k, CENTER], forms[k, ERROR], forms[k, REACH] = center, reach, reach


@compiled
def _multiply(forms: Floats, k: int, a: int, b: int, n: int) -> None:
    """(a0 + A + r)(b0 + B + s) = a0 b0 + a0 B + b0 A + ..., where e_j^2 = 1/2 up to 1/2 in A B."""
    a0, b0 = forms[a, CENTER], forms[b, CENTER]
    known = spread = size = 0.0
    for j in range(FIRST, FIRST + n):
        p, q = forms[a, j], forms[b, j]
        slope = a0 * q + b0 * p
        size += abs(a0 * q) + abs(b0 * p)
        forms[k, j] = slope
        known += p * q
        spread += abs(p * q)
    center = a0 * b0 + 0.5 * known
    size += abs(a0 * b0) + spread
    rest = forms[a, REACH] * forms[b, REACH] * SLACK - 0.5 * spread * (1 - 2.0**-48)
    error = abs(a0) * forms[b, ERROR] + abs(b0) * forms[a, ERROR] + rest
    forms[k, CENTER] = center
    forms[k, ERROR] = (error + 8 * ROUNDING * size) * SLACK + TINY


@compiled
def _square(forms: Floats, k: int, a: int, n: int) -> None:
    """(a0 + A + r)^2 = a0^2 + 2 a0 (A + r) + (A + r)^2, the last one between 0 and the reach's square."""
    a0, reach = forms[a, CENTER], forms[a, REACH]
    half = 0.5 * reach * reach
    size = a0 * a0 + half
    for j in range(FIRST, FIRST + n):
        forms[k, j] = 2 * a0 * forms[a, j]
        size += abs(forms[k, j])
    forms[k, CENTER] = a0 * a0 + half
    forms[k, ERROR] = (2 * abs(a0) * forms[a, ERROR] + half + 8 * ROUNDING * size) * SLACK + TINY


@compiled
def _add(forms: Floats, k: int, a: int, b: int, n: int, sign: float) -> None:
    """a + b, or a - b if the sign is -1."""
    center = forms[a, CENTER] + sign * forms[b, CENTER]
    size = abs(center)
    for j in range(FIRST, FIRST + n):
        slope = forms[a, j] + sign * forms[b, j]
        forms[k, j] = slope
        size += abs(slope)
    forms[k, CENTER] = center
    forms[k, ERROR] = (forms[a, ERROR] + forms[b, ERROR] + ROUNDING * size) * SLACK + TINY


@compiled
def _sine(forms: Floats, k: int, a: int, n: int, quarter: int) -> None:
    """sin(m + d) = sin m cos d + cos m sin d, with 1 - d^2/2 <= cos d <= 1 and |sin d - d| <= |d|^3/6."""
    m, reach = forms[a, CENTER], forms[a, REACH]
    if not (abs(m) < MAX_ANGLE and reach < 4):
        forms[k, CENTER], forms[k, ERROR] = 0.0, inf
        return
    s, c = sine_cosine(m)
    if quarter == 1:
        s, c = c, -s
    bend = 0.25 * reach * reach
    forms[k, CENTER] = s * (1 - bend)
    size = 0.0
    for j in range(FIRST, FIRST + n):
        forms[k, j] = c * forms[a, j]
        size += abs(forms[k, j])
    error = abs(c) * forms[a, ERROR] + abs(s) * bend + abs(c) * reach * bend * (2 / 3)
    forms[k, ERROR] = (error + 8 * ROUNDING * (size + 1) + 2 * SINE_ERROR * (1 + reach)) * SLACK + TINY


@compiled
def _polar(forms: Floats, k: int, a: int, b: int, n: int, operation: int) -> None:
    """x/l, l or 1/l of z = x + iy, l = |z|.

    With z = z0 (1 + p + iq), z0 the center: l = |z0| |1 + p + iq|, and z/l is z0/|z0| turned by an angle t with
    cos t = (1 + p)/|1 + p + iq|, sin t = q/|1 + p + iq|.
    """
    x, y = forms[a, CENTER], forms[b, CENTER]
    square = x * x + y * y
    forms[k, CENTER], forms[k, ERROR] = 0.0, inf
    if not (square > 1e-200 and forms[a, REACH] < LARGE and forms[b, REACH] < LARGE):
        return
    l0 = sqrt(square)
    ux, uy, r0 = x / l0, y / l0, 1 / l0
    # reaches of p and q, and errors in them
    most_p = most_q = size = 0.0
    for j in range(FIRST, FIRST + n):
        s, t = forms[a, j] * r0, forms[b, j] * r0
        p, q = ux * s + uy * t, ux * t - uy * s
        most_p += abs(p)
        most_q += abs(q)
        size += abs(s) + abs(t)
        # slopes so far: of the turned unit vector, of the length, of its inverse
        if operation == DIRECTION:
            forms[k, j] = -uy * q
        elif operation == LENGTH:
            forms[k, j] = l0 * p
        else:
            forms[k, j] = -r0 * p
    rounding = 16 * ROUNDING * size
    error_p = ((abs(ux) * forms[a, ERROR] + abs(uy) * forms[b, ERROR]) * r0 + rounding) * SLACK + TINY
    error_q = ((abs(ux) * forms[b, ERROR] + abs(uy) * forms[a, ERROR]) * r0 + rounding) * SLACK + TINY
    most_p, most_q = (most_p + error_p) * SLACK, (most_q + error_q) * SLACK
    if not most_p < 0.9:
        return
    near = 1 / (1 - most_p) * SLACK
    square_q = most_q * most_q * SLACK
    if operation == DIRECTION:
        # cos t is between 1 - q^2/(2 (1 + p)^2) and 1; sin t = q/l with |1/|1+p+iq| - 1| at most `off`
        bend = 0.25 * square_q * near * near
        off = max((near - 1) * SLACK, most_p + 0.5 * square_q)
        forms[k, CENTER] = ux * (1 - bend)
        error = abs(ux) * bend + abs(uy) * (error_q + most_q * off) + 16 * ROUNDING * (1 + most_q)
    elif operation == LENGTH:
        # between 1 + p and 1 + p + q^2/(2 (1 + p))
        bend = 0.25 * square_q * near
        forms[k, CENTER] = l0 * (1 + bend)
        error = l0 * (error_p + bend + 16 * ROUNDING * (2 + size))
    else:
        # between 1/(1 + p) - q^2/(2 (1 + p)^3) and 1/(1 + p) = 1 - p + p^2/(1 + p)
        more, less = most_p * most_p * near, 0.5 * square_q * near * near * near
        forms[k, CENTER] = r0 * (1 + 0.5 * (more - less))
        error = r0 * (error_p + 0.5 * (more + less) + 16 * ROUNDING * (2 + size + more + less))
    forms[k, ERROR] = error * SLACK + TINY


@compiled
def _reciprocal(forms: Floats, k: int, b: int, n: int, low: float, high: float) -> None:
    """1/x for x in [low, high], which has not 0: for x > 0 and any p > 0, 2 sqrt p <= 1/x + p x, largest at an end."""
    forms[k, CENTER], forms[k, ERROR] = 0.0, inf
    if not (low > 1e-140 or high < -1e-140) or not forms[b, REACH] < LARGE:
        return
    u, v, sign = (low, high, 1.0) if low > 0 else (-high, -low, -1.0)
    p = 1 / (u * v)
    least = 2 * sqrt(p) * (1 - 4 * ROUNDING)
    most = max(1 / u + p * u, 1 / v + p * v) * (1 + 4 * ROUNDING)
    size = p * abs(forms[b, CENTER])
    for j in range(FIRST, FIRST + n):
        forms[k, j] = -p * forms[b, j]
        size += abs(forms[k, j])
    forms[k, CENTER] = sign * 0.5 * (least + most) - p * forms[b, CENTER]
    error = 0.5 * (most - least) + p * forms[b, ERROR] + 8 * ROUNDING * (size + most)
    forms[k, ERROR] = error * SLACK + TINY


@compiled
def run_affine(
    program: Program, box_low: Floats, box_high: Floats, unknowns: Indices, low: Floats, high: Floats, forms: Floats,
    start: int, end: int,
) -> bool:  # fmt: skip
    """Run the nodes from ``start`` to before ``end``, which have been run in intervals on this box."""
    operations, first, second, _, _ = program
    n = len(unknowns)
    scratch = len(operations)
    for i in range(start, end):
        operation, a, b = operations[i], int(first[i]), int(second[i])
        if operation == CONSTANT:
            _interval(forms, i, n, low[i], high[i])
            continue
        if operation == VARIABLE:
            _interval(forms, i, n, low[i], high[i])
            for j in range(n):
                if unknowns[j] == a:
                    forms[i, FIRST + j] = forms[i, ERROR]
                    forms[i, ERROR] = 0.0
            continue
        if operation == MULTIPLY:
            _multiply(forms, i, a, b, n)
        elif operation == ADD:
            _add(forms, i, a, b, n, 1.0)
        elif operation == SUBTRACT:
            _add(forms, i, a, b, n, -1.0)
        elif operation == NEGATE:
            forms[i, CENTER], forms[i, ERROR] = -forms[a, CENTER], forms[a, ERROR]
            for j in range(FIRST, FIRST + n):
                forms[i, j] = -forms[a, j]
        elif operation == SQUARE:
            _square(forms, i, a, n)
        elif operation == SINE:
            _sine(forms, i, a, n, 0)
        elif operation == COSINE:
            _sine(forms, i, a, n, 1)
        elif operation == DIRECTION or operation == LENGTH or operation == INVERSE_LENGTH:
            _polar(forms, i, a, b, n, operation)
        elif operation == MEET:
            low[i], high[i] = max(low[a], low[b]), min(high[a], high[b])
            c = a if forms[a, ERROR] <= forms[b, ERROR] else b
            for j in range(FIRST + n):
                forms[i, j] = forms[c, j]
        else:
            _reciprocal(forms, scratch, b, n, low[b], high[b])
            if forms[scratch, ERROR] < LARGE:
                reach = forms[scratch, ERROR]
                for j in range(FIRST, FIRST + n):
                    reach += abs(forms[scratch, j])
                forms[scratch, REACH] = reach * SLACK + TINY
                _multiply(forms, i, a, scratch, n)
            else:
                forms[i, CENTER], forms[i, ERROR] = 0.0, inf
        if not _set_range(forms, i, n, low, high):
            return False
    return True


class Rows(NamedTuple):
    """Linear equations sum over j of slopes[i, j] e_j + centers[i] + d = 0 with |d| <= errors[i].

    Those from ``equations`` on are not negative in place of zero. ``low``, ``high``: what is known of each e_j.
    """

    slopes: Floats
    centers: Floats
    errors: Floats
    pivots: Indices
    low: Floats
    high: Floats


@compiled
def rows_for(system: Arguments) -> Rows:
    """Space for the rows of a system."""
    n = len(system.unknowns)
    m = len(system.cheap) + len(system.rest) + len(system.costly) + len(system.nonnegative)
    return Rows(
        np.empty((m, n)), np.empty(m), np.empty(m), np.empty(m, np.int64), np.empty(n), np.empty(n),
    )  # fmt: skip


@inlined
def _take(rows: Rows, m: int, places: Indices, forms: Floats, n: int) -> int:
    """Append the forms at the places that have an error; returns how many rows there are."""
    for place in places:
        if forms[place, ERROR] < LARGE:
            for j in range(n):
                rows.slopes[m, j] = forms[place, FIRST + j]
            rows.centers[m], rows.errors[m] = forms[place, CENTER], forms[place, ERROR]
            rows.pivots[m] = -1
            m += 1
    return m


@compiled
def contract_affine(
    system: Arguments, box_low: Floats, box_high: Floats, low: Floats, high: Floats, forms: Floats, rows: Rows
) -> int:
    """Shrink the box in place around the solutions in it, after its tape was run: -1 none, 1 much narrower, 0 else."""
    n = len(system.unknowns)
    if not run_affine(system.program, box_low, box_high, system.unknowns, low, high, forms, 0, system.stages[2]):
        return -1
    for place in system.nonnegative:
        if high[place] < 0:
            return -1
    for places in (system.cheap, system.rest, system.costly):
        for place in places:
            if low[place] > 0 or high[place] < 0:
                return -1
    equal = _take(rows, 0, system.cheap, forms, n)
    equal = _take(rows, equal, system.rest, forms, n)
    equal = _take(rows, equal, system.costly, forms, n)
    count = _take(rows, equal, system.nonnegative, forms, n)
    for j in range(n):
        rows.low[j], rows.high[j] = -1.0, 1.0
    for _ in range(min(n, equal)):
        if not _eliminate(rows, equal, count, n):
            break
    for _ in range(2):
        for i in range(count):
            if not _bound(rows, i, n, i >= equal):
                return -1
    result = 0
    for j in range(n):
        x = system.unknowns[j]
        if rows.low[j] > -1 or rows.high[j] < 1:
            center = 0.5 * (box_low[x] + box_high[x])
            reach = max(center - box_low[x], box_high[x] - center)
            reach += ROUNDING * reach + TINY
            before = box_high[x] - box_low[x]
            box_low[x] = max(box_low[x], down(center + down(reach * rows.low[j])))
            box_high[x] = min(box_high[x], up(center + up(reach * rows.high[j])))
            if box_low[x] > box_high[x]:
                return -1
            if box_high[x] - box_low[x] < 0.8 * before:
                result = 1
    return result


@compiled
def _eliminate(rows: Rows, equal: int, count: int, n: int) -> bool:
    """Solve one more row for the unknown that it knows best, and put that into all others; False if none is left."""
    slopes, centers, errors, pivots = rows.slopes, rows.centers, rows.errors, rows.pivots
    best, row, column = 0.0, -1, -1
    for i in range(equal):
        if pivots[i] >= 0:
            continue
        for j in range(n):
            size = abs(slopes[i, j]) / (errors[i] + TINY)
            if size > best:
                taken = False
                for k in range(equal):
                    if pivots[k] == j:
                        taken = True
                if not taken:
                    best, row, column = size, i, j
    if row < 0 or best < 0.5:
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
        size += abs(slopes[i, column])
        slopes[i, column] = 0.0
        errors[i] = (errors[i] + abs(factor) * errors[row] + 2 * ROUNDING * size) * SLACK + TINY
    return True


@compiled
def _bound(rows: Rows, i: int, n: int, nonnegative: bool) -> bool:
    """What row i says of each unknown, if the others are where they are known to be; False if it cannot hold."""
    slopes, low, high = rows.slopes, rows.low, rows.high
    center, error = rows.centers[i], rows.errors[i]
    if not error < LARGE:
        return True
    least = most = size = 0.0
    for j in range(n):
        u, v = slopes[i, j] * low[j], slopes[i, j] * high[j]
        least += min(u, v)
        most += max(u, v)
        size += max(abs(u), abs(v))
    error = (error + 8 * ROUNDING * (size + abs(center))) * SLACK + TINY
    if center + most < -error or (not nonnegative and center + least > error):
        return False
    for j in range(n):
        slope = slopes[i, j]
        if abs(slope) <= 1e-100:
            continue
        u, v = slope * low[j], slope * high[j]
        # slope e_j lies between -(center + others' most) - error and -(center + others' least) + error
        bottom = -(center + (most - max(u, v))) - error
        top = inf if nonnegative else -(center + (least - min(u, v))) + error
        if slope < 0:
            bottom, top, slope = -top, -bottom, -slope
        if bottom > slope * low[j]:
            low[j] = max(low[j], down(bottom / slope))
        if top < slope * high[j]:
            high[j] = min(high[j], up(top / slope))
        if low[j] > high[j]:
            return False
    return True
