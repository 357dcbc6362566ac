"""How strongly the axes act on the equilibrium, compared with the unknowns: which variable it pays
to bisect.

Guarantee: none is needed. A search is right with any weights; with good ones it is faster.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ptmcad.formulas.graph import Formula
from ptmcad.formulas.intervals import program, run
from ptmcad.formulas.tape import record
from ptmcad.question.slice import Slice

SAMPLES = 200
_SEED = 1
SHORT_SHARE = Fraction(1, 8)
"""A spring shorter than this part of its typical length is searched in its chart."""
TURNING_WEIGHT = 0.25
"""Of a spring's direction, which follows from the unknowns, in the choice which variable to bisect.
"""
RATIO_POWER = 0.75
"""Of the axes' weights: halving the boxes takes fewest of them between there and the ratio itself,
in most records.
"""


def variable_weights(
    slice: Slice, equations: Sequence[Formula], ranges: Sequence[tuple[float, float]]
) -> tuple[float, ...]:
    """The widths of the axes and of the unknowns count this much; the unknown that acts most has
    the weight 1.

    It is a power of the ratio of the typical derivatives of the equations of equilibrium by the
    axes and by the unknowns, at points of the window that are chosen at random but always the same.
    All unknowns have 1.

    Parameters
    ----------
    equations : in the variables 0 and 1, the axes, and one variable for each of the ranges.
    """
    graph = equations[0].graph
    variables = 2 + len(ranges)
    slopes = [graph.derivative(e, v) for v in range(variables) for e in equations]
    middles = _samples(slice, slopes, ranges)
    sizes = np.abs(middles).reshape(SAMPLES, variables, len(equations)).max(axis=2)
    usable: NDArray[np.float64] = sizes[np.isfinite(sizes).all(axis=1)]
    if not len(usable):
        return (1.0,) * variables
    typical = np.median(usable, axis=0)
    most = max(typical[2:])
    x, y = (float(t / most) ** RATIO_POWER if most > 0 and t > 0 else 1.0 for t in typical[:2])
    return (x, y, *(1.0 for _ in ranges))


def short_lengths(
    slice: Slice, lengths: Sequence[Formula], ranges: Sequence[tuple[float, float]]
) -> tuple[Fraction, ...]:
    """Below these, powers of two near a part of the median over such points, springs are searched
    in their charts.
    """
    medians = np.median(_samples(slice, list(lengths), ranges), axis=0) if lengths else ()
    typical = (Fraction(float(m)) if np.isfinite(m) and m > 0 else Fraction(1) for m in medians)
    return tuple(_rounded(SHORT_SHARE * x) for x in typical)


def _rounded(value: Fraction) -> Fraction:
    """A power of two near a positive number; any would do."""
    result = Fraction(1)
    while result > value:
        result /= 2
    while 2 * result < value:
        result *= 2
    return result


def _samples(
    slice: Slice, formulas: list[Formula], ranges: Sequence[tuple[float, float]]
) -> NDArray[np.float64]:
    """Values of formulas at the points, shape (SAMPLES, formulas), to within rounding."""
    tape = record([formulas])
    generator = random.Random(_SEED)
    low, high = np.empty(len(tape)), np.empty(len(tape))
    point = np.empty(2 + len(ranges))
    values = np.full((SAMPLES, len(formulas)), np.nan)
    for k in range(SAMPLES):
        for v, axis in enumerate(slice.axes):
            point[v] = float(
                axis.low + (axis.high - axis.low) * generator.randrange(1, 1000) / 1000
            )
        for v, (least, most) in enumerate(ranges, 2):
            point[v] = generator.uniform(least, most)
        run(program(tape), point, point, low, high, 0, len(tape))
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # those without a finite value are left out by the callers
            values[k] = (low[tape.outputs[0]] + high[tape.outputs[0]]) / 2
    return values
