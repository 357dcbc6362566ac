"""A tape run on a box in Arb's ball arithmetic, at any precision; it shares no code with the
compiled evaluator.

Guarantee: as for `ptmcad.formulas.intervalarithmetic.run`: value k encloses the k-th node's values at every
point of the box; where a node is a `meet`, at every point at which its two operands are equal. A
ball that is not finite says nothing.

References
----------
Johansson, Arb: efficient arbitrary-precision midpoint-radius interval arithmetic, IEEE Trans.
Comput. 66 (2017).
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

from flint import arb, ctx

from ptmcad.formulas.graph import OPERATORS, Formula, Operation
from ptmcad.formulas.tape import NO_OPERAND, Tape, record
from ptmcad.text.balls import ball_of, exact
from ptmcad.text.flint_numbers import from_fraction


class EmptyMeet(Exception):
    """Two enclosures of numbers that are equal at every solution are disjoint: the box holds no
    solution.
    """


def ball(low: Fraction, high: Fraction) -> arb:
    """A ball that contains the interval, at the context's precision."""
    return ball_of(low).union(ball_of(high)) if low != high else ball_of(low)


def balls(low: Iterable[float], high: Iterable[float]) -> list[arb]:
    """The same of several intervals of floats."""
    return [ball(Fraction(u), Fraction(v)) for u, v in zip(low, high, strict=True)]


def lower(value: arb) -> Fraction:
    """The exact lower end of a finite ball."""
    return exact(value.mid()) - exact(value.rad())


def upper(value: arb) -> Fraction:
    """The exact upper end of a finite ball."""
    return exact(value.mid()) + exact(value.rad())


def run_arb(tape: Tape, box: Sequence[arb], precision: int, stages: int | None = None) -> list[arb]:
    """Enclosures of the nodes of the first ``stages`` stages (all, if None).

    Parameters
    ----------
    box : the variables' balls, by their numbers.
    precision : in bits.

    Raises
    ------
    EmptyMeet
        When the box is proved to hold no point at which the operands of all `meet` nodes are equal.
    """
    end = len(tape) if stages is None else int(tape.stages[stages - 1])
    with ctx.workprec(precision):
        values: list[arb] = []
        for function, a, b in _steps(tape)[:end]:
            if function is None:
                values.append(box[a])
            elif function is arb:
                values.append(arb(a))
            elif b == NO_OPERAND:
                values.append(function(values[a]))
            else:
                values.append(function(values[a], values[b]))
        return values


@lru_cache(maxsize=64)
def _steps(tape: Tape) -> list[tuple[Callable[..., arb] | None, Any, int]]:
    """For each node a function and its operands' places; of a variable none, of a constant `arb`
    and the number.
    """
    steps: list[tuple[Callable[..., arb] | None, Any, int]] = []
    rows = zip(*(column.tolist() for column in tape.program[:3]), strict=True)
    for place, (operation, a, b) in enumerate(rows):
        if operation == Operation.CONSTANT:
            steps.append((arb, from_fraction(tape.constants[place]), b))
        else:
            steps.append((_FUNCTIONS.get(operation), a, b))
    return steps


def evaluated(formulas: Sequence[Formula], box: Sequence[arb]) -> list[arb]:
    """Enclosures of formulas at the context's precision; ``box`` and what is raised are those of
    `run_arb`.
    """
    tape = record([formulas])
    values = run_arb(tape, box, ctx.prec)
    return [values[int(place)] for place in tape.outputs[0]]


def signs_of(values: Iterable[arb]) -> tuple[int, ...]:
    """Of each ball 1 where it is positive, -1 where it is negative, else 0."""
    return tuple(1 if value > 0 else -1 if value < 0 else 0 for value in values)


def _length(x: arb, y: arb) -> arb:
    return _hull(_root(x.abs_lower(), y.abs_lower()), _root(x.abs_upper(), y.abs_upper()))


def _inverse_length(x: arb, y: arb) -> arb:
    return 1 / _length(x, y)


def _square(a: arb) -> arb:
    if a.is_exact():
        return a * a
    near, far = a.abs_lower(), a.abs_upper()
    return _hull(near * near, far * far)


def _meet(a: arb, b: arb) -> arb:
    if not a.is_finite():
        return b
    if not b.is_finite():
        return a
    if not a.overlaps(b):
        raise EmptyMeet
    return a.intersection(b)


def _direction(x: arb, y: arb) -> arb:
    """x/|(x, y)|: increasing in x, and nearer to zero for larger |y|."""
    if not (x.is_finite() and y.is_finite()):
        return arb(0, 1)
    near, far = y.abs_lower(), y.abs_upper()
    left, right = x.lower(), x.upper()
    low = _slope(left, far if left > 0 else near, arb(-1))
    high = _slope(right, far if right < 0 else near, arb(1))
    return _hull(low, high)


def _slope(x: arb, y: arb, otherwise: arb) -> arb:
    """x/|(x, y)|; ``otherwise`` where the length may be zero."""
    length = _root(x, y)
    return x / length if length > 0 else otherwise


def _root(x: arb, y: arb) -> arb:
    return (x * x + y * y).sqrt()


def _hull(a: arb, b: arb) -> arb:
    return a if a.is_exact() and b.is_exact() and a == b else a.union(b)


_FUNCTIONS: Mapping[int, Callable[..., arb]] = {
    **OPERATORS,
    Operation.DIVIDE: operator.truediv,
    Operation.SQUARE: _square,
    Operation.SINE: arb.sin,
    Operation.COSINE: arb.cos,
    Operation.LENGTH: _length,
    Operation.INVERSE_LENGTH: _inverse_length,
    Operation.DIRECTION: _direction,
    Operation.MEET: _meet,
}
