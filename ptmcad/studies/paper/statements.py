"""Statements about the mechanism as text, such as ``g1 = -L1*k*(L2*sin12 - 2*rho*s1 + F3/k*c1)``, and if they hold.

Guarantee: an equation holds when both sides agree as functions of the angles and of all parameters; ``not`` before it
says that they do not. Anything else is a comparison of numbers. What the names stand for is derived from the
description (`ptmcad.studies.paper.symbolic`), and numbers of equilibria are those of `ptmcad.solve`.

``U``, ``g1``, ``H11`` and so on are without horizontal loads and free lengths, those that end in ``_h`` with horizontal
loads; ``E1`` and ``E2`` are the gradient in half angles, divided by L1 k and L2 k; ``q0`` to ``q6`` the coefficients of
the ``sextic`` in t2 that elimination of t1 leaves; ``OTHER`` is t1 by t2 where the angles of equal rods under equal
forces differ; ``COS1`` and ``COS2`` are cosines of the triangle with sides L1, L2 and 2 rho; ``eliminated_12`` is what
remains of (11) where the angles differ.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any

import sympy as sp
import yaml

from ptmcad.answer.poses import Poses
from ptmcad.ask.solving import solve
from ptmcad.studies.paper import symbolic
from ptmcad.studies.paper.symbolic import CIRCLES, F3, F4, HORIZONTAL, L1, L2, Expr, c1, c2, l0, rho, s1, s2, t1, t2

T, e1, e2, height, scale = sp.symbols("T e1 e2 height scale")
ANGLES = (*CIRCLES[0], *CIRCLES[1])
_ALL = (*symbolic.PARAMETERS, *symbolic.LENGTHS, *ANGLES, t1, t2, T, e1, e2, height, scale)
SYMBOLS = {str(symbol): symbol for symbol in _ALL}
TEXTS: Mapping[str, Any] = yaml.safe_load(Path(__file__).with_name("expressions.yaml").read_text(encoding="utf-8"))
"""What further names stand for, in the language of statements; and the paper's equations."""


def holds(statement: str) -> bool:
    """Whether a statement does."""
    text = statement.removeprefix("not ")
    left, _, right = text.partition(" = ")
    shown = numerator(expression(left) - expression(right)) == 0 if right else expression(text)
    return bool(shown) == (text == statement)


def expression(text: str) -> Expr:
    """The value of one side of a statement."""
    return sp.sympify(text, locals=names())


@cache
def names() -> dict[str, Any]:
    """What names stand for."""
    known = SYMBOLS | FUNCTIONS
    known |= {f"{name}{axis}": x for name, at in symbolic.points().items() for axis, x in zip("xy", at, strict=True)}
    found = (symbolic.potential(), *symbolic.gradient(), *symbolic.hessian())
    derived = dict(zip(("U", "g1", "g2", "H11", "H12", "H22"), found, strict=True))
    known |= {f"{name}_l": e for name, e in derived.items()}
    for suffix, absent, plain in (("_h", (l0,), {}), ("", (l0, *HORIZONTAL), TEXTS["plain"])):
        local = {name: sp.expand(symbolic.without(e, *absent)) for name, e in derived.items()}
        for name, text in {**TEXTS["definitions"], **plain}.items():
            local[name] = sp.sympify(text, locals=known | local)
        known |= {f"{name}{suffix}": e for name, e in local.items()}
    return known


# --------------------------------------------------------------------------------- expressions in other circumstances


PLACES = {
    "unloaded": {F3: 0, F4: 0}, "symmetric": {L2: L1, F3: F4}, "same": {t1: t2}, "swapped": {t1: t2, t2: t1},
}  # fmt: skip
"""Without loads, for equal rods and forces, where both angles are the same, and with the angles exchanged."""


def placed(values: dict[Expr, Expr], e: Expr) -> Expr:
    """With other values for some symbols."""
    return sp.expand(sp.sympify(e).subs(values, simultaneous=True))


def at(e: Expr, **values: Expr) -> Expr:
    """The same, by names."""
    return sp.sympify(e).subs({SYMBOLS[name]: value for name, value in values.items()}, simultaneous=True)


def flat(e: Expr) -> Expr:
    """In the flat poses: e1 and e2 are the cosines, 1 or -1."""
    there = placed({c1: e1, c2: e2, s1: 0, s2: 0}, e)
    return sp.rem(sp.rem(there, e1**2 - 1, e1), e2**2 - 1, e2)


def triangle(e: Expr) -> Expr:
    """Without loads in the poses of the triangle with the sides L1, L2 and 2 rho; ``height`` is L1 s1 = L2 s2."""
    cosine, other = expression("COS1"), expression("COS2")
    there = placed({F3: 0, F4: 0, s1: height / L1, s2: height / L2, c1: cosine, c2: other}, e)
    return sp.factor(sp.rem(there, height**2 - L1**2 * (1 - cosine**2), height))


def squared(e: Expr) -> Expr:
    """With the squares of the springs' lengths put in."""
    for length, square in zip(symbolic.LENGTHS, symbolic.squares(), strict=True):
        e = sp.rem(e, length**2 - square, length)
    return e


def numerator(e: Expr) -> Expr:
    """Of what remains in half angles; zero exactly if an expression is, wherever c^2 + s^2 = 1 for both angles."""
    return sp.expand(sp.numer(sp.together(symbolic.half_angles(e))))


# ------------------------------------------------------------------------------------------------------------ numbers


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


def flat_stable(e1: int = 0, e2: int = 0, **values: Expr) -> int:
    """How many flat equilibria are stable; of these, with the sign of a cosine, if it is given."""
    flat = [p.cosines_sines[::2] for p in equilibria(**values).equilibria if p.stable is True and p.flat]
    return sum(a.center * int(e1) >= 0 and b.center * int(e2) >= 0 for a, b in flat)


def equal_angles(**values: Expr) -> int:
    """How many equilibria have equal angles; enclosures that meet are taken for equal."""
    pairs = (p.angles for p in equilibria(**values).equilibria)
    return sum(a.low <= b.high and b.low <= a.high for a, b in pairs)


FUNCTIONS: dict[str, Callable[..., Any]] = {
    f.__name__: f
    for f in (at, flat, triangle, squared, numerator, independent, flat_stable, equal_angles, symbolic.half_angles)
}
FUNCTIONS |= {name: partial(placed, values) for name, values in PLACES.items()} | {
    # for equal rods and forces, by t2, where the angles differ
    "unequal": lambda e: sp.factor(symbolic.half_angles(placed(PLACES["symmetric"], e)).subs(t1, expression("OTHER"))),
    "degree": lambda e, unknown: int(sp.degree(numerator(e), unknown)),
    # in all symbols unless some are named
    "terms": lambda e, *unknowns: len(sp.Poly(e, *unknowns).terms()),
    # on how many parameters expressions depend
    "parameters": lambda *all_: len(set().union(*(e.free_symbols for e in all_)) - set(ANGLES)),
    "total": lambda **values: len(equilibria(**values).equilibria),
    "stable": lambda **values: equilibria(**values).stable,
}
