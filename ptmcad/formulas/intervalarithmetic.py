"""A tape run on a box: enclosures of all its nodes, in compiled code.

Guarantee: after a run that returns True, entry k of ``low`` and ``high`` encloses the k-th node's
values at every point of the box; where a node is a `meet`, at every point at which its two operands
are equal. A run that returns False has proved that they are equal at no point of the box.
"""

from __future__ import annotations

from math import inf

import numpy as np

from ptmcad.formulas.compilation import ONE, ZERO, compiled
from ptmcad.formulas.graph import Operation
from ptmcad.formulas.rounding import (
    direction,
    down,
    length,
    magnitude,
    mignitude,
    multiply,
    reciprocal,
    sine,
    up,
)
from ptmcad.formulas.tape import Floats, Program

CONSTANT, VARIABLE, ADD, SUBTRACT = (int(x) for x in list(Operation)[:4])
MULTIPLY, SQUARE, NEGATE, SINE, COSINE = (int(x) for x in list(Operation)[4:9])
INVERSE_LENGTH, DIRECTION, LENGTH, MEET, DIVIDE = (int(x) for x in list(Operation)[9:])


@compiled
def run(
    program: Program,
    box_low: Floats,
    box_high: Floats,
    low: Floats,
    high: Floats,
    start: int,
    end: int,
) -> bool:
    """Run the nodes from ``start`` to before ``end``; those before them have been run on this box."""
    operations, first, second, constant_low, constant_high = program
    for i in range(np.uint64(start), np.uint64(end)):
        operation, a, b = operations[i], first[i], second[i]
        if operation == MULTIPLY:
            u, v = multiply(low[a], high[a], low[b], high[b])
        elif operation == ADD:
            u, v = down(low[a] + low[b]), up(high[a] + high[b])
        elif operation == SUBTRACT:
            u, v = down(low[a] - high[b]), up(high[a] - low[b])
        elif operation == NEGATE:
            u, v = -high[a], -low[a]
        elif operation == SQUARE:
            near, far = mignitude(low[a], high[a]), magnitude(low[a], high[a])
            u, v = max(down(near * near), 0.0), up(far * far)
            if not far < inf:
                u, v = 0.0, inf
        elif operation == CONSTANT:
            u, v = constant_low[i], constant_high[i]
        elif operation == VARIABLE:
            u, v = box_low[a], box_high[a]
        elif operation == DIRECTION:
            u, v = direction(low[a], high[a], low[b], high[b])
        elif operation == SINE:
            u, v = sine(low[a], high[a], ZERO)
        elif operation == COSINE:
            u, v = sine(low[a], high[a], ONE)
        elif operation == MEET:
            u, v = low[a], high[a]
            u = max(u, low[b])
            v = min(v, high[b])
            if u > v:
                return False
        elif operation == LENGTH:
            u, v = length(low[a], high[a], low[b], high[b])
        elif operation == INVERSE_LENGTH:
            u, v = length(low[a], high[a], low[b], high[b])
            u, v = (down(1 / v) if v > 0 else 0.0), (up(1 / u) if u > 0 else inf)
        else:
            u, v = reciprocal(low[b], high[b])
            u, v = multiply(low[a], high[a], u, v)
        low[i], high[i] = u, v
    return True
