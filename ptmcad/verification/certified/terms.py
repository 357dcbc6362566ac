"""Polynomials in parameters, term by term, and their values; powers of balls.

Guarantee: values are exact for exact numbers and functions; balls contain the value for each number in the balls given.
A power is no product of balls that have nothing to do with one another, which would enclose it poorly.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache
from math import prod
from typing import Any

from flint import arb, fmpq_mpoly

from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction

Terms = tuple[tuple[int, int, tuple[str, ...]], ...]
"""A polynomial: numerator and denominator of each coefficient, and the parameters, with repetitions, next to it."""
_ZERO, _ONE = arb(0), arb(1)


def terms_of(p: fmpq_mpoly, names: Sequence[str] = ()) -> Terms:
    """Those of a polynomial in parameters, which are the first variables; by the ring's names, or others."""
    names = names or p.context().names()
    return tuple(
        (int(c.p), int(c.q), tuple(n for n, power in zip(names, powers, strict=False) for _ in range(int(power))))
        for powers, c in p.terms()
    )


def evaluated(terms: Terms, values: Mapping[str, Any]) -> Any:
    """The value of a polynomial for exact numbers, functions or balls; of one without names a fraction, or 0."""
    total: Any = 0
    number = Fraction(0)  # exact: a quotient of integers would be a double
    for numerator, denominator, names in terms:
        if names:
            term = prod([_raised(values[name], exponent) for name, exponent in _powers(names)], start=numerator)
            total = total + (term / denominator if denominator != 1 else term)
        else:
            number += Fraction(numerator, denominator)
    if not number:
        return total
    return total + (from_fraction(number) if isinstance(total, arb) else number)


@cache
def _powers(names: tuple[str, ...]) -> tuple[tuple[str, int], ...]:
    return tuple(Counter(names).items())


def _raised(value: Any, exponent: int) -> Any:
    """A power: of a ball with both signs an even one is not negative."""
    if exponent == 1:
        return value
    return power(value, exponent) if isinstance(value, arb) else value**exponent


def ball(terms: Terms, values: Mapping[str, Any]) -> arb:
    """The value of a polynomial for balls, also of one without names."""
    found = evaluated(terms, values)
    return found if isinstance(found, arb) else ball_of(Fraction(found))


def square(x: arb) -> arb:
    """The square."""
    if x > 0 or x < 0:
        return x * x
    most = x.abs_upper()
    return _ZERO.union(most * most)


def power(x: arb, exponent: int) -> arb:
    """A power; an even one of a ball with both signs is not negative."""
    if exponent == 0:
        return _ONE
    if exponent % 2 == 0 and x.contains(0):
        return _ZERO.union(_product(x.abs_upper(), exponent))
    if x.rad() == 0:
        return _product(x, exponent)
    return _product(x.lower(), exponent).union(_product(x.upper(), exponent))


def _product(x: arb, exponent: int) -> arb:
    """Not by the operator, which has no answer for balls around 0."""
    return prod([x] * exponent, start=_ONE)
