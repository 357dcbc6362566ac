"""The paper's mechanism: the equilibria at one rational point of a slice, counted with proof.

Guarantee: when a `PointCount` is decided, each equilibrium (for `Count.STABLE` and `Count.ADMISSIBLE` each minimum) has
its own box, proved to hold exactly one, and it is proved that there are no others. What is not proved is undecided.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from flint import ctx

from ptmcad.answer.regionmap import Solution
from ptmcad.certified.arb_evaluation import ball, lower, run_arb, upper
from ptmcad.certified.arb_isolation import Box, Isolated, isolate_arb, refined
from ptmcad.certified.distinct import distinct, distinct_balls
from ptmcad.certified.evaluation import program, run
from ptmcad.certified.parameters import values_at
from ptmcad.certified.points import (
    BUDGET,
    MIN_BOX_WIDTHS,
    PRECISIONS,
    QUICK_BUDGET,
    PointCount,
    boxed,
    radius_between,
)
from ptmcad.certified.ptm.cones import cones, creases_at
from ptmcad.certified.ptm.equilibria import Equilibria, slice_equilibria
from ptmcad.certified.ptm.statics import TH1, TH2, TURN
from ptmcad.certified.search import Boxes, isolate
from ptmcad.certified.tape import enclosing_floats
from ptmcad.question.slice import Count, Slice

CREASED = (-1e-9, 6.2831853081)
"""A little more than a full turn, for an angle whose formulas hold between 0 and a full turn."""
CREASED_END = (Fraction(6.283185307179586), Fraction(6.283185307179587))
"""Below and above a full turn."""
EQUAL = np.ones(4)
"""Weights of the variables' widths."""
MAX_OPEN_BOXES = 100
"""Boxes that floating point may leave to Arb."""
ARB_BUDGETS = (6_000, 800)
"""Boxes by precision. What takes many is nearly a curve of equilibria, and of that more digits make no fewer."""


@dataclass(frozen=True, slots=True)
class _Zero:
    """A proved zero with the signs of its Hessian's eigenvalues and of l_i - l0_i (0 where not decided)."""

    solution: Solution
    excess: tuple[int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class PointCounter:
    """Counts at points of one slice; it keeps the formulas that `point_counter` wrote out."""

    slice: Slice
    equilibria: Equilibria
    _on_creases: dict[tuple[bool, bool], Equilibria] = field(default_factory=dict)

    def equilibria_at(self, x: Fraction, y: Fraction) -> Equilibria:
        """The formulas for a point: others where rho = L2 or rho = L1, where spring 1 or 2 may have no length."""
        creases = creases_at(values_at(self.slice, x, y))
        if not any(creases):
            return self.equilibria
        if creases not in self._on_creases:
            self._on_creases[creases] = slice_equilibria(self.slice, creases)
        return self._on_creases[creases]

    def at(self, x: Fraction, y: Fraction, count: Count, *, thorough: bool = True) -> PointCount:
        """What ``count`` needs at the point (x, y) of the two axes.

        ``thorough`` is False where it is better not to decide a hard point than to take seconds for it in Arb.

        Raises
        ------
        ArithmeticError
            When the counts contradict Euler's sum, which would be a fault of this program.
        """
        zeros = self.zeros(x, y, count, thorough=thorough)
        if zeros is None:
            return PointCount()
        minima = [zero for zero in zeros if zero.solution.signs == "++"]
        solutions = tuple(zero.solution for zero in zeros)
        if count is Count.STABLE:
            return PointCount(stable=len(minima), solutions=tuple(z.solution for z in minima), decided=True)
        if count is Count.ADMISSIBLE:
            if any(-1 not in zero.excess and 0 in zero.excess for zero in minima):
                return PointCount()
            admissible = sum(zero.excess == (1, 1, 1) for zero in minima)
            return PointCount(
                stable=len(minima), admissible=admissible, solutions=tuple(z.solution for z in minima), decided=True
            )
        kinds = [zero.solution.signs for zero in zeros]
        index = (kinds.count("++"), kinds.count("+-"), kinds.count("--"))
        peaks = cones(values_at(self.slice, x, y))
        if peaks.regular and index[0] - index[1] + index[2] + peaks.count != 0:
            raise ArithmeticError(f"minima, saddles and maxima {index} with {peaks.count} cones at ({x}, {y})")
        return PointCount(len(zeros), len(minima), None, index, peaks.count, solutions, True)

    def zeros(self, x: Fraction, y: Fraction, count: Count, *, thorough: bool = True) -> list[_Zero] | None:
        """The equilibria that ``count`` needs, each once; None when they cannot be decided."""
        only_minima = count.is_of_stable
        written, creases = self.equilibria_at(x, y), creases_at(values_at(self.slice, x, y))
        for finest in MIN_BOX_WIDTHS:
            unique, narrow, left, ended = self._searched(
                x, y, only_minima, finest, BUDGET if thorough else QUICK_BUDGET
            )
            if ended:
                break
            if not thorough:
                return None
        else:
            return None
        kept = None if len(left) else distinct(unique, narrow, TH1)
        if kept is None and not thorough:
            return None
        if kept is None:
            zeros = _by_arb(written, x, y, only_minima, (unique, narrow), left)
        else:
            zeros = _kinds(written, x, y, unique[kept], narrow[kept], only_minima)
        return None if zeros is None else _off_creases(zeros, creases)

    def proved(self, x: Fraction, y: Fraction) -> tuple[list[Solution], int]:
        """The equilibria that are proved where not all are told, and the number of boxes in which there may be more."""
        written, creases = self.equilibria_at(x, y), creases_at(values_at(self.slice, x, y))
        unique, narrow, left, _ = self._searched(x, y, False, MIN_BOX_WIDTHS[-1], BUDGET)
        kept = distinct(unique, narrow, TH1)
        if kept is None:
            return [], len(left) + len(unique)
        found = [_kinds(written, x, y, unique[[k]], narrow[[k]], False) for k in kept]
        there = [zeros and _off_creases(zeros, creases) for zeros in found]
        return [zero.solution for zeros in there for zero in zeros or ()], len(left) + there.count(None)

    def _searched(
        self, x: Fraction, y: Fraction, only_minima: bool, finest: float, budget: int
    ) -> tuple[Boxes, Boxes, Boxes, bool]:
        """Boxes with one zero each, narrower ones, those that are left, and whether the search came to an end."""
        written, creases = self.equilibria_at(x, y), creases_at(values_at(self.slice, x, y))
        (x_low, x_high), (y_low, y_high) = enclosing_floats(x), enclosing_floats(y)
        second, first = (CREASED if crease else TURN for crease in creases)
        start = np.array([[x_low, y_low, first[0], second[0], x_high, y_high, first[1], second[1]]])
        system, equations = (written.minima if only_minima else written.all).arguments(), written.equations.arguments()
        found = isolate(system, equations, start, (finest, budget, MAX_OPEN_BOXES), EQUAL)
        left = found.left()
        # outside its turn a crease's formulas have zeros of their own, which are no equilibria a turn away either
        inside = np.ones(len(found.narrow), np.bool_)
        for angle, crease in zip((TH1, TH2), reversed(creases), strict=True):
            if crease:
                inside &= (found.narrow[:, 4 + angle] >= 0) & (found.narrow[:, angle] <= float(CREASED_END[1]))
        ended = found.used < budget and len(left) <= MAX_OPEN_BOXES
        return found.unique[inside], found.narrow[inside], left, ended


def point_counter(slice: Slice) -> PointCounter:
    """Write the equilibria of a slice out, to count them at its points."""
    return PointCounter(slice, slice_equilibria(slice))


def _off_creases(zeros: Sequence[_Zero], creases: tuple[bool, bool]) -> list[_Zero] | None:
    """The zeros at which the formulas for rho = L2, rho = L1 hold; None when that cannot be decided for some."""
    kept = []
    for zero in zeros:
        inside = True
        for (low, high), crease in zip(_reach(zero.solution), reversed(creases), strict=True):
            if crease and not (low > 0 and high < CREASED_END[0]):
                if not (high < 0 or low > CREASED_END[1]):
                    return None
                inside = False
        if inside:
            kept.append(zero)
    return kept


def _reach(solution: Solution) -> list[tuple[Fraction, Fraction]]:
    return [(center - solution.radius, center + solution.radius) for center in solution.center]


def _kinds(
    written: Equilibria, x: Fraction, y: Fraction, unique: Boxes, narrow: Boxes, only_minima: bool
) -> list[_Zero] | None:
    tape = written.decisive
    low, high = np.empty((2, len(tape)))
    outputs = tape.outputs[0]
    zeros = []
    for wide, box in zip(unique, narrow, strict=True):
        run(program(tape), box[:4], box[4:], low, high, 0, len(tape))
        signs = [int(low[k] > 0) - int(high[k] < 0) for k in outputs]
        kind = _kind(signs)
        if kind is None or (only_minima and kind == "++" and 0 in signs[3:]):
            exact = Isolated(_balls(x, y, wide, 128), _balls(x, y, box, 128))
            zero = _kind_by_arb(written, exact)
            if zero is None:
                return None
            zeros.append(zero)
        else:
            zeros.append(_Zero(boxed(wide, box, kind, (TH1, TH2)), (signs[3], signs[4], signs[5])))
    return [zero for zero in zeros if not only_minima or zero.solution.signs == "++"]


def _by_arb(
    written: Equilibria, x: Fraction, y: Fraction, only_minima: bool, proved: tuple[Boxes, Boxes], left: Boxes
) -> list[_Zero] | None:
    """The same with Arb, for the boxes that floating point left open; those it proved go on from the narrow ones."""
    system = written.minima if only_minima else written.all
    equations = written.equations
    for precision, budget in zip(PRECISIONS, ARB_BUDGETS, strict=True):
        more = isolate_arb(system, equations, [_balls(x, y, box, precision) for box in left], precision, budget)
        if more is None:
            continue
        for wide, box in zip(*proved, strict=True):
            narrow = refined(equations, _balls(x, y, box, precision), precision)
            more.append(Isolated(_balls(x, y, wide, precision), narrow))
        kept = distinct_balls(more, (TH1, TH2), precision)
        if kept is None:
            continue
        zeros = [_kind_by_arb(written, zero) for zero in kept]
        if any(zero is None for zero in zeros):
            continue
        return [z for z in zeros if z is not None and (not only_minima or z.solution.signs == "++")]
    return None


def _kind_by_arb(written: Equilibria, zero: Isolated) -> _Zero | None:
    tape = written.decisive
    for precision in PRECISIONS:
        narrow = refined(written.equations, zero.narrow, precision)
        values = run_arb(tape, narrow, precision)
        signs = [int(values[int(k)] > 0) - int(values[int(k)] < 0) for k in tape.outputs[0]]
        kind = _kind(signs)
        if kind is not None:
            return _Zero(_solution_of_balls(Isolated(zero.unique, narrow), kind), (signs[3], signs[4], signs[5]))
    return None


def _kind(signs: Sequence[int]) -> str | None:
    """The signs of the Hessian's eigenvalues from those of P11, P22 and D."""
    if signs[2] < 0:
        return "+-"
    if signs[2] > 0 and (signs[0] or signs[1]):
        return "++" if (signs[0] or signs[1]) > 0 else "--"
    return None


def _solution_of_balls(zero: Isolated, kind: str) -> Solution:
    wide = [(lower(zero.unique[k]), upper(zero.unique[k])) for k in (TH1, TH2)]
    tight = [(lower(zero.narrow[k]), upper(zero.narrow[k])) for k in (TH1, TH2)]
    center = [(low + high) / 2 for low, high in tight]
    room = min(min(c - low, high - c) for c, (low, high) in zip(center, wide, strict=True))
    need = max(high - c for c, (_, high) in zip(center, tight, strict=True))
    return Solution((center[0], center[1]), radius_between(need, room), kind)


def _balls(x: Fraction, y: Fraction, box: Boxes, precision: int) -> Box:
    with ctx.workprec(precision):
        angles = [ball(Fraction(float(box[k])), Fraction(float(box[k + 4]))) for k in (TH1, TH2)]
        return (ball(x, x), ball(y, y), *angles)
