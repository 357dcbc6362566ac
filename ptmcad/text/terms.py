"""Polynomials as text, term by term, in the notation of any language.

Guarantee: what is written stands for exactly the terms that are given, in their order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from typing import Any

from ptmcad.text.numerals import integer_text


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
    return " ".join(signed_terms(terms, names, number=_rational_text)) or "0"


def _rational_text(value: int | Fraction) -> str:
    return integer_text(value) if isinstance(value, int) else str(value)
