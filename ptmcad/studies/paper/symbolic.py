"""The mechanism's equations in SymPy, derived from its description once, for all claims, equations and folds.

Guarantee: potential, gradient and Hessian follow from the description's points, springs and loads by differentiation;
nothing of the paper enters them. The symbols are the paper's: L1, L2, rho, k, F3, F4, F3x, F4x; c1, s1, c2, s2 for
cosines and sines; t1, t2 for tangents of half angles; l1, l2, l3 for the springs' lengths and l0 for their free one.

All stiffnesses are k here and all free lengths l0.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any

import sympy as sp

from ptmcad.mechanism import ptm
from ptmcad.mechanism.evaluate import evaluate

Expr = Any
"""A SymPy expression; SymPy has no types of its own for a type checker."""

L1, L2, rho, k, l0 = sp.symbols("L1 L2 rho k l0", positive=True)
F3, F4, F3x, F4x = sp.symbols("F3 F4 F3x F4x", real=True)
c1, s1, c2, s2, t1, t2 = sp.symbols("c1 s1 c2 s2 t1 t2", real=True)
LENGTHS = sp.symbols("l1 l2 l3", positive=True)
CIRCLES = ((c1, s1), (c2, s2))
HORIZONTAL = (F3x, F4x)
HALF = {c1: (1 - t1**2) / (1 + t1**2), s1: 2 * t1 / (1 + t1**2)}
HALF |= {c2: (1 - t2**2) / (1 + t2**2), s2: 2 * t2 / (1 + t2**2)}
CLEAR = (1 + t1**2) * (1 + t2**2)

_MECHANISM = ptm()
PARAMETERS = (L1, L2, rho, k, l0, F3, F4, F3x, F4x)
_ALIASES = dict.fromkeys(_MECHANISM.stiffnesses, k) | dict.fromkeys(_MECHANISM.free_lengths, l0)
_RING: Any = SimpleNamespace(
    constant=lambda value: sp.Rational(value.numerator, value.denominator),
    parameter=({str(s): s for s in PARAMETERS} | _ALIASES).__getitem__,
    cos=lambda angle: CIRCLES[_MECHANISM.angles.index(angle)][0],
    sin=lambda angle: CIRCLES[_MECHANISM.angles.index(angle)][1],
)


@cache
def points() -> Mapping[str, tuple[Expr, Expr]]:
    """The coordinates of A1, A2, A3 and A4."""
    return {name: (evaluate(x, _RING), evaluate(y, _RING)) for name, (x, y) in _MECHANISM.points.items()}


@cache
def squares() -> tuple[Expr, ...]:
    """The squares of the springs' lengths, the sines' squares being eliminated."""
    ends = ((points()[spring.start], points()[spring.end]) for spring in _MECHANISM.springs)
    found = (sum((b - a) ** 2 for a, b in zip(*pair, strict=True)) for pair in ends)
    return tuple(sp.expand(sp.expand(q).subs({s**2: 1 - c**2 for c, s in CIRCLES})) for q in found)


@cache
def potential() -> Expr:
    """Of springs and loads, with the free length; squares of the lengths are put in."""
    total = sum(k / 2 * (square - 2 * l0 * x + l0**2) for x, square in zip(LENGTHS, squares(), strict=True))
    for load in _MECHANISM.loads:
        x, y = points()[load.point]
        total -= evaluate(load.x, _RING) * x + evaluate(load.y, _RING) * y
    return sp.expand(total)


def by_angle(expression: Expr, number: int) -> Expr:
    """The derivative by th1 or th2 of an expression in cosines, sines and the three lengths."""
    cosine, sine = CIRCLES[number - 1]
    total = sp.diff(expression, sine) * cosine - sp.diff(expression, cosine) * sine
    for length, square in zip(LENGTHS, squares(), strict=True):
        if (slope := sp.diff(expression, length)) != 0:
            total += slope * by_angle(square, number) / (2 * length)
    return sp.expand(total)


@cache
def gradient() -> tuple[Expr, Expr]:
    """dU/dth1 and dU/dth2, with the free length and horizontal loads."""
    return by_angle(potential(), 1), by_angle(potential(), 2)


@cache
def hessian() -> tuple[Expr, Expr, Expr]:
    """H(1,1), H(1,2) and H(2,2), likewise."""
    first, second = gradient()
    return by_angle(first, 1), by_angle(first, 2), by_angle(second, 2)


def half_angles(expression: Expr) -> Expr:
    """cos = (1 - t^2)/(1 + t^2) and sin = 2 t/(1 + t^2) put in, for both angles."""
    return sp.sympify(expression).subs(HALF)


def without(expression: Expr, *symbols: Expr) -> Expr:
    """An expression with some parameters zero."""
    return sp.sympify(expression).subs(dict.fromkeys(symbols, 0))
