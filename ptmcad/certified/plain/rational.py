"""Numbers of an equilibrium that are exact because it is a rational point, or its own mirror image.

Guarantee: exact. The point is a guess, by balls. It is taken where it lies in a box that holds no
other equilibrium and the energy's slopes, in fractions, are zero there. Unknowns at multiples
of a quarter turn, or zero, are taken also where a reflection is proved to leave the energy as it
is, and the equilibrium's image lies in that box.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt

from flint import arb, ctx

from ptmcad.certified.plain.problem import FIRST
from ptmcad.formulas.evaluation import Substitution, values
from ptmcad.formulas.graph import Formula, Graph, direction, inverse_length, length
from ptmcad.model import Mechanism
from ptmcad.model.involutions import Involution, involutions
from ptmcad.text.balls import ball_of, exact
from ptmcad.text.expressions import constant

Point = dict[int, tuple[Fraction, ...]]
"""Values of unknowns by their numbers: of a real its own, of an angle its cosine and sine."""


def rational_point(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    slopes: Sequence[Formula],
    held: Mapping[str, arb],
    boxes: Mapping[str, arb],
) -> Point:
    """The values of those unknowns of an equilibrium that are proved to be rational.

    Parameters
    ----------
    slopes : of the energy, by the unknowns.
    held : balls around the equilibrium, at the context's precision.
    boxes : wider ones, which together hold no other solution.
    """
    at: Point = {}
    for number, (name, ball) in enumerate(held.items(), FIRST):
        value, place = _direction(ball) if name in mechanism.angles else _real(ball)
        if ball.overlaps(place) and boxes[name].contains(2 * place - ball):
            at[number] = value
    is_whole = len(at) == len(held) and not mechanism.moments
    if is_whole and all(value == 0 for value in exact_values(slopes, at)):
        return at
    names = dict(enumerate(held, FIRST))
    fixed = {k: value for k, value in at.items() if value[-1] == 0 or value[0] == 0}
    mirrored = {names[k]: bool(value[-1]) for k, value in fixed.items()}
    unknowns = mechanism.unknowns
    mirror = Involution(
        tuple(range(len(unknowns))),
        tuple(-1 if name in mirrored else 1 for name in unknowns),
        tuple(int(mirrored.get(name, False)) for name in unknowns),
    )
    known = {name: constant(value) for name, value in parameters.items()}
    return fixed if fixed and mirror in involutions(mechanism, known) else {}


@dataclass(frozen=True, slots=True)
class _AtPoint(Substitution):
    """Formulas with the values of unknowns in their places; rational lengths are numbers, too."""

    point: Point

    def variable(self, number: int) -> Formula:
        value = self.point.get(number, ())
        return self.graph.constant(value[0]) if len(value) == 1 else self.graph.variable(number)

    def cos(self, number: int) -> Formula:
        value = self.point.get(number)
        return self.graph.constant(value[0]) if value else self.graph.variable(number).cos()

    def sin(self, number: int) -> Formula:
        value = self.point.get(number)
        return self.graph.constant(value[1]) if value else self.graph.variable(number).sin()

    def length(self, x: Formula, y: Formula) -> Formula:
        if x.value is None or y.value is None:
            return length(x, y)
        root = _root(x.value**2 + y.value**2)
        return length(x, y) if root is None else self.graph.constant(root)

    def inverse_length(self, x: Formula, y: Formula) -> Formula:
        root = self.length(x, y)
        return 1 / root if root.value else inverse_length(x, y)

    def direction(self, x: Formula, y: Formula) -> Formula:
        root = self.length(x, y)
        return x / root if root.value else direction(x, y)


def exact_values(formulas: Sequence[Formula], at: Point) -> list[Fraction | None]:
    """The values of formulas in fractions; None of what depends on other unknowns, or is not proved
    to be rational.
    """
    return [formula.value for formula in values(formulas, _AtPoint(Graph(), {}, at))]


def exact_eigenvalues(hessian: list[list[Fraction | None]]) -> list[Fraction]:
    """The eigenvalues, the smallest first, of a diagonal matrix or one of two rows where they are
    rational; or none.
    """
    known = [[entry for entry in row if entry is not None] for row in hessian]
    if any(len(row) != len(hessian) for row in known):
        return []
    if len(known) == 2:
        (a, b), (_, d) = known
        root = _root((a - d) ** 2 + 4 * b * b)
        return [] if root is None else [(a + d - root) / 2, (a + d + root) / 2]
    diagonal = [row[i] for i, row in enumerate(known)]
    return (
        sorted(diagonal)
        if sum(map(bool, diagonal)) == sum(bool(c) for row in known for c in row)
        else []
    )


def _real(ball: arb) -> tuple[tuple[Fraction, ...], arb]:
    """The fraction near a ball's middle that it seems to be: nearly no other number has one so
    near.
    """
    value = exact(ball.mid()).limit_denominator(2 ** (ctx.prec // 4))
    return (value,), ball_of(value)


def _direction(ball: arb) -> tuple[tuple[Fraction, ...], arb]:
    """Cosine and sine, by a rational tangent or cotangent of half the angle, and the angle near the
    ball.
    """
    half = ball.mid() / 2
    steep = bool(abs(half.sin()) > abs(half.cos()))
    (t,), _ = _real(half.cot() if steep else half.tan())
    c, s = (1 - t * t) / (1 + t * t) * (-1 if steep else 1), 2 * t / (1 + t * t)
    angle = arb.atan2(ball_of(s), ball_of(c)) if s or c > 0 else arb.pi()
    turns = round(float((ball - angle).mid() / (2 * arb.pi()).mid()))
    return (c, s), angle + 2 * arb.pi() * turns


def _root(value: Fraction) -> Fraction | None:
    """The square root of a number that is not negative, where it is rational."""
    root = Fraction(isqrt(value.numerator), isqrt(value.denominator))
    return root if root * root == value else None
