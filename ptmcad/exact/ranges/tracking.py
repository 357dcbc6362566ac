"""Following an equilibrium along a line of parameters, by Krawczyk's operator in balls.

Guarantee: a `Tube` that `enclose` returns holds, for every value of the parameter in its range, exactly one
equilibrium, which is nondegenerate and depends smoothly on the parameter. Two tubes are taken to hold the same branch
only where a third one, for a value that both cover, lies inside both. So `follow` never jumps to another branch.

Reference: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations, 5.1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, ctx, fmpq

from ptmcad.algebra.polynomials import from_fraction, to_fraction
from ptmcad.algebra.real_roots import simplest_between
from ptmcad.errors import DimensionError
from ptmcad.exact.models.system import ParametricSystem, Terms
from ptmcad.text.expressions import Expression, Term

Pair = tuple[arb, arb]
Matrix = tuple[Pair, Pair]
BITS = 160
_MIN_STEP = Fraction(1, 2**60)
"""Steps shorter than this, against the distance to be gone, are not tried."""
_MAX_STEPS = 3000
"""Where a branch comes ever nearer to others, steps shrink with the distance and their number has no bound."""


@dataclass(frozen=True, slots=True)
class Family:
    """The mechanism on a line: its parameters as expressions in one unknown, the first axis.

    Raises
    ------
    DimensionError
        When the system does not have two angles.
    """

    system: ParametricSystem
    parameters: Mapping[str, Expression]

    def __post_init__(self) -> None:
        if len(self.system.ring.angles) != 2 or self.system.ring.reals or not self.system.has_index:
            unknowns = ", ".join(self.system.ring.unknowns)
            raise DimensionError(f"paths of equilibria: known for potentials of two angles only, not for {unknowns}")

    def at(self, low: Fraction, high: Fraction) -> Instance:
        """The equations for all parameters from low to high, with their derivatives by the parameter."""
        value = arb(from_fraction(low)).union(arb(from_fraction(high)))
        numbers = [_dual(self.parameters[name], value) for name in self.system.ring.parameters]
        gradient = [_specialised(g, numbers) for g in self.system.equation_terms]
        return Instance(
            tuple(terms for terms, _ in gradient),
            tuple(terms for _, terms in gradient),
            tuple(tuple(_specialised(h, numbers)[0] for h in row) for row in self.system.jacobian_terms),
        )


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
    """Gradient and Hessian of the potential with balls for the parameters, to be evaluated at balls of angles."""

    equation_terms: tuple[Specialised, ...]
    slope_terms: tuple[Specialised, ...]
    hessian_terms: tuple[tuple[Specialised, ...], ...]

    def gradient(self, angles: Pair) -> Pair:
        unknowns = _unknowns(angles)
        first, second = (_evaluated(g, unknowns) for g in self.equation_terms)
        return first, second

    def slope(self, angles: Pair) -> Pair:
        """The derivative of the gradient by the parameter."""
        unknowns = _unknowns(angles)
        first, second = (_evaluated(g, unknowns) for g in self.slope_terms)
        return first, second

    def hessian(self, angles: Pair) -> Matrix:
        unknowns = _unknowns(angles)
        (a, b), (c, d) = (tuple(_evaluated(h, unknowns) for h in row) for row in self.hessian_terms)
        return (a, b), (c, d)


def _unknowns(angles: Pair) -> list[arb]:
    return [f(a) for a in angles for f in (arb.cos, arb.sin)]


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
    """A box of angles that moves with the parameter x: center + velocity (x - middle) + (a box around 0).

    For every x from low to high there is one equilibrium in the box ``unique``, and it lies in the box ``tight``.
    """

    low: Fraction
    high: Fraction
    center: Pair
    velocity: Pair
    unique: Pair
    tight: Pair

    def at(self, value: Fraction) -> Pair:
        """An enclosure of the angles at one value."""
        with ctx.workprec(BITS):
            return self._moved(arb(from_fraction(value - self._middle)), self.tight)

    def hull(self) -> Pair:
        """An enclosure of the angles at all values."""
        with ctx.workprec(BITS):
            return self._moved(arb(from_fraction((self.high - self.low) / 2)) * arb(0, 1), self.tight)

    def holds(self, other: Tube, value: Fraction) -> bool:
        """Whether the other tube's equilibrium at a value lies where this one's is the only one."""
        with ctx.workprec(BITS):
            mine = self._moved(arb(from_fraction(value - self._middle)), self.unique)
            return all(a.contains(b) for a, b in zip(mine, other.at(value), strict=True))

    @property
    def _middle(self) -> Fraction:
        return (self.low + self.high) / 2

    def _moved(self, offset: arb, box: Pair) -> Pair:
        first, second = (c + v * offset + w for c, v, w in zip(self.center, self.velocity, box, strict=True))
        return first, second


def enclose(family: Family, low: Fraction, high: Fraction, guess: Pair) -> Tube | None:
    """A tube around the branch near a guess for the middle of the range; None when not proved.

    Notes
    -----
    With the tube's center c(x) and w the distance from it, Krawczyk's operator is applied to g(x, w) = f(c(x) + w, x)
    for all x at once; g(x, 0) comes from the mean value theorem in x, multiplied by the approximate inverse first.
    """
    with ctx.workprec(BITS):
        middle = family.at((low + high) / 2, (low + high) / 2)
        center = polish(middle, guess)
        inverse = _inverse(middle.hessian(center))
        if inverse is None:
            return None
        fall = _times(inverse, middle.slope(center))
        velocity = ((-fall[0]).mid(), (-fall[1]).mid())
        unit, radius = arb(0, 1), arb(from_fraction((high - low) / 2))
        along = family.at(low, high)
        swept = (center[0] + velocity[0] * radius * unit, center[1] + velocity[1] * radius * unit)
        start = _times(inverse, middle.gradient(center))
        drift = _sum(_times(inverse, along.slope(swept)), _times(_product(inverse, along.hessian(swept)), velocity))
        move = tuple(s + d * radius * unit for s, d in zip(start, drift, strict=True))
        least = arb(fmpq(1, 2 ** (BITS - 20)))
        reach = [2 * abs(m).upper() + least for m in move]
        for _ in range(8):
            (a, b), (c, d) = _product(inverse, along.hessian((swept[0] + reach[0] * unit, swept[1] + reach[1] * unit)))
            spread = (reach[0] * unit, reach[1] * unit)
            image = (
                -move[0] + (1 - a) * spread[0] - b * spread[1],
                -move[1] - c * spread[0] + (1 - d) * spread[1],
            )
            if all(abs(k) < r for k, r in zip(image, reach, strict=True)):
                return Tube(low, high, center, velocity, spread, image)
            reach = [(abs(k).upper() * 3 / 2 + least).upper() for k in image]
            if not all(r < 2 for r in reach):
                return None
        return None


def _inverse(matrix: Matrix) -> Matrix | None:
    """An approximate inverse with exact entries."""
    (a, b), (c, d) = ((x.mid(), y.mid()) for x, y in matrix)
    determinant = (a * d - b * c).mid()
    if determinant == 0:
        return None
    scale = (1 / determinant).mid()
    return ((d * scale).mid(), (-b * scale).mid()), ((-c * scale).mid(), (a * scale).mid())


def _times(matrix: Matrix, vector: Pair) -> Pair:
    (a, b), (c, d) = matrix
    return a * vector[0] + b * vector[1], c * vector[0] + d * vector[1]


def _product(first: Matrix, second: Matrix) -> Matrix:
    (a, b), (c, d) = second
    (p, q), (r, s) = _times(first, (a, c)), _times(first, (b, d))
    return (p, r), (q, s)


def _sum(first: Pair, second: Pair) -> Pair:
    return first[0] + second[0], first[1] + second[1]


def polish(at: Instance, guess: Pair) -> Pair:
    """A few steps of Newton's method, without guarantee."""
    point = (guess[0].mid(), guess[1].mid())
    for _ in range(5):
        inverse = _inverse(at.hessian(point))
        if inverse is None:
            break
        move = _times(inverse, at.gradient(point))
        if not all(abs(m) < 1 for m in move):
            break
        point = ((point[0] - move[0]).mid(), (point[1] - move[1]).mid())
    return point


@dataclass(frozen=True, slots=True)
class Reached:
    """A value of the parameter with the branch's place there; ``over`` covers the branch since the last one."""

    value: Fraction
    place: Tube
    over: Tube

    @property
    def angles(self) -> Pair:
        return self.place.at(self.value)


def at_value(family: Family, value: Fraction, guess: Pair) -> Tube | None:
    """The place of the equilibrium near a guess, at one value of the parameter."""
    return enclose(family, value, value, guess)


def follow(family: Family, start: Reached, end: Fraction, longest: Fraction) -> tuple[list[Reached], bool]:
    """Follow a branch from one value of the parameter to another, in steps no longer than ``longest``.

    Returns
    -------
    What was reached, step by step without the start, and whether the end was.
    """
    found: list[Reached] = []
    current, step = start, max(-longest, min(longest, (end - start.value) / 8))
    least = abs(end - start.value) * _MIN_STEP
    while current.value != end:
        if len(found) == _MAX_STEPS:
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
        guess = tuple(a + v * half for a, v in zip(start.angles, ahead, strict=True))
    over = enclose(family, min(start.value, value), max(start.value, value), (guess[0], guess[1]))
    if over is None or not over.holds(start.place, start.value):
        return None
    place = at_value(family, value, over.at(value))
    return Reached(value, place, over) if place is not None and over.holds(place, value) else None
