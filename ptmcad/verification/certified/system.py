"""The mechanism's potential with free lengths, derived here once more, against the text of the stored one.

Guarantee: the text equals the energy that follows from the coordinates of the four nodes, for all parameters and
angles. Each square root in it is the length l_i of a spring: its radicand is q_i, the square of that length, by
cos^2 + sin^2 = 1. What is left is a polynomial over Q in the parameters, cosines, sines and l1, l2, l3, whose
difference from the energy is reduced to zero by those relations and l_i^2 = q_i. No point is drawn and nothing rounded.

The leading terms of the relations, l_i^2 and cos^2 of each angle, have no variable in common, so that the relations are
a Groebner basis, and its remainders do not depend on how the text was written.
"""

from __future__ import annotations

import ast
from functools import cache

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.verification.certified.energy import NAMES
from ptmcad.verification.claims import Claims
from ptmcad.verification.report import Violation

UNKNOWNS = ("th1", "th2")
_LENGTHS = ("l1", "l2", "l3")
_CIRCLES = (("cos(th1)", "sin(th1)"), ("cos(th2)", "sin(th2)"))
_VARIABLES = (*_LENGTHS, *(name for circle in _CIRCLES for name in circle), *NAMES)
_RING: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(_VARIABLES, Ordering.lex)

# What is far from the potential is no text of it: it is refused before it takes time and memory.
_LONGEST = 5_000
_MAX_DEGREE = 12
_MAX_TERMS = 10_000


def check_potential(claims: Claims) -> str:
    """The unknowns, and the potential in them."""
    system = claims.result.system
    if system.unknowns != UNKNOWNS:
        raise Violation(f"the unknowns are {system.unknowns}, not {UNKNOWNS}")
    if system.relations or system.gradient or system.hessian:
        raise Violation("a certified map has no relations, and its gradient and Hessian follow from the potential")
    try:
        stored = _polynomial(_parsed(system.potential))
    except RecursionError:
        raise Violation(f"the stored potential is nested too deeply: {system.potential[:60]!r}") from None
    difference = _reduced(stored - potential())
    if not difference.is_zero():
        raise Violation(f"the stored potential differs from the mechanism's by {str(difference)[:80]}")
    return f"the potential in {len(UNKNOWNS)} unknowns and {len(NAMES)} parameters"


@cache
def potential() -> fmpq_mpoly:
    """The energy in the parameters, cosines, sines and the springs' lengths."""
    v = {name: _variable(name) for name in _VARIABLES}
    _, _, (x3, y3), (x4, y4) = _nodes()
    energy = -v["F3x"] * x3 - v["F3"] * y3 - v["F4x"] * x4 - v["F4"] * y4
    for n in (1, 2, 3):
        energy += v[f"k{n}"] * (v[f"l{n}"] - v[f"l0_{n}"]) ** 2 / 2
    return energy


@cache
def squares() -> tuple[fmpq_mpoly, ...]:
    """q1, q2, q3: the squares of the springs' lengths, reduced."""
    nodes = _nodes()
    ends = ((nodes[0], nodes[3]), (nodes[1], nodes[2]), (nodes[2], nodes[3]))
    return tuple(_on_circles((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2) for a, b in ends)


def _nodes() -> tuple[tuple[fmpq_mpoly, fmpq_mpoly], ...]:
    length1, length2, rho = (_variable(name) for name in ("L1", "L2", "rho"))
    (c1, s1), (c2, s2) = ((_variable(c), _variable(s)) for c, s in _CIRCLES)
    zero = _RING.constant(0)
    return ((zero, zero), (rho, zero), (length1 * c1, length1 * s1), (rho - length2 * c2, length2 * s2))


def _variable(name: str) -> fmpq_mpoly:
    return _RING.gen(_VARIABLES.index(name))


def _on_circles(p: fmpq_mpoly) -> fmpq_mpoly:
    """The remainder by cos^2 + sin^2 - 1 of each angle."""
    for cosine, sine in _CIRCLES:
        p = divmod(p, _variable(cosine) ** 2 + _variable(sine) ** 2 - 1)[1]
    return p


def _reduced(p: fmpq_mpoly) -> fmpq_mpoly:
    """The remainder by all relations; zero only for what is zero for all parameters and angles."""
    for name, square in zip(_LENGTHS, squares(), strict=True):
        p = divmod(p, _variable(name) ** 2 - square)[1]
    return _on_circles(p)


def _parsed(text: str) -> ast.expr:
    if len(text) > _LONGEST or "**" in text or not text.isascii():
        raise Violation("the stored potential is not a formula in the names of problem records")
    try:
        return ast.parse(text.replace("^", "**"), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise Violation(f"the stored potential can not be read: {text[:60]!r}") from None


def _polynomial(node: ast.expr) -> fmpq_mpoly:
    """Sums, products, small powers, quotients by numbers, sines and cosines of the angles, and the springs' lengths."""
    match node:
        case ast.Constant(value=int(number)) if not isinstance(number, bool):
            return _RING.constant(number)
        case ast.Name(id=name) if name in NAMES:
            return _variable(name)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_polynomial(inner)
        case ast.BinOp(left=left, op=ast.Pow(), right=ast.Constant(value=int(exponent))) if 2 <= exponent <= 9:
            base = _polynomial(left)
            if not base.is_constant():  # powers of numbers would have no degree to be bounded by
                power = base
                for _ in range(exponent - 1):
                    power = _product(power, base)
                return power
        case ast.BinOp(left=one, op=operator, right=two):
            a, b = _polynomial(one), _polynomial(two)
            match operator:
                case ast.Add():
                    return a + b
                case ast.Sub():
                    return a - b
                case ast.Mult():
                    return _product(a, b)
                case ast.Div() if b.is_constant() and not b.is_zero():
                    return a / b.leading_coefficient()
        case ast.Call(func=ast.Name(id="sin" | "cos" as name), args=[ast.Name(id="th1" | "th2" as angle)], keywords=[]):
            return _variable(f"{name}({angle})")
        case ast.Call(func=ast.Name(id="sqrt"), args=[inner], keywords=[]):
            radicand = _reduced(_polynomial(inner))
            for name, square in zip(_LENGTHS, squares(), strict=True):
                if radicand == square:
                    return _variable(name)
            raise Violation(f"the stored potential has a root that is no spring's length: {ast.unparse(node)[:60]!r}")
    raise Violation(f"the stored potential has a part that is no formula: {ast.unparse(node)[:60]!r}")


def _product(a: fmpq_mpoly, b: fmpq_mpoly) -> fmpq_mpoly:
    if a.is_zero() or b.is_zero():
        return _RING.constant(0)
    if int(a.total_degree()) + int(b.total_degree()) > _MAX_DEGREE or len(a) * len(b) > _MAX_TERMS:
        raise Violation("the stored potential has products of a degree that the mechanism's does not have")
    return a * b
