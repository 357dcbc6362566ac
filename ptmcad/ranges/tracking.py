"""Following an equilibrium along a line of parameters, by Krawczyk's operator in balls.

Guarantee: a box that `enclose` returns holds, for every value of the parameter in its range, exactly one equilibrium,
which is nondegenerate and depends smoothly on the parameter. Two boxes are taken to hold the same branch only where a
third box, at a value that both cover, lies inside both. So `follow` never jumps to another branch.

Reference: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations, 5.1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, ctx, fmpq

from ptmcad.algebra.polynomials import from_fraction
from ptmcad.expressions import Expression, Term
from ptmcad.models.system import ParametricSystem, Terms

Pair = tuple[arb, arb]
BITS = 160
_LEAST = Fraction(1, 2**60)
"""Steps shorter than this, against the distance to be gone, are not tried."""


@dataclass(frozen=True, slots=True)
class Family:
    """The mechanism on a line: its parameters as expressions in one unknown, the first axis."""

    system: ParametricSystem
    parameters: Mapping[str, Expression]

    def at(self, low: Fraction, high: Fraction) -> Instance:
        """The equations for all parameters from low to high."""
        value = arb(from_fraction(low)).union(arb(from_fraction(high)))
        numbers = [_value(self.parameters[name], value) for name in self.system.ring.parameters]
        return Instance(
            tuple(_specialised(g, numbers) for g in self.system.gradient_terms),
            tuple(tuple(_specialised(h, numbers) for h in row) for row in self.system.hessian_terms),
        )


Specialised = tuple[tuple[tuple[int, ...], arb], ...]


def _value(expression: Expression, x: arb) -> arb:
    def of(terms: tuple[Term, ...]) -> arb:
        total = arb(0)
        for i, _, c in terms:
            term = arb(from_fraction(c))
            for _ in range(i):
                term = term * x
            total += term
        return total

    return of(expression.numerator) / of(expression.denominator)


def _specialised(terms: Terms, numbers: list[arb]) -> Specialised:
    result = []
    for monomial, part in terms:
        total = arb(0)
        for powers, coefficient in part:
            term = arb(coefficient)
            for k, e in powers:
                for _ in range(e):
                    term = term * numbers[k]
            total += term
        result.append((monomial, total))
    return tuple(result)


@dataclass(frozen=True, slots=True)
class Instance:
    """Gradient and Hessian of the potential with balls for the parameters, to be evaluated at balls of angles."""

    gradient_terms: tuple[Specialised, ...]
    hessian_terms: tuple[tuple[Specialised, ...], ...]

    def gradient(self, angles: Pair) -> Pair:
        unknowns = _unknowns(angles)
        first, second = (_evaluated(g, unknowns) for g in self.gradient_terms)
        return first, second

    def hessian(self, angles: Pair) -> tuple[Pair, Pair]:
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
class Box:
    """For every parameter value of its range: one equilibrium in ``unique``, and it lies in ``tight``."""

    unique: Pair
    tight: Pair

    def holds(self, other: Box) -> bool:
        """Whether the other box's equilibrium is in the part where this one's is the only one."""
        return all(a.contains(b) for a, b in zip(self.unique, other.tight, strict=True))


def enclose(at: Instance, guess: Pair) -> Box | None:
    """A box around a point that holds exactly one equilibrium for every parameter value; None when not proved."""
    with ctx.workprec(BITS):
        center = (guess[0].mid(), guess[1].mid())
        inverse = _inverse(at.hessian(center))
        if inverse is None:
            return None
        move = _times(inverse, at.gradient(center))
        unit = arb(0, 1)
        reach = [2 * abs(m).upper() + arb(fmpq(1, 2 ** (BITS - 20))) for m in move]
        for _ in range(8):
            box = (center[0] + reach[0] * unit, center[1] + reach[1] * unit)
            (a, b), (c, d) = at.hessian(box)
            columns = (_times(inverse, (a, c)), _times(inverse, (b, d)))
            spread = (reach[0] * unit, reach[1] * unit)
            image = (
                -move[0] + (1 - columns[0][0]) * spread[0] - columns[1][0] * spread[1],
                -move[1] - columns[0][1] * spread[0] + (1 - columns[1][1]) * spread[1],
            )
            if all(abs(k) < r for k, r in zip(image, reach, strict=True)):
                return Box(box, (center[0] + image[0], center[1] + image[1]))
            reach = [(abs(k).upper() * 3 / 2).upper() for k in image]
            if not all(r < 2 for r in reach):
                return None
        return None


def _inverse(matrix: tuple[Pair, Pair]) -> tuple[Pair, Pair] | None:
    """An approximate inverse with exact entries."""
    (a, b), (c, d) = ((x.mid(), y.mid()) for x, y in matrix)
    determinant = (a * d - b * c).mid()
    if determinant == 0:
        return None
    scale = (1 / determinant).mid()
    return ((d * scale).mid(), (-b * scale).mid()), ((-c * scale).mid(), (a * scale).mid())


def _times(matrix: tuple[Pair, Pair], vector: Pair) -> Pair:
    (a, b), (c, d) = matrix
    return a * vector[0] + b * vector[1], c * vector[0] + d * vector[1]


def polish(at: Instance, guess: Pair) -> Pair:
    """A few steps of Newton's method, without guarantee."""
    with ctx.workprec(BITS):
        point = (guess[0].mid(), guess[1].mid())
        for _ in range(4):
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
    """A value of the parameter with the box of the branch there; ``over`` covers the branch since the last one."""

    value: Fraction
    box: Box
    over: Box


def at_value(family: Family, value: Fraction, guess: Pair) -> Box | None:
    """The box of the equilibrium near a point, at one value of the parameter."""
    at = family.at(value, value)
    return enclose(at, polish(at, guess))


def follow(family: Family, start: Reached, end: Fraction) -> tuple[list[Reached], bool]:
    """Follow a branch from one value of the parameter to another.

    Returns
    -------
    What was reached, step by step without the start, and whether the end was.
    """
    found: list[Reached] = []
    current, step = start, (end - start.value) / 16
    least = abs(end - start.value) * _LEAST
    while current.value != end:
        if abs(step) >= abs(end - current.value):
            step = end - current.value
        reached = bridge(family, current, current.value + step)
        if reached is not None:
            found.append(reached)
            current, step = reached, step * 3 / 2
        else:
            step = step / 2
            if abs(step) < least:
                return found, False
        # short numbers keep the arithmetic cheap
        step = Fraction(step.numerator * 2**80 // step.denominator, 2**80) or step
    return found, True


def bridge(family: Family, start: Reached, value: Fraction) -> Reached | None:
    """The same branch at another value, if one box proves it for all values between; else None."""
    low, high = min(start.value, value), max(start.value, value)
    middle = (low + high) / 2
    guess = polish(family.at(middle, middle), start.box.tight)
    over = enclose(family.at(low, high), guess)
    if over is None or not over.holds(start.box):
        return None
    box = at_value(family, value, over.tight)
    return Reached(value, box, over) if box is not None and over.holds(box) else None
