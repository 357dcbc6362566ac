"""What all curves of a slice at which counts change have in common, and a curve made of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ptmcad.certified.curve import CriticalCurve
from ptmcad.certified.plain.bounds import Range
from ptmcad.certified.plain.chart import SpringChart
from ptmcad.certified.plain.frame import MirrorFrame
from ptmcad.certified.plain.geometry import FactoredProblem
from ptmcad.certified.plain.problem import FIRST, Condition, Problem
from ptmcad.certified.scales import TURNING_WEIGHT
from ptmcad.certified.solved import quotients
from ptmcad.certified.system import system
from ptmcad.formulas.graph import Formula


class Pruning(NamedTuple):
    """What discards boxes beside a curve's equations.

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
    ranges, weights : of the unknowns, and of the axes and these.
    short : below this length a spring is searched in its chart.
    stable : whether only folds of minima are asked for.
    swallowed : whether solutions that springs without length swallow have curves of their own.
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
    swallowed: bool
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
        ranges : of the coordinates, which are the problem's unknowns where nothing is said; where
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
