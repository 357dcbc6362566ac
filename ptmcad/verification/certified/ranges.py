"""Bounds of the real unknowns at given parameters, beyond which a model has no solution.

Guarantee: for all parameters in the balls no solution has a real unknown beyond its bound.

An equation is a polynomial in the unknown h. If all coefficients of its Taylor polynomial at h = R have one sign, and
the constant one is not zero, it has no zero from R on; the same for h = -R after a reflection. Coefficients are balls
over all angles and all other real unknowns as far as they are bounded; the part of a spring with a free length is at
most its pull times the slope, of either sign. The second engine evaluates by Horner's rule on unbounded intervals.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import comb

from flint import arb

from ptmcad.verification.certified.equilibria import Unproved
from ptmcad.verification.certified.field import power, size
from ptmcad.verification.certified.vectors import Terms, evaluated
from ptmcad.verification.certified.waves import Form, Key, Waves

HALF_TURN = 101 / 32
"""A little more than pi, so that a range of this half width around 0 has the whole circle."""
POWERS = range(-10, 41)
"""Powers of two that are tried as bounds."""
FINE_POWERS = (4, 10, 20, 40)
"""... and those that are tried with angles in parts, where none will do for all angles at once."""
MAX_PARTS = 400

Coefficients = dict[int, arb]
"""By the power of the unknown."""
Box = list[arb | None]
"""A ball for each unknown; None for one of which no bound is known."""
_Evaluated = list[tuple[Key, arb]]


class _Equation:
    """An equation with balls for its coefficients, and the slopes of the springs by its unknown."""

    def __init__(self, k: int, form: Form, values: Mapping[str, arb]):
        def row(waves: Waves) -> _Evaluated:
            return [(key, _value(terms, values)) for key, terms in waves.items()]

        self.smooth = row(form.equations[k])
        self.springs = [(_value(c.pull, values), row(c.slopes[k][0]), row(c.slopes[k][1])) for c in form.cones]

    def in_powers(self, k: int, box: Box) -> Coefficients | None:
        """The coefficients as a polynomial in an unknown; None where another one in them has no bound."""
        total = _coefficients(self.smooth, k, box)
        if total is None:
            return None
        for pull, right, above in self.springs:
            across, up = _coefficients(right, k, box), _coefficients(above, k, box)
            if across is None or up is None:
                return None
            for exponent in across.keys() | up.keys():
                reach = pull * size(across.get(exponent, _ZERO), up.get(exponent, _ZERO))
                total[exponent] = total.get(exponent, _ZERO) + reach * _ANY
        return total


_ZERO, _ANY = arb(0), arb(0, 1)


def _value(terms: Terms, values: Mapping[str, arb]) -> arb:
    return arb(evaluated(terms, values))


def _coefficients(row: _Evaluated, k: int, box: Box) -> Coefficients | None:
    total: Coefficients = {}
    for (turned, raised, sine), c in row:
        term, angle = c, _ZERO
        for j, x in enumerate(box):
            if j == k or not (turned[j] or raised[j]):
                continue
            if x is None:
                return None
            angle = angle + turned[j] * x
            term = term * power(x, raised[j]) if raised[j] else term
        if any(turned):
            term = term * (angle.sin() if sine else angle.cos())
        total[raised[k]] = total.get(raised[k], _ZERO) + term
    return total


def _has_no_zero_from(coefficients: Coefficients, bound: arb) -> bool:
    """Whether a polynomial has no zero from a positive number on."""
    degree = max(coefficients, default=0)
    shifted = [
        sum((c * comb(i, j) * bound ** (i - j) for i, c in coefficients.items() if i >= j), _ZERO)
        for j in range(degree + 1)
    ]
    return any(sign * shifted[0] > 0 and all(sign * c >= 0 for c in shifted[1:]) for sign in (1, -1))


def _empty(equations: list[_Equation], k: int, box: Box, bound: arb, parts: int) -> bool:
    """Whether no solution has the unknown at the bound or beyond, on either side."""
    waiting = [box]
    treated = 0
    while waiting:
        part = waiting.pop()
        treated += 1
        found = [c for c in (e.in_powers(k, part) for e in equations) if c is not None]
        mirrored = [{i: -c if i % 2 else c for i, c in coefficients.items()} for coefficients in found]
        if all(any(_has_no_zero_from(c, bound) for c in side) for side in (found, mirrored)):
            continue
        shares = {
            j: float((x.rad() / y.rad()).mid())
            for j, (x, y) in enumerate(zip(part, box, strict=True))
            if j != k and x is not None and y is not None and y.rad() > 0
        }
        widest = max(shares, key=lambda j: shares[j], default=k)
        whole = part[widest]
        if whole is None or treated + len(waiting) >= parts:
            return False
        for side in (whole.lower().union(whole.mid()), arb(whole.mid()).union(whole.upper())):
            waiting.append([side if j == widest else x for j, x in enumerate(part)])
    return True


def half_widths(form: Form, values: Mapping[str, arb]) -> tuple[float, ...]:
    """For each unknown half the width of a range around 0 that has all solutions, or a whole turn.

    Raises
    ------
    Unproved
        With the unknown, when no bound of it could be proved.
    """
    found: list[float | None] = [HALF_TURN if circle else None for circle in form.is_circle]
    equations = [_Equation(k, form, values) for k in range(form.size)] if None in found else []
    waiting = [k for k, half in enumerate(found) if half is None]
    while waiting:
        box: Box = [None if half is None else arb(0, half) for half in found]
        for k in waiting:
            bound = _bound(equations, k, box)
            if bound is not None:
                found[k] = bound
                break
        else:
            raise Unproved(f"no bound of the unknown {form.unknowns[waiting[0]]} could be proved")
        waiting.remove(k)
    return tuple(half for half in found if half is not None)


def _bound(equations: list[_Equation], k: int, box: Box) -> float | None:
    for powers, parts in ((POWERS, 1), (FINE_POWERS, MAX_PARTS)):
        for exponent in powers:
            if _empty(equations, k, box, arb(2) ** exponent, parts):
                return float(2.0**exponent)
    return None
