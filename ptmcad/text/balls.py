"""From Arb's balls to enclosures in decimals.

Guarantee: the enclosure contains the ball, has decimal ends, and settles the digits that were asked
for.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import prod

from flint import arb, ctx

from ptmcad.text.enclosure import Enclosure
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.numerals import magnitude
from ptmcad.text.tree import Tree, arithmetic, interpret

_GUARD = 6
"""Digits of the enclosure's middle beyond those asked for, at first."""
_BITS = 100
_MAX_POWER = 100
"""Larger ones are computed by logarithms."""


def enclosed(ball: arb, digits: int) -> Enclosure | None:
    """An enclosure that settles ``digits`` digits of any number in the ball; None when the ball is
    too wide.

    >>> enclosed(arb(1) / 4, 10) == Enclosure(Fraction(1, 4), Fraction(1, 4)), enclosed(arb(0, 1), 10) is None
    (True, True)
    """
    if not ball.is_finite():
        return None
    if ball.is_exact():  # no wider enclosure of a short decimal settles its digits
        return Enclosure(exact(ball), exact(ball))
    # the test of the radius below would say so too; most balls that are too wide end here
    if ball.contains(0) or 10 * ball.rel_accuracy_bits() < 33 * (digits + _GUARD - 2):
        return None
    middle, radius = exact(ball.mid()), exact(ball.rad())
    # the place of the first digit, to within one: 0.30103 is the logarithm of 2
    first = (middle.numerator.bit_length() - middle.denominator.bit_length()) * 30103 // 100000
    guard = _GUARD
    while True:
        unit = Fraction(10) ** (first - digits - guard)
        if 2 * radius > unit:
            return None
        # within half a unit of the middle's modulus, so within a unit of each number's
        center = round(middle / unit)
        found = Enclosure((center - 1) * unit, (center + 1) * unit)
        if found.settles(digits):
            return found
        guard *= 2


def bounded(ball: arb) -> Enclosure | None:
    """All of a ball; where it holds zero, up to a power of ten on either side. None of a ball that
    is not finite.

    >>> bounded(arb(0, "2e-31")) == Enclosure(-Fraction(1, 10**30), Fraction(1, 10**30))
    True
    """
    if not ball.is_finite():
        return None
    if ball.is_exact() or not ball.contains(0):
        return enclosure_of(ball)
    most = Fraction(10) ** (magnitude(exact(ball.abs_upper())) + 1)
    return Enclosure(-most, most)


def ball_of(value: Fraction) -> arb:
    """A ball that contains the number, at the context's precision."""
    return arb(from_fraction(value))


def ball_over(low: Fraction, high: Fraction) -> arb:
    """A ball that contains all numbers between two."""
    return ball_of(low).union(ball_of(high))


def enclosure_of(ball: arb) -> Enclosure:
    """All of the ball, with exact ends."""
    return Enclosure(exact(ball.lower()), exact(ball.upper()))


def exact(ball: arb) -> Fraction:
    """The number that a ball of radius zero is.

    Raises
    ------
    ValueError
        When the radius is not zero, or the ball not finite.
    """
    return to_fraction(ball.fmpq())


def in_balls(tree: Tree, known: Mapping[str, arb]) -> arb:
    """The value of an expression at the values of names; not finite where it has none."""
    with ctx.workprec(_BITS):
        found: arb = interpret(tree, arithmetic(ball_of, known, _FUNCTIONS, _power))
    return found


_FUNCTIONS = {"cos": arb.cos, "sin": arb.sin}


def _power(base: arb, exponent: arb) -> arb:
    whole = exponent.unique_fmpz()
    if whole is None or abs(whole) > _MAX_POWER:
        return base**exponent
    # python-flint's ball ** int is not a number when the ball's middle is zero
    found = prod([base] * abs(int(whole)), start=arb(1))
    return found if whole >= 0 else 1 / found
