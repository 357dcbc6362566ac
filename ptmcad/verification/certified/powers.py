"""Powers of balls, which products of balls that have nothing to do with each other would enclose poorly.

Guarantee: every ball contains the power of each number in the ball given.
"""

from __future__ import annotations

from math import prod

from flint import arb

_ZERO, _ONE = arb(0), arb(1)


def square(x: arb) -> arb:
    """The square: no product of two balls that have nothing to do with one another."""
    return _ZERO.union(_product(x.abs_upper(), 2)) if x.contains(0) else x * x


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
