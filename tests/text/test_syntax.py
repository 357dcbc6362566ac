"""Trees of arithmetic: their shape, their positions, and that what is printed is read as the same
tree.
"""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.text.syntax import MAX_DEPTH, names_in, parse
from ptmcad.text.tree import (
    Call,
    Chain,
    Name,
    Negative,
    Number,
    Power,
    Step,
    Tree,
    interpret,
    names_of,
    to_text,
)


def without_positions(tree: Tree) -> Tree:
    match tree:
        case Number(value):
            return Number(value)
        case Name(name):
            return Name(name)
        case Negative(operand):
            return Negative(without_positions(operand))
        case Chain(first, steps):
            bare = tuple(Step(step.operator, without_positions(step.operand)) for step in steps)
            return Chain(without_positions(first), bare)
        case Power(base, exponent):
            return Power(without_positions(base), without_positions(exponent))
        case Call(function, argument):
            return Call(function, without_positions(argument))


# decimals of all lengths, the longest that are read among them
numbers = st.one_of(
    st.integers(0, 100).map(Fraction),
    st.builds(
        lambda m, e: Fraction(m) * Fraction(10) ** e,
        st.integers(0, 10**30),
        st.integers(-1000, 1000),
    ),
).map(Number)
here = st.just(0)
names = st.sampled_from(["rho", "L2", "th1", "cos", "e1"]).map(Name)


def joined(parts: st.SearchStrategy[Tree]) -> st.SearchStrategy[Tree]:
    def chain(operators: str) -> st.SearchStrategy[Tree]:
        steps = st.lists(
            st.builds(Step, st.sampled_from(operators), parts, here), min_size=1, max_size=4
        )
        return st.builds(Chain, parts, steps.map(tuple))

    return st.one_of(
        chain("+-"),
        chain("*/"),
        st.builds(Negative, parts, here),
        st.builds(Power, parts, parts, here),
        st.builds(Call, st.sampled_from(["cos", "sin"]), parts, here),
    )


trees = st.recursive(st.one_of(numbers, names), joined, max_leaves=12)


@given(trees)
def test_what_is_printed_is_read_as_the_same_tree(tree: Tree) -> None:
    text = to_text(tree)
    assert without_positions(parse(text)) == tree
    assert to_text(parse(text)) == text


@pytest.mark.parametrize(
    "text",
    [
        "." + "1" * 1999 + "e-1000",
        "1" * 2000 + "e1000",
        "0." + "0" * 1996 + "3e-1000",
        "1" * 1000 + "." + "1" * 999,
    ],
    ids=["decimals", "digits", "small", "both"],
)
def test_the_longest_numbers_are_printed_as_they_are_read(text: str) -> None:
    assert without_positions(parse(to_text(parse(text)))) == without_positions(parse(text))


def test_positions() -> None:
    tree = parse("rho - L2*cos(th2)^2")
    match tree:
        case Chain(
            Name("rho", 0),
            (Step("-", Chain(Name("L2", 6), (Step("*", Power(call, two, 17), 8),)), 4),),
        ):
            assert call == Call("cos", Name("th2", 13), 9)
            assert two == Number(Fraction(2), 18)
        case _:
            pytest.fail(repr(tree))


class Value:
    """An interpretation in rational numbers, with the order in which it was asked."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    def number(self, number: Number) -> Fraction:
        return number.value

    def name(self, name: Name) -> Fraction:
        self.asked.append(name.name)
        return Fraction(ord(name.name))

    def call(self, call: Call) -> Fraction:
        return 2 * interpret(call.argument, self)

    def negative(self, value: Fraction) -> Fraction:
        return -value

    def joined(self, left: Fraction, step: Step, right: Fraction) -> Fraction:
        self.asked.append(step.operator)
        return {"+": left + right, "-": left - right, "*": left * right, "/": left / right}[
            step.operator
        ]

    def power(self, base: Fraction, power: Power, exponent: Fraction) -> Fraction:
        return Fraction(base**exponent)


def test_a_long_sum_is_shallow() -> None:
    """As many terms as a text holds, on a stack that nesting alone fills."""
    tree = parse("+".join(["a"] * 5000))
    assert isinstance(tree, Chain)
    assert len(tree.steps) == 4999
    assert interpret(tree, Value()) == 97 * 5000
    deep = parse("(" * MAX_DEPTH + "a" + ")" * MAX_DEPTH)
    assert interpret(deep, Value()) == 97


def test_names() -> None:
    text = "rho - L2*cos(th2)^rho + 1e3"
    assert names_of(parse(text)) == ("rho", "L2", "th2")
    assert names_in(text) == ("rho", "L2", "cos", "th2")
    assert names_in("rho + (") == ("rho",)
