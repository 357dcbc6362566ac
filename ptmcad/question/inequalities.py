"""Conditions on a design: inequalities between expressions in its parameters, of numbers and of
intervals.

Guarantee: exact for numbers; over intervals the bounds hold for all values in them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.errors import ExpressionError
from ptmcad.question.shipped import FIRST, SECOND
from ptmcad.text.syntax import parse, unknown_name
from ptmcad.text.tree import Call, Name, Number, Power, Step, Tree, interpret, names_of

Bounds = tuple[Fraction, Fraction]
"""An interval by its ends; of a number both are equal."""


@dataclass(frozen=True, slots=True)
class Inequality:
    """An inequality that a design satisfies: ``difference`` is at least zero.

    >>> condition = condition_of("L1 + L2 <= 3")
    >>> ends = {"L1": (Fraction(1), Fraction(2)), "L2": (Fraction(3), Fraction(3))}
    >>> condition.bounds(ends.__getitem__) == (-2, -1)
    True
    """

    text: str
    difference: tuple[Tree, Tree]

    @property
    def names(self) -> tuple[str, ...]:
        """The names in it."""
        return tuple(dict.fromkeys(name for side in self.difference for name in names_of(side)))

    def bounds(self, value: Callable[[str], Bounds]) -> Bounds:
        """Bounds of the difference where names have values in intervals.

        Raises
        ------
        ExpressionError
            For a divisor that may be zero.
        """
        (low, high), (least, most) = (
            interpret(side, _Intervals(value)) for side in self.difference
        )
        return low - most, high - least


def condition_of(text: str) -> Inequality:
    """The condition of a text such as ``a + b <= 3``.

    Raises
    ------
    ExpressionError
        For another text.
    """
    found = re.fullmatch(r"([^<>=]+)(<=|>=)([^<>=]+)", text)
    if found is None:
        raise ExpressionError(f"{text[:60]!r} is no inequality such as {FIRST} + {SECOND} <= 3")
    left, right = parse(found[1].strip()), parse(found[3].strip())
    return Inequality(" ".join(text.split()), (right, left) if found[2] == "<=" else (left, right))


@dataclass(frozen=True, slots=True)
class _Intervals:
    """Expressions in intervals with rational ends."""

    value: Callable[[str], Bounds]

    def number(self, number: Number) -> Bounds:
        return number.value, number.value

    def name(self, name: Name) -> Bounds:
        return self.value(name.name)

    def call(self, call: Call) -> Bounds:
        raise ExpressionError(f"'{call.function}' is no function here", call.position)

    def negative(self, value: Bounds) -> Bounds:
        return -value[1], -value[0]

    def joined(self, left: Bounds, step: Step, right: Bounds) -> Bounds:
        if step.operator == "+":
            return left[0] + right[0], left[1] + right[1]
        if step.operator == "-":
            return left[0] - right[1], left[1] - right[0]
        if step.operator == "/":
            if right[0] <= 0 <= right[1]:
                raise ExpressionError("a divisor may be zero within the bounds", step.position)
            right = (1 / right[1], 1 / right[0])
        products = [a * b for a in left for b in right]
        return min(products), max(products)

    def power(self, base: Bounds, power: Power, exponent: Bounds) -> Bounds:
        if exponent[0] != exponent[1] or exponent[0].denominator != 1 or not 0 <= exponent[0] <= 32:
            raise ExpressionError("an exponent here is a whole number from 0 to 32", power.position)
        n = int(exponent[0])
        ends = sorted((base[0] ** n, base[1] ** n))
        return (
            (Fraction(0), ends[1])
            if n and n % 2 == 0 and base[0] < 0 < base[1]
            else (ends[0], ends[1])
        )


def named(known: Mapping[str, Bounds], texts: Mapping[str, str]) -> Callable[[str], Bounds]:
    """The values of names: the known ones, and those that texts without circles give.

    Raises
    ------
    ExpressionError
        From the function, for another name.
    """

    def value(name: str) -> Bounds:
        if name in known:
            return known[name]
        if name not in texts:
            raise unknown_name(name, 0, (*known, *texts))
        return interpret(parse(texts[name]), _Intervals(value))

    return value
