"""Signs over the window: known by construction, and Bernstein bounds against values."""

from __future__ import annotations

from fractions import Fraction
from math import comb

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.expressions import axis, parse
from ptmcad.positivity import bernstein, find_negative, find_nonpositive, find_pole
from ptmcad.slice import Axis

AXES = (Axis("rho", Fraction(0), Fraction(2)), Axis("F", Fraction(-3), Fraction(1)))
NAMES = {"rho": axis(0), "F": axis(1)}
coefficients = st.dictionaries(
    st.tuples(st.integers(0, 3), st.integers(0, 3)), st.integers(-5, 5).filter(bool), min_size=1, max_size=6
)
units = st.fractions(min_value=0, max_value=1, max_denominator=9)


@given(coefficients, units, units)
def test_the_bernstein_form_has_the_polynomial_values(
    polynomial: dict[tuple[int, int], int], s: Fraction, t: Fraction
) -> None:
    terms = tuple((i, j, Fraction(c)) for (i, j), c in sorted(polynomial.items()))
    (m, n) = (max(i for i, _ in polynomial), max(j for _, j in polynomial))
    x, y = 2 * s, -3 + 4 * t
    form = bernstein(terms, ((AXES[0].low, AXES[0].high), (AXES[1].low, AXES[1].high)))
    weights = [
        comb(m, p) * s**p * (1 - s) ** (m - p) * comb(n, q) * t**q * (1 - t) ** (n - q)
        for p in range(m + 1)
        for q in range(n + 1)
    ]
    assert sum(w * b for w, b in zip(weights, form, strict=True)) == sum(c * x**i * y**j for i, j, c in terms)


@pytest.mark.parametrize(
    ("text", "found"),
    [("rho", False), ("rho*(2-rho)", False), ("1+F^2", False), ("4+F", False), ("rho-1", True), ("F", True),
     ("1/(1+rho)", False), ("1/(-1-rho)", True), ("rho^2-rho+1/5", True), ("-rho", True)],
)  # fmt: skip
def test_lengths(text: str, found: bool) -> None:
    assert (find_nonpositive(parse(text, NAMES), AXES) is not None) == found


@pytest.mark.parametrize(
    ("text", "found"),
    [("0*rho", False), ("(rho-1)^2", False), ("rho*(F+3)", False), ("rho-1/8", True), ("(rho-1)^2-1/1000", True),
     ("1/(-1-rho)", True), ("(rho-1)^2/(-1-rho)", True), ("rho-2", True)],
)  # fmt: skip
def test_free_lengths_may_be_zero(text: str, found: bool) -> None:
    assert (find_negative(parse(text, NAMES), AXES) is not None) == found


@pytest.mark.parametrize(
    ("text", "found"),
    [("1/rho", False), ("1/(rho-2)", False), ("1/(rho-1)", True), ("1/(rho^2+F^2)", False), ("1/(rho+F)", True),
     ("1/(rho-1)^2", True), ("rho", False)],
)  # fmt: skip
def test_poles(text: str, found: bool) -> None:
    assert (find_pole(parse(text, NAMES), AXES) is not None) == found


def test_a_value_too_long_to_be_written_out_is_named() -> None:
    """A 17th power at a point of 400 digits has 6800 of them, more than Python converts."""
    axes = (Axis("rho", Fraction(1), 1 + Fraction(1, 10**400)), Axis("F", Fraction(1), Fraction(4)))
    found = find_nonpositive(parse("0 - rho^17", NAMES), axes)
    assert found is not None
    assert found.startswith("about -1 at rho = ")
