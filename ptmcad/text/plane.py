"""A polynomial in the two axes, with integer coefficients, independent of any engine.

Guarantee: terms are sorted by exponents, coefficients are nonzero and without common factor, the
first one positive, so two polynomials that are equal up to a constant are equal objects.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd
from typing import Any

from ptmcad.text.numerals import MAX_DIGITS, integer_of, integer_text, text_of

Names = tuple[str, str]
"""Those of the two axes."""


@dataclass(frozen=True, slots=True)
class PlanePolynomial:
    """A primitive polynomial in Z[x, y]; ``terms`` holds ``(i, j, c)`` for c x^i y^j, highest
    exponents first.
    """

    terms: tuple[tuple[int, int, int], ...]

    @classmethod
    def of(cls, terms: Iterable[tuple[int, int, int]]) -> PlanePolynomial:
        """The primitive polynomial that is proportional to the given one."""
        ordered = sorted(((int(i), int(j), int(c)) for i, j, c in terms if c), reverse=True)
        content = gcd(*(c for _, _, c in ordered)) if ordered else 1
        if ordered and ordered[0][2] < 0:
            content = -content
        return cls(tuple((i, j, c // content) for i, j, c in ordered))

    def __repr__(self) -> str:
        terms = ", ".join(map(str, self.terms[:2]))
        return f"<PlanePolynomial {terms}{', …' if len(self.terms) > 2 else ''}: {len(self.terms)} terms>"

    @property
    def degrees(self) -> tuple[int, int]:
        """The degree in each axis."""
        first, second, _ = map(max, zip(*self.terms, strict=True)) if self.terms else (0, 0, 0)
        return first, second

    @property
    def total_degree(self) -> int:
        return max((i + j for i, j, _ in self.terms), default=0)

    def __call__(self, x: Fraction, y: Fraction) -> Fraction:
        """The exact value at a rational point."""
        # integers over one denominator: a fraction for each term would be reduced each time
        across, along = map(_homogeneous_powers, (x, y), self.degrees)
        total = sum(c * across[i] * along[j] for i, j, c in self.terms)
        return Fraction(total, across[0] * along[0])

    def text(self, names: Names = ("x", "y")) -> str:
        """The polynomial as text, such as ``2*x^2*y - 1``."""
        return plane_text(self.terms, names)

    def to_sympy(self, names: Names = ("x", "y")) -> Any:
        """The polynomial as a SymPy expression in symbols of these names."""
        import sympy

        x, y = (sympy.Symbol(name) for name in names)
        return sympy.Add(*(c * x**i * y**j for i, j, c in self.terms))

    @classmethod
    def parse(cls, text: str, names: Names = ("x", "y")) -> PlanePolynomial:
        """The polynomial that `text` wrote (for longer texts than the expression parser takes).

        Raises
        ------
        ValueError
            When the text was not written by `text`.
        """
        if text == "0":
            return cls(())
        terms = []
        for sign, body in re.findall(r"(^-?|[+-]) ?([^ ]+)", text):
            powers, coefficient = [0, 0], 1
            for factor in body.split("*"):
                name, _, exponent = factor.partition("^")
                if name in names:
                    powers[names.index(name)] += _natural(exponent) if exponent else 1
                else:
                    coefficient *= _natural(factor)
            terms.append((powers[0], powers[1], -coefficient if sign == "-" else coefficient))
        result = cls.of(terms)
        if result.text(names) != text:
            raise ValueError(
                f"not a primitive polynomial in {names[0]} and {names[1]}: {text[:60]}"
            )
        return result


def _homogeneous_powers(x: Fraction, degree: int) -> list[int]:
    """The numerators of 1, x, x^2, ... over the common denominator that the last one has."""
    powers = [x.denominator**degree]
    for _ in range(degree):
        powers.append(powers[-1] // x.denominator * x.numerator)
    return powers


def _natural(digits: str) -> int:
    if not (digits.isascii() and digits.isdigit()) or len(digits) > MAX_DIGITS:
        raise ValueError(f"{digits[:40]!r} is not a natural number")
    return integer_of(digits)


def signed_terms(
    terms: Iterable[tuple[Sequence[int], Any]],
    names: Sequence[str],
    power: str = "{}^{}",
    times: str = "*",
    number: Callable[[Any], str] = integer_text,
) -> Iterator[str]:
    """Each term with its sign and a blank; the first one without the blank, and without a sign that
    is positive.

    Parameters
    ----------
    terms : the exponents of the names, and the coefficient, which is not zero.
    power : format of base and exponent.
    number : the text of a positive coefficient.
    """
    for n, (exponents, c) in enumerate(terms):
        factors = [
            power.format(s, e) if e > 1 else s for s, e in zip(names, exponents, strict=True) if e
        ]
        if abs(c) != 1 or not factors:
            factors.insert(0, number(abs(c)))
        sign = ("-" if c < 0 else "") if n == 0 else ("- " if c < 0 else "+ ")
        yield sign + times.join(factors)


def terms_text(terms: Iterable[tuple[Sequence[int], Any]], names: Sequence[str]) -> str:
    """Such as ``2*x^2*y - 1``; coefficients may be fractions.

    >>> terms_text((((2, 1), 2), ((0, 0), Fraction(-1, 3))), ("x", "y"))
    '2*x^2*y - 1/3'
    """
    return " ".join(signed_terms(terms, names, number=text_of)) or "0"


def plane_text(terms: Iterable[tuple[int, int, Any]], names: Sequence[str]) -> str:
    """The same of terms ``(i, j, c)`` in two names."""
    return terms_text(((powers, c) for *powers, c in terms), names)
