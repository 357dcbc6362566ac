"""Affine forms of formulas over a box, in compiled code: a value in the middle, slopes by the variables, and an error.

Guarantee: over a box with the middle m and half widths r, a value at the point m + r e, with each |e_j| at most 1, is
within ``error`` of center + sum of slopes_j e_j, and it lies in [low, high]. An error that is infinite claims nothing.
The error of each operation's own linearisation is a bound of its second derivative times half the square of how far its
operands are from their centers; rounding adds 2^-49 of all numbers that were added up.

(J. Stolfi and L. H. de Figueiredo, Self-Validated Numerical Methods and Applications, 1997, chapter 3.)
"""

from __future__ import annotations

from math import cos, inf, sin, sqrt
from typing import Any

import numpy as np

from ptmcad.verification.exclusion.arithmetic import operation, outward, reach
from ptmcad.verification.exclusion.compiled import compiled
from ptmcad.verification.exclusion.formulas import (
    ADD,
    CONSTANT,
    COSINE,
    DIRECTION,
    DIVIDE,
    INVERSE_LENGTH,
    MULTIPLY,
    SINE,
    SQUARE,
    VARIABLE,
)

_ROUNDING = 2.0**-49
_BENT = 0.58
"""More than half of 2/sqrt(3): |h|^2/l^2 times that is the most of the second derivative of a unit vector along h."""


@compiled
def evaluate(tape: Any, box: Any, forms: Any, start: int, end: int) -> None:
    """The affine forms of some of the values of a tape.

    Parameters
    ----------
    box : (variables, 2).
    start, end : of the operations; those before were evaluated over the same box.
    forms : (operations, variables + 4): slopes, center, error, low, high.
    """
    nv = box.shape[0]
    c, e, low, high = nv, nv + 1, nv + 2, nv + 3
    for n in range(start, end):
        code, i, j, f = tape.code[n], tape.first[n], tape.second[n], forms[n]
        for k in range(nv):
            f[k] = 0.0
        if code <= VARIABLE:
            a, b = (tape.low[n], tape.high[n]) if code == CONSTANT else (box[i, 0], box[i, 1])
            f[c], f[e], f[low], f[high] = 0.5 * (a + b), 0.0, a, b
            wide = max(b - f[c], f[c] - a) * (1 + 2.0**-50)
            if code == VARIABLE:
                f[i] = wide
            else:
                f[e] = wide
            continue
        a, b = operation(code, forms[i, low], forms[i, high], forms[j, low], forms[j, high])
        f[low], f[high] = a, b
        if a == -inf or forms[i, e] == inf or forms[j, e] == inf:
            _flat(f, nv)
            continue
        if code <= MULTIPLY:
            _binary(code, f, forms[i], forms[j], nv)
        elif code == DIVIDE:
            _quotient(f, forms[i], forms[j], nv)
        elif code in (SQUARE, COSINE, SINE):
            _unary(code, f, forms[i], nv)
        else:
            _of_vector(code, f, forms[i], forms[j], nv)
        _settle(f, nv)


@compiled
def _flat(f: Any, nv: int) -> None:
    """A form without slopes, from the interval."""
    for k in range(nv):
        f[k] = 0.0
    a, b = f[nv + 2], f[nv + 3]
    f[nv], f[nv + 1] = 0.0, inf
    if a > -inf:
        f[nv] = 0.5 * (a + b)
        f[nv + 1] = max(b - f[nv], f[nv] - a) * (1 + 2.0**-50)


@compiled
def _settle(f: Any, nv: int) -> None:
    """Make the interval as narrow as the form says; drop the form where the interval alone is narrower."""
    total = f[nv + 1]
    for k in range(nv):
        total += abs(f[k])
    size = abs(f[nv]) + total
    if not size < 1e150:
        _flat(f, nv)
        return
    f[nv + 1] += _ROUNDING * size
    total += 2 * _ROUNDING * size
    if f[nv + 1] > 0.5 * (f[nv + 3] - f[nv + 2]):
        _flat(f, nv)
        return
    a, b = outward(f[nv] - total, f[nv] + total)
    f[nv + 2], f[nv + 3] = max(f[nv + 2], a), min(f[nv + 3], b)


@compiled
def radius(f: Any, nv: int) -> float:
    """How far a form may be from its center."""
    total = f[nv + 1]
    for k in range(nv):
        total += abs(f[k])
    return float(total * (1 + _ROUNDING))


@compiled
def _binary(code: int, f: Any, p: Any, q: Any, nv: int) -> None:
    """Sum, difference and product."""
    c, e = nv, nv + 1
    if code != MULTIPLY:
        sign = 1.0 if code == ADD else -1.0
        for k in range(nv):
            f[k] = p[k] + sign * q[k]
        f[c], f[e] = p[c] + sign * q[c], p[e] + q[e]
        f[e] += _ROUNDING * (abs(p[c]) + abs(q[c]) + radius(p, nv) + radius(q, nv)) * 0.125
        return
    same = mixed = 0.0
    for k in range(nv):
        f[k] = p[c] * q[k] + q[c] * p[k]
        same += p[k] * q[k]
        mixed += abs(p[k] * q[k])
    # the squares of the variables' shares are between 0 and 1
    r, s = radius(p, nv), radius(q, nv)
    f[c] = p[c] * q[c] + 0.5 * same
    f[e] = abs(p[c]) * q[e] + abs(q[c]) * p[e] + (r * s - 0.5 * mixed)
    f[e] += _ROUNDING * (abs(p[c]) + r) * (abs(q[c]) + s)


@compiled
def _linear(f: Any, p: Any, nv: int, value: float, slope: float, least: float, most: float) -> None:
    """value + slope (p - center) + what is between least and most."""
    for k in range(nv):
        f[k] = slope * p[k]
    f[nv] = value + 0.5 * (least + most)
    f[nv + 1] = abs(slope) * p[nv + 1] + 0.5 * (most - least)
    f[nv + 1] += _ROUNDING * (abs(value) + abs(slope) * radius(p, nv) + abs(least) + abs(most))


@compiled
def _unary(code: int, f: Any, p: Any, nv: int) -> None:
    at, r = p[nv], radius(p, nv)
    half = 0.5 * r * r
    if code == SQUARE:
        _linear(f, p, nv, at * at, 2 * at, 0.0, 2 * half)
        f[nv + 1] += _ROUNDING * (at * at + 2 * abs(at) * r)
        return
    if not p[nv + 2] <= at <= p[nv + 3]:  # what is between has to be in the interval
        _flat(f, nv)
        return
    # the second derivative is the function itself with the other sign, and [low, high] has all its values
    a, b = f[nv + 2], f[nv + 3]
    least, most = min(0.0, -b * half), max(0.0, -a * half)
    if code == COSINE:
        _linear(f, p, nv, cos(at), -sin(at), least, most)
    else:
        _linear(f, p, nv, sin(at), cos(at), least, most)
    f[nv + 1] += _ROUNDING * (1 + r)


@compiled
def _quotient(f: Any, p: Any, q: Any, nv: int) -> None:
    """p times 1/q, where 1/(c + d) = 1/c - d/c^2 + d^2/(c^2 (c + d))."""
    at, r = q[nv], radius(q, nv)
    a, b = q[nv + 2], q[nv + 3]
    if not (a > 0.0 or b < 0.0) or not a <= at <= b:
        _flat(f, nv)
        return
    nearest = a if a > 0.0 else b
    bend = r * r / (at * at * nearest)
    inverse = np.empty(nv + 4)
    _linear(inverse, q, nv, 1 / at, -1 / (at * at), min(0.0, bend), max(0.0, bend))
    inverse[nv + 1] += _ROUNDING * (1 / abs(at) + r / (at * at) + abs(bend))
    _binary(MULTIPLY, f, p, inverse, nv)


@compiled
def _of_vector(code: int, f: Any, p: Any, q: Any, nv: int) -> None:
    """Direction, inverse length and length of a vector, about the length and direction in the middle."""
    c, e, low, high = nv, nv + 1, nv + 2, nv + 3
    least, _ = reach(p[low], p[high], q[low], q[high])
    x, y = p[c], q[c]
    length = sqrt(x * x + y * y)
    # the segment from the centers has to stay where the length is at least that
    if not (least > 0.0 and p[low] <= x <= p[high] and q[low] <= y <= q[high]):
        _flat(f, nv)
        return
    r, s = radius(p, nv), radius(q, nv)
    square = r * r + s * s
    ux, uy = x / length, y / length
    if code == DIRECTION:
        value, by_x, by_y = ux, uy * uy / length, -ux * uy / length
        bend = _BENT * square / (least * least)
        below, above = -bend, bend
    elif code == INVERSE_LENGTH:
        value, by_x, by_y = 1 / length, -ux / (length * length), -uy / (length * length)
        bend = 0.5 * square / (least * least * least)
        below, above = -bend, 2 * bend
    else:
        value, by_x, by_y = length, ux, uy
        below, above = 0.0, 0.5 * square / least
    for k in range(nv):
        f[k] = by_x * p[k] + by_y * q[k]
    f[c] = value + 0.5 * (below + above)
    f[e] = abs(by_x) * p[e] + abs(by_y) * q[e] + 0.5 * (above - below)
    f[e] += 2 * _ROUNDING * (abs(value) + abs(by_x) * r + abs(by_y) * s + abs(below) + abs(above))


__all__ = ["evaluate", "radius"]
