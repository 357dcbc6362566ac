"""A system on a line of parameters, in balls: its equations with their derivatives of first and second order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from flint import arb

from ptmcad.algebra.trigonometric import TrigonometricPolynomial
from ptmcad.exact.models.system import ParametricSystem, Terms, terms_of
from ptmcad.exact.ranges.matrices import Matrix, Vector, plus, scaled, times
from ptmcad.formulas.graph import Formula
from ptmcad.formulas.values import values
from ptmcad.model import Model
from ptmcad.model.compile import compiled
from ptmcad.text.balls import ball_of, ball_over
from ptmcad.text.expressions import Expression, Term


@dataclass(frozen=True, slots=True)
class LineSystem:
    """A model on a line: its system, and its parameters as expressions in one unknown, the first axis."""

    model: Model
    system: ParametricSystem
    parameters: Mapping[str, Expression]

    @property
    def angles(self) -> int:
        """How many of the unknowns are on the circle: the first ones."""
        return len(self.system.ring.angles)

    def _numbers(self, low: Fraction, high: Fraction) -> list[Jet]:
        value = ball_over(low, high)
        return [_jet(self.parameters[name], value) for name in self.system.ring.parameters]

    def at(self, low: Fraction, high: Fraction) -> Instance:
        """The equations for all parameters from low to high, with their derivatives by the parameter."""
        numbers = self._numbers(low, high)
        return Instance(
            self.angles,
            tuple(_specialised(g, numbers) for g in self.system.equation_terms),
            tuple(tuple(_specialised(h, numbers) for h in row) for row in self.system.jacobian_terms),
        )

    def conditions(self, low: Fraction, high: Fraction, point: Vector) -> Vector:
        """The left sides of the inequalities for all parameters from low to high, at balls of the unknowns."""
        numbers = self._numbers(low, high)
        coordinates = coordinates_of(point, self.angles)
        terms = (terms_of(self.system.ring, p) for p in self.system.inequalities)
        return tuple(evaluated(_specialised(t, numbers)[0], coordinates) for t in terms)

    def values_of(self, formulas: Sequence[Formula], low: Fraction, high: Fraction, point: Vector) -> list[arb]:
        """Formulas of the model's for all parameters from low to high, at balls of the unknowns."""
        known, span = compiled(self.model), ball_over(low, high)
        unknowns = dict(zip(known.unknowns, point, strict=True))
        return values(formulas, _BallArithmetic(known.names, self.parameters, span, unknowns))

    def slope(self, p: TrigonometricPolynomial, low: Fraction, high: Fraction) -> arb:
        """The derivative of an element of the system's ring by the parameter, from low to high and at all angles.

        The ring has no unknowns on the line.
        """
        numbers = self._numbers(low, high)
        return evaluated(_specialised(terms_of(self.system.ring, p), numbers)[1], [arb(0, 1)] * (2 * self.angles))


class _BallArithmetic(NamedTuple):
    """Balls as an arithmetic for formulas, whose variables have these names.

    Attributes
    ----------
    span : of the first axis.
    unknowns : by their numbers.
    """

    names: tuple[str, ...]
    parameters: Mapping[str, Expression]
    span: arb
    unknowns: Mapping[int, arb]

    def constant(self, value: Fraction) -> arb:
        return ball_of(value)

    def variable(self, number: int) -> arb:
        known = self.unknowns.get(number)
        return _jet(self.parameters[self.names[number]], self.span)[0] if known is None else known

    def cos(self, number: int) -> arb:
        return self.unknowns[number].cos()

    def sin(self, number: int) -> arb:
        return self.unknowns[number].sin()


Jet = tuple[arb, arb, arb]
"""A value and its first and second derivative by the parameter."""
Specialised = tuple[tuple[tuple[int, ...], arb], ...]
"""A polynomial in the unknowns: exponents with coefficients."""
SpecialisedJet = tuple[Specialised, Specialised, Specialised]


def _jet(expression: Expression, x: arb) -> Jet:
    def of(terms: tuple[Term, ...]) -> Jet:
        total = (arb(0), arb(0), arb(0))
        for i, _, c in terms:
            power = (ball_of(c), arb(0), arb(0))
            for _ in range(i):
                power = _times_jet(power, (x, arb(1), arb(0)))
            total = _plus(total, power)
        return total

    top, (b, db, ddb) = of(expression.numerator), of(expression.denominator)
    value = top[0] / b
    slope = (top[1] - value * db) / b
    return value, slope, (top[2] - 2 * slope * db - value * ddb) / b


def _plus(first: Jet, second: Jet) -> Jet:
    return first[0] + second[0], first[1] + second[1], first[2] + second[2]


def _times_jet(first: Jet, second: Jet) -> Jet:
    (a, da, dda), (b, db, ddb) = first, second
    return a * b, da * b + a * db, dda * b + 2 * da * db + a * ddb


def _specialised(terms: Terms, numbers: list[Jet]) -> SpecialisedJet:
    """The polynomial in the unknowns, and its first and second derivative by the parameter."""
    found: tuple[list[tuple[tuple[int, ...], arb]], ...] = ([], [], [])
    for monomial, part in terms:
        total = (arb(0), arb(0), arb(0))
        for powers, coefficient in part:
            term = (arb(coefficient), arb(0), arb(0))
            for k, e in powers:
                for _ in range(e):
                    term = _times_jet(term, numbers[k])
            total = _plus(total, term)
        for order, (kept, x) in enumerate(zip(found, total, strict=True)):
            if order == 0 or x != 0:
                kept.append((monomial, x))
    return tuple(found[0]), tuple(found[1]), tuple(found[2])


@dataclass(frozen=True, slots=True)
class Instance:
    """Equations and Jacobian with balls for the parameters, to be evaluated at balls of the unknowns."""

    angles: int
    equation_jets: tuple[SpecialisedJet, ...]
    jacobian_jets: tuple[tuple[SpecialisedJet, ...], ...]

    def equations(self, point: Vector) -> Vector:
        return self._equations(point, 0)

    def slope(self, point: Vector) -> Vector:
        """The derivative of the equations by the parameter."""
        return self._equations(point, 1)

    def jacobian(self, point: Vector) -> Matrix:
        return self._jacobian(point, 0)

    def _equations(self, point: Vector, order: int) -> Vector:
        coordinates = coordinates_of(point, self.angles)
        return tuple(evaluated(g[order], coordinates) for g in self.equation_jets)

    def _jacobian(self, point: Vector, order: int) -> Matrix:
        coordinates = coordinates_of(point, self.angles)
        return tuple(tuple(evaluated(h[order], coordinates) for h in row) for row in self.jacobian_jets)

    def jacobian_slopes(self, point: Vector) -> tuple[Matrix, ...]:
        """The Jacobian's derivative by the parameter, then that by each unknown."""
        coordinates = coordinates_of(point, self.angles)
        entries = [[_gradient(h, coordinates, self.angles) for h, *_ in row] for row in self.jacobian_jets]
        return self._jacobian(point, 1), *(
            tuple(tuple(e[k] for e in row) for row in entries) for k in range(len(point))
        )

    def bend(self, point: Vector, velocity: Vector) -> Vector:
        """The second derivative of the equations by the parameter along a straight line of unknowns."""
        mixed, *by = self.jacobian_slopes(point)
        turned = (scaled(times(d, velocity), v) for d, v in zip(by, velocity, strict=True))
        return plus(plus(self._equations(point, 2), scaled(times(mixed, velocity), arb(2))), *turned)


def coordinates_of(point: Vector, angles: int) -> list[arb]:
    """Cosine and sine of each angle, then the unknowns on the line."""
    return [*(f(a) for a in point[:angles] for f in (arb.cos, arb.sin)), *point[angles:]]


def evaluated(terms: Specialised, unknowns: list[arb]) -> arb:
    """A polynomial's value at balls of the coordinates."""
    total = arb(0)
    for monomial, coefficient in terms:
        term = coefficient
        for value, e in zip(unknowns, monomial, strict=True):
            for _ in range(e):
                term = term * value
        total += term
    return total


def _gradient(terms: Specialised, coordinates: list[arb], angles: int) -> Vector:
    """The derivative of a polynomial by each unknown."""
    by = []
    for k in range(len(coordinates)):
        lowered = ((m, c * m[k]) for m, c in terms if m[k])
        by.append(evaluated(tuple(((*m[:k], m[k] - 1, *m[k + 1 :]), c) for m, c in lowered), coordinates))
    turned = (coordinates[k] * by[k + 1] - coordinates[k + 1] * by[k] for k in range(0, 2 * angles, 2))
    return (*turned, *by[2 * angles :])
