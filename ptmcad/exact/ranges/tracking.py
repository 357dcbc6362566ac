"""Following a solution along a line of parameters, by Krawczyk's operator in balls, in any number of unknowns.

Guarantee: a `Tube` that `enclose` returns holds, for every value of the parameter in its range, exactly one
solution, which is nondegenerate and depends smoothly on the parameter. Two tubes are taken to hold the same branch
only where a third one, for a value that both cover, lies inside both. So `follow` never jumps to another branch.

Reference: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations, 5.1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat, ctx, fmpq

from ptmcad.algebra.polynomials import from_fraction, to_fraction
from ptmcad.algebra.real_roots import simplest_between
from ptmcad.algebra.trigonometric import TrigonometricPolynomial
from ptmcad.exact.models.system import ParametricSystem, Terms, terms_of
from ptmcad.mechanism import Model
from ptmcad.text.expressions import Expression, Term

Vector = tuple[arb, ...]
"""One ball for each unknown: the angles, then those on the line."""
Matrix = tuple[Vector, ...]
BITS = 160
_MIN_STEP = Fraction(1, 2**60)
"""Steps shorter than this, against the distance to be gone, are not tried."""
_MAX_STEPS = 3000
"""Where a branch comes ever nearer to others, steps shrink with the distance and their number has no bound."""


@dataclass(frozen=True, slots=True)
class Family:
    """A model on a line: its system, and its parameters as expressions in one unknown, the first axis."""

    model: Model
    system: ParametricSystem
    parameters: Mapping[str, Expression]

    @property
    def angles(self) -> int:
        """How many of the unknowns are on the circle: the first ones."""
        return len(self.system.ring.angles)

    def at(self, low: Fraction, high: Fraction) -> Instance:
        """The equations for all parameters from low to high, with their derivatives by the parameter."""
        value = arb(from_fraction(low)).union(arb(from_fraction(high)))
        numbers = [_dual(self.parameters[name], value) for name in self.system.ring.parameters]
        equations = [_specialised(g, numbers) for g in self.system.equation_terms]
        return Instance(
            self.angles,
            tuple(terms for terms, _ in equations),
            tuple(terms for _, terms in equations),
            tuple(tuple(_specialised(h, numbers)[0] for h in row) for row in self.system.jacobian_terms),
        )

    def conditions(self, low: Fraction, high: Fraction, point: Vector) -> Vector:
        """The left sides of the inequalities for all parameters from low to high, at balls of the unknowns."""
        value = arb(from_fraction(low)).union(arb(from_fraction(high)))
        numbers = [_dual(self.parameters[name], value) for name in self.system.ring.parameters]
        coordinates = coordinates_of(point, self.angles)
        terms = (terms_of(self.system.ring, p) for p in self.system.inequalities)
        return tuple(_evaluated(_specialised(t, numbers)[0], coordinates) for t in terms)

    def slope(self, p: TrigonometricPolynomial, low: Fraction, high: Fraction) -> arb:
        """The derivative of an element of the system's ring by the parameter, from low to high and at all angles.

        The ring has no unknowns on the line.
        """
        value = arb(from_fraction(low)).union(arb(from_fraction(high)))
        numbers = [_dual(self.parameters[name], value) for name in self.system.ring.parameters]
        return _evaluated(_specialised(terms_of(self.system.ring, p), numbers)[1], [arb(0, 1)] * (2 * self.angles))


Dual = tuple[arb, arb]
"""A value and its derivative by the parameter."""
Specialised = tuple[tuple[tuple[int, ...], arb], ...]


def _dual(expression: Expression, x: arb) -> Dual:
    def of(terms: tuple[Term, ...]) -> Dual:
        value, slope = arb(0), arb(0)
        for i, _, c in terms:
            power, derivative = arb(1), arb(0)
            for k in range(i):
                derivative, power = power * (k + 1), power * x
            factor = arb(from_fraction(c))
            value, slope = value + factor * power, slope + factor * derivative
        return value, slope

    (a, da), (b, db) = of(expression.numerator), of(expression.denominator)
    return a / b, (da * b - a * db) / (b * b)


def value_of(expression: Expression, x: arb) -> arb:
    """An expression in the first axis at a ball."""
    return _dual(expression, x)[0]


def _specialised(terms: Terms, numbers: list[Dual]) -> tuple[Specialised, Specialised]:
    """The polynomial in the unknowns, and its derivative by the parameter."""
    values, slopes = [], []
    for monomial, part in terms:
        total, rise = arb(0), arb(0)
        for powers, coefficient in part:
            term, slope = arb(coefficient), arb(0)
            for k, e in powers:
                value, derivative = numbers[k]
                for _ in range(e):
                    term, slope = term * value, slope * value + term * derivative
            total, rise = total + term, rise + slope
        values.append((monomial, total))
        if rise != 0:
            slopes.append((monomial, rise))
    return tuple(values), tuple(slopes)


@dataclass(frozen=True, slots=True)
class Instance:
    """Equations and Jacobian with balls for the parameters, to be evaluated at balls of the unknowns."""

    angles: int
    equation_terms: tuple[Specialised, ...]
    slope_terms: tuple[Specialised, ...]
    jacobian_terms: tuple[tuple[Specialised, ...], ...]

    def equations(self, point: Vector) -> Vector:
        coordinates = coordinates_of(point, self.angles)
        return tuple(_evaluated(g, coordinates) for g in self.equation_terms)

    def slope(self, point: Vector) -> Vector:
        """The derivative of the equations by the parameter."""
        coordinates = coordinates_of(point, self.angles)
        return tuple(_evaluated(g, coordinates) for g in self.slope_terms)

    def jacobian(self, point: Vector) -> Matrix:
        coordinates = coordinates_of(point, self.angles)
        return tuple(tuple(_evaluated(h, coordinates) for h in row) for row in self.jacobian_terms)


def coordinates_of(point: Vector, angles: int) -> list[arb]:
    """Cosine and sine of each angle, then the unknowns on the line."""
    return [*(f(a) for a in point[:angles] for f in (arb.cos, arb.sin)), *point[angles:]]


def _evaluated(terms: Specialised, unknowns: list[arb]) -> arb:
    total = arb(0)
    for monomial, coefficient in terms:
        term = coefficient
        for value, e in zip(unknowns, monomial, strict=True):
            for _ in range(e):
                term = term * value
        total += term
    return total


@dataclass(frozen=True, slots=True)
class Tube:
    """A box of unknowns that moves with the parameter x: center + velocity (x - middle) + (a box around 0).

    For every x from low to high there is one solution in the box ``unique``, and it lies in the box ``tight``.
    """

    low: Fraction
    high: Fraction
    center: Vector
    velocity: Vector
    unique: Vector
    tight: Vector

    def at(self, value: Fraction) -> Vector:
        """An enclosure of the unknowns at one value."""
        with ctx.workprec(BITS):
            return self._moved(arb(from_fraction(value - self._middle)), self.tight)

    def hull(self) -> Vector:
        """An enclosure of the unknowns at all values."""
        with ctx.workprec(BITS):
            return self._moved(arb(from_fraction((self.high - self.low) / 2)) * arb(0, 1), self.tight)

    def holds(self, other: Tube, value: Fraction) -> bool:
        """Whether the other tube's solution at a value lies where this one's is the only one."""
        with ctx.workprec(BITS):
            mine = self._moved(arb(from_fraction(value - self._middle)), self.unique)
            return all(a.contains(b) for a, b in zip(mine, other.at(value), strict=True))

    @property
    def _middle(self) -> Fraction:
        return (self.low + self.high) / 2

    def _moved(self, offset: arb, box: Vector) -> Vector:
        return tuple(c + v * offset + w for c, v, w in zip(self.center, self.velocity, box, strict=True))


def enclose(family: Family, low: Fraction, high: Fraction, guess: Vector) -> Tube | None:
    """A tube around the branch near a guess for the middle of the range; None when not proved.

    Notes
    -----
    With the tube's center c(x) and w the distance from it, Krawczyk's operator is applied to g(x, w) = f(c(x) + w, x)
    for all x at once; g(x, 0) comes from the mean value theorem in x, multiplied by the approximate inverse first.
    """
    with ctx.workprec(BITS):
        middle = family.at((low + high) / 2, (low + high) / 2)
        center = polish(middle, guess)
        inverse = _inverse(middle.jacobian(center))
        if inverse is None:
            return None
        velocity = tuple((-fall).mid() for fall in _times(inverse, middle.slope(center)))
        unit, radius = arb(0, 1), arb(from_fraction((high - low) / 2))
        along = family.at(low, high)
        swept = tuple(c + v * radius * unit for c, v in zip(center, velocity, strict=True))
        start = _times(inverse, middle.equations(center))
        drift = _sum(_times(inverse, along.slope(swept)), _times(_product(inverse, along.jacobian(swept)), velocity))
        move = tuple(s + d * radius * unit for s, d in zip(start, drift, strict=True))
        least = _least(center, family.angles)
        reach = [2 * abs(m).upper() + e for m, e in zip(move, least, strict=True)]
        for _ in range(8):
            spread = tuple(r * unit for r in reach)
            slopes = _product(inverse, along.jacobian(_sum(swept, spread)))
            image = _sum(tuple(-m for m in move), _times(_from_identity(slopes), spread))
            if all(abs(k) < r for k, r in zip(image, reach, strict=True)):
                return Tube(low, high, center, velocity, spread, image)
            reach = [(abs(k).upper() * 3 / 2 + e).upper() for k, e in zip(image, least, strict=True)]
            if not all(r < 2 for r in reach[: family.angles]) or not all(r.is_finite() for r in reach):
                return None
        return None


def _least(center: Vector, angles: int) -> list[arb]:
    """The least reach of a tube in each unknown, a little more than what rounding does to it."""
    least = arb(fmpq(1, 2 ** (BITS - 20)))
    return [least if k < angles else (least * (1 + abs(c))).upper() for k, c in enumerate(center)]


def _inverse(matrix: Matrix) -> Matrix | None:
    """An approximate inverse with exact entries."""
    size = len(matrix)
    try:
        found = arb_mat(size, size, [x.mid() for row in matrix for x in row]).inv()
    except ZeroDivisionError:
        return None
    inverse = tuple(tuple(found[i, j].mid() for j in range(size)) for i in range(size))
    return inverse if all(x.is_finite() for row in inverse for x in row) else None


def _times(matrix: Matrix, vector: Vector) -> Vector:
    return tuple(sum((a * b for a, b in zip(row, vector, strict=True)), arb(0)) for row in matrix)


def _product(first: Matrix, second: Matrix) -> Matrix:
    columns = [_times(first, column) for column in zip(*second, strict=True)]
    return tuple(zip(*columns, strict=True))


def _from_identity(matrix: Matrix) -> Matrix:
    """The identity minus a matrix."""
    return tuple(tuple(int(i == j) - x for j, x in enumerate(row)) for i, row in enumerate(matrix))


def _sum(first: Vector, second: Vector) -> Vector:
    return tuple(a + b for a, b in zip(first, second, strict=True))


def polish(at: Instance, guess: Vector) -> Vector:
    """A few steps of Newton's method, without guarantee."""
    point = tuple(x.mid() for x in guess)
    for _ in range(5):
        inverse = _inverse(at.jacobian(point))
        if inverse is None:
            break
        move = _times(inverse, at.equations(point))
        if not all(abs(m) < 1 for m in move[: at.angles]):
            break
        point = tuple((x - m).mid() for x, m in zip(point, move, strict=True))
    return point


@dataclass(frozen=True, slots=True)
class Reached:
    """A value of the parameter with the branch's place there; ``over`` covers the branch since the last one."""

    value: Fraction
    place: Tube
    over: Tube

    @property
    def point(self) -> Vector:
        """The unknowns."""
        return self.place.at(self.value)


def at_value(family: Family, value: Fraction, guess: Vector) -> Tube | None:
    """The place of the solution near a guess, at one value of the parameter."""
    return enclose(family, value, value, guess)


def follow(
    family: Family, start: Reached, end: Fraction, longest: Fraction, most: int | None = None
) -> tuple[list[Reached], bool]:
    """Follow a branch from one value of the parameter to another, in steps no longer than ``longest``.

    Parameters
    ----------
    most : steps; `_MAX_STEPS` when None.

    Returns
    -------
    What was reached, step by step without the start, and whether the end was.
    """
    found: list[Reached] = []
    current, step = start, max(-longest, min(longest, (end - start.value) / 8))
    least = abs(end - start.value) * _MIN_STEP
    while current.value != end:
        if len(found) == (_MAX_STEPS if most is None else most):
            return found, False
        goal = end if abs(step) >= abs(end - current.value) else _short(current.value, step)
        reached = bridge(family, current, goal)
        if reached is not None:
            found.append(reached)
            current, step = reached, max(-longest, min(longest, step * 3 / 2))
        else:
            step = step / 2
            if abs(step) < least:
                return found, False
    return found, True


def _short(value: Fraction, step: Fraction) -> Fraction:
    """A rational of few digits about a step away: without this each step would make the value's digits more."""
    low, high = sorted((value + step * 15 / 16, value + step))
    return to_fraction(simplest_between(from_fraction(low), from_fraction(high)))


def bridge(family: Family, start: Reached, value: Fraction) -> Reached | None:
    """The same branch at another value, if one tube proves it for all values between; else None."""
    ahead = start.place.velocity
    with ctx.workprec(BITS):
        half = arb(from_fraction((value - start.value) / 2))
        guess = tuple(a + v * half for a, v in zip(start.point, ahead, strict=True))
    over = enclose(family, min(start.value, value), max(start.value, value), guess)
    if over is None or not over.holds(start.place, start.value):
        return None
    place = at_value(family, value, over.at(value))
    return Reached(value, place, over) if place is not None and over.holds(place, value) else None
