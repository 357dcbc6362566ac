"""Places about which series of a wall may be taken at an end of its stack: not analytic there, or only just beyond.

They are critical values, edges of the window over which branches meet, and poles of the curve's height a little beyond
an end, which a branch that leaves the window runs up to.

Guarantee: none is needed for the choice; a place's ball contains it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.answer.regionmap import CriticalValue
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.verification.claims import PlaneCurve, ball, bracket
from ptmcad.verification.sturm import isolating_intervals, squarefree

Abscissa = Callable[[fmpq], arb]
"""A ball around a place, at most as wide as a number."""
_ROOM_BITS = 64
"""By so many bits is a place known better than it is asked for."""
_CLOSE = 8
"""So small a part of the stack's width is a pole beyond it away."""
_TOLD_APART = (16, 64, 256, 1024)
"""Bits, beside the stack's width, at which a pole is told from the stack's end."""


class Place(NamedTuple):
    """A place at or beyond an end of a stack.

    Attributes
    ----------
    gap : what is left out of the stack beside it.
    away : by how much the rest is away from it, about.
    """

    abscissa: Abscissa
    gap: fmpq
    away: fmpq


def at_value(value: CriticalValue, margin: fmpq) -> Place:
    """A critical value that ends a stack."""
    return Place(abscissa_of(value), margin, margin)


def at_edge(curve: PlaneCurve, edge: fmpq, margin: fmpq) -> list[Place]:
    """An edge of the window, if branches meet over it or go to infinity."""
    p = curve.over(edge)
    if p.degree() == curve.degrees[1] and p.gcd(p.derivative()).degree() == 0:
        return []
    return [Place(lambda _: arb(edge), margin, margin)]


def beyond(curve: PlaneCurve, span: tuple[fmpq, fmpq], side: int) -> Iterator[Place]:
    """The pole of the curve's height next to an end of a stack, if it is close."""
    width = span[1] - span[0]
    end = span[side]
    reach = (end, end + width / _CLOSE) if side else (end - width / _CLOSE, end)
    found = _poles(curve, *reach)
    if not found:
        return
    pole = found[0 if side else -1]
    for bits in _TOLD_APART:
        low, high = bracket(pole, width / fmpq(2) ** bits)
        away = low - end if side else end - high
        if away > high - low:
            yield Place(abscissa_of(pole), fmpq(0), away)
            return


@cache
def _poles(curve: PlaneCurve, low: fmpq, high: fmpq) -> tuple[CriticalValue, ...]:
    leading = curve.in_v[-1]
    if leading.degree() < 1:
        return ()
    leading = squarefree(leading)
    coefficients = tuple(int(c) for c in leading.coeffs())
    return tuple(
        CriticalValue(coefficients, to_fraction(a), to_fraction(b), "")
        for a, b in isolating_intervals(leading, low, high)
    )


def abscissa_of(value: CriticalValue) -> Abscissa:
    """A function for a ball around a critical value, which remembers it for each power of two."""

    @cache
    def known(bits: int) -> arb:
        with ctx.workprec(max(ctx.prec, bits + _ROOM_BITS)):
            return ball(value, fmpq(2) ** -bits)

    def abscissa(width: fmpq) -> arb:
        return known(int((1 / width).ceil()).bit_length())

    return abscissa
