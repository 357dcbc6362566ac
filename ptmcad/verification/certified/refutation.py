"""Whether a stored text differs from the true formula at random configurations, in balls of many digits.

Guarantee: what is called different is different. Texts that agree at the configurations may still differ elsewhere, so
this never confirms one: it is for texts that are too large to be compared as polynomials, which would else be believed.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Mapping
from math import prod

from flint import arb, ctx, fmpq, fmpq_mpoly

_BITS = 4096
_PLACES = 2
_PARTS = 2**48


def differs_somewhere(
    node: ast.expr,
    true: fmpq_mpoly,
    squares: Mapping[str, fmpq_mpoly],
    angles: Mapping[str, tuple[str, str]],
    seed: str,
) -> bool:
    """Whether a text and a polynomial surely have different values at one of a few random configurations.

    Parameters
    ----------
    node : the text, read: sums, products, powers, quotients, roots, cosines and sines; its names are generators.
    true : the polynomial, in a ring with generators for parameters, unknowns, lengths, cosines and sines.
    squares : the square of each length, by the length's generator.
    angles : the generators of cosine and sine of each angle, by the angle's.
    seed : of the configurations.

    Raises
    ------
    RecursionError
        When the text has too many parts within each other.
    """
    rng = random.Random(seed)
    with ctx.workprec(_BITS):
        for _ in range(_PLACES):
            at = {name: arb(fmpq(rng.randrange(1, 2 * _PARTS), _PARTS)) for name in true.context().names()}
            for angle, (cosine, sine) in angles.items():
                at[cosine], at[sine] = at[angle].cos(), at[angle].sin()
            for length, square in squares.items():
                at[length] = _at(square, at).sqrt()
            if not _value(node, at).overlaps(_at(true, at)):
                return True
    return False


def _at(p: fmpq_mpoly, at: Mapping[str, arb]) -> arb:
    values = [at[name] for name in p.context().names()]
    terms = (c * prod((x**e for x, e in zip(values, key, strict=True) if e), start=arb(1)) for key, c in p.terms())
    return sum(terms, arb(0))


def _value(node: ast.expr, at: Mapping[str, arb]) -> arb:
    """A text's value; a ball without bound where it is no formula, which other checks reject."""
    match node:
        case ast.Constant(value=int(number)):
            return arb(number)
        case ast.Name(id=name) if name in at:
            return at[name]
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_value(inner, at)
        case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(exponent))):
            return _value(base, at) ** exponent
        case ast.BinOp(left=one, op=operator, right=two):
            a, b = _value(one, at), _value(two, at)
            match operator:
                case ast.Add():
                    return a + b
                case ast.Sub():
                    return a - b
                case ast.Mult():
                    return a * b
                case ast.Div():
                    return a / b
        case ast.Call(func=ast.Name(id=name), args=[inner], keywords=[]):
            x = _value(inner, at)
            match name:
                case "sqrt":
                    return x.sqrt()
                case "cos":
                    return x.cos()
                case "sin":
                    return x.sin()
    return arb("nan")
