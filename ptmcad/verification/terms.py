"""Polynomials in parameters and their values; powers of balls.

Guarantee: values are exact for exact numbers and functions; balls contain the value for each number
in the balls given. A power is no product of balls that have nothing to do with one another, which
would enclose it poorly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any

from flint import arb, fmpq, fmpq_mpoly

from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction, to_fraction

_ZERO, _ONE = arb(0), arb(1)


def monomials(
    p: fmpq_mpoly, names: Sequence[str] = ()
) -> Iterator[tuple[fmpq, list[tuple[str, int]]]]:
    """The coefficients of a polynomial, each with the names of what it is next to and their powers.

    Parameters
    ----------
    names : of the first variables, if they are not the ring's own.
    """
    names = names or p.context().names()
    for powers, c in p.terms():
        yield c, [(name, int(power)) for name, power in zip(names, powers, strict=False) if power]


def evaluated(p: fmpq_mpoly, values: Mapping[str, Any], names: Sequence[str] = ()) -> Any:
    """The value of a polynomial for exact numbers, functions or balls; of one without names a
    fraction, or 0.
    """
    total: Any = 0
    number = Fraction(0)  # exact: a quotient of integers would be a double
    for c, factors in monomials(p, names):
        if factors:
            term = prod(
                [_raised(values[name], exponent) for name, exponent in factors], start=int(c.p)
            )
            total = total + (term / int(c.q) if c.q != 1 else term)
        else:
            number = to_fraction(c)
    if not number:
        return total
    return total + (from_fraction(number) if isinstance(total, arb) else number)


def _raised(value: Any, exponent: int) -> Any:
    """A power: of a ball with both signs an even one is not negative."""
    if exponent == 1:
        return value
    return power(value, exponent) if isinstance(value, arb) else value**exponent


def ball(p: fmpq_mpoly, values: Mapping[str, Any]) -> arb:
    """The value of a polynomial for balls, also of one without names."""
    found = evaluated(p, values)
    return found if isinstance(found, arb) else ball_of(Fraction(found))


def ball_at(x: Sequence[arb]) -> Callable[[fmpq_mpoly], arb]:
    """The values of polynomials in so many variables, which have their monomials in common."""
    known: dict[tuple[int, ...], arb] = {}

    def value(p: fmpq_mpoly) -> arb:
        total = _ZERO
        for powers, c in p.terms():
            if powers not in known:
                known[powers] = prod(
                    (power(b, int(k)) for b, k in zip(x, powers, strict=True) if k), start=_ONE
                )
            total += known[powers] * c
        return total

    return value


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
