"""Affine forms of formulas over a box, in compiled code: a value in the middle, slopes by the
variables, and an error; and the tapes of operations that are evaluated so.

Guarantee: over a box with the middle m and half widths r, a value at the point m + r e, with each
|e_j| at most 1, is within ``error`` of center + sum of slopes_j e_j, and it lies in [low, high]. An
error that is infinite claims nothing. The error of each operation's own linearisation is a bound of
its second derivative times half the square of how far its operands are from their centers; rounding
adds 2^-49 of all numbers that were added up.

A form is a row of as many slopes as there may be variables, those of variables that are not there
being zero: loops of a fixed length become a few instructions for several numbers at once, in a
quarter of the time.

(J. Stolfi and L. H. de Figueiredo, Self-Validated Numerical Methods and Applications, 1997, chapter
3.)
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import cos, inf, nextafter, sin, sqrt
from typing import Any, NamedTuple

import numpy as np

from ptmcad.verification.exclusion.arithmetic import compiled, inlined, operation, outward, reach
from ptmcad.verification.normalform.operations import (
    ADD,
    CONSTANT,
    COSINE,
    DIRECTION,
    DIVIDE,
    INVERSE_LENGTH,
    MAX_VARIABLES,
    MULTIPLY,
    SINE,
    SQUARE,
    SUBTRACT,
    VARIABLE,
    Formulas,
)


class IntervalTape(NamedTuple):
    """Operations in their order, in arrays.

    Attributes
    ----------
    code, first, second : of each value the operation and the numbers of its operands (of a variable
        its own number).
    low, high : enclosures of constants.
    """

    code: Any
    first: Any
    second: Any
    low: Any
    high: Any


def tape_of(
    formulas: Formulas, first: Sequence[int], wanted: Sequence[int]
) -> tuple[IntervalTape, int, list[int]]:
    """The operations that some values need, those of the first of them first.

    Returns
    -------
    The operations; how many of them the first values need; and the places of all.
    """
    early = formulas.needed(first)
    order = [*sorted(early), *sorted(formulas.needed(wanted) - early)]
    place = {n: k for k, n in enumerate(order)}
    low, high, rows = [], [], []
    for n in place:
        operation, a, b = formulas.rows[n]
        assert operation != VARIABLE or a < MAX_VARIABLES
        if operation > VARIABLE:
            a, b = place[a], place[b]
        rows.append((operation, a, b))
        below, above = enclosing(formulas.numbers.get(n, Fraction(0)))
        low.append(below)
        high.append(above)
    code, first_of, second = (np.array([row[k] for row in rows], dtype=np.int64) for k in range(3))
    tape = IntervalTape(code, first_of, second, np.array(low), np.array(high))
    return tape, len(early), [place[n] for n in (*first, *wanted)]


def enclosing(value: Fraction) -> tuple[float, float]:
    """Floats that a rational number lies between, or is equal to; infinite ones where there are no
    others.
    """
    try:
        near = float(value)
    except OverflowError:
        return (-inf, -1e308) if value < 0 else (1e308, inf)
    if Fraction(near) == value:
        return near, near
    return nextafter(near, -inf), nextafter(near, inf)


CENTER, ERROR, LOW, HIGH, WIDTH = range(MAX_VARIABLES, MAX_VARIABLES + 5)
"""Columns of a form after those of the slopes, and their number."""
_ROUNDING = 2.0**-49
_BENT = 0.58
"""More than half of 2/sqrt(3): |h|^2/l^2 times that is the most of the second derivative of a unit
vector along h.
"""


@compiled
def evaluate(tape: Any, box: Any, forms: Any, start: int, end: int) -> None:
    """The affine forms of some of the values of a tape.

    Parameters
    ----------
    box : (variables, 2).
    start, end : of the operations; those before were evaluated over the same box.
    forms : (operations, WIDTH): slopes, center, error, low, high.
    """
    for n in range(start, end):
        code, i, j = tape.code[n], tape.first[n], tape.second[n]
        if code <= VARIABLE:
            a, b = (tape.low[n], tape.high[n]) if code == CONSTANT else (box[i, 0], box[i, 1])
            forms[n, LOW], forms[n, HIGH] = a, b
            _flat(forms, n)
            if code == VARIABLE:
                forms[n, i], forms[n, ERROR] = forms[n, ERROR], 0.0
            continue
        a, b, c, d = forms[i, LOW], forms[i, HIGH], forms[j, LOW], forms[j, HIGH]
        a, b = operation(code, a, b, c, d)
        forms[n, LOW], forms[n, HIGH] = a, b
        if a == -inf or forms[i, ERROR] == inf or forms[j, ERROR] == inf:
            _flat(forms, n)
            continue
        if code == MULTIPLY:
            _product(forms, n, i, j)
        elif code <= SUBTRACT:
            _sum(forms, n, i, j, 1.0 if code == ADD else -1.0)
        elif code == DIVIDE:
            _quotient(forms, n, i, j)
        elif code in (SQUARE, COSINE, SINE):
            _unary(code, forms, n, i)
        else:
            _of_vector(code, forms, n, i, j)
        _settle(forms, n)


@inlined
def _flat(f: Any, n: int) -> None:
    """A form without slopes, from the interval."""
    for k in range(MAX_VARIABLES):
        f[n, k] = 0.0
    a, b = f[n, LOW], f[n, HIGH]
    middle, error = 0.0, inf
    if a > -inf:
        middle = 0.5 * (a + b)
        error = max(b - middle, middle - a) * (1 + 2.0**-50)
    f[n, CENTER], f[n, ERROR] = middle, error


@inlined
def _slopes(f: Any, n: int) -> float:
    """The sum of the slopes' sizes, in an order that leaves few additions to wait for."""
    total = 0.0
    for k in range(0, MAX_VARIABLES, 2):
        total += abs(f[n, k]) + abs(f[n, k + 1])
    return total


@inlined
def radius(f: Any, n: int) -> float:
    """How far a form may be from its center."""
    return float((_slopes(f, n) + f[n, ERROR]) * (1 + _ROUNDING))


@inlined
def _settle(f: Any, n: int) -> None:
    """Make the interval as narrow as the form says; drop the form where the interval alone is
    narrower.
    """
    center, error = f[n, CENTER], f[n, ERROR]
    total = _slopes(f, n) + error
    size = abs(center) + total
    error += _ROUNDING * size
    total += 2 * _ROUNDING * size
    if size < 1e150 and error <= 0.5 * (f[n, HIGH] - f[n, LOW]):
        a, b = outward(center - total, center + total)
        f[n, ERROR], f[n, LOW], f[n, HIGH] = error, max(f[n, LOW], a), min(f[n, HIGH], b)
    else:
        _flat(f, n)


@inlined
def _sum(f: Any, n: int, p: int, q: int, sign: float) -> None:
    """p + sign q"""
    for k in range(MAX_VARIABLES):
        f[n, k] = f[p, k] + sign * f[q, k]
    f[n, CENTER] = f[p, CENTER] + sign * f[q, CENTER]
    size = abs(f[p, CENTER]) + abs(f[q, CENTER]) + radius(f, p) + radius(f, q)
    f[n, ERROR] = f[p, ERROR] + f[q, ERROR] + _ROUNDING * size * 0.125


@inlined
def _product(f: Any, n: int, p: int, q: int) -> None:
    a, b = f[p, CENTER], f[q, CENTER]
    same = mixed = 0.0
    for k in range(0, MAX_VARIABLES, 2):
        one, two = f[p, k] * f[q, k], f[p, k + 1] * f[q, k + 1]
        same += one + two
        mixed += abs(one) + abs(two)
    r, s = radius(f, p), radius(f, q)
    for k in range(MAX_VARIABLES):
        f[n, k] = a * f[q, k] + b * f[p, k]
    # the squares of the variables' shares are between 0 and 1
    f[n, CENTER] = a * b + 0.5 * same
    f[n, ERROR] = abs(a) * f[q, ERROR] + abs(b) * f[p, ERROR] + (r * s - 0.5 * mixed)
    f[n, ERROR] += _ROUNDING * (abs(a) + r) * (abs(b) + s)


@inlined
def _linear(
    f: Any, n: int, p: int, value: float, slope: float, least: float, most: float, lost: float
) -> None:
    """value + slope (p - center) + what is between least and most, and rounding of so much more."""
    size = abs(value) + abs(slope) * radius(f, p) + abs(least) + abs(most) + lost
    for k in range(MAX_VARIABLES):
        f[n, k] = slope * f[p, k]
    f[n, CENTER] = value + 0.5 * (least + most)
    f[n, ERROR] = abs(slope) * f[p, ERROR] + 0.5 * (most - least) + _ROUNDING * size


@compiled
def _unary(code: int, f: Any, n: int, p: int) -> None:
    at, r = f[p, CENTER], radius(f, p)
    half = 0.5 * r * r
    value, slope, least, most, lost = at * at, 2 * at, 0.0, 2 * half, at * at + 2 * abs(at) * r
    if code != SQUARE:
        if not f[p, LOW] <= at <= f[p, HIGH]:  # what is between has to be in the interval
            _flat(f, n)
            return
        # the second derivative is the function itself with the other sign, and [low, high] has all
        # its values
        least, most, lost = min(0.0, -f[n, HIGH] * half), max(0.0, -f[n, LOW] * half), 1 + r
        value, slope = (cos(at), -sin(at)) if code == COSINE else (sin(at), cos(at))
    _linear(f, n, p, value, slope, least, most, lost)


@compiled
def _quotient(f: Any, n: int, p: int, q: int) -> None:
    """p times 1/q, where 1/(c + d) = 1/c - d/c^2 + d^2/(c^2 (c + d))."""
    at, r = f[q, CENTER], radius(f, q)
    a, b = f[q, LOW], f[q, HIGH]
    if not (a > 0.0 or b < 0.0) or not a <= at <= b:
        _flat(f, n)
        return
    nearest = a if a > 0.0 else b
    bend = r * r / (at * at * nearest)
    lost = 1 / abs(at) + r / (at * at) + abs(bend)
    _linear(f, n, q, 1 / at, -1 / (at * at), min(0.0, bend), max(0.0, bend), lost)
    _product(f, n, p, n)


@compiled
def _of_vector(code: int, f: Any, n: int, p: int, q: int) -> None:
    """Direction, inverse length and length of a vector, about the length and direction in the
    middle.
    """
    least, _ = reach(f[p, LOW], f[p, HIGH], f[q, LOW], f[q, HIGH])
    x, y = f[p, CENTER], f[q, CENTER]
    length = sqrt(x * x + y * y)
    # the segment from the centers has to stay where the length is at least that
    if not (least > 0.0 and f[p, LOW] <= x <= f[p, HIGH] and f[q, LOW] <= y <= f[q, HIGH]):
        _flat(f, n)
        return
    r, s = radius(f, p), radius(f, q)
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
    for k in range(MAX_VARIABLES):
        f[n, k] = by_x * f[p, k] + by_y * f[q, k]
    f[n, CENTER] = value + 0.5 * (below + above)
    f[n, ERROR] = abs(by_x) * f[p, ERROR] + abs(by_y) * f[q, ERROR] + 0.5 * (above - below)
    f[n, ERROR] += (
        2 * _ROUNDING * (abs(value) + abs(by_x) * r + abs(by_y) * s + abs(below) + abs(above))
    )


__all__ = ["CENTER", "ERROR", "HIGH", "LOW", "WIDTH", "evaluate", "radius"]
