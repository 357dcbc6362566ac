"""Statements about the mechanism as text, such as ``g1 = -L1*k*(L2*sin12 - 2*rho*s1 + F3/k*c1)``,
and if they hold.

Guarantee: potential, gradient and Hessian follow from the description's points, springs and loads
by differentiation; nothing of the paper enters them. An equation holds when both sides agree as
functions of the angles and of all parameters; ``not`` before it says that they do not. Anything
else is a comparison of numbers. Numbers of equilibria are those of `ptmcad.solve`.

The symbols are the paper's: L1, L2, rho, k, F3, F4, F3x, F4x; c1, s1, c2, s2 for cosines and sines;
t1, t2 for tangents of half angles; l1, l2, l3 for the springs' lengths and l0 for their free one.
All stiffnesses are k here and all free lengths l0.

``U``, ``g1``, ``H11`` and so on are without horizontal loads and free lengths, those that end in
``_h`` with horizontal loads; ``E1`` and ``E2`` are the gradient in half angles, divided by L1 k and
L2 k; ``q0`` to ``q6`` the coefficients of the ``sextic`` in t2 that elimination of t1 leaves;
``OTHER`` is t1 by t2 where the angles of equal rods under equal forces differ; ``COS1`` and
``COS2`` are cosines of the triangle with sides L1, L2 and 2 rho; ``eliminated_12`` is what remains
of (11) where the angles differ.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial
from types import SimpleNamespace
from typing import Any

import sympy as sp

from ptmcad.answer.poses import Poses
from ptmcad.ask.solving import solve
from ptmcad.model import ptm
from ptmcad.model.evaluate import Named, evaluate
from ptmcad.studies.byhand import on_circle
from ptmcad.studies.texts import texts_beside

Expr = Any
"""A SymPy expression; SymPy has no types of its own for a type checker."""

L1, L2, rho, k, l0 = sp.symbols("L1 L2 rho k l0", positive=True)
F3, F4, F3x, F4x = sp.symbols("F3 F4 F3x F4x", real=True)
c1, s1, c2, s2, t1, t2 = sp.symbols("c1 s1 c2 s2 t1 t2", real=True)
LENGTHS = sp.symbols("l1 l2 l3", positive=True)
CIRCLES = ((c1, s1), (c2, s2))
HORIZONTAL = (F3x, F4x)
HALF = dict(zip((c1, s1, c2, s2), (*on_circle(t1), *on_circle(t2)), strict=True))
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
T, e1, e2, height, scale = sp.symbols("T e1 e2 height scale")
ANGLES = (*CIRCLES[0], *CIRCLES[1])
_ALL = (*PARAMETERS, *LENGTHS, *ANGLES, t1, t2, T, e1, e2, height, scale)
SYMBOLS = {str(symbol): symbol for symbol in _ALL}
TEXTS = texts_beside(__file__, "expressions.yaml")
"""What further names stand for, in the language of statements; and the paper's equations."""


@cache
def points() -> Mapping[str, tuple[Expr, Expr]]:
    """The coordinates of A1, A2, A3 and A4."""
    return {
        name: (evaluate(x, _RING), evaluate(y, _RING)) for name, (x, y) in _MECHANISM.points.items()
    }


@cache
def squares() -> tuple[Expr, ...]:
    """The squares of the springs' lengths, the sines' squares being eliminated."""
    ends = ((points()[start], points()[end]) for start, end in _MECHANISM.spring_ends)
    found = (sum((b - a) ** 2 for a, b in zip(*pair, strict=True)) for pair in ends)
    return tuple(sp.expand(sp.expand(q).subs({s**2: 1 - c**2 for c, s in CIRCLES})) for q in found)


@cache
def potential() -> Expr:
    """Of springs and loads, with the free length; squares of the lengths are put in."""
    total = sum(
        k / 2 * (square - 2 * l0 * x + l0**2) for x, square in zip(LENGTHS, squares(), strict=True)
    )
    placed = Named(_RING, _MECHANISM.coordinates)
    for element in _MECHANISM.elements.values():
        if element.root is None:  # those that have one are the springs
            total += sum(evaluate(tree, placed) for tree in element.energies)
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


# ----------------------------------------------------------------------------------------------------------- statements


@cache
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
    known |= {
        f"{name}{axis}": x
        for name, at in points().items()
        for axis, x in zip("xy", at, strict=True)
    }
    found = (potential(), *gradient(), *hessian())
    derived = dict(zip(("U", "g1", "g2", "H11", "H12", "H22"), found, strict=True))
    known |= {f"{name}_l": e for name, e in derived.items()}
    for suffix, absent, plain in (("_h", (l0,), {}), ("", (l0, *HORIZONTAL), TEXTS["plain"])):
        local = {name: placed(dict.fromkeys(absent, 0), e) for name, e in derived.items()}
        for name, text in {**TEXTS["definitions"], **plain}.items():
            local[name] = sp.sympify(text, locals=known | local)
        known |= {f"{name}{suffix}": e for name, e in local.items()}
    return known


# --------------------------------------------------------------------------------- expressions in other circumstances


PLACES = {
    "unloaded": {F3: 0, F4: 0}, "symmetric": {L2: L1, F3: F4}, "same": {t1: t2}, "swapped": {t1: t2, t2: t1},
}  # fmt: skip
"""Without loads, for equal rods and forces, where both angles are the same, and with the angles
exchanged.
"""


def placed(values: dict[Expr, Expr], e: Expr) -> Expr:
    """With other values for some symbols."""
    return sp.expand(sp.sympify(e).subs(values, simultaneous=True))


def at(e: Expr, **values: Expr) -> Expr:
    """The same, by names."""
    return sp.sympify(e).subs(
        {SYMBOLS[name]: value for name, value in values.items()}, simultaneous=True
    )


def flat(e: Expr) -> Expr:
    """In the flat poses: e1 and e2 are the cosines, 1 or -1."""
    there = placed({c1: e1, c2: e2, s1: 0, s2: 0}, e)
    return sp.rem(sp.rem(there, e1**2 - 1, e1), e2**2 - 1, e2)


def triangle(e: Expr) -> Expr:
    """Without loads in the poses of the triangle with the sides L1, L2 and 2 rho; ``height`` is L1
    s1 = L2 s2.
    """
    cosine, other = expression("COS1"), expression("COS2")
    there = placed({F3: 0, F4: 0, s1: height / L1, s2: height / L2, c1: cosine, c2: other}, e)
    return sp.factor(sp.rem(there, height**2 - L1**2 * (1 - cosine**2), height))


def squared(e: Expr) -> Expr:
    """With the squares of the springs' lengths put in."""
    for length, square in zip(LENGTHS, squares(), strict=True):
        e = sp.rem(e, length**2 - square, length)
    return e


def numerator(e: Expr) -> Expr:
    """Of what remains in half angles; zero exactly if an expression is, wherever c^2 + s^2 = 1 for
    both angles.
    """
    return sp.expand(sp.numer(sp.together(half_angles(e))))


# ------------------------------------------------------------------------------------------------------------ numbers


def independent() -> int:
    """How many numbers the nodes' positions depend on: the rank of their derivatives at a pose,
    which is the most.
    """
    places = [x for place in points().values() for x in place]
    derivatives = [[sp.diff(x, rho), by_angle(x, 1), by_angle(x, 2)] for x in places]
    pose = {L1: 1, L2: 2, t1: sp.Rational(1, 2), t2: sp.Rational(1, 3)}
    return int(half_angles(sp.Matrix(derivatives)).subs(pose).rank())


@cache
def equilibria(**values: Expr) -> Poses:
    """By `ptmcad.solve`; what is not given is L1 = L2 = rho = 1, k = 100 and no load."""
    at: dict[str, Any] = {name: str(value) for name, value in values.items()}
    return solve(**at)


def flat_stable(e1: int = 0, e2: int = 0, **values: Expr) -> int:
    """How many flat equilibria are stable; of these, with the sign of a cosine, if it is given."""
    flat = [
        p.cosines_sines[::2] for p in equilibria(**values).equilibria if p.stable is True and p.flat
    ]
    return sum(a.center * int(e1) >= 0 and b.center * int(e2) >= 0 for a, b in flat)


def equal_angles(**values: Expr) -> int:
    """How many equilibria have equal angles; enclosures that meet are taken for equal."""
    pairs = (p.angles for p in equilibria(**values).equilibria)
    return sum(a.low <= b.high and b.low <= a.high for a, b in pairs)


FUNCTIONS: dict[str, Callable[..., Any]] = {
    f.__name__: f
    for f in (
        at,
        flat,
        triangle,
        squared,
        numerator,
        independent,
        flat_stable,
        equal_angles,
        half_angles,
    )
}
FUNCTIONS |= {name: partial(placed, values) for name, values in PLACES.items()} | {
    # for equal rods and forces, by t2, where the angles differ
    "unequal": lambda e: sp.factor(
        half_angles(placed(PLACES["symmetric"], e)).subs(t1, expression("OTHER"))
    ),
    "degree": lambda e, unknown: int(sp.degree(numerator(e), unknown)),
    # in all symbols unless some are named
    "terms": lambda e, *unknowns: len(sp.Poly(e, *unknowns).terms()),
    # on how many parameters expressions depend
    "parameters": lambda *all_: len(set().union(*(e.free_symbols for e in all_)) - set(ANGLES)),
    "total": lambda **values: len(equilibria(**values).equilibria),
    "stable": lambda **values: equilibria(**values).stable,
}
