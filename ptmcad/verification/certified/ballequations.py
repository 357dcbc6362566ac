"""The equations of any model and their Jacobian in balls of Arb, over boxes of the unknowns and of
the parameters.

Guarantee: every ball contains the exact value at each configuration and for all parameters in the
balls given. Where a spring with a free length may have no length, its direction is any unit vector,
and nothing is said of the Jacobian.

What is evaluated are the formulas of `normalform.modelequations`. With u = d/|d|, slopes g_i of d by the unknowns,
second derivatives g_ij, and c_i = u x g_i, a spring's part of the equations is -K u.g_i and of the
Hessian -K (c_i c_j/|d| + u.g_ij). With closed loops other vectors w_i are in the place of the g_i:
of the equations -K u.w_i, and -K ((u x w_i) c_j/|d| + u.w_ij). Where u is on a line that turns by
n_j with the unknowns, c_j/|d| is n_j.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from types import MappingProxyType

from flint import arb

from ptmcad.text.balls import ball_of
from ptmcad.verification.coordinates import ball, power, square
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.normalform.modelequations import Equations
from ptmcad.verification.normalform.operations import (
    ADD,
    COSINE,
    DIRECTION,
    DIVIDE,
    INVERSE_LENGTH,
    LENGTH,
    MAX_VARIABLES,
    MULTIPLY,
    POWER,
    SINE,
    SQUARE,
    SUBTRACT,
    VARIABLE,
    Formulas,
)
from ptmcad.verification.normalform.waves import Form, Sides

Matrix = list[list[arb]]
_ZERO, _ANY, _UNKNOWN = arb(0), arb(0, 1), arb("nan")
_Step = tuple[int, Callable[[arb, arb], arb], int, int]
"""The number of a value, and of what operands."""


def _of_length(a: arb, b: arb) -> arb:
    squared = square(a) + square(b)
    return squared.sqrt() if squared > 0 else _ZERO.union(squared.abs_upper().sqrt())


def _of_inverse_length(a: arb, b: arb) -> arb:
    return (square(a) + square(b)).rsqrt()


def _of_direction(a: arb, b: arb) -> arb:
    squared = square(a) + square(b)
    found = a * squared.rsqrt() if squared > 0 else _ANY
    return found if found.rad() < 1 else _ANY


_OPERATIONS: Mapping[int, Callable[[arb, arb], arb]] = {
    ADD: operator.add,
    SUBTRACT: operator.sub,
    MULTIPLY: operator.mul,
    SQUARE: lambda a, _: square(a),
    DIVIDE: operator.truediv,
    COSINE: lambda a, _: a.cos(),
    SINE: lambda a, _: a.sin(),
    DIRECTION: _of_direction,
    INVERSE_LENGTH: _of_inverse_length,
    LENGTH: _of_length,
}


class _FormFormulas:
    """The formulas of a form with springs on one line each on some sides, by their numbers in one
    list.

    Attributes
    ----------
    squared : of each spring |d|^2.
    numbers : of the Jacobian's entries, row by row, and of what is positive, by its name.
    steady : the operations in which no unknown is.
    """

    def __init__(self, form: Form, names: Sequence[str], sides: Sides):
        f = self.list = Formulas(with_powers=True)
        m = self.model = Equations(
            form, f, {name: f.variable(MAX_VARIABLES + k) for k, name in enumerate(names)}
        )
        m.sides = sides
        directions = m.directions()
        self.equations = m.equations(directions)
        rows = m.hessian(directions)
        self.squared = [f.dot(s.vector, s.vector) for s in m.cones]
        self.may_be_short = [k for k, s in enumerate(m.cones) if s.name not in sides]
        stability = list(map(m.waves, form.stability))
        if form.closing:
            stability = [f.determinant([[row[k] for k in form.closing] for row in rows])]
        self.numbers = {
            "ahead": [m.ahead(k) for k, s in enumerate(m.cones) if s.name in sides],
            "inequalities": list(map(m.waves, form.inequalities)),
            "stability": stability,
            "margins": [m.waves(margin.value) for margin in form.margins],
            "jacobian": [entry for row in rows for entry in row],
        }
        self._moving = set[int]()
        for n, (code, a, b) in enumerate(f.rows):
            if (code == VARIABLE and a < MAX_VARIABLES) or (
                code > VARIABLE and not self._moving.isdisjoint((a, b))
            ):
                self._moving.add(n)
        self.steady = self._in_order(
            {n for n, (code, *_) in enumerate(f.rows) if code > VARIABLE} - self._moving
        )
        self._first = f.needed([*self.equations, *self.squared])
        self.first = self._in_order(self._first & self._moving)
        self._known: dict[tuple[str, ...], tuple[list[int], list[_Step]]] = {}

    def further(self, names: tuple[str, ...]) -> tuple[list[int], list[_Step]]:
        """The numbers of some values, and the operations that they need besides the first ones."""
        if names not in self._known:
            numbers = [n for name in names for n in self.numbers[name]]
            needed = (self.list.needed(numbers) - self._first) & self._moving
            self._known[names] = numbers, self._in_order(needed)
        return self._known[names]

    def _in_order(self, numbers: Collection[int]) -> list[_Step]:
        return [step for n in sorted(numbers) if (step := self._step(n)) is not None]

    def _step(self, n: int) -> _Step | None:
        code, a, b = self.list.rows[n]
        if code <= VARIABLE:
            return None
        if code == POWER:
            exponent = int(self.list.numbers[b])
            return n, lambda x, _: power(x, exponent), a, a
        return n, _OPERATIONS[code], a, b


@lru_cache(maxsize=64)
def _formulas_of(
    form: Form, names: tuple[str, ...], sides: tuple[tuple[str, int], ...], pulling: tuple[str, ...]
) -> _FormFormulas:
    """Those with some of the springs."""
    return _FormFormulas(
        replace(form, cones=tuple(c for c in form.cones if c.name in pulling)), names, dict(sides)
    )


def _run(steps: Iterable[_Step], known: list[arb]) -> None:
    for n, function, a, b in steps:
        known[n] = function(known[a], known[b])


@dataclass(frozen=True)
class BallJet:
    """The equations at all configurations in a box, and further values on request.

    Attributes
    ----------
    values : zero at solutions.
    conditions : what is positive at solutions that count.
    short : whether a spring may have no length; the Jacobian is of no finite numbers then.
    """

    values: list[arb]
    conditions: list[arb]
    short: bool
    formulas: _FormFormulas
    known: list[arb]

    def of(self, name: str) -> list[arb]:
        """Some of the formulas; not finite where they are not known."""
        numbers, steps = self.formulas.further((name,))
        _run(steps, self.known)
        return [self.known[n] for n in numbers]

    @cached_property
    def jacobian(self) -> Matrix:
        """The derivatives, which points and most boxes that are discarded do without."""
        n = len(self.values)
        entries = [_UNKNOWN] * (n * n) if self.short else self.of("jacobian")
        return [entries[n * i : n * i + n] for i in range(n)]


class BallEquations:
    """The equations at given parameters as functions of the unknowns.

    Parameters
    ----------
    values : a ball for each parameter; no pull of a spring is negative.
    conditions : "inequalities" and "stability", as far as they are asked for; with closed loops the
        latter is the determinant of the Jacobian, with its columns as `Form.closing` has them.
    sides : of springs on one line each, on which side of length zero solutions are looked for.
        There every one of these has its direction, also where it is short, and a further condition,
        which comes before all others.

    Raises
    ------
    Unproved
        When such a line may have no direction.
    """

    def __init__(
        self,
        form: Form,
        values: Mapping[str, arb],
        conditions: Sequence[str] = (),
        sides: Sides = MappingProxyType({}),
    ):
        self.form, self.values, self.sides = form, dict(values), sides
        # one that pulls nothing at a point has its sides there, too, as all other choices of them
        # have
        pulling = [c.name for c in form.cones if c.name in sides or not (ball(c.pull, values) == 0)]  # noqa: SIM201
        for cone in form.cones:
            line = cone.line if cone.name in sides else None
            if (
                line is not None
                and not sum((square(ball(p, values)) for p in line.vector), _ZERO) > 0
            ):
                raise Unproved(f"the line of spring {cone.name} may have no direction")
        of = self._formulas = _formulas_of(form, (*values,), (*sides.items(),), (*pulling,))
        self._conditions, further = of.further(("ahead", *conditions))
        self._steps = [*of.first, *further]
        self._known = [_ZERO] * len(of.list.rows)
        for n, number in of.list.numbers.items():
            self._known[n] = ball_of(number)
        for name, n in of.model.parameters.items():
            self._known[n] = values[name]
        _run(of.steady, self._known)

    @property
    def circles(self) -> tuple[bool, ...]:
        """Of each unknown, whether the equations are the same after a full turn: not where half of
        it turns a line.
        """
        lines = [s.line for s in self._formulas.model.cones if s.name in self.sides]
        return tuple(
            c and not any(line.twice[k] % 2 for line in lines)
            for k, c in enumerate(self.form.is_circle)
        )

    def __call__(self, at: Sequence[arb]) -> BallJet:
        """At all configurations in a box."""
        of, known = self._formulas, self._known.copy()
        for n, value in zip(of.model.unknowns, at, strict=True):
            known[n] = value
        _run(self._steps, known)
        short = not all(known[of.squared[k]] > 0 for k in of.may_be_short)
        values = [known[n] for n in of.equations]
        return BallJet(values, [known[n] for n in self._conditions], short, of, known)
