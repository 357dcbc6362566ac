"""A polynomial in the two axes, with integer coefficients, independent of any engine.

Guarantee: terms are sorted by exponents, coefficients are nonzero and without common factor, the first one positive,
so two polynomials that are equal up to a constant are equal objects.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from math import gcd


@dataclass(frozen=True, slots=True)
class PlanePolynomial:
    """A primitive polynomial in Z[x, y]; ``terms`` holds ``(i, j, c)`` for c x^i y^j, highest exponents first."""

    terms: tuple[tuple[int, int, int], ...]

    @classmethod
    def of(cls, terms: Iterable[tuple[int, int, int]]) -> PlanePolynomial:
        """The primitive polynomial that is proportional to the given one."""
        ordered = sorted(((int(i), int(j), int(c)) for i, j, c in terms if c), reverse=True)
        content = gcd(*(c for _, _, c in ordered)) if ordered else 1
        if ordered and ordered[0][2] < 0:
            content = -content
        return cls(tuple((i, j, c // content) for i, j, c in ordered))

    @property
    def degrees(self) -> tuple[int, int]:
        """The degree in each axis."""
        return (max((i for i, _, _ in self.terms), default=0), max((j for _, j, _ in self.terms), default=0))

    @property
    def total_degree(self) -> int:
        return max((i + j for i, j, _ in self.terms), default=0)

    def __call__(self, x: Fraction, y: Fraction) -> Fraction:
        """The exact value at a rational point."""
        return sum((c * x**i * y**j for i, j, c in self.terms), Fraction(0))

    def text(self, names: tuple[str, str] = ("x", "y"), power: str = "^") -> str:
        """The polynomial as text that the expression parser reads back."""
        pieces = []
        for i, j, c in self.terms:
            factors = [f"{n}{power}{e}" if e > 1 else n for n, e in zip(names, (i, j), strict=True) if e]
            if abs(c) != 1 or not factors:
                factors.insert(0, str(abs(c)))
            pieces.append(("- " if c < 0 else "+ ") + "*".join(factors))
        return " ".join(pieces).removeprefix("+ ").replace("- ", "-", 1) if pieces and pieces[0][0] == "-" else (
            " ".join(pieces).removeprefix("+ ") or "0"
        )
