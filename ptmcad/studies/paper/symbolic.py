"""The mechanism's equations in SymPy, in the paper's symbols, translated from the exact model.

Guarantee: potential, gradient and Hessian are those of `ptmcad.exact.models`, with k1 = k2 = k3 = k; nothing of the
paper enters them. What is printed in the paper is in `ptmcad.studies.paper.printed`, and the two are compared as
polynomials.

The symbols: L1, L2, rho, k, F3, F4, F3x, F4x; c1, s1, c2, s2 for cosines and sines; t1, t2 for tangents of half angles.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import sympy as sp

from ptmcad.exact.models.potential import geometry_of, system_from
from ptmcad.mechanism import ptm

Expr = Any
"""A SymPy expression; SymPy has no types of its own for a type checker."""

L1, L2, rho, k = sp.symbols("L1 L2 rho k", positive=True)
F3, F4, F3x, F4x = sp.symbols("F3 F4 F3x F4x", real=True)
c1, s1, c2, s2, t1, t2 = sp.symbols("c1 s1 c2 s2 t1 t2", real=True)
L = L1
"""The common rod length of section 3.2."""

VERTICAL: Mapping[Expr, Expr] = {F3x: 0, F4x: 0}
UNLOADED: Mapping[Expr, Expr] = {F3: 0, F4: 0, **VERTICAL}
SYMMETRIC: Mapping[Expr, Expr] = {L2: L1, F3: F4, **VERTICAL}
FLAT = tuple({c1: a, s1: 0, c2: b, s2: 0} for a in (1, -1) for b in (1, -1))
"""The four flat configurations: th1, th2 each 0 or pi."""

_PARAMETERS = {"L1": L1, "L2": L2, "rho": rho, "k1": k, "k2": k, "k3": k, "F3": F3, "F4": F4, "F3x": F3x, "F4x": F4x}


def _expression(p: Any) -> Expr:
    ring = system_from(ptm()).ring
    parameters = [_PARAMETERS[name] for name in ring.parameters]
    total = sp.Integer(0)
    for powers, part in ring.split(p).items():
        for exponents, c in part.items():
            term = sp.Rational(int(c.p), int(c.q))
            for symbol, e in zip((*parameters, c1, s1, c2, s2), (*exponents, *powers), strict=True):
                term *= symbol**e
            total += term
    return total


@lru_cache(maxsize=1)
def potential() -> Expr:
    """U in c1, s1, c2, s2; Wenger & Chablat (1) with horizontal forces added."""
    return _expression(system_from(ptm()).potential)


@lru_cache(maxsize=1)
def coordinates() -> Mapping[str, tuple[Expr, Expr]]:
    """The nodes A1, A2, A3 and A4 of the model."""
    return {name: (_expression(x), _expression(y)) for name, (x, y) in geometry_of(ptm()).nodes.items()}


def by_angle(expression: Expr, number: int) -> Expr:
    """The derivative of a polynomial in cosines and sines by th1 or th2."""
    cosine, sine = ((c1, s1), (c2, s2))[number - 1]
    return sp.expand(sp.diff(expression, sine) * cosine - sp.diff(expression, cosine) * sine)


@lru_cache(maxsize=1)
def gradient() -> tuple[Expr, Expr]:
    """dU/dth1 and dU/dth2."""
    first, second = (_expression(g) for g in system_from(ptm()).equations)
    return first, second


@lru_cache(maxsize=1)
def hessian() -> tuple[Expr, Expr, Expr]:
    """H(1,1), H(1,2) and H(2,2)."""
    (a, b), (_, d) = ((_expression(h) for h in row) for row in system_from(ptm()).jacobian)
    return a, b, d


def determinant() -> Expr:
    """det H = H(1,1) H(2,2) - H(1,2)^2."""
    a, b, d = hessian()
    return sp.expand(a * d - b**2)


def half_angles(expression: Expr) -> Expr:
    """cos = (1 - t^2)/(1 + t^2) and sin = 2 t/(1 + t^2) put in, for both angles."""
    return expression.subs(
        {
            c1: (1 - t1**2) / (1 + t1**2),
            s1: 2 * t1 / (1 + t1**2),
            c2: (1 - t2**2) / (1 + t2**2),
            s2: 2 * t2 / (1 + t2**2),
        }
    )


def cleared(expression: Expr) -> Expr:
    """An expression of degree 1 in each angle, in half angles, times (1 + t1^2)(1 + t2^2)."""
    return sp.expand(sp.cancel(half_angles(expression) * (1 + t1**2) * (1 + t2**2)))


def vanishes(expression: Expr) -> bool:
    """Whether a rational function of all symbols is zero wherever c^2 + s^2 = 1 for both angles."""
    numerator = sp.numer(sp.together(half_angles(sp.sympify(expression))))
    return bool(sp.expand(numerator) == 0)


def equal(left: Expr, right: Expr) -> bool:
    """Whether two expressions agree as functions of the angles and parameters."""
    return vanishes(left - right)


@lru_cache(maxsize=1)
def half_angle_equations() -> tuple[Expr, Expr]:
    """The equilibrium equations in half angles, divided by L1 k and L2 k: the right (5), (6) with F3x, F4x."""
    first, second = gradient()
    return sp.expand(cleared(first) / (L1 * k)), sp.expand(cleared(second) / (L2 * k))


def quadratic_elimination(p: Expr, q: Expr, unknown: Expr) -> tuple[Expr, Expr, Expr]:
    """Two polynomials of degree 2 in an unknown: their resultant, and their combination a x + b of degree 1.

    Returns
    -------
    The resultant, a and b: with p = p2 x^2 + p1 x + p0 and q likewise, a = p2 q1 - q2 p1 and b = p2 q0 - q2 p0.
    """
    p0, p1, p2 = (p.coeff(unknown, e) for e in range(3))
    q0, q1, q2 = (q.coeff(unknown, e) for e in range(3))
    a, b = sp.expand(p2 * q1 - q2 * p1), sp.expand(p2 * q0 - q2 * p0)
    return sp.expand(b**2 - a * (p1 * q0 - q1 * p0)), a, b


@lru_cache(maxsize=1)
def sextic() -> tuple[Expr, ...]:
    """Coefficients, highest first, of the polynomial in t2 that elimination of t1 leaves, vertical forces, over k = 1.

    Raises
    ------
    ArithmeticError
        If the resultant does not have the factor 1 + t2^2 once.
    """
    first, second = (e.subs({**VERTICAL, k: 1}) for e in half_angle_equations())
    resultant, _, _ = quadratic_elimination(first, second, t1)
    quotient, remainder = sp.div(sp.Poly(resultant, t2), sp.Poly(1 + t2**2, t2))
    if not remainder.is_zero or sp.div(quotient, sp.Poly(1 + t2**2, t2))[1].is_zero:
        raise ArithmeticError("the resultant has not the factor 1 + t2^2 once")
    return tuple(sp.factor(c) for c in quotient.all_coeffs())
