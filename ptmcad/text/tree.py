"""Arithmetic as a tree: numbers, names, sums, products, powers and functions, each with its
position in a text.

Guarantee: `to_text` writes a tree that was read in a form that is read as the same tree.

What a tree means is said by an interpretation: rational functions of two axes in
`ptmcad.text.parsing`, the elements of any ring in `ptmcad.model.evaluate`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from operator import add, mul, neg, sub, truediv
from types import SimpleNamespace
from typing import Any, NamedTuple, Protocol, TypeVar, cast

from ptmcad.text.numerals import decimal_places, pointed, text_of

MAX_DIGITS = 2_000
MAX_DECIMAL_EXPONENT = 1_000
FUNCTIONS = ("cos", "sin")
"""Names that are functions where a parenthesis follows, and names like others where none does."""
SUM, PRODUCT, TIGHTER = 1, 2, 3
BINDING = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT}
"""How tightly operators bind, below signs and powers."""
OPERATORS: Mapping[str, Callable[[Any, Any], Any]] = {
    "+": add, "-": sub, "*": mul, "/": truediv,
}  # fmt: skip
"""What operators do with values of Python's own, or of a library that has these."""

# Named tuples: they are defined in a seventh of a dataclass's time, and every command pays for that
# when it starts.


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
    """One more operand of a `Chain`: how it is joined to what stands before it, at its operator's
    position.
    """

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


class _Interpretation(Protocol[Value]):
    """What the parts of a tree mean, in values of one type.

    `interpret` asks from left to right: operands before what joins them. A method may raise
    `ExpressionError` with the position of the part that has no meaning.
    """

    def number(self, number: Number) -> Value: ...

    def name(self, name: Name) -> Value: ...

    def call(self, call: Call) -> Value:
        """A function; the argument is handed over as a tree, for it may be of another kind than the
        value.
        """

    def negative(self, value: Value) -> Value: ...

    def joined(self, left: Value, step: Step, right: Value) -> Value:
        """``left`` and the step's operand, whose value is ``right``."""

    def power(self, base: Value, power: Power, exponent: Value) -> Value: ...


def interpret(
    tree: Tree,
    interpretation: _Interpretation[Value],
    known: dict[int, tuple[Tree, Value]] | None = None,
) -> Value:
    """The value of a tree.

    Parameters
    ----------
    known : keeps the values of parts, by their identity, for other trees in the same interpretation
        that share them.
    """
    if known is not None and id(tree) in known:
        return known[id(tree)][1]
    match tree:
        case Name():
            value = interpretation.name(tree)
        case Number():
            value = interpretation.number(tree)
        case Chain(first, steps):
            value = interpret(first, interpretation, known)
            for step in steps:
                operand = interpret(step.operand, interpretation, known)
                value = interpretation.joined(value, step, operand)
        case Power(base, exponent):
            below = interpret(base, interpretation, known)
            value = interpretation.power(below, tree, interpret(exponent, interpretation, known))
        case Call():
            value = interpretation.call(tree)
        case Negative(operand):
            value = interpretation.negative(interpret(operand, interpretation, known))
    if known is not None:  # with the tree, whose identity nothing else has while it is kept
        known[id(tree)] = tree, value
    return value


def arithmetic(
    constant: Callable[[Fraction], Any],
    names: Mapping[str, Any],
    functions: Mapping[str, Callable[[Any], Any]],
    power: Callable[[Any, Any], Any],
) -> _Interpretation[Any]:
    """The interpretation in values that have operators of their own.

    Parameters
    ----------
    constant : makes a value of a number.
    names, functions : what each name stands for.
    power : of a base and an exponent.
    """
    found: Any = SimpleNamespace(
        number=lambda number: constant(number.value),
        name=lambda name: names[name.name],
        call=lambda call: functions[call.function](interpret(call.argument, found)),
        negative=neg,
        joined=lambda left, step, right: OPERATORS[step.operator](left, right),
        power=lambda base, _, exponent: power(base, exponent),
    )
    return cast(_Interpretation[Any], found)


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


def mapped(tree: Tree, change: Callable[[Tree], Tree | None]) -> Tree:
    """A tree with others in place of parts: ``change`` gives them; None for a part of which the
    parts are looked at.
    """
    if (found := change(tree)) is not None:
        return found
    match tree:
        case Chain(first, steps):
            return Chain(
                mapped(first, change),
                tuple(s._replace(operand=mapped(s.operand, change)) for s in steps),
            )
        case Power(base, exponent, position):
            return Power(mapped(base, change), mapped(exponent, change), position)
        case Negative(operand, position):
            return Negative(mapped(operand, change), position)
        case Call(function, argument, position):
            return Call(function, mapped(argument, change), position)
    return tree


def replaced(tree: Tree, values: Mapping[str, Tree]) -> Tree:
    """A tree with others in place of names, all at once; the same object where none of them occurs."""
    if values.keys().isdisjoint(names_of(tree)):
        return tree
    return mapped(tree, lambda part: values.get(part.name) if isinstance(part, Name) else None)


_MAX_PLACES = 20
"""Numbers with more decimal places are written with an exponent."""


def to_text(tree: Tree) -> str:
    """A tree as text; one that was read is read again as the same tree, but for positions.

    A number without a finite decimal form, which no text has as one number, is written as a
    quotient.
    """
    match tree:
        case Name(name):
            return name
        case Number(value):
            return _number_text(value)
        case Chain(first, steps):
            lowest = PRODUCT if tree.is_sum else TIGHTER
            text = _within(first, lowest)
            for step in steps:
                operator = f" {step.operator} " if tree.is_sum else step.operator
                text += operator + _within(step.operand, lowest)
            return text
        case Power(base, exponent):
            inner = f"({to_text(base)})" if isinstance(base, Power | Negative) else _within(base)
            return f"{inner}^{_within(exponent)}"
        case Negative(operand):
            return f"-{_within(operand)}"
        case Call(function, argument):
            return f"{function}({to_text(argument)})"


def _within(tree: Tree, lowest: int = TIGHTER) -> str:
    """A tree as a part of another: in parentheses when it is a chain that binds less tightly than
    `lowest`.
    """
    text = to_text(tree)
    if isinstance(tree, Chain):
        return text if (SUM if tree.is_sum else PRODUCT) >= lowest else f"({text})"
    return f"({text})" if isinstance(tree, Number) and ("/" in text or "-" in text) else text


def _number_text(value: Fraction) -> str:
    """A number as it is read, or a quotient."""
    places = decimal_places(value)
    if places is None:
        return text_of(value)
    sign = "-" if value < 0 else ""
    digits = str(abs(value.numerator) * 10**places // value.denominator)
    if places == 0 and len(digits) <= MAX_DIGITS:
        return sign + digits
    if places == 0:
        zeros = min(len(digits) - len(digits.rstrip("0")), MAX_DECIMAL_EXPONENT)
        return f"{sign}{digits[: len(digits) - zeros]}e{zeros}"
    scale = min(places, MAX_DECIMAL_EXPONENT) if places > _MAX_PLACES else 0
    text = pointed(digits, scale - places)
    if len(text) > MAX_DIGITS:
        text = text.removeprefix("0")
    return sign + text + (f"e-{scale}" if scale else "")
