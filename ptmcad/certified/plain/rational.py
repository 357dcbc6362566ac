"""Numbers of an equilibrium that are exact because it is a rational point, or its own mirror image.

Guarantee: exact. The point is a guess, by balls. It is taken where it lies in a box that holds no
other equilibrium and the energy's slopes, run in fractions, are zero there. Unknowns at multiples
of a quarter turn, or zero, are taken also where a reflection is proved to leave the energy as it
is, and the equilibrium's image lies in that box.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import isqrt

from flint import arb, ctx

from ptmcad.certified.plain.problem import FIRST
from ptmcad.formulas.graph import OPERATORS, Operation
from ptmcad.formulas.tape import Tape
from ptmcad.model import Mechanism
from ptmcad.model.involutions import Involution, involutions
from ptmcad.text.balls import ball_of, exact
from ptmcad.text.expressions import constant

Point = dict[int, tuple[Fraction, ...]]
"""Values of unknowns by their numbers: of a real its own, of an angle its cosine and sine."""


def rational_point(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    tape: Tape,
    held: Mapping[str, arb],
    boxes: Mapping[str, arb],
) -> Point:
    """The values of those unknowns of an equilibrium that are proved to be rational.

    Parameters
    ----------
    tape : has the energy's slopes as its last outputs.
    held : balls around the equilibrium, at the context's precision.
    boxes : wider ones, which together hold no other solution.
    """
    at: Point = {}
    for number, (name, ball) in enumerate(held.items(), FIRST):
        value, place = _direction(ball) if name in mechanism.angles else _real(ball)
        if ball.overlaps(place) and boxes[name].contains(2 * place - ball):
            at[number] = value
    if len(at) == len(held) and not mechanism.moments:
        values = exact_values(tape, at)
        if all(values[int(place)] == 0 for place in tape.outputs[-1]):
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


def exact_values(tape: Tape, at: Point) -> list[Fraction | None]:
    """The tape run in fractions; None of what depends on other unknowns, or is not proved to be
    rational.
    """
    values: list[Fraction | None] = []
    rows = zip(
        map(Operation, tape.operations.tolist()),
        tape.first.tolist(),
        tape.second.tolist(),
        strict=True,
    )
    for place, (operation, first, second) in enumerate(rows):
        if operation is Operation.CONSTANT:
            values.append(tape.constants[place])
        elif operation is Operation.VARIABLE:
            values.append(at[first][0] if len(at.get(first, ())) == 1 else None)
        elif operation in (Operation.COSINE, Operation.SINE):
            direction = (
                at.get(int(tape.first[first]), ())
                if tape.operations[first] == Operation.VARIABLE
                else ()
            )
            values.append(direction[operation is Operation.SINE] if len(direction) == 2 else None)
        else:
            values.append(_result(operation, [values[k] for k in (first, second) if k >= 0]))
    return values


def _result(operation: Operation, operands: Sequence[Fraction | None]) -> Fraction | None:
    known = [operand for operand in operands if operand is not None]
    if len(known) < len(operands):
        return Fraction(0) if operation is Operation.MULTIPLY and 0 in known else None
    if operation in OPERATORS:
        return Fraction(OPERATORS[operation](*known))
    a, b = known[0], known[-1]
    if operation is Operation.SQUARE:
        return a * a
    if operation is Operation.DIVIDE:
        return a / b if b else None
    length = _root(a * a + b * b)
    if operation is Operation.LENGTH:
        return length
    if operation is Operation.DIRECTION and a == 0 != b:
        return a  # whatever the length is
    return (a if operation is Operation.DIRECTION else 1) / length if length else None


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
