"""Taylor arithmetic: a tape run on power series in one variable, with intervals for coefficients.

Guarantee: let the variables be series in t about each point s of a set S, and ``low[x, k] <= (k-th
coefficient of variable x about s) <= high[x, k]`` for all s in S and all k up to the order. Then
the same holds for every node of the tape that is analytic there; where a node may not be, its
coefficients are unbounded. (Lemma 28 of docs/soundness.md.)

References
----------
Moore, Interval Analysis (1966), chapter 11; Tucker, Validated Numerics (2011), chapter 4.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from ptmcad.formulas.compilation import ONE, ZERO, compiled, inlined
from ptmcad.formulas.intervalarithmetic import (
    ADD,
    CONSTANT,
    COSINE,
    DIRECTION,
    DIVIDE,
    LENGTH,
    MEET,
    MULTIPLY,
    NEGATE,
    SINE,
    SQUARE,
    SUBTRACT,
    VARIABLE,
    Floats,
    Program,
)
from ptmcad.formulas.rounding import direction, down, length, multiply, reciprocal, sine, up


class TapeSeries(NamedTuple):
    """Coefficients of all nodes of a tape; row k has those of node k, column j those of t^j.

    Attributes
    ----------
    low, high : of the nodes, shape (nodes, order + 1).
    other_low, other_high : of what a node needs besides: the cosine of a sine and the reverse, the
        length of a direction or of an inverse length.
    """

    low: Floats
    high: Floats
    other_low: Floats
    other_high: Floats


@compiled
def series(nodes: int, order: int) -> TapeSeries:
    """Room for so many nodes."""
    return TapeSeries(
        np.empty((nodes, order + 1)), np.empty((nodes, order + 1)),
        np.empty((nodes, order + 1)), np.empty((nodes, order + 1)),
    )  # fmt: skip


@compiled
def _product(
    a_low: Floats, a_high: Floats, b_low: Floats, b_high: Floats, first: int, last: int, k: int
) -> tuple[float, float]:
    """The sum of a_i b_(k - i) for i from ``first`` to ``last``."""
    u = v = 0.0
    for i in range(first, last + 1):
        p, q = multiply(a_low[i], a_high[i], b_low[k - i], b_high[k - i])
        u, v = down(u + p), up(v + q)
    return u, v


@compiled
def _weighted(
    a_low: Floats, a_high: Floats, b_low: Floats, b_high: Floats, k: int
) -> tuple[float, float]:
    """The sum of i a_i b_(k - i) for i from 1 to k, over k."""
    u = v = 0.0
    for i in range(1, k + 1):
        p, q = multiply(a_low[i], a_high[i], b_low[k - i], b_high[k - i])
        u, v = down(u + down(i * p)), up(v + up(i * q))
    return down(u / k), up(v / k)


@compiled
def _length_coefficient(
    a_low: Floats,
    a_high: Floats,
    b_low: Floats,
    b_high: Floats,
    l_low: Floats,
    l_high: Floats,
    k: int,
) -> tuple[float, float]:
    """Coefficient k > 0 of l = |(a, b)|, from l^2 = a^2 + b^2 and the coefficients of l before."""
    u, v = _product(a_low, a_high, a_low, a_high, 0, k, k)
    p, q = _product(b_low, b_high, b_low, b_high, 0, k, k)
    u, v = down(u + p), up(v + q)
    p, q = _product(l_low, l_high, l_low, l_high, 1, k - 1, k)
    u, v = down(u - q), up(v - p)
    p, q = reciprocal(2 * l_low[0], 2 * l_high[0])
    return multiply(u, v, p, q)


@compiled
def _quotient_coefficient(
    a_low: float,
    a_high: float,
    d_low: Floats,
    d_high: Floats,
    b_low: Floats,
    b_high: Floats,
    k: int,
) -> tuple[float, float]:
    """Coefficient k of d = a/b, from d b = a, a's coefficient and the coefficients of d before."""
    p, q = _product(d_low, d_high, b_low, b_high, 0, k - 1, k)
    u, v = down(a_low - q), up(a_high - p)
    p, q = reciprocal(b_low[0], b_high[0])
    return multiply(u, v, p, q)


@compiled
def extend(
    program: Program,
    low_of: Floats,
    high_of: Floats,
    into: TapeSeries,
    first: int,
    last: int,
    end: int,
) -> None:
    """Coefficients ``first`` to ``last`` of the tape's nodes before ``end``; those before are
    known.

    Parameters
    ----------
    low_of, high_of : the variables' coefficients, shape (variables, order + 1).
    """
    operations, left, right, constant_low, constant_high = program
    low, high, other_low, other_high = into
    for k in range(first, last + 1):
        for i in range(np.uint64(0), np.uint64(end)):
            operation, a, b = operations[i], left[i], right[i]
            if operation == VARIABLE:
                u, v = low_of[a, k], high_of[a, k]
            elif operation == CONSTANT:
                u, v = (constant_low[i], constant_high[i]) if k == 0 else (0.0, 0.0)
            elif operation == ADD:
                u, v = down(low[a, k] + low[b, k]), up(high[a, k] + high[b, k])
            elif operation == SUBTRACT:
                u, v = down(low[a, k] - high[b, k]), up(high[a, k] - low[b, k])
            elif operation == NEGATE:
                u, v = -high[a, k], -low[a, k]
            elif operation == MULTIPLY:
                u, v = _product(low[a], high[a], low[b], high[b], 0, k, k)
            elif operation == SQUARE:
                u, v = _product(low[a], high[a], low[a], high[a], 0, k, k)
                if k == 0:
                    u = max(u, 0.0)
            elif operation == MEET:
                u, v = low[a, k], high[a, k]
            elif operation == DIVIDE:
                if k == 0:
                    p, q = reciprocal(low[b, 0], high[b, 0])
                    u, v = multiply(low[a, 0], high[a, 0], p, q)
                else:
                    u, v = _quotient_coefficient(
                        low[a, k], high[a, k], low[i], high[i], low[b], high[b], k
                    )
            elif operation in (SINE, COSINE):
                u, v = _wave(operation == COSINE, low[a], high[a], into, i, k)
            else:
                u, v = _of_length(operation, low, high, other_low[i], other_high[i], a, b, i, k)
            low[i, k], high[i, k] = u, v


@inlined
def _wave(
    cosine: bool, low: Floats, high: Floats, into: TapeSeries, i: int, k: int
) -> tuple[float, float]:
    """Coefficient k of a sine or cosine, whose derivative is the other one, up to its sign."""
    if k == 0:
        u, v = sine(low[0], high[0], ONE if cosine else ZERO)
        p, q = sine(low[0], high[0], ZERO if cosine else ONE)
    else:
        u, v = _weighted(low, high, into.other_low[i], into.other_high[i], k)
        p, q = _weighted(low, high, into.low[i], into.high[i], k)
        if cosine:
            u, v = -v, -u
        else:
            p, q = -q, -p
    into.other_low[i, k], into.other_high[i, k] = p, q
    return u, v


@inlined
def _of_length(
    operation: int,
    low: Floats,
    high: Floats,
    l_low: Floats,
    l_high: Floats,
    a: int,
    b: int,
    i: int,
    k: int,
) -> tuple[float, float]:
    """Coefficient k of |(a, b)|, of 1/|(a, b)| or of a/|(a, b)|; of the length in ``l_low`` and
    ``l_high``, too.
    """
    if k == 0:
        l_low[0], l_high[0] = length(low[a, 0], high[a, 0], low[b, 0], high[b, 0])
        if operation == LENGTH:
            u, v = l_low[0], l_high[0]
        elif operation == DIRECTION:
            u, v = direction(low[a, 0], high[a, 0], low[b, 0], high[b, 0])
        else:
            u = down(1 / l_high[0]) if l_high[0] > 0 else 0.0
            v = up(1 / l_low[0]) if l_low[0] > 0 else inf
    else:
        l_low[k], l_high[k] = _length_coefficient(
            low[a], high[a], low[b], high[b], l_low, l_high, k
        )
        if operation == LENGTH:
            u, v = l_low[k], l_high[k]
        elif operation == DIRECTION:
            u, v = _quotient_coefficient(low[a, k], high[a, k], low[i], high[i], l_low, l_high, k)
        else:
            u, v = _quotient_coefficient(0.0, 0.0, low[i], high[i], l_low, l_high, k)
    return u, v
