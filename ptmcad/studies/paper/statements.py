"""Statements about the mechanism as text, such as ``g1 = -L1*k*(L2*sin12 - 2*rho*s1 + F3/k*c1)``, and if they hold.

Guarantee: an equation holds when both sides agree as functions of the angles and of all parameters; ``not`` before it
says that they do not. Anything else is a comparison of numbers. What the names stand for is derived from the
description (`ptmcad.studies.paper.symbolic`), and numbers of equilibria are those of `ptmcad.solve`.

``U``, ``g1``, ``H11`` and so on are without horizontal loads and free lengths, those that end in ``_h`` with horizontal
loads; ``E1`` and ``E2`` are the gradient in half angles, divided by L1 k and L2 k; ``q0`` to ``q6`` the coefficients of
the ``sextic`` in t2 that elimination of t1 leaves; ``OTHER`` is t1 by t2 where the angles of equal rods under equal
forces differ; ``COS1`` and ``COS2`` are cosines of the triangle with sides L1, L2 and 2 rho.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import sympy as sp

from ptmcad.answer.poses import Poses
from ptmcad.ask.solving import solve
from ptmcad.studies.paper import symbolic
from ptmcad.studies.paper.symbolic import CIRCLES, F3, F4, HORIZONTAL, L1, L2, Expr, c1, c2, k, l0, rho, s1, s2, t1, t2

OTHER = -(F4 * t2 + 2 * k * rho) / (F4 - 2 * k * rho * t2)
COS1 = (4 * rho**2 + L1**2 - L2**2) / (4 * rho * L1)
COS2 = (4 * rho**2 + L2**2 - L1**2) / (4 * rho * L2)
T, e1, e2, height, scale = sp.symbols("T e1 e2 height scale")
SQUARED_HEIGHT = L1**2 * (1 - COS1**2)


def holds(statement: str) -> bool:
    """Whether a statement does."""
    text = statement.removeprefix("not ")
    left, _, right = text.partition(" = ")
    shown = symbolic.vanishes(expression(left) - expression(right)) if right else bool(expression(text))
    return shown if text == statement else not shown


def expression(text: str) -> Expr:
    """The value of one side of a statement."""
    return sp.sympify(text, locals=names())


@cache
def names() -> dict[str, Any]:
    """What names stand for."""
    known = {str(s): s for s in (*symbolic._PARAMETERS.values(), *symbolic.LENGTHS, *sum(CIRCLES, ()), t1, t2)}
    known |= {str(s): s for s in (T, e1, e2, height, scale)}
    for name, (x, y) in symbolic.points().items():
        known |= {f"{name}x": x, f"{name}y": y}
    h11, h12, h22 = symbolic.hessian()
    derived = dict(zip(("U", "g1", "g2", "H11", "H12", "H22"), (
        symbolic.potential(), *symbolic.gradient(), h11, h12, h22), strict=True))  # fmt: skip
    known |= {f"{name}_l": e for name, e in derived.items()}
    derived = {name: symbolic.without(e, l0) for name, e in derived.items()}
    derived["detH"] = sp.expand(derived["H11"] * derived["H22"] - derived["H12"] ** 2)
    derived |= dict(zip(("E1", "E2"), symbolic.half_angle_equations(), strict=True))
    for name, e in derived.items():
        known |= {name: sp.expand(symbolic.without(e, *HORIZONTAL)), f"{name}_h": e}
    for suffix in ("", "_h"):
        pair = [sp.expand(known[f"{name}{suffix}"].subs(k, 1)) for name in ("E1", "E2")]
        found, a, b = symbolic.quadratic_elimination(pair)
        known |= {
            f"resultant{suffix}": found,
            f"sextic{suffix}": symbolic.divided(found),
            f"a{suffix}": a,
            f"b{suffix}": b,
        }
    known |= {f"q{n}": sp.factor(known["sextic"].coeff(t2, n)) for n in range(7)}
    known |= {"sin12": s1 * c2 + c1 * s2, "cos12": c1 * c2 - s1 * s2, "OTHER": OTHER, "COS1": COS1, "COS2": COS2}
    return known | {f.__name__: f for f in _FUNCTIONS}


# --------------------------------------------------------------------------------- expressions in other circumstances


def at(e: Expr, **values: Expr) -> Expr:
    """With other values for some symbols."""
    return sp.sympify(e).subs({names()[name]: value for name, value in values.items()}, simultaneous=True)


def unloaded(e: Expr) -> Expr:
    return symbolic.without(e, F3, F4)


def symmetric(e: Expr) -> Expr:
    """For equal rods and forces."""
    return sp.expand(e.subs({L2: L1, F3: F4}))


def flat(e: Expr) -> Expr:
    """In the flat poses: e1 and e2 are the cosines, 1 or -1."""
    return reduced(e.subs({c1: e1, c2: e2, s1: 0, s2: 0}))


def reduced(e: Expr) -> Expr:
    """With e1^2 = e2^2 = 1."""
    powers = sp.Poly(e, e1, e2).terms()
    return sp.Add(*(c * e1 ** (i % 2) * e2 ** (j % 2) for (i, j), c in powers))


def triangle(e: Expr) -> Expr:
    """Without loads in the poses of the triangle with the sides L1, L2 and 2 rho; ``height`` is L1 s1 = L2 s2."""
    there = sp.expand(unloaded(e).subs({s1: height / L1, s2: height / L2, c1: COS1, c2: COS2}))
    powers = sp.Poly(there, height).terms()
    return sp.factor(sp.Add(*(c * SQUARED_HEIGHT ** (n // 2) * height ** (n % 2) for (n,), c in powers)))


def squared(e: Expr) -> Expr:
    """With the squares of the springs' lengths put in."""
    for length, square in zip(symbolic.LENGTHS, symbolic.squares(), strict=True):
        powers = sp.Poly(e, length).as_dict()
        e = sp.Add(*(c * (square if n == 2 else length**n) for (n,), c in powers.items()))
    return e


def same(e: Expr) -> Expr:
    """Where both angles are the same."""
    return sp.sympify(e).subs(t1, t2)


def swapped(e: Expr) -> Expr:
    """With the angles exchanged."""
    return e.subs({t1: t2, t2: t1}, simultaneous=True)


def numerator(e: Expr) -> Expr:
    return sp.expand(sp.numer(sp.together(symbolic.half_angles(e))))


def unequal(e: Expr) -> Expr:
    """For equal rods and forces, by t2, where the angles differ."""
    return sp.factor(sp.cancel(sp.together(symbolic.half_angles(symmetric(e)).subs(t1, OTHER))))


def eliminated_12() -> Expr:
    """The numerator that remains of (11) where the angles differ."""
    return sp.expand(symbolic.divided(numerator(symmetric(names()["E2"] * k).subs(t1, OTHER))))


# ------------------------------------------------------------------------------------------------------------ numbers


def degree(e: Expr, unknown: Expr) -> int:
    return int(sp.Poly(numerator(e), unknown).degree())


def real_roots(e: Expr) -> int:
    return int(sp.Poly(e, t2).count_roots())


def positive(e: Expr) -> bool:
    """Whether a rational function of T is positive on the open interval (0, 1): by Sturm's count of roots and poles."""
    parts = [sp.Poly(p, T) for p in sp.fraction(sp.cancel(e))]
    inner = [p.count_roots(0, 1) - sum(p.eval(end) == 0 for end in (0, 1)) for p in parts]
    return inner == [0, 0] and bool(e.subs(T, sp.Rational(1, 2)) > 0)


def terms(e: Expr, *unknowns: Expr) -> int:
    """How many terms a polynomial has."""
    return len(sp.Poly(e, *unknowns).terms()) if unknowns else len(sp.expand(e).args)


def parameters(*expressions: Expr) -> int:
    """On how many parameters expressions depend."""
    return len(set().union(*(e.free_symbols for e in expressions)) - {*sum(CIRCLES, ())})


def independent() -> int:
    """How many numbers the nodes' positions depend on: the rank of their derivatives at a pose, which is the most."""
    places = [x for place in symbolic.points().values() for x in place]
    derivatives = [[sp.diff(x, rho), symbolic.by_angle(x, 1), symbolic.by_angle(x, 2)] for x in places]
    pose = {L1: 1, L2: 2, t1: sp.Rational(1, 2), t2: sp.Rational(1, 3)}
    return int(symbolic.half_angles(sp.Matrix(derivatives)).subs(pose).rank())


@cache
def equilibria(**values: Expr) -> Poses:
    """By `ptmcad.solve`; what is not given is L1 = L2 = rho = 1, k = 100 and no load."""
    at: dict[str, Any] = {name: str(value) for name, value in values.items()}
    return solve(**at)


def total(**values: Expr) -> int:
    return len(equilibria(**values).equilibria)


def stable(**values: Expr) -> int:
    return equilibria(**values).stable


def flat_stable(**values: Expr) -> int:
    return sum(p.stable is True and p.flat for p in equilibria(**values).equilibria)


def equal_angles(**values: Expr) -> int:
    """How many equilibria have equal angles; enclosures that meet are taken for equal."""
    pairs = (p.angles for p in equilibria(**values).equilibria)
    return sum(a.low <= b.high and b.low <= a.high for a, b in pairs)


_FUNCTIONS: tuple[Callable[..., Any], ...] = (
    at, unloaded, symmetric, flat, triangle, squared, same, swapped, unequal, eliminated_12, numerator, degree,
    real_roots, positive, terms, parameters, independent, total, stable, flat_stable, equal_angles, sp.diff, sp.factor,
)  # fmt: skip
