"""Solutions in half angles, placed in the description's unknowns.

Guarantee: exact, or enclosed; a cube that is returned holds the solution, and no other one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from flint import arb, ctx, fmpq_mat, fmpz_mat

from ptmcad.answer.regionmap import Solution
from ptmcad.certified.arb_isolation import Box, refined
from ptmcad.certified.equationsystem import EquationSystem
from ptmcad.certified.plain.problem import FIRST, Problem
from ptmcad.certified.plain.straight import Rows
from ptmcad.certified.plain.zeros import PRECISIONS, PointCount, radius_between
from ptmcad.certified.uniqueness import FULL_TURN
from ptmcad.formulas.ballarithmetic import ball
from ptmcad.text.balls import ball_of, exact
from ptmcad.text.flint_numbers import to_fraction


def located(
    problem: Problem,
    equations: EquationSystem,
    point: tuple[Fraction, Fraction],
    solution: Solution,
    precision: int,
) -> tuple[Solution, Box]:
    """The cube of the description's unknowns in which a solution is the only one, and a narrow box
    around that.

    Parameters
    ----------
    equations : of the problem.
    solution : alone in a cube of the problem's unknowns, in which all inequalities of its branch
        are positive.
    """
    with ctx.workprec(precision):
        unknowns = (ball(c - solution.radius, c + solution.radius) for c in solution.center)
        own = (*(ball(value, value) for value in point), *unknowns)
    narrow = refined(equations, own, precision)
    rows = problem.rows
    if not rows:
        return solution, narrow
    center = tuple(
        sum((c * x for c, x in zip(row, solution.center, strict=True)), Fraction(0)) for row in rows
    )
    # the problem's unknowns of a cube so much smaller are all in the given one
    most = max(sum(map(abs, row)) for row in _inverse(rows))
    with ctx.workprec(precision):
        image = (
            sum((c * x for c, x in zip(row, narrow[FIRST:], strict=True)), arb(0)) for row in rows
        )
        return Solution(center, solution.radius / most, solution.signs), (*narrow[:FIRST], *image)


def in_description(
    problem: Problem,
    equations: EquationSystem,
    point: tuple[Fraction, Fraction],
    counts: PointCount,
) -> PointCount:
    """Counts of a problem with their solutions in the description's unknowns; undecided where these
    are too near.
    """
    if not problem.rows:
        return counts
    found = []
    for solution in counts.solutions:
        placed = _within_a_turn(
            *located(problem, equations, point, solution, PRECISIONS[0]), problem.is_angle
        )
        if placed is None:
            return PointCount()
        found.append(placed)
    return replace(counts, solutions=tuple(found))


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


def _inverse(rows: Rows) -> list[list[Fraction]]:
    return [
        list(map(to_fraction, row))
        for row in fmpq_mat(fmpz_mat([list(row) for row in rows])).inv().tolist()
    ]
