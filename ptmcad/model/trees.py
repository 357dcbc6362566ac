"""Trees that are made of trees: sums, products, and angles without quarter turns.

Quarter turns may be added to angles, ``phi - th + pi/2``: their cosine and sine are whole numbers,
so that what `split_angle` and `without_quarter_turns` return has no pi in it.

Guarantee: exact. What is zero at sight is left out, and no more is simplified: values are expanded
where they are made.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.errors import ExpressionError
from ptmcad.model.evaluate import FIXED_ANGLE, multiples, multiples_with_positions
from ptmcad.text.tree import Call, Chain, Name, Negative, Number, Step, Tree, mapped, names_of

PI = "pi"
ZERO: Tree = Number(Fraction(0))
ONE: Tree = Number(Fraction(1))


def total(*trees: Tree) -> Tree:
    """A sum."""
    kept = [tree for tree in trees if tree != ZERO]
    if not kept:
        return ZERO
    steps = [Step("-", t.operand) if isinstance(t, Negative) else Step("+", t) for t in kept[1:]]
    return Chain(kept[0], tuple(steps)) if steps else kept[0]


def negative(tree: Tree) -> Tree:
    """The tree with the other sign."""
    if isinstance(tree, Negative):
        return tree.operand
    return ZERO if tree == ZERO else Negative(tree)


def product(*trees: Tree) -> Tree:
    """A product, with its number and sign in front."""
    number = Fraction(1)
    factors: list[Tree] = []
    for tree in trees:
        sign, operand = (-1, tree.operand) if isinstance(tree, Negative) else (1, tree)
        number *= sign
        parts = [operand]
        if isinstance(operand, Chain) and all(step.operator == "*" for step in operand.steps):
            parts = [operand.first, *(step.operand for step in operand.steps)]
        for part in parts:
            if isinstance(part, Number):
                number *= part.value
            else:
                factors.append(part)
    if number == 0:
        return ZERO
    if abs(number) != 1 or not factors:
        factors.insert(0, Number(abs(number)))
    whole = (
        factors[0]
        if len(factors) == 1
        else Chain(factors[0], tuple(Step("*", tree) for tree in factors[1:]))
    )
    return Negative(whole) if number < 0 else whole


def split_angle(tree: Tree) -> tuple[Tree, int]:
    """An angle as the part that varies and the quarter turns, from 0 to 3, that are added to it.

    >>> from ptmcad.text.syntax import parse
    >>> from ptmcad.text.tree import to_text
    >>> varying, turns = split_angle(parse("phi - pi/2"))
    >>> to_text(varying), turns
    ('phi', 3)

    Raises
    ------
    ExpressionError
        When the angle is no sum of multiples of names, or what is added to it is no multiple of
        pi/2.
    """
    parts, positions = multiples_with_positions(tree)
    turns = 2 * parts.get(PI, Fraction(0))
    if parts.get("") or turns.denominator != 1:
        raise ExpressionError(FIXED_ANGLE)
    if PI in parts:
        names = (name for name in parts if name not in ("", PI))
        tree = total(*(product(Number(parts[name]), Name(name, positions[name])) for name in names))
    return tree, int(turns) % 4


def angle_name(tree: Tree) -> str:
    """A sum of multiples of angles in the shortest way, such as ``phi-2*th``; empty for the angle
    zero.
    """
    name = ""
    for angle, multiple in multiples(tree).items():
        if angle and multiple:
            sign = "-" if multiple < 0 else "+" if name else ""
            name += sign + ("" if abs(multiple) == 1 else f"{abs(multiple)}*") + angle
    return name


def cosine_and_sine(angle: Tree, turns: int) -> tuple[Tree, Tree]:
    """Those of an angle with quarter turns added to it."""
    c, s = Call("cos", angle), Call("sin", angle)
    return ((c, s), (Negative(s), c), (Negative(c), Negative(s)), (s, Negative(c)))[turns]


def without_quarter_turns(tree: Tree) -> Tree:
    """A tree in which no argument of a cosine or sine has a fixed part.

    Raises
    ------
    ExpressionError
        When one has a part that is no multiple of pi/2; with its position.
    """
    return mapped(tree, _of_varying_angle) if PI in names_of(tree) else tree


def _of_varying_angle(part: Tree) -> Tree | None:
    if not isinstance(part, Call):
        return None
    try:
        pair = cosine_and_sine(*split_angle(part.argument))
    except ExpressionError as error:
        raise ExpressionError(
            error.message, part.position if error.position is None else error.position
        ) from None
    return pair[0 if part.function == "cos" else 1]
