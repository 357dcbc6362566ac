"""Formulas as lists of operations on numbered values, which are evaluated in balls or by compiled
code.

Guarantee: exact; equal operations are written once, and those of rational numbers are carried out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import fmpq_mpoly

from ptmcad.text.flint_numbers import to_fraction
from ptmcad.verification.coordinates import monomials

(
    CONSTANT,
    VARIABLE,
    ADD,
    SUBTRACT,
    MULTIPLY,
    SQUARE,
    DIVIDE,
    COSINE,
    SINE,
    DIRECTION,
    INVERSE_LENGTH,
    LENGTH,
    POWER,
) = range(13)
"""Operations. DIRECTION, INVERSE_LENGTH and LENGTH of the vector (a, b): a/|(a, b)|, 1/|(a, b)| and
|(a, b)|; POWER of a value, with a whole exponent.
"""
MAX_VARIABLES = 6
"""Both axes, three unknowns, and the direction of a spring; even, as sums over them take two at
once. Parameters that are variables come after them."""


class Formulas:
    """A list of operations that grows; a value is the number of an operation.

    Attributes
    ----------
    rows : of each value the operation and the numbers of its operands; of a variable its own
        number.
    numbers : those that are rational.

    Parameters
    ----------
    with_powers : whether a power is one operation. As a product of balls that have nothing to do
        with one another it would be enclosed poorly; compiled code has products alone.
    """

    def __init__(self, *, with_powers: bool = False) -> None:
        self._with_powers = with_powers
        self.rows: list[tuple[int, int, int]] = []
        self.numbers: dict[int, Fraction] = {}
        self._known: dict[Any, int] = {}

    def number(self, value: Fraction | int) -> int:
        """A rational number."""
        key = ("number", Fraction(value))
        if key not in self._known:
            self._known[key] = len(self.rows)
            self.numbers[len(self.rows)] = Fraction(value)
            self.rows.append((CONSTANT, 0, 0))
        return self._known[key]

    def constant(self, value: int) -> Fraction | None:
        """The number that a value is; None where it is no number."""
        return self.numbers.get(value)

    def variable(self, number: int) -> int:
        """One of the variables."""
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

    def polynomial(self, p: fmpq_mpoly, values: Mapping[str, int]) -> int:
        """The value of a polynomial, with values of its variables."""
        return self.sum(
            self.multiply(
                self.number(to_fraction(c)),
                self.product(values[name] for name, power in names for _ in range(power)),
            )
            for c, names in monomials(p)
        )

    def power(self, a: int, exponent: int) -> int:
        """A power with a whole exponent that is not negative."""
        if exponent == 0:
            return self.number(1)
        if self._with_powers and exponent > 1 and self.constant(a) is None:
            return self._new(POWER, a, self.number(exponent))
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
            part = self.multiply(
                entry, self.determinant([[*row[:k], *row[k + 1 :]] for row in rows[1:]])
            )
            total = self.subtract(total, part) if k % 2 else self.add(total, part)
        return total

    def needed(self, wanted: Sequence[int]) -> set[int]:
        """All that some values need, and themselves."""
        needed, waiting = set[int](), list(wanted)
        while waiting:
            n = waiting.pop()
            if n not in needed:
                needed.add(n)
                code, a, b = self.rows[n]
                waiting += [] if code in (CONSTANT, VARIABLE) else [a, b]
        return needed

    def _new(self, code: int, a: int, b: int) -> int:
        key = (code, a, b)
        if key not in self._known:
            self._known[key] = len(self.rows)
            self.rows.append(key)
        return self._known[key]
