"""Arithmetic as text is read as a `Tree` that knows where each of its parts stands; nothing is
evaluated here.

Guarantee: numbers are exact (``0.1`` is 1/10). Any text is answered within a fraction of a second,
by a tree or by an `ExpressionError` with the position of the offending character; a tree is at most
`MAX_DEPTH` levels deep, however many terms a sum in it has.

>>> from ptmcad.text.tree import names_of, to_text
>>> tree = parse("rho - L2*cos(th2)")
>>> to_text(tree), names_of(tree)
('rho - L2*cos(th2)', ('rho', 'L2', 'th2'))
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from fractions import Fraction
from typing import NamedTuple

from ptmcad.errors import ExpressionError
from ptmcad.text.numerals import FINITE, of_digits
from ptmcad.text.tree import (
    BINDING,
    FUNCTIONS,
    MAX_DECIMAL_EXPONENT,
    MAX_DIGITS,
    PRODUCT,
    SUM,
    Call,
    Chain,
    Name,
    Negative,
    Number,
    Power,
    Step,
    Tree,
)

MAX_TEXT = 10_000
MAX_DEPTH = 100
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TOKEN = re.compile(
    r"(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*)"
    r"|(?P<operator>\*\*|[-+*/^()])"
)
_BLANK = re.compile(r"[ \t]*")
NOT_NUMBERS = frozenset({"nan", "inf", "infinity"})
NOT_INTEGER = "the exponent is not an integer: write one, such as 2, and make a root itself a parameter or an unknown"
_RATIONAL = "values are rational: write a number near it, such as {}"
_OF_ANGLES = "give a fixed angle by its cosine and sine, as two parameters such as 3/5 and 4/5"
_NO_ROOT = f"{_RATIONAL.format('1.41421356')}, or in a system let r be an unknown with r^2 - (...) = 0 and r positive"
_TRANSCENDENTAL = (
    "of functions there are sin and cos of unknown angles only: write a rational number near its value, or where an "
    "unknown occurs in it alone, make its value the unknown (that of exp is positive)"
)
_NO_CASES = "there are no cases: write its square, or a record for each case"
_REMEDIES = {
    "pi": f"{_RATIONAL.format('355/113')}, or {_OF_ANGLES}",
    "sqrt": _NO_ROOT, "cbrt": _NO_ROOT, "root": _NO_ROOT,
    **dict.fromkeys(("exp", "ln", "log", "log10", "sinh", "cosh", "tanh"), _TRANSCENDENTAL),
    "tan": f"multiply by cos(...) and write sin(...) in its place; {_OF_ANGLES}",
    **dict.fromkeys(("asin", "acos", "atan", "atan2", "arcsin", "arccos", "arctan", "sin", "cos"), _OF_ANGLES),
    **dict.fromkeys(("abs", "min", "max", "sign"), _NO_CASES),
}  # fmt: skip
"""What is written in place of a name that means something elsewhere."""
_UNIT = re.compile(r"[cdkmu]?m|inch|[kmM]?Nm{0,2}|J|[kMG]?Pa|k?g|m?s|rad|deg(rees)?")
_WRITE_INSTEAD = {
    "−": "-", "–": "-", "—": "-", "×": "*", "·": "*", "⋅": "*", "∗": "*", "÷": "/", "⁄": "/", "∕": "/",
    "²": "^2", "³": "^3", "ρ": "rho", "½": "1/2", "¼": "1/4", "¾": "3/4", ",": "a decimal point",
    "°": "the angle by its cosine and sine, as two parameters", "∞": "a large number, since all values are finite",
    "√": "a rational number near the root, or make it an unknown", "%": "a share as a fraction, such as 1/2",
    "π": "a rational number near it, such as 355/113", "|": "the square, or a record for each case",
    "=": "the left side less the right side, which is zero then",
    **dict.fromkeys("<>", "what has to be positive alone"),
}  # fmt: skip


class _Token(NamedTuple):
    kind: str  # number, name, operator, end
    text: str
    position: int


def parse(text: str, functions: Collection[str] = FUNCTIONS, longest: int = MAX_TEXT) -> Tree:
    """Read an arithmetic expression: numbers, names, ``+ - * /``, powers ``^`` or ``**``,
    parentheses, `FUNCTIONS`.

    ``^`` binds tighter than a sign on its left and groups to the right, as in mathematics: ``-x^2``
    is -(x^2).

    Parameters
    ----------
    functions : names that are functions where a parenthesis follows.
    longest : characters that a text may have.

    Raises
    ------
    ExpressionError
        With the position of the offending character: not arithmetic, or one of the limits of this
        module (length, depth, digits, decimal exponent).
    """
    return _Parser(text, functions, longest).run()


def names_in(text: str) -> tuple[str, ...]:
    """The names that occur in a text, functions among them, in order of appearance, each once.

    Raises
    ------
    ExpressionError
        If a character cannot stand in an expression; whether the text is one is not asked.
    """
    return tuple(dict.fromkeys(token.text for token in _tokens(text) if token.kind == "name"))


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "", between: str = ", ") -> str:
    """``"; did you mean 'rho'?"``, what to write in place of a name such as ``sqrt``, or the names
    that there are.

    Parameters
    ----------
    otherwise : words before the names that there are; they are not listed without.
    between : what stands between these names.
    """
    if name.lower() in _REMEDIES:
        return f"; {_REMEDIES[name.lower()]}"
    from difflib import get_close_matches  # for messages only

    names = list(known)
    close = [other for other in names if other.lower() == name.lower()]
    close = close or get_close_matches(name[:100], names, n=1)
    if close:
        return f"; did you mean '{close[0]}'?"
    return otherwise and otherwise + between.join(names)


def unknown_name(name: str, position: int, known: Iterable[str]) -> ExpressionError:
    """The error for a name that has no meaning."""
    if name.lower() in NOT_NUMBERS:
        return ExpressionError(
            f"'{name}' is not a number that can be computed with; {FINITE}", position
        )
    return ExpressionError(f"unknown name '{_short(name)}'{did_you_mean(name, known)}", position)


def _tokens(text: str, longest: int = MAX_TEXT) -> list[_Token]:
    if len(text) > longest:
        raise ExpressionError(f"the expression has {len(text)} characters, more than {longest}")
    tokens: list[_Token] = []
    position = _blank(text, 0)
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise _bad_character(text, position)
        kind = match.lastgroup or ""
        if tokens and tokens[-1].kind == "number" and _UNIT.fullmatch(match.group()):
            raise _with_unit(match.group(), position)
        if kind == "number" and (after := NAME.match(text, match.end())):
            if _UNIT.fullmatch(after.group()):
                raise _with_unit(after.group(), after.start())
            raise ExpressionError(
                f"'{_short(match.group())}' and '{_short(after.group())}' stand side by side: write * between them",
                after.start(),
            )
        tokens.append(_Token(kind, match.group(), position))
        position = _blank(text, match.end())
    tokens.append(_Token("end", "", len(text)))
    return tokens


def _blank(text: str, position: int) -> int:
    match = _BLANK.match(text, position)
    return match.end() if match else position


def _bad_character(text: str, position: int) -> ExpressionError:
    character, after = text[position], NAME.match(text, position + 1)
    if character == "." and after and after.group().lower() in NOT_NUMBERS:  # as YAML spells them
        return unknown_name(after.group(), position, ())
    remedy = "an expression has numbers, names, + - * / ^ and parentheses"
    if character in _WRITE_INSTEAD:
        remedy = f"write {_WRITE_INSTEAD[character]}"
    elif character == "_":
        remedy = "a name starts with a letter, and digits are not grouped"
    shown = repr(character) if character.isascii() else f"'{character}' (U+{ord(character):04X})"
    return ExpressionError(f"the character {shown} cannot be used: {remedy}", position)


def _with_unit(unit: str, position: int) -> ExpressionError:
    remedy = (
        _OF_ANGLES
        if unit[:3] in ("rad", "deg")
        else "write all lengths in one unit, and all forces in one"
    )
    return ExpressionError(
        f"a number has no unit: leave '{unit}' out, or write * before a name; {remedy}", position
    )


def _short(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:30]}..."


class _Parser:
    """Precedence climbing, in one pass."""

    def __init__(self, text: str, functions: Collection[str], longest: int):
        self.tokens, self.functions = _tokens(text, longest), functions
        self.index = 0

    def run(self) -> Tree:
        tree = self.climb(0, 0)
        token = self.tokens[self.index]
        if token.kind == "end":
            return tree
        if token.text == ")":
            raise ExpressionError("this ')' has no '(' before it", token.position)
        before = self.tokens[self.index - 1]
        if token.text == "(" and before.kind == "name":
            hint = did_you_mean(before.text, FUNCTIONS) or ": is an operator missing?"
            raise ExpressionError(
                f"'{_short(before.text)}' is no function here{hint}", token.position
            )
        raise ExpressionError(
            f"'{_short(token.text)}' is not expected here: is an operator missing?", token.position
        )

    def next(self) -> _Token:
        token = self.tokens[self.index]
        self.index += token.kind != "end"
        return token

    def climb(self, binding: int, depth: int) -> Tree:
        """Read operands and operators that bind tighter than `binding`."""
        tree = self.operand(depth)
        for level in (PRODUCT, SUM):
            if level <= binding:
                break
            steps = []
            while BINDING.get(self.tokens[self.index].text, 0) == level:
                operator = self.next()
                steps.append(Step(operator.text, self.climb(level, depth + 1), operator.position))
            if steps:
                tree = Chain(tree, tuple(steps))
        return tree

    def operand(self, depth: int) -> Tree:
        token = self.next()
        if depth > MAX_DEPTH:
            raise ExpressionError(f"more than {MAX_DEPTH} levels of nesting", token.position)
        if token.text in ("+", "-"):
            operand = self.operand(depth + 1)
            return Negative(operand, token.position) if token.text == "-" else operand
        tree: Tree
        if token.kind == "number":
            tree = Number(_number(token), token.position)
        elif (
            token.kind == "name"
            and token.text in self.functions
            and self.tokens[self.index].text == "("
        ):
            tree = Call(token.text, self.enclosed(self.next(), depth), token.position)
        elif token.kind == "name":
            tree = Name(token.text, token.position)
        elif token.text == "(":
            tree = self.enclosed(token, depth)
        elif token.kind == "end":
            raise ExpressionError("the expression is empty" if self.index == 0 else "the expression ends too early",
                                  token.position)  # fmt: skip
        else:
            raise ExpressionError(
                f"'{token.text}' is not expected here: a number or a name is missing",
                token.position,
            )
        operator = self.tokens[self.index]
        if operator.text in ("^", "**"):
            self.next()
            return Power(tree, self.operand(depth + 1), operator.position)
        return tree

    def enclosed(self, opening: _Token, depth: int) -> Tree:
        """What stands between an opening parenthesis, which has been read, and its closing one."""
        tree = self.climb(0, depth + 1)
        if self.next().text != ")":
            raise ExpressionError("this '(' is never closed", opening.position)
        return tree


def _number(token: _Token) -> Fraction:
    """The exact value of a number token."""
    digits, _, exponent = token.text.lower().partition("e")
    if len(digits) > MAX_DIGITS:
        raise ExpressionError(f"a number has more than {MAX_DIGITS} digits", token.position)
    if len(exponent) > 6 or abs(int(exponent or "0")) > MAX_DECIMAL_EXPONENT:
        raise ExpressionError(
            f"a decimal exponent is at most {MAX_DECIMAL_EXPONENT}", token.position
        )
    whole, _, decimals = digits.partition(".")
    if len(whole) > 1 and whole.startswith("0"):
        raise ExpressionError(
            f"'{_short(token.text)}' starts with 0: drop the leading zeros", token.position
        )
    return of_digits(whole, decimals, int(exponent or "0"))
