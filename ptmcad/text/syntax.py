"""Arithmetic as text: an expression tree that knows where each of its parts stands; nothing is evaluated here.

Guarantee: numbers are exact (``0.1`` is 1/10). Any text is answered within a fraction of a second, by a tree or by an
`ExpressionError` with the position of the offending character; a tree is at most `MAX_DEPTH` levels deep, however many
terms a sum in it has. `to_text` writes a tree that was read in a form that `parse` reads as the same tree.

What a tree means is said by an `Interpretation`: rational functions of two axes in `ptmcad.text.expressions`, the
elements of any ring in `ptmcad.mechanism.evaluate`.

>>> tree = parse("rho - L2*cos(th2)")
>>> to_text(tree), names_of(tree)
('rho - L2*cos(th2)', ('rho', 'L2', 'th2'))
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import get_close_matches
from fractions import Fraction
from typing import NamedTuple, Protocol, TypeVar

from ptmcad.errors import ExpressionError

MAX_TEXT = 10_000
MAX_DIGITS = 2_000
MAX_DECIMAL_EXPONENT = 1_000
MAX_DEPTH = 100
FUNCTIONS = ("cos", "sin")
"""Names that are functions where a parenthesis follows, and names like others where none does."""


# --------------------------------------------------------------------------------------------------------- the tree
# Named tuples: they are defined in a seventh of a dataclass's time, and every command pays for that when it starts.


class Number(NamedTuple):
    """An exact number; a number that was read is not negative."""

    value: Fraction
    position: int = 0


class Name(NamedTuple):
    """A parameter, an unknown or whatever else the interpretation knows by this name."""

    name: str
    position: int = 0


class Negative(NamedTuple):
    """The operand with the other sign."""

    operand: Tree
    position: int = 0


class Step(NamedTuple):
    """One more operand of a `Chain`: how it is joined to what stands before it, at its operator's position."""

    operator: str
    operand: Tree
    position: int = 0


class Chain(NamedTuple):
    """A sum (operators + and -) or a product (* and /) of any length, from left to right."""

    first: Tree
    steps: tuple[Step, ...]

    @property
    def is_sum(self) -> bool:
        return self.steps[0].operator in "+-"


class Power(NamedTuple):
    """A base with an exponent, at its operator's position."""

    base: Tree
    exponent: Tree
    position: int = 0


class Call(NamedTuple):
    """One of the `FUNCTIONS` of an argument."""

    function: str
    argument: Tree
    position: int = 0


Tree = Number | Name | Negative | Chain | Power | Call
Value = TypeVar("Value")


class Interpretation(Protocol[Value]):
    """What the parts of a tree mean, in values of one type.

    `interpret` asks from left to right: operands before what joins them. A method may raise `ExpressionError` with the
    position of the part that has no meaning.
    """

    def number(self, number: Number) -> Value: ...

    def name(self, name: Name) -> Value: ...

    def call(self, call: Call) -> Value:
        """A function; the argument is handed over as a tree, for it may be of another kind than the value."""

    def negative(self, value: Value) -> Value: ...

    def joined(self, left: Value, step: Step, right: Value) -> Value:
        """``left`` and the step's operand, whose value is ``right``."""

    def power(self, base: Value, power: Power, exponent: Value) -> Value: ...


def interpret(tree: Tree, interpretation: Interpretation[Value]) -> Value:
    """The value of a tree."""
    match tree:
        case Name():
            return interpretation.name(tree)
        case Number():
            return interpretation.number(tree)
        case Chain(first, steps):
            value = interpret(first, interpretation)
            for step in steps:
                value = interpretation.joined(value, step, interpret(step.operand, interpretation))
            return value
        case Power(base, exponent):
            return interpretation.power(interpret(base, interpretation), tree, interpret(exponent, interpretation))
        case Call():
            return interpretation.call(tree)
        case Negative(operand):
            return interpretation.negative(interpret(operand, interpretation))


def names_of(tree: Tree) -> tuple[str, ...]:
    """The names that occur in a tree, functions apart, in order of appearance, each once."""
    names: dict[str, None] = {}
    waiting = [tree]
    while waiting:
        match waiting.pop():
            case Name(name):
                names[name] = None
            case Chain(first, steps):
                waiting += [*(step.operand for step in reversed(steps)), first]
            case Power(base, exponent):
                waiting += [exponent, base]
            case Negative(operand) | Call(_, operand):
                waiting.append(operand)
    return tuple(names)


# ----------------------------------------------------------------------------------------------------- from a text

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TOKEN = re.compile(
    r"(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*)"
    r"|(?P<operator>\*\*|[-+*/^()])"
)
_BLANK = re.compile(r"[ \t]*")
NOT_NUMBERS = frozenset({"nan", "inf", "infinity"})
_WRITE_INSTEAD = {
    "−": "-", "–": "-", "—": "-", "×": "*", "·": "*", "⋅": "*", "∗": "*", "÷": "/", "⁄": "/", "∕": "/",
    "²": "^2", "³": "^3", "ρ": "rho", "½": "1/2", "¼": "1/4", "¾": "3/4", ",": "a decimal point",
}  # fmt: skip
_SUM, _PRODUCT, _TIGHTER = 1, 2, 3
_BINDING = {"+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT}


class _Token(NamedTuple):
    kind: str  # number, name, operator, end
    text: str
    position: int


def parse(text: str) -> Tree:
    """Read an arithmetic expression: numbers, names, ``+ - * /``, powers ``^`` or ``**``, parentheses, `FUNCTIONS`.

    ``^`` binds tighter than a sign on its left and groups to the right, as in mathematics: ``-x^2`` is -(x^2).

    Raises
    ------
    ExpressionError
        With the position of the offending character: not arithmetic, or one of the limits of this module (length,
        depth, digits, decimal exponent).
    """
    return _Parser(text).run()


def names_in(text: str) -> tuple[str, ...]:
    """The names that occur in a text, functions among them, in order of appearance, each once.

    Raises
    ------
    ExpressionError
        If a character cannot stand in an expression; whether the text is one is not asked.
    """
    return tuple(dict.fromkeys(token.text for token in _tokens(text) if token.kind == "name"))


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """``"; did you mean 'rho'?"``, or the empty string when nothing known is close."""
    names = list(known)
    close = get_close_matches(name[:100], names, n=1)
    if not close:
        close = [other for other in names if other.lower() == name.lower()]
    return f"; did you mean '{close[0]}'?" if close else ""


def unknown_name(name: str, position: int, known: Iterable[str]) -> ExpressionError:
    """The error for a name that has no meaning."""
    if name.lower() in NOT_NUMBERS:
        return ExpressionError(f"'{name}' is not a number that can be computed with", position)
    return ExpressionError(f"unknown name '{_short(name)}'{did_you_mean(name, known)}", position)


def _tokens(text: str) -> list[_Token]:
    if len(text) > MAX_TEXT:
        raise ExpressionError(f"the expression has {len(text)} characters, more than {MAX_TEXT}")
    tokens = []
    position = _blank(text, 0)
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise _bad_character(text, position)
        kind = match.lastgroup or ""
        if kind == "number" and (after := NAME.match(text, match.end())):
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
    character = text[position]
    if character in _WRITE_INSTEAD:
        remedy = f": write {_WRITE_INSTEAD[character]}"
    elif character == "_":
        remedy = ": a name starts with a letter, and digits are not grouped"
    else:
        remedy = ": an expression has numbers, names, + - * / ^ and parentheses"
    shown = repr(character) if character.isascii() else f"'{character}' (U+{ord(character):04X})"
    return ExpressionError(f"the character {shown} cannot be used{remedy}", position)


def _short(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:30]}..."


class _Parser:
    """Precedence climbing, in one pass."""

    def __init__(self, text: str):
        self.tokens = _tokens(text)
        self.index = 0

    def run(self) -> Tree:
        tree = self.climb(0, 0)
        token = self.tokens[self.index]
        if token.kind == "end":
            return tree
        if token.text == ")":
            raise ExpressionError("this ')' has no '(' before it", token.position)
        raise ExpressionError(f"'{_short(token.text)}' is not expected here: is an operator missing?", token.position)

    def next(self) -> _Token:
        token = self.tokens[self.index]
        self.index += token.kind != "end"
        return token

    def climb(self, binding: int, depth: int) -> Tree:
        """Read operands and operators that bind tighter than `binding`."""
        tree = self.operand(depth)
        for level in (_PRODUCT, _SUM):
            if level <= binding:
                break
            steps = []
            while _BINDING.get(self.tokens[self.index].text, 0) == level:
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
        elif token.kind == "name" and token.text in FUNCTIONS and self.tokens[self.index].text == "(":
            tree = Call(token.text, self.enclosed(self.next(), depth), token.position)
        elif token.kind == "name":
            tree = Name(token.text, token.position)
        elif token.text == "(":
            tree = self.enclosed(token, depth)
        elif token.kind == "end":
            raise ExpressionError("the expression is empty" if self.index == 0 else "the expression ends too early",
                                  token.position)  # fmt: skip
        else:
            raise ExpressionError(f"'{token.text}' is not expected here: a number or a name is missing", token.position)
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
        raise ExpressionError(f"a decimal exponent is at most {MAX_DECIMAL_EXPONENT}", token.position)
    whole, _, decimals = digits.partition(".")
    if len(whole) > 1 and whole.startswith("0"):
        raise ExpressionError(f"'{_short(token.text)}' starts with 0: drop the leading zeros", token.position)
    scale = int(exponent or "0") - len(decimals)
    value = int(whole + decimals)
    return Fraction(value * 10**scale) if scale >= 0 else Fraction(value, 10**-scale)


# ------------------------------------------------------------------------------------------------------- to a text

_MAX_PLACES = 20
"""Numbers with more decimal places are written with an exponent."""


def to_text(tree: Tree) -> str:
    """A tree as text; one that was read is read again as the same tree, but for positions.

    A number without a finite decimal form, which no text has as one number, is written as a quotient.
    """
    match tree:
        case Name(name):
            return name
        case Number(value):
            return _number_text(value)
        case Chain(first, steps):
            lowest = _PRODUCT if tree.is_sum else _TIGHTER
            text = _within(first, lowest)
            for step in steps:
                operator = f" {step.operator} " if tree.is_sum else step.operator
                text += operator + _within(step.operand, lowest)
            return text
        case Power(base, exponent):
            inner = f"({to_text(base)})" if isinstance(base, Power | Negative) else _within(base, _TIGHTER)
            return f"{inner}^{_within(exponent, _TIGHTER)}"
        case Negative(operand):
            return f"-{_within(operand, _TIGHTER)}"
        case Call(function, argument):
            return f"{function}({to_text(argument)})"


def _within(tree: Tree, lowest: int) -> str:
    """A tree as a part of another: in parentheses when it is a chain that binds less tightly than `lowest`."""
    text = to_text(tree)
    if isinstance(tree, Chain):
        return text if (_SUM if tree.is_sum else _PRODUCT) >= lowest else f"({text})"
    return f"({text})" if isinstance(tree, Number) and ("/" in text or "-" in text) else text


def _number_text(value: Fraction) -> str:
    """A number as `_number` reads it, or a quotient."""
    places, denominator = 0, value.denominator
    for prime in (2, 5):
        power = 0
        while denominator % prime == 0:
            denominator //= prime
            power += 1
        places = max(places, power)
    if denominator != 1:
        return f"{value.numerator}/{value.denominator}"
    sign = "-" if value < 0 else ""
    digits = str(abs(value.numerator) * 10**places // value.denominator)
    if places == 0 and len(digits) <= MAX_DIGITS:
        return sign + digits
    if places == 0:
        zeros = min(len(digits) - len(digits.rstrip("0")), MAX_DECIMAL_EXPONENT)
        return f"{sign}{digits[: len(digits) - zeros]}e{zeros}"
    scale = min(places, MAX_DECIMAL_EXPONENT) if places > _MAX_PLACES else 0
    shown = digits.rjust(places - scale + 1, "0")
    point = len(shown) - (places - scale)
    text = f"{shown[:point]}.{shown[point:]}" if places > scale else shown
    if len(text) > MAX_DIGITS:
        text = text.removeprefix("0")
    return sign + text + (f"e-{scale}" if scale else "")
