"""Sums of whole multiples of unknown angles with quarter turns added to them: ``phi - th + pi/2``.

Guarantee: exact. Of quarter turns the cosine and sine are whole numbers, so that what leaves here has no pi in it.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.errors import ExpressionError
from ptmcad.model.evaluate import FIXED_ANGLE, multiples, multiples_with_positions
from ptmcad.text.tree import Call, Chain, Name, Negative, Number, Step, Tree, mapped, names_of

PI = "pi"


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
        When the angle is no sum of multiples of names, or what is added to it is no multiple of pi/2.
    """
    parts, positions = multiples_with_positions(tree)
    turns = 2 * parts.get(PI, Fraction(0))
    if parts.get("") or turns.denominator != 1:
        raise ExpressionError(FIXED_ANGLE)
    return (_without_pi(parts, positions) if PI in parts else tree), int(turns) % 4


def angle_name(tree: Tree) -> str:
    """A sum of multiples of angles in the shortest way, such as ``phi-2*th``; empty for the angle zero."""
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
        raise ExpressionError(error.message, part.position if error.position is None else error.position) from None
    return pair[0 if part.function == "cos" else 1]


def _without_pi(parts: Mapping[str, Fraction], positions: Mapping[str, int]) -> Tree:
    """A sum of multiples of names, without that of pi; each name where it stands first."""
    first: Tree = Number(Fraction(0))
    steps: list[Step] = []
    for name, multiple in parts.items():
        if name in ("", PI) or not multiple:
            continue
        place = Name(name, positions[name])
        term: Tree = place if abs(multiple) == 1 else Chain(Number(abs(multiple)), (Step("*", place),))
        if first == Number(Fraction(0)):
            first = Negative(term) if multiple < 0 else term
        else:
            steps.append(Step("-" if multiple < 0 else "+", term))
    return Chain(first, tuple(steps)) if steps else first
