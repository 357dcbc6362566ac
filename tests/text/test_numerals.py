"""Numbers of any length as text, and the table that shows them."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.maps import shipped
from support.replacing import replace

from ptmcad.errors import ExpressionError
from ptmcad.text.numerals import (
    MAX_DIGITS,
    MAX_EXPONENT,
    approximate_text,
    decimal,
    exactly,
    fraction_of,
    integer_of,
    integer_text,
    magnitude,
    shortest_text,
    text_of,
)
from ptmcad.text.syntax import parse
from ptmcad.text.tree import Number


def test_the_table_of_a_damaged_result_ends() -> None:
    """An area between 10^4298 and 2 once made the table look for the magnitude of a negative number
    for ever.
    """
    result = shipped("fig2")
    first, *others = result.regions
    damaged = replace(
        result, regions=(replace(first, area=(Fraction(10) ** 4298, Fraction(2))), *others)
    )
    assert damaged.table().endswith("unknown")
    with pytest.raises(ValueError, match="magnitude"):
        magnitude(Fraction(-1))


@pytest.mark.parametrize("exponent", [0, 1, 17, 308, 4300, 100_000])
def test_magnitudes_of_any_size(exponent: int) -> None:
    """Exact at and just under each power of ten."""
    power = Fraction(10) ** exponent
    assert magnitude(power) == exponent
    assert magnitude(power - Fraction(1, 7)) == exponent - 1
    assert magnitude(1 / power) == -exponent


def test_limits_of_length_are_exact() -> None:
    """The longest number is read, one digit more is not; so for exponents, fractions and decimals."""
    nines = "9" * MAX_DIGITS
    assert fraction_of(nines) == 10**MAX_DIGITS - 1
    with pytest.raises(ValueError, match="the number 99999999999999999999"):
        fraction_of(nines + "9")
    assert fraction_of(f"1e{MAX_EXPONENT}") == 10**MAX_EXPONENT
    assert fraction_of(f"1e-{MAX_EXPONENT}") == Fraction(1, 10**MAX_EXPONENT)
    for sign in ("", "-"):
        with pytest.raises(ValueError, match="is too long"):
            fraction_of(f"1e{sign}{MAX_EXPONENT + 1}")
    half = "1/" + "7" * (2 * MAX_DIGITS - 2)  # as many characters as a text may have
    with pytest.raises(ValueError, match="is too long"):  # but the denominator is a number too
        fraction_of(half)
    with pytest.raises(ValueError, match=f"a number has {2 * MAX_DIGITS + 1} characters"):
        fraction_of("0" * (2 * MAX_DIGITS + 1))
    assert fraction_of("1/" + nines).denominator == 10**MAX_DIGITS - 1
    decimals = "0." + "0" * (MAX_DIGITS - 2) + "1"
    assert fraction_of(decimals) == Fraction(1, 10 ** (MAX_DIGITS - 1))
    with pytest.raises(ValueError, match="is too long"):
        fraction_of("0." + "0" * MAX_DIGITS + "1")


@pytest.mark.parametrize(
    "text",
    ["", "-", "1/", "/2", "1.", ".5", "1e", "e3", "1e1234567", "+1", "1/2e3", "1/-2", "١", "1 "],
)
def test_what_is_no_exact_number(text: str) -> None:
    with pytest.raises(ValueError, match="is not an exact number such as 7"):
        fraction_of(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [("-7/10", Fraction(-7, 10)), ("-0", Fraction(0)), ("1.25e2", Fraction(125)), ("-1.5e-3", Fraction(-3, 2000)),
     ("12.5", Fraction(25, 2)), ("1e-1", Fraction(1, 10)), ("0012", Fraction(12))],
)  # fmt: skip
def test_exact_numbers(text: str, value: Fraction) -> None:
    assert fraction_of(text) == value


def test_a_zero_denominator_is_named() -> None:
    with pytest.raises(ValueError, match="'1/00' has a zero denominator"):
        fraction_of("1/00")


@pytest.mark.parametrize("digits", [1, 3999, 4000, 4001, 4299, 4301, 8000, 8001, 20_011])
@pytest.mark.parametrize("head", ["1", "9", "-1", "-5"])
def test_long_integers_and_back(head: str, digits: int) -> None:
    """Split at powers of ten, with zeros in front of the lower half kept; 4300 is where Python
    refuses.
    """
    for tail in ("0", "7"):
        text = head + (digits - 1) * tail
        n = int(Fraction(head) * 10 ** (digits - 1)) + (
            0 if tail == "0" else _sevens(digits - 1, head)
        )
        assert integer_text(n) == text
        assert integer_of(text.removeprefix("-")) == abs(n)
        assert text_of(n) == text
    low, high = Fraction(n, 3 * abs(n) + 1), Fraction(1)
    assert text_of(low).count("/") == 1
    assert fraction_of(text_of(low)) == low
    assert text_of(high) == "1"


def _sevens(digits: int, head: str) -> int:
    value = 7 * (10**digits - 1) // 9
    return -value if head.startswith("-") else value


@pytest.mark.parametrize(
    ("value", "text"),
    [(Fraction(-1, 3), "-0.333333333"), (Fraction(1, 3), "0.333333333"), (Fraction(0), "0"), (Fraction(-2), "-2"),
     (Fraction(-2, 3), "-0.666666666"), (Fraction(-(10**25)), "-1.0e25"), (Fraction(-1, 10**9), "-1.0e-9"),
     (Fraction(123456789123), "123456789000"), (Fraction(-123456789987, 1000), "-123456789"),
     (Fraction(1, 10**6), "0.000001"), (Fraction(1, 10**7), "0.0000001"), (Fraction(1, 10**8), "1.0e-8"),
     (Fraction(10**20), "100000000000000000000"), (Fraction(10**21), "1.0e21"), (Fraction(999, 1000), "0.999"),
     (Fraction(25, 2), "12.5"), (Fraction(99999999999, 10), "9999999990")],
)  # fmt: skip
def test_approximations_are_rounded_towards_zero(value: Fraction, text: str) -> None:
    assert approximate_text(value) == text


@pytest.mark.parametrize(
    ("value", "down", "up"),
    [(Fraction(1, 3), "0.333", "0.334"), (Fraction(2), "2", "2"), (Fraction(9999, 10), "999", "1000"),
     (Fraction(12345), "12300", "12400"), (Fraction(1, 8), "0.125", "0.125"), (Fraction(0), "0", "0"),
     (Fraction(10**30 + 1), "1.0e30", "1.01e30"), (Fraction(1, 3 * 10**9), "3.33e-10", "3.34e-10")],
)  # fmt: skip
def test_decimals_bound_from_the_side_asked_for(value: Fraction, down: str, up: str) -> None:
    assert decimal(value, up=False, digits=3) == down
    assert decimal(value, up=True, digits=3) == up
    assert fraction_of(down) <= value <= fraction_of(up)


def test_decimals_have_18_digits_unless_told_otherwise() -> None:
    assert decimal(Fraction(1, 3), up=False) == "0." + 18 * "3"


@pytest.mark.parametrize(
    ("value", "text"),
    [(Fraction(1, 8), "0.125"), (Fraction(-1, 8), "-0.125"), (Fraction(3), "3"), (Fraction(1, 3), "1/3"),
     (Fraction(1, 10**6), "0.000001"), (Fraction(1, 10**7), "1e-7"), (Fraction(-1, 10**7), "-1e-7"),
     (Fraction(3, 10**7), "0.0000003"), (Fraction(1, 10**24), "1e-24"), (Fraction(1, 10**25), f"1/{10**25}"),
     (Fraction(-25, 2), "-12.5"), (Fraction(-7, 100), "-0.07")],
)  # fmt: skip
def test_the_shortest_text(value: Fraction, text: str) -> None:
    assert shortest_text(value) == text
    assert fraction_of(text) == value


def test_fractions_of_numpys_integers_are_plain_ones() -> None:
    value = exactly(Fraction(np.int64(3), 400))
    assert value == Fraction(3, 400)
    assert type(value.numerator) is int is type(value.denominator)


def told(read: Callable[[str], object], text: str) -> object:
    """What is read of a text, None where it is refused."""
    try:
        return read(text)
    except (ValueError, ExpressionError):
        return None


def number_in(text: str) -> Fraction | None:
    """The number that the text is as an expression, None of one that is more than a number."""
    tree = parse(text)
    return tree.value if isinstance(tree, Number) else None


@given(st.from_regex(r"(0|[1-9][0-9]{0,30})(\.[0-9]{1,30})?(e-?[0-9]{1,3})?", fullmatch=True))
def test_decimals_of_results_and_of_expressions_are_the_same(text: str) -> None:
    assert fraction_of(text) == number_in(text) == Fraction(text)


@given(
    st.text("0123456789.eE+", min_size=1, max_size=8)
    | st.from_regex(r"0?[0-9]*\.?[0-9]*([eE][+-]?[0-9])?", fullmatch=True)
)
def test_decimals_that_one_of_them_refuses(text: str) -> None:
    """Results are written without a sign of the exponent and with digits around the point; records
    without zeros that lead."""
    stored, expressed = told(fraction_of, text), told(number_in, text)
    assert {stored, expressed} <= {None, told(Fraction, text)}
    if stored is not None and expressed is None:
        assert re.match("0[0-9]", text)
    if expressed is not None and stored is None:
        assert re.search(r"[E+]|^\.|\.(?![0-9])", text)
