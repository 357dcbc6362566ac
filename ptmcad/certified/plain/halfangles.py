"""Problems in half angles, and where their solutions are in the description's unknowns.

Guarantee: exact. With q_k = 2 t - sum of c_j q_j, c_j whole numbers, every polynomial in cosines
and sines of the q is one in those of t and the other q. A configuration has two places in the new
unknowns, half a turn of t apart; that one of them counts only, a condition has to say (Lemma S10 of
docs/soundness.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from flint import arb, ctx, fmpq_mat, fmpz_mat

from ptmcad.answer.regionmap import Solution
from ptmcad.certified.arb_isolation import Box, refined
from ptmcad.certified.equationsystem import EquationSystem
from ptmcad.certified.plain.harmonics import Multi, TrigonometricPolynomial, Vector
from ptmcad.certified.plain.problem import FIRST, Condition, Problem
from ptmcad.certified.plain.zeros import PRECISIONS, PointCount, radius_between
from ptmcad.certified.uniqueness import FULL_TURN
from ptmcad.formulas.ballarithmetic import ball
from ptmcad.text.balls import ball_of, exact
from ptmcad.text.flint_numbers import to_fraction

Rows = tuple[Multi, ...]
"""Of the description's unknowns as whole multiples of a problem's; none where these are the same.
"""


def in_half_angle(problem: Problem, turn: Multi) -> Problem:
    """The problem in other unknowns, in which cosine and sine of half a sum of its angles are
    polynomials.

    Parameters
    ----------
    problem : without pushes.
    turn : the multiples of its angles in that sum, of which some are odd.
    """
    size = range(len(turn))
    halved = min((k for k in size if turn[k] % 2), key=lambda k: abs(turn[k]))
    others = {j: turn[halved] * turn[j] for j in size if j != halved}
    rows = tuple(
        tuple(2 * (j == k) - others.get(j, 0) if k == halved else int(j == k) for j in size)
        for k in size
    )

    def slopes(old: Sequence[TrigonometricPolynomial]) -> tuple[TrigonometricPolynomial, ...]:
        """By the new unknowns; with closed loops the last one is along these, the first ones stay
        without springs.
        """
        there = [f.substituted(rows) for f in old]
        if problem.closing:
            return tuple(there)
        parts = (
            [f.scaled(Fraction(row[i])) for f, row in zip(there, rows, strict=True)] for i in size
        )
        return tuple(sum(some, start=TrigonometricPolynomial({})) for some in parts)

    def vectors(old: Sequence[Vector]) -> tuple[Vector, ...]:
        across, up = (slopes(some) for some in zip(*old, strict=True))
        return tuple(zip(across, up, strict=True))

    def conditions(old: Sequence[Condition]) -> tuple[Condition, ...]:
        return tuple(
            replace(
                c,
                value=c.value.substituted(rows),
                squares=tuple(f.substituted(rows) for f in c.squares),
            )
            for c in old
        )

    return replace(
        problem,
        equations=slopes(problem.equations),
        cones=tuple(
            replace(
                cone,
                difference=(
                    cone.difference[0].substituted(rows),
                    cone.difference[1].substituted(rows),
                ),
                weights=vectors(cone.weights),
            )
            for cone in problem.cones
        ),
        inequalities=conditions(problem.inequalities),
        stability=conditions(problem.stability),
        multiples=tuple(f.substituted(rows) for f in problem.multiples),
        further=conditions(problem.further),
        covering=_product(problem.covering, rows) if problem.covering else rows,
    )


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
    rows = problem.covering
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
    if not problem.covering:
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


def _product(one: Rows, other: Rows) -> Rows:
    columns = list(zip(*other, strict=True))
    return tuple(
        tuple(sum(a * b for a, b in zip(row, column, strict=True)) for column in columns)
        for row in one
    )


def _inverse(rows: Rows) -> list[list[Fraction]]:
    return [
        list(map(to_fraction, row))
        for row in fmpq_mat(fmpz_mat([list(row) for row in rows])).inv().tolist()
    ]
