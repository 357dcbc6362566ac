"""The solutions of a problem at one rational point of a slice, counted with proof.

Guarantee: when a `PointCount` is decided, each solution that the count needs has its own box,
proved to hold exactly one, and it is proved that there are no others; signs of eigenvalues and of
conditions are those of intervals. What is not proved is undecided. Springs without length are no
solutions: total counts do not have them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from flint import arb, arb_mat, ctx

from ptmcad.answer.counts import counts_of_signs, euler_sum
from ptmcad.certified.arb_isolation import refined
from ptmcad.certified.branchandprune import Boxes
from ptmcad.certified.equationsystem import EquationSystem, system
from ptmcad.certified.peaks import peaks
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.problem import MAX_UNKNOWNS, Problem, problem_of
from ptmcad.certified.plain.spectrum import inertia
from ptmcad.certified.plain.springchart import SpringChart, chart, principal_minors
from ptmcad.certified.plain.straight import branches
from ptmcad.certified.plain.unknownranges import ranges
from ptmcad.certified.plain.zeros import PRECISIONS, PointCount, ZeroSearch, boxed
from ptmcad.errors import DegenerateSliceError
from ptmcad.formulas.ballarithmetic import balls, run_arb
from ptmcad.formulas.graph import Formula
from ptmcad.formulas.intervalarithmetic import run
from ptmcad.formulas.tape import Indices, Tape, record
from ptmcad.model import ptm
from ptmcad.model.criterion import by_hessian
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import values_at
from ptmcad.text.numerals import text_of

WITNESSES = tuple(
    (Fraction(u), Fraction(v))
    for u, v in (("10/21", "19/35"), ("2/13", "11/17"), ("15/19", "4/23"))
)
"""Shares of the window: points that are rarely on a curve that a person has in mind."""

HALVINGS = 60
"""Of a box around a solution, before it is in no other solution's way."""


@dataclass(frozen=True, slots=True, eq=False)
class PlainCounter:
    """Counts at points of one slice, with the formulas written out once.

    Attributes
    ----------
    all, stable : the systems that a search prunes with, for all solutions that count and for the
        stable ones.
    hessian : a tape of one stage with the Hessian's entries row by row.
    conditions : a tape with the inequalities, then the conditions for stability, with closed loops
        the Jacobian's determinant; and in a second stage what has to be positive where the count's
        predicate holds.
    """

    slice: Slice
    search: ZeroSearch
    all: EquationSystem
    stable: EquationSystem
    hessian: Tape
    conditions: Tape

    @property
    def problem(self) -> Problem:
        return self.search.problem

    @property
    def equations(self) -> EquationSystem:
        """The equations alone."""
        return self.search.equations

    def at(self, x: Fraction, y: Fraction, count: Count, *, thorough: bool = True) -> PointCount:
        """What ``count`` needs at the point (x, y) of the two axes.

        ``thorough`` is False where it is better not to decide a hard point than to take long for
        it.

        Raises
        ------
        ArithmeticError
            When the counts contradict Euler's sum on the torus, which would be a fault of this
            program.
        """
        system = self.stable if count.is_of_stable else self.all
        unique, narrow, more = self.search.at(x, y, system, thorough)
        counted, unclear = self._counted(x, y, zip(unique, narrow, strict=True), count)
        unclear += more
        if unclear and count.is_of_stable:
            return PointCount(open=unclear)
        signs = [self._signs(x, y, wide, narrow, count) for wide, narrow in counted]
        is_decided = not (unclear or (self.problem.is_gradient and "" in signs))
        kept = [k for k, sign in enumerate(signs) if not (count.is_of_stable and "-" in sign)]
        if count.is_of_stable and not is_decided:
            kept = []
        solutions = tuple(boxed(*counted[k], signs[k]) for k in kept)
        found = PointCount(solutions=solutions, open=unclear)
        if not is_decided:
            return found
        if count.is_of_stable:
            return self._of_stable(x, y, found, [counted[k][0] for k in kept], count)
        found = replace(found, total=len(solutions), decided=True)
        return self._of_potential(x, y, found) if self.problem.is_gradient else found

    def _signs(self, x: Fraction, y: Fraction, wide: Boxes, narrow: Boxes, count: Count) -> str:
        """Those of the Hessian's eigenvalues, or of conditions for stability, at a proved zero;
        empty where one is open, or there are none."""
        if self.problem.is_gradient:
            negative = self._index_in_floats(narrow)
            negative = self._index(x, y, wide) if negative is None else negative
            return (
                ""
                if negative is None
                else "+" * (len(self.problem.unknowns) - negative) + "-" * negative
            )
        asked = self.conditions.outputs[0][len(self.problem.inequalities) :]
        if count.is_of_stable:  # only where all of them are positive is a zero counted
            return "+" * len(asked)
        # where all are counted, which of them are stable is known here only: it may change within
        # the cell
        holds = [self._holds(x, y, wide, asked[k : k + 1]) for k in range(len(asked))]
        return "" if None in holds else "".join("+" if h else "-" for h in holds)

    def _of_potential(self, x: Fraction, y: Fraction, found: PointCount) -> PointCount:
        """The counts of all critical points with those by their indices.

        Raises
        ------
        ArithmeticError
            As `at` does.
        """
        counts = counts_of_signs(
            [s.signs for s in found.solutions], by_hessian(len(self.problem.unknowns))
        )
        index = counts.index or ()
        smooth = all(self.problem.is_angle) and not (
            self.problem.has_springs or self.problem.inequalities
        )
        if smooth and euler_sum(index):
            raise ArithmeticError(
                f"critical points of a function on the torus by index {[*index]} at ({x}, {y})"
            )
        cones = 0 if smooth else None
        if self.slice.model == ptm() and self.problem.has_springs:
            absent = dict.fromkeys(self.slice.model.variables, Fraction(0))
            cones, is_regular = peaks(absent | values_at(self.slice.parameters, x, y))
            if is_regular and index[0] - index[1] + index[2] + cones:
                raise ArithmeticError(
                    f"minima, saddles and maxima {[*index]} with {cones} cones at ({x}, {y})"
                )
        return replace(found, stable=counts.stable, index=index, cones=cones)

    def _of_stable(
        self, x: Fraction, y: Fraction, found: PointCount, boxes: Sequence[Boxes], count: Count
    ) -> PointCount:
        """The number of stable solutions, and of those among them at which a predicate holds, where
        it is asked for.
        """
        further = {}
        if count.kind.predicate is not None:
            holds = [self._holds(x, y, box, self.conditions.outputs[1]) for box in boxes]
            if None in holds:
                return PointCount()
            further[count.value] = holds.count(True)
        return replace(found, stable=len(boxes), decided=True, further=further)

    def _counted(
        self, x: Fraction, y: Fraction, zeros: Iterable[tuple[Boxes, Boxes]], count: Count
    ) -> tuple[list[tuple[Boxes, Boxes]], int]:
        """The proved zeros at which all conditions are positive, and of how many that is not
        decided.
        """
        asked = self.conditions.outputs[0][: self._asked(count)]
        found, unclear = list[tuple[Boxes, Boxes]](), 0
        for unique, narrow in zeros:
            counts = self._holds(x, y, unique, asked)
            if counts is False:
                continue
            own = self._apart(x, y, unique, narrow) if counts and self.problem.is_branch else unique
            if counts is None or own is None:
                unclear += 1
            else:
                found.append((own, narrow))
        return found, unclear

    def _apart(self, x: Fraction, y: Fraction, unique: Boxes, narrow: Boxes) -> Boxes | None:
        """A box around a zero of a branch, between the two given ones, in which the branch's
        inequalities hold: no other branch has a zero there.

        None where they are not proved to hold in the narrower one.
        """
        for k in range(HALVINGS):
            box = np.clip(narrow + (unique - narrow) / 2.0**k, *_ends(unique))
            values = run_arb(self.conditions, self.search.box(x, y, box), PRECISIONS[0])
            if all(
                values[int(place)] > 0
                for place in self.conditions.outputs[0][: len(self.problem.inequalities)]
            ):
                return box
        return None

    def _asked(self, count: Count) -> int:
        """How many of the conditions hold at what is counted, from the first one on."""
        return len(self.conditions.outputs[0] if count.is_of_stable else self.problem.inequalities)

    def _holds(self, x: Fraction, y: Fraction, unique: Boxes, conditions: Indices) -> bool | None:
        """Whether all of some conditions are positive at a proved zero."""
        if not len(conditions):
            return True
        for values, _ in self._at_zero(x, y, unique, self.conditions, conditions):
            if any(value < 0 for value in values):
                return False
            if all(value > 0 for value in values):
                return True
        return None

    def _at_zero(
        self, x: Fraction, y: Fraction, unique: Boxes, tape: Tape, places: Indices
    ) -> Iterator[tuple[list[arb], int]]:
        """Values at a proved zero, with more and more bits."""
        for precision in PRECISIONS:
            with ctx.workprec(precision):
                narrow = refined(self.equations, self.search.box(x, y, unique), precision)
                values = run_arb(tape, narrow, precision)
            yield [values[int(place)] for place in places], precision

    def zero_condition(self, x: Fraction, y: Fraction, count: Count) -> str:
        """What is not decided of the signs of conditions at a proved zero, to as many digits as
        there are, in words.
        """
        conditions = [c.text for c in self.problem.conditions(count)]
        further = [c.text for c in self.problem.further]
        if not (conditions or further):
            return ""
        zeros, _, unclear = self.search.at(x, y, self.stable if further else self.all, False)
        for unique in () if unclear else zeros:
            if further and self.problem.is_gradient and self._index(x, y, unique) != 0:
                continue
            for texts, places in zip((conditions, further), self.conditions.outputs, strict=True):
                signs = [self._holds(x, y, unique, places[k : k + 1]) for k in range(len(texts))]
                if None in signs and False not in signs:
                    return texts[signs.index(None)]
                if False in signs:
                    break
        return ""

    def _index_in_floats(self, narrow: Boxes) -> int | None:
        """The number of negative eigenvalues all over a box; None where doubles do not decide it."""
        size, variables = len(self.problem.unknowns), len(narrow) // 2
        low, high = np.empty((2, len(self.hessian)))
        run(
            self.hessian.program,
            narrow[:variables],
            narrow[variables:],
            low,
            high,
            0,
            len(self.hessian),
        )
        places = self.hessian.outputs[0]
        if not np.isfinite(low[places]).all() or not np.isfinite(high[places]).all():
            return None
        with ctx.workprec(PRECISIONS[0]):
            return inertia(arb_mat(size, size, balls(low[places], high[places])))

    def _index(self, x: Fraction, y: Fraction, unique: Boxes) -> int | None:
        """The number of negative eigenvalues at a proved zero."""
        size = len(self.problem.unknowns)
        for entries, precision in self._at_zero(
            x, y, unique, self.hessian, self.hessian.outputs[0]
        ):
            with ctx.workprec(precision):
                found = inertia(arb_mat(size, size, entries))
            if found is not None:
                return found
        return None


@dataclass(frozen=True, slots=True, eq=False)
class BranchCounter:
    """Counts at points of one slice, of whose problem each branch has a counter, in unknowns of its
    own.
    """

    branches: tuple[PlainCounter, ...]

    def at(self, x: Fraction, y: Fraction, count: Count, *, thorough: bool = True) -> PointCount:
        """What ``count`` needs at the point (x, y) of the two axes, as `PlainCounter.at` has it; where that
        is not decided in some branch, nothing of the others.
        """
        parts = []
        for counter in self.branches:
            own = counter.at(x, y, count, thorough=thorough)
            if not own.decided:
                return PointCount()
            parts.append(counter.search.in_description(x, y, own))
            if not parts[-1].decided:
                return PointCount()
        return parts[0] if len(parts) == 1 else _sum(parts)


def _ends(box: Boxes) -> tuple[Boxes, Boxes]:
    """Its low ends, twice, and its high ends, twice."""
    low, high = np.split(box, 2)
    return np.concatenate([low, low]), np.concatenate([high, high])


def _sum(parts: Sequence[PointCount]) -> PointCount:
    """Of decided counts of solutions that are all different."""

    def added(numbers: Sequence[int | None]) -> int | None:
        return None if None in numbers else sum(n for n in numbers if n is not None)

    indices = [p.index for p in parts if p.index is not None]
    return PointCount(
        total=added([p.total for p in parts]),
        stable=added([p.stable for p in parts]),
        further={name: sum(p.further[name] for p in parts) for name in parts[0].further},
        index=tuple(map(sum, zip(*indices, strict=True))) if len(indices) == len(parts) else None,
        solutions=tuple(solution for p in parts for solution in p.solutions),
        decided=True,
    )


def plain_counter(
    slice: Slice, most: int = MAX_UNKNOWNS, pause: Callable[[], None] | None = None
) -> BranchCounter:
    """Write the solutions of a slice out, to count them at its points.

    Parameters
    ----------
    most : unknowns that the model may have.
    pause : see `ZeroSearch`.

    Raises
    ------
    ConfigError
        As `problem_of` and `ranges` do.
    DegenerateSliceError
        When a condition is zero at a solution wherever one looks, so that nothing would ever be
        decided.
    """
    problem = problem_of(slice, most)
    return BranchCounter(
        tuple(_counter(slice, branch, pause) for branch in branches(problem, slice.axes))
    )


def _counter(slice: Slice, problem: Problem, pause: Callable[[], None] | None) -> PlainCounter:
    at = chart(geometry(problem))
    vanishing = (at.dependent, at.balances)
    asked = problem.inequalities, problem.stability, problem.further
    inequalities, stability, further = (
        [c.value.formula(at.unknowns) for c in some] for some in asked
    )
    if problem.closing:
        stability = [at.determinant()]
    minima = _semidefinite(at) if problem.is_gradient else stability
    alone = system(at.equations, problem.variables, jacobian=at.hessian)
    counter = PlainCounter(
        slice,
        ZeroSearch(problem, ranges(problem, slice.axes), alone, pause),
        system(at.equations, problem.variables, vanishing, inequalities, at.hessian),
        system(at.equations, problem.variables, vanishing, [*minima, *inequalities], at.hessian),
        record([[entry for row in at.hessian for entry in row]]),
        record([[*inequalities, *stability], further]),
    )
    if not problem.is_branch:  # sides of kinks are not conditions that anybody asked for
        _check_conditions(counter)
    return counter


def _semidefinite(at: SpringChart) -> list[Formula]:
    """What is not negative at minima."""
    whole = [at.determinant(at_equilibrium=True)] if len(at.equations) <= MAX_UNKNOWNS else []
    return [*principal_minors(at.matrix_at_equilibrium()), *whole]


def _check_conditions(counter: PlainCounter) -> None:
    slice = counter.slice
    across, up = slice.axes
    points = [
        (across.low + (across.high - across.low) * u, up.low + (up.high - up.low) * v)
        for u, v in WITNESSES
    ]
    idle = {counter.zero_condition(x, y, slice.count) for x, y in points}
    if len(idle) == 1 and (text := idle.pop()):
        (x, y), names = points[0], slice.axis_names
        advice = (
            "ask for another count"
            if counter.problem.further
            else "choose exact, or ask for another condition"
        )
        raise DegenerateSliceError(
            f"{text} is zero, to 90 digits and more, at a solution at {names[0]} = {text_of(x)}, {names[1]} = "
            f"{text_of(y)}, and so it is at the other points that were tried: the certified engine decides nothing of "
            f"such a slice; {advice}"
        )
