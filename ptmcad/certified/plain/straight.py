"""Springs whose ends can only move along one line relative to each other, as that of a slider along its own guide.

Guarantee: a problem's solutions are, without one left out or twice, those of its branches at which all inequalities of
their branch are positive (Lemma S6 of docs/soundness.md).

With d = s e, e a fixed vector, K |d| is K |e| |s|: no cone, but a kink along s = 0. On either side of it the potential
continues smoothly across s = 0, with u = e/|e| or u = -e/|e| everywhere. So there is one branch for each choice of
sides, a problem without that spring's cone and with the inequality s > 0, or -s > 0, instead.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

from ptmcad.certified.plain.divisors import common_divisor, quotient, square_root
from ptmcad.certified.plain.problem import Condition, Cone, Problem, Push
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.question.positivity import PROVED, Need, decide
from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, constant

Pair = tuple[Expression, Expression]


@dataclass(frozen=True, slots=True)
class _Line:
    """A cone whose vector is s e, and whose weights are w_i e."""

    cone: Cone
    direction: Pair
    way: TrigonometricPolynomial
    weights: tuple[TrigonometricPolynomial, ...]


def branches(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Problem, ...]:
    """The problem on either side of each kink; the problem itself where there is none.

    Parameters
    ----------
    axes : of the window in which a line's direction is to be a vector other than zero.
    """
    lines = [line for cone in problem.cones if (line := _line(cone, axes)) is not None]
    if not lines:
        return (problem,)
    straight = {line.cone.name for line in lines}
    bare = replace(problem, cones=tuple(cone for cone in problem.cones if cone.name not in straight))
    return tuple(_branch(bare, lines, sides, axes) for sides in product((1, -1), repeat=len(lines)))


def _branch(problem: Problem, lines: list[_Line], sides: tuple[int, ...], axes: tuple[Axis, Axis]) -> Problem:
    for line, side in zip(lines, sides, strict=True):
        ex, ey = line.direction
        pull, norm = line.cone.pull * side, _rational_norm(line.direction, axes)
        ahead = f"({', '.join((side * e).to_text() for e in (ex, ey))})"
        text = f"length of spring {line.cone.name} along {ahead}"
        inequalities = (*problem.inequalities, Condition(text, line.way.scaled(Fraction(side))))
        problem = replace(problem, inequalities=inequalities, where=f"{problem.where}, {line.cone.name} along {ahead}")
        if norm is None:
            problem = replace(problem, pushes=(*problem.pushes, Push(pull, line.direction, line.weights)))
            continue
        parts = (w.scaled(pull * norm) for w in line.weights)
        problem = replace(problem, equations=tuple(f - g for f, g in zip(problem.equations, parts, strict=True)))
    return problem


def _rational_norm(direction: Pair, axes: tuple[Axis, Axis]) -> Expression | None:
    """|e|, where that is a polynomial in the axes."""
    ex, ey = direction
    norm = square_root((ex * ex + ey * ey).numerator)
    if norm is None:
        return None
    found = Expression(norm)
    x, y = ((axis.low + axis.high) / 2 for axis in axes)
    return found if found.evaluate(x, y) > 0 else -found


def _line(cone: Cone, axes: tuple[Axis, Axis]) -> _Line | None:
    """The line along which a cone's vector stays, if there is one and it is proved to have a direction everywhere."""
    across, up = cone.difference
    first = next(pair for pair in _coefficients(across, up) if any(c.numerator for c in pair))
    direction = _primitive(first)
    vectors = [cone.difference, *cone.weights]
    if any(_crossed(pair, direction) for vector in vectors for pair in _coefficients(*vector)):
        return None
    ex, ey = direction
    if decide(ex * ex + ey * ey, axes, Need.POSITIVE) != PROVED:
        return None
    way, *weights = ((a.scaled(1 / ex) if ex.numerator else b.scaled(1 / ey)) for a, b in vectors)
    return _Line(cone, direction, way, tuple(weights))


def _coefficients(across: TrigonometricPolynomial, up: TrigonometricPolynomial) -> Iterator[Pair]:
    """The vectors of the coefficients of each wave."""
    nothing = constant(0), constant(0)
    for key in across.terms.keys() | up.terms.keys():
        yield from zip(across.terms.get(key, nothing), up.terms.get(key, nothing), strict=True)


def _primitive(pair: Pair) -> Pair:
    """A vector of polynomials without a common divisor in the direction of one of rational functions."""
    a, b = pair
    x, y = Expression(a.numerator) * Expression(b.denominator), Expression(b.numerator) * Expression(a.denominator)
    divisor = common_divisor([x.numerator, y.numerator])
    x, y = (Expression(quotient(c.numerator, divisor)) if c.numerator else c for c in (x, y))
    if not (x.is_constant and y.is_constant):
        return x, y
    # the smallest whole numbers, which are told to the user
    p, q = x.constant(), y.constant()
    ratio = q / p if p else Fraction(0)
    return (constant(ratio.denominator), constant(ratio.numerator)) if p else (constant(0), constant(1))


def _crossed(pair: Pair, direction: Pair) -> bool:
    """Whether a vector is not along a direction."""
    return bool((pair[0] * direction[1] - pair[1] * direction[0]).numerator)
