"""The sign of a rational function over the open window, proved once more: Sturm counts between
critical abscissae.

Guarantee: `Sign.PROVED` and `Sign.WRONG` are theorems. `Sign.UNCHECKED` is answered where a
function of both axes has a degree over `MAX_DEGREE`, or may be zero at an isolated point.

It shares nothing with what the engines ask (`ptmcad.question.positivity`): no Bernstein
coefficients, no halving of boxes, no isolation by Descartes' rule, another elimination. A
polynomial changes sign in the open window where one of its irreducible factors of odd multiplicity
does; and between the roots of such a factor's discriminant and of its values on two edges, the
number of its roots in a fibre, all of them simple, is that over one sample (`window`).
"""

from __future__ import annotations

from enum import Enum

from flint import fmpq, fmpq_mpoly

from ptmcad.text.expressions import Expression
from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.plane import factored, polynomial
from ptmcad.verification.window import RUNS, Interval, point_in_window

MAX_DEGREE = 30
"""The sum of the degrees in the two axes up to which a function of both is looked at."""

Window = tuple[Interval, Interval]


class Sign(Enum):
    """What is known of a function in the window."""

    PROVED = "proved"
    WRONG = "wrong"
    UNCHECKED = "not checked"


def has_no_pole(e: Expression, window: Window) -> Sign:
    """Whether the denominator, as it is stored, has no zero in the open window."""
    denominator = polynomial(e.denominator)
    return _sign(denominator * _side(denominator, window), window, strict=True)


def is_in_domain(e: Expression, window: Window, strict: bool) -> Sign:
    """Whether a function without a pole is positive, or not negative, in the open window."""
    if not e.numerator:
        return Sign.WRONG if strict else Sign.PROVED
    denominator = polynomial(e.denominator)
    return _sign(polynomial(e.numerator) * _side(denominator, window), window, strict)


def _side(p: fmpq_mpoly, window: Window) -> int:
    """The sign at the window's middle, where it has one."""
    (u0, u1), (v0, v1) = window
    return -1 if p((u0 + u1) / 2, (v0 + v1) / 2) < 0 else 1


def _sign(p: fmpq_mpoly, window: Window, strict: bool) -> Sign:
    """Whether a polynomial that is not zero is positive, or not negative, in the open window."""
    relevant = [
        PlaneCurve.of(0, f, 0) for f, multiplicity in factored(p) if strict or multiplicity % 2
    ]
    if any(min(f.degrees) > 0 and sum(f.degrees) > MAX_DEGREE for f in relevant):
        (u0, u1), (v0, v1) = window
        grid = [fmpq(k, 32) for k in range(1, 32)]
        values = (p(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t) for s in grid for t in grid)
        return Sign.WRONG if any(value < 0 for value in values) else Sign.UNCHECKED
    met = {point_in_window(f, *window, isolated=strict) for f in relevant}
    if RUNS in met or _generic_value(p, window) < 0:
        return Sign.WRONG
    return Sign.PROVED if met <= {None} else Sign.UNCHECKED


def _generic_value(p: fmpq_mpoly, window: Window) -> fmpq:
    """The value at a point where it is not zero."""
    (u0, u1), (v0, v1) = window
    for k in range(2, 200):
        for m in range(2, 200):
            value = p(u0 + (u1 - u0) / k, v0 + (v1 - v0) / m)
            if value != 0:
                return value
    raise ArithmeticError("a polynomial of low degree is zero at 39204 points of a grid")
