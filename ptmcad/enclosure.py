"""Enclosures of real numbers, and real algebraic numbers: what certified answers are made of.

Guarantee: an `Enclosure` contains the number it stands for, and each digit of its `text` is right: the text is the number
rounded to nearest. An `AlgebraicNumber` is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Enclosure:
    """A closed interval with rational ends; the number is exact when they are equal."""

    low: Fraction
    high: Fraction

    @property
    def exact(self) -> Fraction | None:
        """The number itself when it is known exactly."""
        return self.low if self.low == self.high else None

    def __float__(self) -> float:
        """The middle, rounded: for pictures, never for decisions."""
        return float((self.low + self.high) / 2)


@dataclass(frozen=True, slots=True)
class AlgebraicNumber:
    """The only real root of ``polynomial`` in [low, high].

    Attributes
    ----------
    polynomial : in Z[T], irreducible, primitive, leading coefficient positive; constant term first.
    """

    polynomial: tuple[int, ...]
    low: Fraction
    high: Fraction

    def __float__(self) -> float:
        """The middle, rounded: for pictures, never for decisions."""
        return float((self.low + self.high) / 2)
