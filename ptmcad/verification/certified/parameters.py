"""The mechanism's parameters at a point of the window, exactly, or over a box of it, in balls.

Guarantee: bars and stiffnesses are positive, base and free lengths are not negative, for everything that is returned.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from flint import arb, fmpq

from ptmcad.expressions import Expression
from ptmcad.slice import FREE_LENGTHS, Slice
from ptmcad.verification.certified.energy import NAMES, Energy
from ptmcad.verification.certified.equilibria import Unproved
from ptmcad.verification.claims import Claims
from ptmcad.verification.report import Violation

POSITIVE = ("L1", "L2", "k1", "k2", "k3")
NOT_NEGATIVE = ("rho", *FREE_LENGTHS)
Values = dict[str, Fraction]


def exact(value: Fraction) -> arb:
    """The ball of a rational number, as narrow as the precision allows."""
    return arb(fmpq(value.numerator, value.denominator))


def values_at(claims: Claims, x: Fraction, y: Fraction) -> Values:
    """Every parameter at a point.

    Raises
    ------
    Violation
        When one has a pole there, or is outside its domain.
    """
    values = {name: Fraction(0) for name in FREE_LENGTHS} | claims.parameters_at(x, y)
    for name in POSITIVE:
        if values[name] <= 0:
            raise Violation(f"{name} is {float(values[name]):g}, not positive")
    for name in NOT_NEGATIVE:
        if values[name] < 0:
            raise Violation(f"{name} is negative")
    return values


def energy_at(values: Mapping[str, Fraction]) -> Energy:
    """The energy at exact parameters."""
    return Energy(
        {name: exact(values[name]) for name in NAMES}, values["rho"] == values["L2"], values["rho"] == values["L1"]
    )


def energy_over(slice: Slice, x: arb, y: arb) -> Energy:
    """The energy for all parameters over a box of the window.

    Raises
    ------
    Unproved
        When a parameter may have a pole there, or be outside its domain.
    """
    values = {name: arb(0) for name in FREE_LENGTHS}
    for name, expression in slice.parameters.items():
        values[name] = _over(expression, x, y)
        if name in POSITIVE and not values[name] > 0:
            raise Unproved(f"{name} may be zero")
        if name in NOT_NEGATIVE and not (values[name] >= 0):
            raise Unproved(f"{name} may be negative")
    return Energy({name: values[name] for name in NAMES})


def _over(expression: Expression, x: arb, y: arb) -> arb:
    below = _sum(expression.denominator, x, y)
    if below.contains(0):
        raise Unproved("a parameter may have a pole")
    return _sum(expression.numerator, x, y) / below


def _sum(terms: Sequence[tuple[int, int, Fraction]], x: arb, y: arb) -> arb:
    return sum((exact(c) * x**i * y**j for i, j, c in terms), arb(0))
