"""All that the formulas of a problem are made of, exactly and once: springs with a free length,
factors, derivatives, and bodies that one angle turns together.

Guarantee: every formula of a spring is read off the difference of its ends; products of slopes are in
Fourier's normal form, so that what is constant for rigid bodies is a constant. Everything in a
`FactoredProblem` is over the positive common factor of its equation. The moment of a `Turn`, in
which springs between the bodies have no part, vanishes at every equilibrium, and its stiffness is
its derivative along w: the second derivative of the energy, up to a positive factor. (Lemma S4 of
docs/soundness.md.)

With u = d/|d| the slope of |d| by q_i is u.a_i, a_i = dd/dq_i, and its second derivative
u.d^2d/dq_i dq_j + (u x a_i)(u x a_j)/|d|. An equilibrium balances each spring: K u.a_i is the rest
of the i-th equation, whatever the direction u is. So the squared sines are known there, too, by
(u x a_i)(u x a_j) = a_i.a_j - (u.a_i)(u.a_j), also where the spring is short and its direction is
not.

With d' = c J d + e along w, J being the turn by a right angle and c = -1, 0 or 1, a spring's length
l has l' = u.e and l'' = c u x e + (u x e)^2/l + u.e'. Of a spring that turns as a whole e is zero,
and of one from a body that turns to a fixed point it is as long as the way from there to the axis,
however long the spring is. That way is often the same for all springs: times this arm stands what
all of them do together, which intervals enclose more narrowly than the sum of its products.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import NamedTuple

from ptmcad.certified.plain.divisors import common_factor, divided, largest_factor, over
from ptmcad.certified.plain.harmonics import TrigonometricPolynomial, Unknown
from ptmcad.certified.plain.problem import Problem, Push, SpringCone
from ptmcad.formulas.evaluation import mapped
from ptmcad.formulas.graph import (
    Formula,
    direction,
    expression_formula,
    inverse_length,
    length,
    meet,
)
from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, constant

Vector = tuple[Formula, Formula]
Matrix = tuple[tuple[Formula, ...], ...]
Pair = tuple[TrigonometricPolynomial, TrigonometricPolynomial]


class ConeFormulas(NamedTuple):
    """A spring in one configuration, with the vectors w_i by which it is in the equations, each over
    the factor of its equation.

    Of open chains w_i is the slope a_i of d by the i-th unknown over the factor of that one's
    equation.

    Attributes
    ----------
    pull : stiffness times free length.
    vector, unit, extent : d, its direction u and |d|, which is d.u where the direction is a
        variable.
    inverse : 1/|d|.
    active : the equations that the spring is in.
    cosines, sines : u.w_i and u x w_i.
    turns : u x a_j, over the same factors.
    bends : u.dw_i/dq_j.
    levers : d.dw_i/dq_i.
    squares, crosses : w_i.w_j and w_i x w_j.
    """

    pull: Formula
    vector: Vector
    unit: Vector
    extent: Formula
    inverse: Formula
    active: tuple[int, ...]
    cosines: tuple[Formula, ...]
    sines: tuple[Formula, ...]
    turns: tuple[Formula, ...]
    bends: Matrix
    levers: tuple[Formula, ...]
    squares: Matrix
    crosses: Matrix

    def products(self) -> Matrix:
        """(u x w_i)(u x a_j)."""
        return tuple(tuple(p * q for q in self.turns) for p in self.sines)

    def products_at_equilibrium(self, rest: Sequence[Formula]) -> Matrix:
        """The same where K u.w_i is ``rest``; never to be differentiated. Of closed loops no more
        is known.

        A rest that is the constant zero says nothing where K may be zero, too: 0/0 is no interval.
        """
        if self.turns != self.sines:
            return self.products()
        known = [
            meet(c, r / self.pull)
            if i in self.active and (r.value is None or self.pull.value is not None)
            else c
            for i, (c, r) in enumerate(zip(self.cosines, rest, strict=True))
        ]
        return tuple(
            tuple(
                meet(product, self.squares[i][j] - known[i] * known[j])
                if i in self.active and j in self.active
                else product
                for j, product in enumerate(row)
            )
            for i, row in enumerate(self.products())
        )


Writer = Callable[[Sequence[Unknown], Formula | None], ConeFormulas]
"""The formulas of a spring in what stands for the unknowns, with the angle of its direction where
that is a variable of its own."""


def writer(cone: SpringCone, factors: Sequence[Expression]) -> Writer:
    """What writes a spring; it is multiplied out once, over the positive factors of the equations."""
    (x, y), size = cone.difference, range(len(factors))
    weights = tuple(
        (over(a, g), over(b, g)) for (a, b), g in zip(cone.weights, factors, strict=True)
    )
    slopes = tuple(
        (over(x.derivative(i), g), over(y.derivative(i), g)) for i, g in enumerate(factors)
    )
    bends = tuple(tuple((a.derivative(j), b.derivative(j)) for j in size) for a, b in weights)
    products = (
        tuple(x * a.derivative(i) + y * b.derivative(i) for i, (a, b) in enumerate(weights)),
        tuple(tuple(a * c + b * d for c, d in weights) for a, b in weights),
        tuple(tuple(a * d - b * c for c, d in weights) for a, b in weights),
    )
    active = tuple(i for i, (a, b) in enumerate(weights) if a.terms or b.terms)

    def written(unknowns: Sequence[Unknown], phi: Formula | None) -> ConeFormulas:
        (dx, dy), by_weights, by_slopes, by_bends, numbers = mapped(
            (cone.difference, weights, slopes, bends, products),
            lambda f: f.formula(unknowns),
            TrigonometricPolynomial,
        )
        ux, uy = (direction(dx, dy), direction(dy, dx)) if phi is None else (phi.cos(), phi.sin())
        return ConeFormulas(
            expression_formula(unknowns[0].graph, cone.pull),
            (dx, dy),
            (ux, uy),
            length(dx, dy) if phi is None else dx * ux + dy * uy,
            inverse_length(dx, dy),
            active,
            tuple(ux * a + uy * b for a, b in by_weights),
            tuple(ux * b - uy * a for a, b in by_weights),
            tuple(ux * b - uy * a for a, b in by_slopes),
            tuple(tuple(ux * a + uy * b for a, b in row) for row in by_bends),
            *numbers,
        )

    return written


@dataclass(frozen=True, slots=True)
class FactoredProblem:
    """A problem with its factors.

    Attributes
    ----------
    factors : of the equations, positive in the open window.
    equations : the smooth parts over their factors.
    writers : of the springs with a free length.
    turns : directions in which bodies turn together; none are used of closed loops, and where
        springs are pushes.
    pushes : of the problem, with their weights over the factors.
    """

    problem: Problem
    factors: tuple[Expression, ...]
    equations: tuple[TrigonometricPolynomial, ...]
    writers: tuple[Writer, ...]
    turns: tuple[Turn, ...]
    pushes: tuple[Push, ...]


def geometry(problem: Problem, axes: tuple[Axis, Axis] | None = None) -> FactoredProblem:
    """The same for all charts of a problem.

    Parameters
    ----------
    axes : of the window in which factors are to be positive; without them, and of closed loops, all
        factors are 1, and nothing turns.
    """
    factors: tuple[Expression, ...] = (constant(1),) * len(problem.equations)
    found: tuple[Turn, ...] = ()
    if axes is not None and not problem.closing:
        factors = common_factors(problem, axes)
        found = tuple(_turn(problem, weights, axes) for weights in turning_directions(problem))
    equations = tuple(over(f, g) for f, g in zip(problem.equations, factors, strict=True))
    return FactoredProblem(
        problem,
        factors,
        equations,
        tuple(writer(cone, factors) for cone in problem.cones),
        found,
        tuple(
            replace(
                push, weights=tuple(over(w, g) for w, g in zip(push.weights, factors, strict=True))
            )
            for push in problem.pushes
        ),
    )


def common_factors(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Expression, ...]:
    """Of each equation and the slopes of its springs' ends: a positive common factor, 1 where none
    is proved to be.
    """
    return tuple(
        common_factor(
            [
                f,
                *(d.derivative(i) for cone in problem.cones for d in cone.difference),
                *(push.weights[i] for push in problem.pushes),
            ],
            axes,
        )
        for i, f in enumerate(problem.equations)
    )


@dataclass(frozen=True, slots=True)
class Turn:
    """A direction w of unknowns that change together.

    Attributes
    ----------
    weights : w.
    slope : of the smooth part of the energy along w, over the factor: what is a multiple of the
        arm, over it, and the rest.
    bend : the slope's own.
    levers : for each cone c, e and e', the latter two over the factor and the arm.
    factor : positive in the open window.
    arm : what divides all e.
    """

    weights: tuple[int, ...]
    slope: Pair
    bend: Pair
    levers: tuple[tuple[int, Pair, Pair], ...]
    factor: Expression
    arm: Expression


def turning_directions(problem: Problem) -> list[tuple[int, ...]]:
    """The direction w in which most springs or terms drop out, if they do in any; none of closed
    loops, and where springs are pushes. More of them would cost more than they discard.
    """
    if problem.closing or problem.pushes:
        return []
    found = []
    for weights in product((0, 1, -1), repeat=len(problem.unknowns)):
        lead = next((w for w in weights if w), 0)
        angles = all(is_angle for is_angle, w in zip(problem.is_angle, weights, strict=True) if w)
        if lead > 0 and sum(map(abs, weights)) > 1 and angles:
            gain = _gain(problem, weights)
            if gain > 0:
                found.append((gain, weights))
    return [max(found, key=lambda entry: entry[0])[1]] if found else []


def _gain(problem: Problem, weights: Sequence[int]) -> int:
    """How many terms less there are than in the equations that the moment is put together of."""
    before = sum(len(f.terms) for w, f in zip(weights, problem.equations, strict=True) if w)
    after = len(_along(problem.equations, weights).terms)
    for cone in problem.cones:
        before += sum(
            len(d.derivative(i).terms) for i, w in enumerate(weights) if w for d in cone.difference
        )
        after += sum(len(f.terms) for f in _lever(cone, weights)[1])
    return before - after


def _along(
    slopes: Sequence[TrigonometricPolynomial], weights: Sequence[int]
) -> TrigonometricPolynomial:
    total = TrigonometricPolynomial({})
    for w, f in zip(weights, slopes, strict=True):
        total = total + f if w > 0 else total - f if w < 0 else total
    return total


def _derivative(f: TrigonometricPolynomial, weights: Sequence[int]) -> TrigonometricPolynomial:
    return _along([f.derivative(i) for i in range(len(weights))], weights)


def _lever(cone: SpringCone, weights: Sequence[int]) -> tuple[int, Pair]:
    """c and e with the fewest terms."""
    x, y = cone.difference
    dx, dy = (_derivative(f, weights) for f in (x, y))
    choices: list[tuple[int, Pair]] = [
        (c, (dx + y.scaled(Fraction(c)), dy - x.scaled(Fraction(c)))) for c in (0, 1, -1)
    ]
    return min(choices, key=lambda choice: sum(len(f.terms) for f in choice[1]))


def _turn(problem: Problem, weights: tuple[int, ...], axes: tuple[Axis, Axis]) -> Turn:
    slope = _along(problem.equations, weights)
    levers = [_lever(cone, weights) for cone in problem.cones]
    factor = common_factor([slope, *(f for _, e in levers for f in e)], axes)
    arm = largest_factor(over(f, factor) for _, e in levers for f in e)
    ends = [(c, (over(e[0], factor * arm), over(e[1], factor * arm))) for c, e in levers]
    parts = divided(over(slope, factor), arm)
    return Turn(
        weights,
        parts,
        (_derivative(parts[0], weights), _derivative(parts[1], weights)),
        tuple((c, e, (_derivative(e[0], weights), _derivative(e[1], weights))) for c, e in ends),
        factor,
        arm,
    )
