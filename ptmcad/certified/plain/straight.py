"""Springs whose ends can only move along one line relative to each other, which may turn with angles;
and problems in half angles, in which half the sum of two angles turns such a line.

The ends are those of a slider along its own guide, along one on a crank, or two points of a crank's
circle.

Guarantee: exact. A problem's solutions are, without one left out or twice, those of its branches at
which all inequalities of their branch are positive (Lemmas S6 and S10 of docs/soundness.md). With
q_k = 2 t - sum of c_j q_j, c_j whole numbers, every polynomial in cosines and sines of the q is one
in those of t and the other q. A configuration has two places in the new unknowns, half a turn of t
apart; a condition has to say that one of them counts only.

With d = s e, e a fixed vector or one that turns, K |d| is K |e| |s|: no cone, but a kink along
s = 0. On either side of it the potential continues smoothly across s = 0, with u = e/|e| or
u = -e/|e| everywhere. So there is one branch for each choice of sides, a problem without that
spring's cone and with the inequality s > 0, or -s > 0, instead. Where the line turns by half a turn
with a whole turn of an angle, both sides are one, over two turns of the angle.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

from ptmcad.certified.plain.divisors import common_divisor, positive_inside, quotient, square_root
from ptmcad.certified.plain.harmonics import (
    Multi,
    TrigonometricPolynomial,
    Vector,
    times,
    waves,
)
from ptmcad.certified.plain.problem import Condition, Problem, Push, SpringCone
from ptmcad.formulas.evaluation import mapped
from ptmcad.question.positivity import Need, decide
from ptmcad.question.slice import PROVED, Axis
from ptmcad.text.expressions import Expression, constant

Pair = tuple[Expression, Expression]


@dataclass(frozen=True, slots=True)
class _Line:
    """A cone whose vector is s e, e turned by a sum of angles, and the parts of its weights along
    e, over e.

    Attributes
    ----------
    turn : the multiples of the angles in that sum.
    """

    cone: SpringCone
    turn: Multi
    direction: Pair
    way: TrigonometricPolynomial
    weights: tuple[TrigonometricPolynomial, ...]


def branches(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Problem, ...]:
    """The problem on either side of each kink; the problem itself where there is none.

    Parameters
    ----------
    axes : of the window in which a line's direction is to be a vector other than zero.
    """
    problem, one_sided = _in_half_angles(problem, axes)
    lines = [line for cone in problem.cones if (line := _line(cone, axes)) is not None]
    if not lines:
        return (problem,)
    straight = {line.cone.name for line in lines}
    bare = replace(
        problem, cones=tuple(cone for cone in problem.cones if cone.name not in straight)
    )
    choices = [(1,) if line.cone.name in one_sided else (1, -1) for line in lines]
    return tuple(_branch(bare, lines, sides, axes) for sides in product(*choices))


def _in_half_angles(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Problem, set[str]]:
    """The problem in unknowns by whose sums all lines turn; and the springs whose sides change from
    one place of a configuration to its other one: either side of such a spring has every
    configuration once.
    """
    one_sided = set[str]()
    for k in range(len(problem.cones)):
        first, last = _ends(problem.cones[k].difference)
        if any((a + b) % 2 for a, b in zip(first, last, strict=True)):
            halved = in_half_angle(problem, tuple(b - a for a, b in zip(first, last, strict=True)))
            if _line(halved.cones[k], axes) is not None:
                problem = halved
                one_sided.add(problem.cones[k].name)
    return problem, one_sided


def _branch(
    problem: Problem, lines: list[_Line], sides: tuple[int, ...], axes: tuple[Axis, Axis]
) -> Problem:
    for line, side in zip(lines, sides, strict=True):
        ex, ey = line.direction
        pull, norm = line.cone.pull * side, _rational_norm(line.direction, axes)
        ahead = f"along ({', '.join((side * e).to_text() for e in (ex, ey))})"
        if any(line.turn):  # the directions of such lines are those of no part of the mechanism
            ahead = f"{'forwards' if side > 0 else 'backwards'} along its line"
        longer = Condition(
            f"the length of spring {line.cone.name}", line.way.scaled(Fraction(side))
        )
        inequalities = (*problem.inequalities, longer)
        where = f"{problem.where} {'and' if problem.is_branch else 'with'} spring {line.cone.name} {ahead}"
        problem = replace(problem, inequalities=inequalities, where=where, is_branch=True)
        if norm is None:
            problem = replace(
                problem, pushes=(*problem.pushes, Push(pull, line.direction, line.weights))
            )
            continue
        parts = (w.scaled(pull * norm) for w in line.weights)
        problem = replace(
            problem, equations=tuple(f - g for f, g in zip(problem.equations, parts, strict=True))
        )
    return problem


def _rational_norm(direction: Pair, axes: tuple[Axis, Axis]) -> Expression | None:
    """|e|, where that is a polynomial in the axes."""
    ex, ey = direction
    norm = square_root((ex * ex + ey * ey).numerator)
    if norm is None:
        return None
    return positive_inside(Expression(norm), axes)


def _line(cone: SpringCone, axes: tuple[Axis, Axis]) -> _Line | None:
    """The line along which a cone's vector stays, if there is one and it is proved to have a
    direction everywhere.

    A line that turns by an odd half of an angle is none of these.
    """
    twice = tuple(a + b for a, b in zip(*_ends(cone.difference), strict=True))
    if any(n % 2 for n in twice):
        return None
    turn = tuple(n // 2 for n in twice)
    (across, up), *weights = (
        _turned_back(vector, turn) for vector in (cone.difference, *cone.weights)
    )
    first = next(pair for pair in _coefficients(across, up) if any(c.numerator for c in pair))
    ex, ey = direction = _primitive(first)
    if any((a * ey - b * ex).numerator for a, b in _coefficients(across, up)):
        return None
    squared = ex * ex + ey * ey
    if decide(squared, axes, Need.POSITIVE) != PROVED:
        return None
    way = across.scaled(1 / ex) if ex.numerator else up.scaled(1 / ey)
    if not any(any(m) or any(e) for m, e in way.terms):
        return None  # of a length that no unknown changes
    along = tuple(a.scaled(ex / squared) + b.scaled(ey / squared) for a, b in weights)
    return _Line(cone, turn, direction, way, along)


def _ends(vector: Vector) -> tuple[Multi, Multi]:
    """Of the multiples by which a vector's parts turn, d_x + i d_y a sum of c e^(i m.q): the first
    and the last one.

    Of s e turned by n.q they are on both sides of n, equally far from it, as s is real.
    """
    across, up = vector
    found = set[Multi]()
    for key in across.terms.keys() | up.terms.keys():
        (ax, bx), (ay, by) = (f.terms.get(key, _NOTHING) for f in vector)
        ahead, back = (ax + by, ay - bx), (ax - by, ay + bx)
        for pair, sign in ((ahead, 1), (back, -1)):
            if any(c.numerator for c in pair):
                found.add(tuple(sign * m for m in key[0]))
    return min(found), max(found)


def _turned_back(vector: Vector, turn: Multi) -> Vector:
    """By a sum of angles."""
    across, up = vector
    cosine, sine = waves(turn)
    return across * cosine + up * sine, up * cosine - across * sine


def _coefficients(across: TrigonometricPolynomial, up: TrigonometricPolynomial) -> Iterator[Pair]:
    """The vectors of the coefficients of each wave."""
    for key in across.terms.keys() | up.terms.keys():
        yield from zip(across.terms.get(key, _NOTHING), up.terms.get(key, _NOTHING), strict=True)


_NOTHING = constant(0), constant(0)


def _primitive(pair: Pair) -> Pair:
    """A vector of polynomials without a common divisor in the direction of one of rational
    functions.
    """
    a, b = pair
    x, y = (
        Expression(a.numerator) * Expression(b.denominator),
        Expression(b.numerator) * Expression(a.denominator),
    )
    divisor = common_divisor([x.numerator, y.numerator])
    x, y = (Expression(quotient(c.numerator, divisor)) if c.numerator else c for c in (x, y))
    if not (x.is_constant and y.is_constant):
        return x, y
    # the smallest whole numbers, which the user sees
    p, q = x.constant(), y.constant()
    ratio = q / p if p else Fraction(0)
    return (
        (constant(ratio.denominator), constant(ratio.numerator))
        if p
        else (constant(0), constant(1))
    )


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
    size, rows = range(len(turn)), _rows(turn)

    def there(structure: Any) -> Any:
        """With the new unknowns in the polynomials."""
        return mapped(structure, lambda f: f.substituted(rows), TrigonometricPolynomial)

    def slopes(old: Sequence[TrigonometricPolynomial]) -> tuple[TrigonometricPolynomial, ...]:
        """By the new unknowns; with closed loops the last one is along these, the first ones stay
        without springs.
        """
        if problem.closing:
            return tuple(old)
        parts = (
            [f.scaled(Fraction(row[i])) for f, row in zip(old, rows, strict=True)] for i in size
        )
        return tuple(sum(some, start=TrigonometricPolynomial({})) for some in parts)

    def turned(cone: SpringCone) -> SpringCone:
        across, up = (slopes(some) for some in zip(*cone.weights, strict=True))
        return cone._replace(weights=tuple(zip(across, up, strict=True)))

    return replace(
        problem,
        equations=slopes(there(problem.equations)),
        cones=tuple(map(turned, there(problem.cones))),
        inequalities=there(problem.inequalities),
        stability=there(problem.stability),
        multiples=there(problem.multiples),
        further=there(problem.further),
        rows=tuple(times(row, rows) for row in problem.rows) if problem.rows else rows,
    )


def _rows(turn: Multi) -> Rows:
    """The angles as multiples of new ones, of which one is half the sum."""
    size = range(len(turn))
    halved = min((k for k in size if turn[k] % 2), key=lambda k: abs(turn[k]))
    others = {j: turn[halved] * turn[j] for j in size if j != halved}
    return tuple(
        tuple(2 * (j == k) - others.get(j, 0) if k == halved else int(j == k) for j in size)
        for k in size
    )
