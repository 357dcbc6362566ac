"""The potential of a mechanism, derived here once more from its description: points, springs and loads.

Guarantee: nothing is taken from what the engines derive; the description's trees are read here by a walk of its own, in
whatever numbers or polynomials the caller has for parameters, cosines and sines. Springs have no free length, unless
their lengths are asked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from typing import Any

from flint import fmpq

from ptmcad.mechanism import Kind, Mechanism, ptm
from ptmcad.text.tree import Call, Chain, Name, Negative, Number, Power, Tree

MECHANISM = ptm()
PARAMETERS = MECHANISM.without_free_lengths
ANGLES = MECHANISM.angles
UNKNOWNS = tuple(f"{function}_{angle}" for angle in ANGLES for function in ("cos", "sin"))
"""As the exact engine names them."""
POSITIVE = MECHANISM.positive
NOT_NEGATIVE = MECHANISM.nonnegative
SHORTHANDS = tuple(name for name in MECHANISM.shorthands if MECHANISM.kind(name) is not Kind.FREE_LENGTH)
"""That a slice may name beside what they stand for."""


@dataclass(frozen=True, slots=True)
class Configuration:
    """Values of parameters, and cosine and sine of each angle, in numbers that can be added and multiplied together."""

    parameters: Mapping[str, Any]
    circles: Mapping[str, tuple[Any, Any]]

    def value(self, tree: Tree) -> Any:
        """The value of a tree of the description."""
        match tree:
            case Number(number):
                return fmpq(number.numerator, number.denominator)
            case Name(name):
                return self.parameters[name]
            case Negative(operand):
                return -self.value(operand)
            case Chain(first, steps):
                total = self.value(first)
                for step in steps:
                    one = self.value(step.operand)
                    match step.operator:
                        case "+":
                            total = total + one
                        case "-":
                            total = total - one
                        case "*":
                            total = total * one
                        case _:
                            total = total * (1 / one)
                return total
            case Power(base, exponent):
                number = self.value(base)
                return prod([number] * int(self.value(exponent)), start=fmpq(1))
            case Call(function, argument):
                return self.circle(argument)[0 if function == "cos" else 1]

    def circle(self, argument: Tree) -> tuple[Any, Any]:
        """Cosine and sine of a sum of multiples of angles."""
        if isinstance(argument, Name):
            return self.circles[argument.name]
        cosine, sine = fmpq(1), fmpq(0)
        for angle, multiple in _multiples(argument, 1):
            c, s = self.circles[angle]
            for _ in range(abs(multiple)):
                turned = s if multiple > 0 else -s
                cosine, sine = cosine * c - sine * turned, sine * c + cosine * turned
        return cosine, sine

    def points(self, mechanism: Mechanism = MECHANISM) -> dict[str, tuple[Any, Any]]:
        """The coordinates of all points."""
        return {name: (self.value(x), self.value(y)) for name, (x, y) in mechanism.points.items()}


def potential(configuration: Configuration, mechanism: Mechanism = MECHANISM) -> Any:
    """Half the stiffness times the squared length of each spring, without free lengths, less the work of the loads."""
    points = configuration.points(mechanism)
    energy = work(configuration, points, mechanism)
    for spring in mechanism.springs:
        across, up = (points[spring.end][i] - points[spring.start][i] for i in (0, 1))
        energy = energy + (across * across + up * up) * (configuration.value(spring.stiffness) * fmpq(1, 2))
    return energy


def work(configuration: Configuration, points: Mapping[str, tuple[Any, Any]], mechanism: Mechanism = MECHANISM) -> Any:
    """What the loads contribute to the potential."""
    energy: Any = fmpq(0)
    for load in mechanism.loads:
        for force, coordinate in zip((load.x, load.y), points[load.point], strict=True):
            energy = energy - coordinate * configuration.value(force)
    return energy


def _multiples(tree: Tree, times: int) -> Iterator[tuple[str, int]]:
    """The angles of a sum, each with its factor."""
    match tree:
        case Name(name):
            yield name, times
        case Negative(operand):
            yield from _multiples(operand, -times)
        case Chain(first, steps) if tree.is_sum:
            yield from _multiples(first, times)
            for step in steps:
                yield from _multiples(step.operand, times if step.operator == "+" else -times)
        case Chain(Number(number), (step,)) if step.operator == "*" and number.denominator == 1:
            yield from _multiples(step.operand, times * int(number))
        case _:
            raise NotImplementedError("the checker knows sums of multiples of angles, such as 2*a - b, only")


def rational(value: Fraction) -> fmpq:
    """A Python fraction as a FLINT rational."""
    return fmpq(value.numerator, value.denominator)
