"""Check of the stored potential of a certified map, as a polynomial in the springs' lengths.

Guarantee: exact. The text equals the energy that follows from the nodes' coordinates, as a function of all
parameters and both angles: both are polynomials over Q in the parameters, cosines, sines and lengths l_i, modulo
cos^2 + sin^2 = 1 and l_i^2 = q_i, and their normal forms are the same. A root is read only where it is a length.

Values at points would not do: what agrees at points of any number and precision may still be wrong elsewhere, be it
sqrt(F3^2) for F3, a high power of a number below one, or a product that vanishes at the points.
"""

from __future__ import annotations

import ast
import re
from functools import cache

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.verification.certified.vectors import NAMES
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import ANGLES, MECHANISM, UNKNOWNS, Configuration, work
from ptmcad.verification.report import Violation

_LENGTHS = tuple(f"l{n}" for n in range(1, len(MECHANISM.springs) + 1))
_CIRCLES = UNKNOWNS
_NAMES = (*_LENGTHS, *_CIRCLES, *NAMES)
_RING: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(_NAMES, Ordering.lex)
_MAX_TEXT = 5_000
_SIGNS = re.compile(r"[A-Za-z0-9_ ()^*/+-]*", re.ASCII)
_WRONG = re.compile(r"\*\*|(?<![A-Za-z0-9_])(?:_|[0-9]+[A-Za-z_])", re.ASCII)
"""Integers, names and signs: no comments, lines, decimals, or other things that are Python. Each takes linear time;
possessive quantifiers, which would do, are wrong in Python before 3.11.5."""
_MAX_TERMS, _MAX_DEGREE, _MAX_BITS = 2_000, 60, 2_000
"""Of what a part of the text stands for, so that no text takes long; the energy has some 30 terms of degree 5."""


def check_potential(claims: Claims) -> str:
    """The unknowns, and the potential in them."""
    system = claims.result.system
    if system.unknowns != ANGLES:
        raise Violation(f"the unknowns are {system.unknowns}, not {ANGLES}")
    if system.relations or system.gradient or system.hessian:
        raise Violation("a certified map has no relations, and its gradient and Hessian follow from the potential")
    try:
        stored = _value(_parsed(system.potential))
    except RecursionError:
        raise Violation("the stored potential has too many parts within each other") from None
    difference = _reduced(stored - _energy())
    if not difference.is_zero():
        raise Violation(f"the stored potential differs from the mechanism's by {str(difference)[:80]}")
    return f"the potential in {len(ANGLES)} unknowns and {len(NAMES)} parameters"


def _variable(name: str) -> fmpq_mpoly:
    return _RING.gen(_NAMES.index(name))


@cache
def _configuration() -> Configuration:
    circles = {angle: (_variable(f"cos_{angle}"), _variable(f"sin_{angle}")) for angle in ANGLES}
    return Configuration({name: _variable(name) for name in NAMES}, circles)


@cache
def _circles() -> tuple[fmpq_mpoly, ...]:
    return tuple(c * c + s * s - 1 for c, s in _configuration().circles.values())


@cache
def _squares() -> tuple[fmpq_mpoly, ...]:
    """The squares of the springs' lengths in cosines and sines, in normal form."""
    found, points = [], _configuration().points()
    for spring in MECHANISM.springs:
        across, up = (points[spring.end][i] - points[spring.start][i] for i in (0, 1))
        square = across * across + up * up
        for circle in _circles():
            square = divmod(square, circle)[1]
        found.append(square)
    return tuple(found)


def _reduced(p: fmpq_mpoly) -> fmpq_mpoly:
    """The normal form: at most the first power of each length and of each cosine."""
    for name, square in zip(_LENGTHS, _squares(), strict=True):
        p = divmod(p, _variable(name) ** 2 - square)[1]
    for circle in _circles():
        p = divmod(p, circle)[1]
    return p


@cache
def _energy() -> fmpq_mpoly:
    configuration = _configuration()
    energy: fmpq_mpoly = work(configuration, configuration.points())
    for length, spring in zip(_LENGTHS, MECHANISM.springs, strict=True):
        stretch = _variable(length) - configuration.value(spring.free)
        energy += stretch * stretch * (configuration.value(spring.stiffness) * fmpq(1, 2))
    return energy


def _parsed(text: str) -> ast.expr:
    if len(text) > _MAX_TEXT or _SIGNS.fullmatch(text) is None or _WRONG.search(text):
        raise Violation("the stored potential is not a formula in the names of problem records")
    try:
        return ast.parse(text.replace("^", "**"), mode="eval").body
    except (SyntaxError, RecursionError, MemoryError):
        raise Violation(f"the stored potential cannot be read: {text[:60]!r}") from None


def _value(node: ast.expr) -> fmpq_mpoly:
    """What sums, products, small powers, quotients by numbers, lengths, sines and cosines stand for."""
    match node:
        case ast.Constant(value=int(number)) if not isinstance(number, bool):
            return _bounded(_RING.constant(number))
        case ast.Name(id=name) if name in NAMES:
            return _variable(name)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_value(inner)
        case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(exponent))) if 0 <= exponent <= 9:
            power, factor = _RING.constant(1), _value(base)
            for _ in range(exponent):
                power = _product(power, factor)
            return power
        case ast.BinOp(left=one, op=operator, right=two):
            a, b = _value(one), _value(two)
            match operator:
                case ast.Add():
                    return _bounded(a + b)
                case ast.Sub():
                    return _bounded(a - b)
                case ast.Mult():
                    return _product(a, b)
                case ast.Div() if b.is_constant() and not b.is_zero():
                    return _product(a, _RING.constant(1 / b.coeffs()[0]))
        case ast.Call(func=ast.Name(id="sin" | "cos" as name), args=[ast.Name(id=angle)], keywords=[]) if (
            angle in ANGLES
        ):
            return _variable(f"{name}_{angle}")
        case ast.Call(func=ast.Name(id="sqrt"), args=[inner], keywords=[]):
            square = _reduced(_value(inner))
            if square in _squares():
                return _variable(_LENGTHS[_squares().index(square)])
            raise Violation(f"the stored potential has a root of what is no spring's length: {_shown(node)}")
    raise Violation(f"the stored potential has a part that is no formula: {_shown(node)}")


def _shown(node: ast.expr) -> str:
    return repr(ast.unparse(node)[:60])


def _product(a: fmpq_mpoly, b: fmpq_mpoly) -> fmpq_mpoly:
    if len(a) * len(b) > _MAX_TERMS:
        raise Violation(f"the stored potential has a product of more than {_MAX_TERMS} terms")
    return _bounded(a * b)


def _bounded(p: fmpq_mpoly) -> fmpq_mpoly:
    """A polynomial that is not too large to go on with."""
    bits = max((max(int(c.p).bit_length(), int(c.q).bit_length()) for c in p.coeffs()), default=0)
    if len(p) > _MAX_TERMS or p.total_degree() > _MAX_DEGREE or bits > _MAX_BITS:
        raise Violation("the stored potential has a part of too many terms, too high a degree or too long numbers")
    return p
