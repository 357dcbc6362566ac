"""Formulas as lists of operations on numbered values, for the exclusion of critical curves.

Guarantee: exact; equal operations are written once, and those of rational numbers are carried out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import inf, nextafter
from typing import Any, NamedTuple

import numpy as np

CONSTANT, VARIABLE, ADD, SUBTRACT, MULTIPLY, SQUARE, DIVIDE, COSINE, SINE, DIRECTION, INVERSE_LENGTH, LENGTH = range(12)
"""Operations. DIRECTION, INVERSE_LENGTH and LENGTH of the vector (a, b): a/|(a, b)|, 1/|(a, b)| and |(a, b)|."""
MAX_VARIABLES = 6
"""Both axes, three unknowns, and the direction of a spring; even, as sums over them take two at once."""


class IntervalTape(NamedTuple):
    """Operations in their order, in arrays.

    Attributes
    ----------
    code, first, second : of each value the operation and the numbers of its operands (of a variable its own number).
    low, high : enclosures of constants.
    """

    code: Any
    first: Any
    second: Any
    low: Any
    high: Any


class Formulas:
    """A list of operations that grows; a value is the number of an operation."""

    def __init__(self) -> None:
        self._rows: list[tuple[int, int, int]] = []
        self._numbers: dict[int, Fraction] = {}
        self._known: dict[Any, int] = {}

    def number(self, value: Fraction | int) -> int:
        """A rational number."""
        key = ("number", Fraction(value))
        if key not in self._known:
            self._known[key] = len(self._rows)
            self._numbers[len(self._rows)] = Fraction(value)
            self._rows.append((CONSTANT, 0, 0))
        return self._known[key]

    def constant(self, value: int) -> Fraction | None:
        """The number that a value is; None where it is no number."""
        return self._numbers.get(value)

    def variable(self, number: int) -> int:
        """One of the variables."""
        assert number < MAX_VARIABLES
        return self._new(VARIABLE, number, number)

    def add(self, a: int, b: int) -> int:
        """a + b"""
        x, y = self.constant(a), self.constant(b)
        if x is not None and y is not None:
            return self.number(x + y)
        if x == 0 or y == 0:
            return b if x == 0 else a
        return self._new(ADD, min(a, b), max(a, b))

    def subtract(self, a: int, b: int) -> int:
        """a - b"""
        x, y = self.constant(a), self.constant(b)
        if x is not None and y is not None:
            return self.number(x - y)
        if y == 0 or a == b:
            return a if y == 0 else self.number(0)
        return self._new(SUBTRACT, a, b)

    def multiply(self, a: int, b: int) -> int:
        """a b"""
        x, y = self.constant(a), self.constant(b)
        if x is not None and y is not None:
            return self.number(x * y)
        if x == 0 or y == 0:
            return self.number(0)
        if x == 1 or y == 1:
            return b if x == 1 else a
        return self._new(SQUARE, a, a) if a == b else self._new(MULTIPLY, min(a, b), max(a, b))

    def divide(self, a: int, b: int) -> int:
        """a/b"""
        y = self.constant(b)
        return self._new(DIVIDE, a, b) if y is None else self.multiply(a, self.number(1 / y))

    def cosine(self, a: int) -> int:
        """cos a"""
        return self._new(COSINE, a, a)

    def sine(self, a: int) -> int:
        """sin a"""
        return self._new(SINE, a, a)

    def direction(self, a: int, b: int) -> tuple[int, int]:
        """The vector (a, b) divided by its length; any unit vector where it has none."""
        return self._new(DIRECTION, a, b), self._new(DIRECTION, b, a)

    def inverse_length(self, a: int, b: int) -> int:
        """1/|(a, b)|"""
        return self._new(INVERSE_LENGTH, a, b)

    def length(self, a: int, b: int) -> int:
        """|(a, b)|"""
        return self._new(LENGTH, a, b)

    def sum(self, values: Iterable[int]) -> int:
        """The sum of values."""
        total = self.number(0)
        for value in values:
            total = self.add(total, value)
        return total

    def product(self, values: Iterable[int]) -> int:
        """The product of values; powers by squares."""
        powers: dict[int, int] = {}
        for value in values:
            powers[value] = powers.get(value, 0) + 1
        total = self.number(1)
        for value, exponent in powers.items():
            total = self.multiply(total, self.power(value, exponent))
        return total

    def power(self, a: int, exponent: int) -> int:
        """A power with a whole exponent that is not negative."""
        if exponent == 0:
            return self.number(1)
        half = self.power(a, exponent // 2)
        whole = self.multiply(half, half)
        return self.multiply(whole, a) if exponent % 2 else whole

    def dot(self, a: tuple[int, int], b: tuple[int, int]) -> int:
        """The inner product of two vectors."""
        return self.add(self.multiply(a[0], b[0]), self.multiply(a[1], b[1]))

    def cross(self, a: tuple[int, int], b: tuple[int, int]) -> int:
        """a x b"""
        return self.subtract(self.multiply(a[0], b[1]), self.multiply(a[1], b[0]))

    def determinant(self, rows: Sequence[Sequence[int]]) -> int:
        """Of a square matrix, by its first row."""
        if len(rows) == 1:
            return rows[0][0]
        total = self.number(0)
        for k, entry in enumerate(rows[0]):
            part = self.multiply(entry, self.determinant([[*row[:k], *row[k + 1 :]] for row in rows[1:]]))
            total = self.subtract(total, part) if k % 2 else self.add(total, part)
        return total

    def tape(self, first: Sequence[int], wanted: Sequence[int]) -> tuple[IntervalTape, int, list[int]]:
        """The operations that some values need, those of the first of them first.

        Returns
        -------
        The operations; how many of them the first values need; and the places of all.
        """
        early = self._needed(first)
        order = [*sorted(early), *sorted(self._needed(wanted) - early)]
        place = {n: k for k, n in enumerate(order)}
        low, high, rows = [], [], []
        for n in place:
            operation, a, b = self._rows[n]
            if operation > VARIABLE:
                a, b = place[a], place[b]
            rows.append((operation, a, b))
            below, above = enclosing(self._numbers.get(n, Fraction(0)))
            low.append(below)
            high.append(above)
        code, first_of, second = (np.array([row[k] for row in rows], dtype=np.int64) for k in range(3))
        tape = IntervalTape(code, first_of, second, np.array(low), np.array(high))
        return tape, len(early), [place[n] for n in (*first, *wanted)]

    def _needed(self, wanted: Sequence[int]) -> set[int]:
        """All that some values need, and themselves."""
        needed, waiting = set[int](), list(wanted)
        while waiting:
            n = waiting.pop()
            if n not in needed:
                needed.add(n)
                code, a, b = self._rows[n]
                waiting += [] if code in (CONSTANT, VARIABLE) else [a, b]
        return needed

    def _new(self, code: int, a: int, b: int) -> int:
        key = (code, a, b)
        if key not in self._known:
            self._known[key] = len(self._rows)
            self._rows.append(key)
        return self._known[key]


def enclosing(value: Fraction) -> tuple[float, float]:
    """Floats that a rational number lies between, or is equal to; infinite ones where there are no others."""
    try:
        near = float(value)
    except OverflowError:
        return (-inf, -1e308) if value < 0 else (1e308, inf)
    if Fraction(near) == value:
        return near, near
    return nextafter(near, -inf), nextafter(near, inf)
