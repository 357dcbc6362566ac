"""Check of the stored potential of a certified map, by values at random points.

Guarantee: at three random points of all parameters and angles the text's value and that of the energy, from the four
nodes' coordinates, are in balls of width below 1e-25 that overlap.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Mapping

from flint import arb, ctx

from ptmcad.verification.certified.energy import NAMES
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import ANGLES, MECHANISM, Place, work
from ptmcad.verification.report import Violation

_LONGEST = 5_000
_POINTS = 3


def check_potential(claims: Claims, seed: str) -> str:
    """The unknowns, and the potential in them."""
    system = claims.result.system
    if system.unknowns != ANGLES:
        raise Violation(f"the unknowns are {system.unknowns}, not {ANGLES}")
    if system.relations or system.gradient or system.hessian:
        raise Violation("a certified map has no relations, and its gradient and Hessian follow from the potential")
    expression = _parsed(system.potential)
    rng = random.Random(seed)
    with ctx.workprec(128):
        for _ in range(_POINTS):
            point = {name: arb(rng.randrange(1, 2**20)) / 2**18 for name in (*NAMES, *ANGLES)}
            stored, true = _value(expression, point), _energy(point)
            if not (stored - true).contains(0) or not (stored - true).rad() < 1e-25:
                difference = float((stored - true).mid())
                raise Violation(f"the stored potential differs from the mechanism's by {difference:.3g} somewhere")
    return f"the potential in {len(ANGLES)} unknowns and {len(NAMES)} parameters"


def _energy(v: Mapping[str, arb]) -> arb:
    place = Place(v, {angle: (v[angle].cos(), v[angle].sin()) for angle in ANGLES})
    points = place.points()
    energy = work(place, points)
    for spring in MECHANISM.springs:
        across, up = (points[spring.end][i] - points[spring.start][i] for i in (0, 1))
        stretch = arb(across * across + up * up).sqrt() - place.value(spring.free)
        energy += place.value(spring.stiffness) * stretch * stretch / 2
    return arb(energy)


def _parsed(text: str) -> ast.expr:
    if len(text) > _LONGEST or "**" in text or not text.isascii():
        raise Violation("the stored potential is not a formula in the names of problem records")
    try:
        return ast.parse(text.replace("^", "**"), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise Violation(f"the stored potential can not be read: {text[:60]!r}") from None


def _value(node: ast.expr, point: Mapping[str, arb]) -> arb:
    """The value of sums, products, quotients, small powers, square roots, sines and cosines."""
    match node:
        case ast.Constant(value=int(number)) if not isinstance(number, bool):
            return arb(number)
        case ast.Name(id=name) if name in point:
            return point[name]
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_value(inner, point)
        case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(exponent))) if 0 <= exponent <= 9:
            return _value(base, point) ** exponent
        case ast.BinOp(left=one, op=operator, right=two):
            a, b = _value(one, point), _value(two, point)
            match operator:
                case ast.Add():
                    return a + b
                case ast.Sub():
                    return a - b
                case ast.Mult():
                    return a * b
                case ast.Div():
                    return a / b
        case ast.Call(func=ast.Name(id="sqrt" | "sin" | "cos" as name), args=[inner], keywords=[]):
            value = _value(inner, point)
            return value.sqrt() if name == "sqrt" else value.sin() if name == "sin" else value.cos()
    raise Violation(f"the stored potential has a part that is no formula: {ast.unparse(node)[:60]!r}")
