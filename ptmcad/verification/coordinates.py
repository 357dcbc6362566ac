"""Polynomials over Q in the coordinates of a model's unknowns and in its parameters, and trees of
descriptions as such.

Guarantee: exact. Trees are read by a walk of its own; the coordinates of an angle are its cosine
and its sine.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from operator import add, mul, sub, truediv
from typing import Any, Generic, TypeVar

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.tree import Call, Chain, Name, Negative, Number, Power, Tree

_SHOWN = 400
Circle = tuple[fmpq_mpoly, fmpq_mpoly]
"""Cosine and sine of an angle."""
R = TypeVar("R", bound=Any)
_OPERATORS = {"+": add, "-": sub, "*": mul, "/": truediv}


def circle_names(angle: str) -> tuple[str, str]:
    """The names of an angle's coordinates, which no description has."""
    return f"cos({angle})", f"sin({angle})"


class TreeValues(Generic[R]):
    """A ring in which trees have values."""

    def constant(self, value: Fraction) -> R:
        raise NotImplementedError

    def named(self, name: str) -> R:
        raise NotImplementedError

    def circle_of(self, angle: str) -> tuple[R, R]:
        """Cosine and sine of an angle."""
        raise NotImplementedError

    def root(self, square: R, tree: Tree) -> R:
        """The value of a root, given that of its argument."""
        raise NotImplementedError("the checker knows no roots")

    def value(self, tree: Tree) -> R:
        """What a tree of the description is."""
        match tree:
            case Number(number):
                return self.constant(number)
            case Name(name):
                return self.named(name)
            case Negative(operand):
                opposite: R = -self.value(operand)
                return opposite
            case Chain(first, steps):
                total = self.value(first)
                for step in steps:
                    total = _OPERATORS[step.operator](total, self.value(step.operand))
                return total
            case Power(base, exponent):
                power: R = self.value(base) ** int(_number(multiples(exponent)))
                return power
            case Call("sqrt", argument):
                return self.root(self.value(argument), tree)
            case Call(function, argument):
                return self.circle(argument)[0 if function == "cos" else 1]

    def circle(self, argument: Tree) -> tuple[R, R]:
        """Cosine and sine of a sum of multiples of angles."""
        cosine, sine = self.constant(Fraction(1)), self.constant(Fraction(0))
        for angle, multiple in multiples(argument).items():
            if multiple.denominator != 1 or (multiple and not angle):
                raise NotImplementedError(
                    "the checker knows sums of whole multiples of angles, such as 2*a - b, only"
                )
            for _ in range(abs(int(multiple))):
                c, s = self.circle_of(angle)
                up = s if multiple > 0 else -s
                cosine, sine = cosine * c - sine * up, sine * c + cosine * up
        return cosine, sine


@dataclass(frozen=True)
class CoordinateRing(TreeValues[fmpq_mpoly]):
    """A ring of polynomials.

    Attributes
    ----------
    names : of the variables, in lexicographic order: of the angles the `circle_names`, of all else
        their own.
    angles : those of which coordinates are variables.
    numbers : of parameters in the place of variables.
    """

    names: tuple[str, ...]
    angles: tuple[str, ...]
    numbers: Mapping[str, fmpq] = field(default_factory=dict)

    @cached_property
    def context(self) -> fmpq_mpoly_ctx:
        """FLINT's ring, whose own names are plain: those of a description may be any."""
        return fmpq_mpoly_ctx.get(tuple(f"x{k}" for k in range(len(self.names))), Ordering.lex)

    @cached_property
    def elements(self) -> Mapping[str, fmpq_mpoly]:
        """What each name stands for."""
        known = {name: self.context.constant(number) for name, number in self.numbers.items()}
        return known | dict(zip(self.names, self.context.gens(), strict=True))

    @cached_property
    def circles(self) -> Mapping[str, Circle]:
        """Cosine and sine of each angle."""
        return {angle: self._circle_of(angle) for angle in self.angles}

    def _circle_of(self, angle: str) -> Circle:
        cosine, sine = (self.elements[name] for name in circle_names(angle))
        return cosine, sine

    @cached_property
    def relations(self) -> tuple[fmpq_mpoly, ...]:
        """What is zero on the circles of the angles."""
        return tuple(c * c + s * s - 1 for c, s in self.circles.values())

    def normal(self, p: fmpq_mpoly) -> fmpq_mpoly:
        """The normal form modulo the circles: at most the first power of each cosine."""
        for relation in self.relations:
            p = divmod(p, relation)[1]
        return p

    def by(self, p: fmpq_mpoly, unknown: str) -> fmpq_mpoly:
        """The derivative by an unknown, also where an angle stands outside of cosines and sines."""
        slope = self.context.constant(0)
        if unknown in self.names:
            slope += p.derivative(self.names.index(unknown))
        if unknown in self.angles:
            (c, s), (across, up) = (
                self.circles[unknown],
                map(self.names.index, circle_names(unknown)),
            )
            slope += c * p.derivative(up) - s * p.derivative(across)
        return slope

    def gradient(self, p: fmpq_mpoly, unknowns: Iterable[str]) -> tuple[fmpq_mpoly, ...]:
        """The derivatives by unknowns."""
        return tuple(self.by(p, unknown) for unknown in unknowns)

    def taken(self, p: fmpq_mpoly, ring: CoordinateRing) -> fmpq_mpoly:
        """A polynomial of another ring, of which this one has all variables that are in it."""
        nothing = self.context.constant(0)
        return p.compose(
            *(self.elements.get(name, nothing) for name in ring.names), ctx=self.context
        )

    def text(self, p: fmpq_mpoly) -> str:
        """The beginning of a polynomial's text."""
        return re.sub(r"x([0-9]+)", lambda found: self.names[int(found[1])], str(p)[:_SHOWN])[:80]

    def constant(self, value: Fraction) -> fmpq_mpoly:
        return self.context.constant(from_fraction(value))

    def named(self, name: str) -> fmpq_mpoly:
        return self.elements[name]

    def circle_of(self, angle: str) -> Circle:
        return self.circles[angle]


def multiples(tree: Tree) -> dict[str, Fraction]:
    """The angles of a sum, each with its factor; what is no multiple of an angle has the empty
    name.
    """
    match tree:
        case Number(number):
            return {"": number}
        case Name(name):
            return {name: Fraction(1)}
        case Negative(operand):
            return {name: -multiple for name, multiple in multiples(operand).items()}
        case Chain(first, steps):
            total = multiples(first)
            for step in steps:
                total = _joined(total, step.operator, multiples(step.operand))
            return total
        case Power(base, exponent):
            return {"": _number(multiples(base)) ** int(_number(multiples(exponent)))}
        case Call():
            raise NotImplementedError("the checker knows no angle that is a cosine or sine")


def _joined(
    left: dict[str, Fraction], operator: str, right: dict[str, Fraction]
) -> dict[str, Fraction]:
    if operator in "+-":
        sign = 1 if operator == "+" else -1
        return left | {
            name: left.get(name, Fraction(0)) + sign * multiple for name, multiple in right.items()
        }
    if operator == "*" and left.keys() == {""}:
        left, right = right, left
    factor = _number(right) if operator == "*" else 1 / _number(right)
    return {name: multiple * factor for name, multiple in left.items()}


def _number(multiples: dict[str, Fraction]) -> Fraction:
    if multiples.keys() != {""}:
        raise NotImplementedError("the checker knows no products of angles")
    return multiples[""]
