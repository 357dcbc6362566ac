"""What the curves of a slice at which counts change have in common, a curve made of it, and the
weights by which a search chooses the variable to bisect.

Guarantee: a search is right with any weights; with good ones, which say how strongly the axes act
on the equilibrium compared with the unknowns, it is faster.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.equationsystem import quotients, system
from ptmcad.certified.plain.geometry import FactoredProblem
from ptmcad.certified.plain.mirrors import MirrorFrame
from ptmcad.certified.plain.problem import FIRST, Condition, Problem, Range
from ptmcad.certified.plain.springchart import SpringChart
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.formulas.graph import Formula
from ptmcad.formulas.intervalarithmetic import run
from ptmcad.formulas.tape import record
from ptmcad.question.slice import Slice


class Pruning(NamedTuple):
    """The formulas that discard boxes, in addition to a curve's equations.

    Attributes
    ----------
    cheap, costly : formulas that vanish at its solutions.
    nonnegative : formulas that are not negative there.
    solving : of those that vanish, where axes may be solved for, these.
    """

    cheap: Sequence[Formula] = ()
    costly: Sequence[Formula] = ()
    nonnegative: Sequence[Formula] = ()
    solving: Sequence[Formula] = ()


@dataclass(frozen=True, slots=True)
class CurveSearch:
    """What all curves of a slice have in common.

    Attributes
    ----------
    exact : the problem with common factors that are positive in the window.
    ranges : of the unknowns.
    weights : of the axes and the unknowns.
    short : below this length a spring is searched in its chart.
    stable : whether only folds of minima are asked for.
    dependent : whether formulas that vanish at all solutions are used besides the equations.
    conditions : positive at solutions that count.
    rising : whether only solutions are asked for at which the Jacobian's determinant is not
        negative.
    mirrors : a frame of each involution, configurations near whose fixed points are searched about
        these.
    """

    exact: FactoredProblem
    ranges: tuple[Range, ...]
    weights: tuple[float, ...]
    short: tuple[Fraction, ...]
    stable: bool
    dependent: bool
    conditions: tuple[Condition, ...]
    rising: bool
    mirrors: tuple[MirrorFrame, ...] = ()

    @property
    def problem(self) -> Problem:
        return self.exact.problem

    def values(self, at: SpringChart) -> list[Formula]:
        """What is not negative at solutions that count, nor at limits of them."""
        return [condition.value.formula(at.unknowns) for condition in self.conditions]

    def curve(
        self,
        name: str,
        reason: str,
        equations: Sequence[Formula],
        pruning: Pruning,
        ranges: tuple[Range, ...] | None = None,
    ) -> CriticalCurve:
        """A curve in the axes and some coordinates.

        Parameters
        ----------
        ranges : of the coordinates, the problem's unknowns by default; where
            there is one more than these have, it is the direction of a short spring.
        """
        ranges = self.ranges if ranges is None else ranges
        ends = [
            c
            for cone in self.problem.cones
            for d in cone.difference
            for pair in d.terms.values()
            for c in pair
        ]
        solving = pruning.solving if self.dependent and ends and len(self.ranges) > 1 else ()
        # none that springs' directions depend on; with one unknown that costs more boxes than it
        # saves
        solved = quotients(solving, [k for k in (0, 1) if not any(c.uses(k) for c in ends)])
        vanishing = pruning.cheap, pruning.costly
        return CriticalCurve(
            name,
            reason,
            system(
                equations, range(FIRST + len(ranges)), vanishing, pruning.nonnegative, solved=solved
            ),
            ranges,
            np.array([*self.weights, TURNING_WEIGHT][: FIRST + len(ranges)]),
        )


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
        run(tape.program, point, point, low, high, 0, len(tape))
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # those without a finite value are left out by the callers
            values[k] = (low[tape.outputs[0]] + high[tape.outputs[0]]) / 2
    return values
