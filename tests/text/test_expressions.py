"""The parser against Python's own fractions, and hostile texts."""

from __future__ import annotations

import time
from fractions import Fraction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ptmcad.errors import ExpressionError, PoleError
from ptmcad.text.expressions import Expression, axis, constant
from ptmcad.text.parsing import parse, rational
from ptmcad.text.syntax import names_in

NAMES = {"rho": axis(0), "L2": axis(1)}
small = st.fractions(min_value=-5, max_value=5, max_denominator=12)


@st.composite
def trees(draw: st.DrawFn, depth: int = 4) -> tuple[str, object]:
    """A text, and the same as a function of (rho, L2) computed by `fractions`."""
    if depth == 0 or draw(st.integers(0, 4)) == 0:
        kind = draw(st.sampled_from(["rho", "L2", "number"]))
        if kind == "rho":
            return "rho", lambda x, y: x
        if kind == "L2":
            return "L2", lambda x, y: y
        text = draw(st.sampled_from(["0", "1", "2", "0.5", ".25", "1e-2", "3.", "12.5e1", "7"]))
        return text, lambda x, y, value=Fraction(text): value
    operator = draw(st.sampled_from(["+", "-", "*", "/", "^", "neg"]))
    left, f = draw(trees(depth=depth - 1))
    if operator == "neg":
        return f"-({left})", lambda x, y: -f(x, y)
    if operator == "^":
        n = draw(st.integers(-2, 3))
        sign = draw(st.sampled_from(["^", "**"]))
        return f"({left}){sign}{n}", lambda x, y: f(x, y) ** n
    right, g = draw(trees(depth=depth - 1))
    combine = {
        "+": lambda x, y: f(x, y) + g(x, y),
        "-": lambda x, y: f(x, y) - g(x, y),
        "*": lambda x, y: f(x, y) * g(x, y),
        "/": lambda x, y: f(x, y) / g(x, y),
    }[operator]
    return f"({left}) {operator} ({right})", combine


@given(trees(), small, small)
def test_values_equal_those_of_fractions(
    tree: tuple[str, object], x: Fraction, y: Fraction
) -> None:
    text, function = tree
    try:
        expected = function(x, y)
    except ZeroDivisionError:
        assume(False)
    expression = parse(text, NAMES)
    assert expression.evaluate(x, y) == expected
    assert parse(expression.to_text(("rho", "L2")), NAMES).evaluate(x, y) == expected


@given(trees())
def test_normal_form(tree: tuple[str, object]) -> None:
    try:
        expression = parse(tree[0], NAMES)
    except ExpressionError as error:
        assert "division by zero" in str(error)
        return
    for terms in (expression.numerator, expression.denominator):
        assert list(terms) == sorted(terms, key=lambda term: term[:2])
        assert len({term[:2] for term in terms}) == len(terms)
        assert all(c != 0 for _, _, c in terms)
    assert expression.denominator
    if len(expression.denominator) == 1 and expression.denominator[0][:2] == (0, 0):
        assert expression.denominator[0][2] == 1


@given(st.text(max_size=40))
def test_any_text_is_an_expression_or_a_refusal(text: str) -> None:
    try:
        assert isinstance(parse(text, NAMES), Expression)
    except ExpressionError as error:
        assert error.position is None or 0 <= error.position <= len(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.1", Fraction(1, 10)),
        ("-0.1", Fraction(-1, 10)),
        ("-1/10", Fraction(-1, 10)),
        ("1e-30", Fraction(1, 10**30)),
        ("3/4", Fraction(3, 4)),
        (
            "1.234567890123456789012345678901234567891",
            Fraction(1234567890123456789012345678901234567891, 10**39),
        ),
        ("-2^2", Fraction(-4)),
        ("2^-2", Fraction(1, 4)),
        ("2^3^2", Fraction(512)),
        ("(-1)^99999", Fraction(-1)),
        ("0^0", Fraction(1)),
        ("1-2-3", Fraction(-4)),
        ("8/4/2", Fraction(1)),
        ("2*-3", Fraction(-6)),
        ("+5", Fraction(5)),
    ],
)
def test_constants(text: str, value: Fraction) -> None:
    assert rational(text) == value


@pytest.mark.parametrize(
    ("text", "part", "position"),
    [
        ("(" * 100_000, "characters", None),
        ("(" * 5_000, "levels of nesting", 101),
        ("-" * 5_000 + "1", "levels of nesting", 101),
        ("1" * 10**6, "characters", None),
        ("1" * 3_000, "digits", 0),
        ("1e999999999", "exponent", 0),
        ("rho**1000000000", "at most 64", 3),
        ("2^2^2^2^2^2^2", "bits", 5),
        ("(rho+L2+1)^64", "terms", 10),
        ("*".join(["(rho + L2 + 1)"] * 60), "terms", None),
        ("rho.__class__", "'.'", 3),
        ("__import__('os')", "'_'", 0),
        ("1_000", "'_'", 1),
        ("ρ", "write rho", 0),
        ("−1", "write -", 0),
        ("1١", "U+0661", 1),
        ("0,5", "decimal point", 1),
        ("nan", "not a number", 0),
        ("Inf", "not a number", 0),
        ("010", "leading zeros", 0),
        ("0x10", "side by side", 1),
        ("2rho", "write * between", 1),
        ("2 rho", "operator missing", 2),
        ("roh", "did you mean 'rho'?", 0),
        ("1/0", "division by zero", 1),
        ("1/(rho-rho)", "division by zero", 1),
        ("0^-1", "division by zero", 1),
        ("rho^L2", "not an integer", 3),
        ("2^0.5", "not an integer", 1),
        ("", "empty", 0),
        ("1+", "ends too early", 2),
        ("(1", "never closed", 0),
        ("1)", "no '('", 1),
        ("*1", "missing", 0),
        ("rho(1)", "operator missing", 3),
    ],
    ids=lambda value: repr(value)[:20],
)
def test_refusals_are_fast_and_placed(text: str, part: str, position: int | None) -> None:
    start = time.perf_counter()
    with pytest.raises(ExpressionError) as caught:
        parse(text, NAMES)
    assert time.perf_counter() - start < 2
    assert part in str(caught.value)
    if position is not None:
        assert caught.value.position == position
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("value", [0.1j, True, None, [1]])
def test_inexact_values_are_refused(value: object) -> None:
    with pytest.raises(ExpressionError, match="not an exact number"):
        parse(value)


def test_a_pole_is_named() -> None:
    with pytest.raises(PoleError, match="x = 1, y = 0"):
        parse("1/(rho-1)", NAMES).evaluate(Fraction(1), Fraction(0))


def test_cancellation() -> None:
    assert parse("(rho^2-L2^2)/(rho-L2)", NAMES) == axis(0) + axis(1)
    assert parse("rho/(2*rho*L2)", NAMES) == parse("1/(2*L2)", NAMES)
    assert (1 - axis(0)) / (axis(0) - 1) == constant(-1)
    assert 2 / constant(4) == constant(Fraction(1, 2))


def test_names_in() -> None:
    assert names_in("2*rho + F*rho - 1e3") == ("rho", "F")
