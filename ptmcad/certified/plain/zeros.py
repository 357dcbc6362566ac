"""The zeros of a problem's equations at one rational point of a slice: a search in floats, and then
in balls; what a count at a point says; and solutions in half angles, placed in the unknowns of the
description.

Guarantee: each box holds exactly one zero, each zero has one, and there are no others but in what
is left open. When a `PointCount` is decided, each solution (where stable ones alone are counted,
each of these) has its own box, proved to hold exactly one, and it is proved that there are no
others. What is not proved is undecided. A cube that is placed holds its solution, and no other one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import frexp

import numpy as np
from flint import arb, ctx, fmpq, fmpq_mat, fmpz_mat

from ptmcad.answer.counts import Counted, MorseIndex
from ptmcad.answer.regionmap import Solution
from ptmcad.certified.arb_isolation import Box, isolate_arb, refined
from ptmcad.certified.branchandprune import Boxes, SearchResult, isolate
from ptmcad.certified.equationsystem import Arguments, EquationSystem
from ptmcad.certified.plain.problem import FIRST, MAX_UNKNOWNS, Problem, Range
from ptmcad.certified.uniqueness import FULL_TURN, distinct
from ptmcad.formulas.ballarithmetic import ball, balls, lower, upper
from ptmcad.formulas.tape import enclosing_floats
from ptmcad.text.balls import ball_of, exact
from ptmcad.text.flint_numbers import to_fraction

MANY_BOXES = 6_000_000
"""Boxes in floating point for one point where there are more than `MAX_UNKNOWNS` unknowns: about
half a minute.
"""

MAX_OPEN_BOXES = 40
"""Boxes as narrow as is looked at that stay open, before a search ends: with one of them nothing is
decided.
"""

ARB_BUDGETS = (6_000, 800)
"""Boxes by precision. What takes many is nearly a curve of equilibria, and of that more digits make
no fewer.
"""


@dataclass(frozen=True, slots=True, eq=False)
class ZeroSearch:
    """What is searched at all points of one slice.

    Attributes
    ----------
    ranges : of the unknowns over the window.
    equations : alone.
    pause : called between the parts of a long search; what it raises ends that.
    """

    problem: Problem
    ranges: tuple[Range, ...]
    equations: EquationSystem
    pause: Callable[[], None] | None = None

    def at(
        self, x: Fraction, y: Fraction, system: EquationSystem, thorough: bool
    ) -> tuple[Boxes, Boxes, int]:
        """The zeros at a point that a search proves: boxes with exactly one each, narrower ones
        around it, each zero once; and how many boxes may hold more.

        Parameters
        ----------
        system : the equations with what discards boxes.
        thorough : whether a hard point may take long.
        """
        (x_low, x_high), (y_low, y_high) = enclosing_floats(x), enclosing_floats(y)
        low, high = zip(*self.ranges, strict=True)
        start = np.array([[x_low, y_low, *low, x_high, y_high, *high]])
        arguments = system.arguments
        for finest in MIN_BOX_WIDTHS if thorough else MIN_BOX_WIDTHS[:1]:
            found = self._isolated(arguments, start, finest, thorough)
            if not len(found.left()):
                break
        if thorough and 0 < len(found.small) <= MAX_OPEN_BOXES and not len(found.waiting):
            found = self._with_more_digits(x, y, system, found)
        periods = np.array(
            [0.0] * FIRST + [FULL_TURN * is_angle for is_angle in self.problem.is_angle]
        )
        kept = distinct(found.unique, found.narrow, FIRST, periods)
        if kept is None:
            return found.unique[:0], found.narrow[:0], len(found.left()) + len(found.unique)
        return found.unique[kept], found.narrow[kept], len(found.left())

    def _isolated(
        self, arguments: Arguments, start: Boxes, finest: float, thorough: bool
    ) -> SearchResult:
        """What a search finds in boxes no finer than that; a thorough one goes on where a budget ends,
        with more than three unknowns for longer.
        """
        equations, weights = self.equations.arguments, np.ones(start.shape[1] // 2)
        most = MANY_BOXES if len(self.problem.unknowns) > MAX_UNKNOWNS else BUDGET
        part = BUDGET if thorough else QUICK_BUDGET
        found = isolate(arguments, equations, start, (finest, part, MAX_OPEN_BOXES), weights)
        while (
            thorough
            and len(found.waiting)
            and len(found.small) <= MAX_OPEN_BOXES
            and found.used < most
        ):
            if self.pause is not None:
                self.pause()
            more = isolate(
                arguments, equations, found.waiting, (finest, part, MAX_OPEN_BOXES), weights
            )
            unique, narrow, small = (
                np.concatenate(pair) for pair in zip(found[:3], more[:3], strict=True)
            )
            found = SearchResult(unique, narrow, small, more.waiting, found.used + more.used)
        return found

    def _with_more_digits(
        self, x: Fraction, y: Fraction, system: EquationSystem, found: SearchResult
    ) -> SearchResult:
        """The same with the zeros, if any, in the boxes that floating point left open, where more
        digits decide them.
        """
        for precision, budget in zip(PRECISIONS, ARB_BUDGETS, strict=True):
            with ctx.workprec(precision):
                start = [self.box(x, y, box) for box in found.small]
            zeros = isolate_arb(system, self.equations, start, precision, budget)
            boxes = [_in_floats(*zero, found.small[0]) for zero in zeros or ()]
            if zeros is not None and None not in boxes:
                more = np.array(boxes, np.float64).reshape(len(boxes), 2, found.small.shape[1])
                return found._replace(
                    unique=np.concatenate([found.unique, more[:, 0]]),
                    narrow=np.concatenate([found.narrow, more[:, 1]]),
                    small=found.small[:0],
                )
        return found

    def box(self, x: Fraction, y: Fraction, box: Boxes) -> Box:
        """A box over the point in balls of the precision that is set."""
        low, high = np.split(box, 2)
        return (ball(x, x), ball(y, y), *balls(low[FIRST:], high[FIRST:]))

    def located(
        self, x: Fraction, y: Fraction, solution: Solution, precision: int
    ) -> tuple[Solution, Box]:
        """The cube of the description's unknowns in which a solution is the only one, and a narrow
        box around that.

        Parameters
        ----------
        solution : alone in a cube of the problem's unknowns, in which all inequalities of its
            branch are positive.
        """
        rows = self.problem.rows
        with ctx.workprec(precision):
            unknowns = (ball(c - solution.radius, c + solution.radius) for c in solution.center)
            own = ball(x, x), ball(y, y), *unknowns
        narrow = refined(self.equations, own, precision)
        if not rows:
            return solution, narrow
        center = tuple(
            sum((c * u for c, u in zip(row, solution.center, strict=True)), Fraction(0))
            for row in rows
        )
        # the problem's unknowns of a cube so much smaller are all in the given one
        inverse = fmpq_mat(fmpz_mat([list(row) for row in rows])).inv().tolist()
        radius = solution.radius / to_fraction(max(sum(map(abs, row), fmpq(0)) for row in inverse))
        with ctx.workprec(precision):
            image = (
                sum((c * u for c, u in zip(row, narrow[FIRST:], strict=True)), arb(0))
                for row in rows
            )
            return Solution(center, radius, solution.signs), (*narrow[:FIRST], *image)

    def in_description(self, x: Fraction, y: Fraction, counts: PointCount) -> PointCount:
        """Counts with their solutions in the description's unknowns; undecided where these are too
        near.
        """
        if not self.problem.rows:
            return counts
        found = []
        for solution in counts.solutions:
            cube, narrow = self.located(x, y, solution, PRECISIONS[0])
            placed = _within_a_turn(cube, narrow, self.problem.is_angle)
            if placed is None:
                return PointCount()
            found.append(placed)
        return replace(counts, solutions=tuple(found))


def _in_floats(unique: Box, narrow: Box, around: Boxes) -> tuple[list[float], list[float]] | None:
    """Its boxes, the wide one rounded inward and the narrow one outward; None where these meet."""
    ends = [
        (
            enclosing_floats(lower(wide))[1],
            enclosing_floats(lower(own))[0],
            enclosing_floats(upper(own))[1],
            enclosing_floats(upper(wide))[0],
        )
        for wide, own in zip(unique[FIRST:], narrow[FIRST:], strict=True)
    ]
    if not all(low < least <= most < high for low, least, most, high in ends):
        return None
    (low, least, most, high), (first, last) = (
        zip(*ends, strict=True),
        (some[:FIRST].tolist() for some in np.split(around, 2)),
    )
    return [*first, *low, *last, *high], [*first, *least, *last, *most]


QUICK_BUDGET = 6_000
BUDGET = 60_000
"""Boxes in floating point for one point."""
MIN_BOX_WIDTHS = (1e-8, 1e-4)
"""Boxes this narrow are left to Arb. Where some are, the search begins again with the second number:
next to a fold the first one may leave too many.
"""
PRECISIONS = (128, 320)


@dataclass(frozen=True, slots=True)
class PointCount(Counted):
    """The counts at a point; None where the count asked for does not need them, and where nothing
    is decided.

    Attributes
    ----------
    index : numbers of minima, saddles and maxima.
    cones : configurations in which springs have no length and the energy has a peak.
    solutions : disjoint boxes, angles in radians: all solutions, or the minima when only these were
        counted. Where nothing is decided those that are proved, without signs where these are open.
    open : boxes in which there may be more of them.
    further : by the names of predicates, how many of the stable solutions they hold at.
    """

    total: int | None = None
    stable: int | None = None
    index: MorseIndex | None = None
    cones: int | None = None
    solutions: tuple[Solution, ...] = ()
    decided: bool = False
    open: int = 0
    further: Mapping[str, int] = field(default_factory=dict)


def boxed(unique: Boxes, narrow: Boxes, signs: str) -> Solution:
    """A cube of the unknowns between the two boxes, its radius a power of two.

    Parameters
    ----------
    unique, narrow : shape (2v,): low ends, then high ends; ``narrow`` lies in ``unique``.
    """
    (low, high), (least, most) = (
        [ends[FIRST:] for ends in np.split(box, 2)] for box in (unique, narrow)
    )
    center = 0.5 * (least + most)
    room, need = np.minimum(center - low, high - center), np.maximum(center - least, most - center)
    radius = radius_between(Fraction(float(need.max())), Fraction(float(room.min())))
    return Solution(tuple(map(Fraction, center.tolist())), radius, signs)


def radius_between(need: Fraction, room: Fraction) -> Fraction:
    """A power of two well below ``room``, or all of it where ``need`` leaves no choice."""
    if room <= 0:
        raise ArithmeticError("a narrow box leaves the box in which its zero is the only one")
    _, exponent = frexp(float(room)) if room > Fraction(1, 2**1000) else (0.0, -1000)
    radius = Fraction(2) ** (exponent - 3)
    return radius if need <= radius else room


def _within_a_turn(cube: Solution, narrow: Box, is_angle: Sequence[bool]) -> Solution | None:
    """The same in a cube whose center has no angle beyond half a turn; None where the box is not
    narrow enough.
    """
    with ctx.workprec(PRECISIONS[0]):
        center, need, room = list[Fraction](), arb(0), ball_of(cube.radius)
        for whole, found, angle in zip(
            map(ball_of, cube.center), narrow[FIRST:], is_angle, strict=True
        ):
            turns = round(float(whole) / FULL_TURN) * 2 * arb.pi() if angle else arb(0)
            center.append(Fraction(float(found - turns)))
            need = need.max(abs(found - turns - ball_of(center[-1])))
            room = room.min(ball_of(cube.radius) - abs(whole - turns - ball_of(center[-1])))
        if not need < room:
            return None
        return Solution(
            tuple(center), radius_between(exact(need.upper()), exact(room.lower())), cube.signs
        )
