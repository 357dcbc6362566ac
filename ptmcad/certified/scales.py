"""How strongly the axes act on the equilibrium, compared with the angles: which variable it pays to bisect.

Guarantee: none is needed. A search is right with any weights; with good ones it is faster.
"""

from __future__ import annotations

import random

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.evaluation import program, run
from ptmcad.certified.formula import Formula
from ptmcad.certified.tape import record
from ptmcad.question.slice import Slice

SAMPLES = 200
_SEED = 1


def axis_weights(slice: Slice, equilibrium: tuple[Formula, Formula]) -> tuple[float, float]:
    """The widths of the axes count this much in comparison with an angle's.

    It is the ratio of the typical derivatives of the equations of equilibrium by the axis and by the angles, at points
    of the window that are chosen at random but always the same.
    """
    graph = equilibrium[0].graph
    tape = record([[graph.derivative(e, v) for v in range(4) for e in equilibrium]])
    generator = random.Random(_SEED)
    low, high = np.empty(len(tape)), np.empty(len(tape))
    point = np.empty(4)
    sizes = np.full((SAMPLES, 4), np.nan)
    for k in range(SAMPLES):
        for v, axis in enumerate(slice.axes):
            point[v] = float(axis.low + (axis.high - axis.low) * generator.randrange(1, 1000) / 1000)
        for v in (2, 3):
            point[v] = generator.uniform(-np.pi, np.pi)
        run(program(tape), point, point, low, high, 0, len(tape))
        with np.errstate(over="ignore", invalid="ignore"):  # samples without a finite slope are left out below
            slopes = np.abs(low[tape.outputs[0]].reshape(4, 2) + high[tape.outputs[0]].reshape(4, 2)) / 2
        sizes[k] = slopes.max(axis=1)
    usable: NDArray[np.float64] = sizes[np.isfinite(sizes).all(axis=1)]
    if not len(usable):
        return 1.0, 1.0
    typical = np.median(usable, axis=0)
    angles = max(typical[2], typical[3])
    x, y = (float(t / angles) if angles > 0 and t > 0 else 1.0 for t in typical[:2])
    return x, y
