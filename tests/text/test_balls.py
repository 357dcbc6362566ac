"""Enclosures of balls: they hold the ball, settle its digits, and are no wider than that takes."""

from __future__ import annotations

from fractions import Fraction

from flint import arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.text.balls import enclosed, exact


@given(
    st.integers(-(10**30), 10**30).filter(bool), st.integers(1, 10**30), st.integers(-200, 200), st.integers(1, 30),
    st.integers(10, 300),
)  # fmt: skip
def test_an_enclosure_holds_the_ball_and_settles_its_digits(
    numerator: int, denominator: int, exponent: int, digits: int, bits: int
) -> None:
    with ctx.workprec(bits):
        ball = arb(fmpq(numerator, denominator)) * arb(2) ** exponent
        found = enclosed(ball, digits)
        low, high = exact(ball.lower()), exact(ball.upper())
    value = Fraction(numerator, denominator) * Fraction(2) ** exponent
    if found is None:
        assert ball.rel_accuracy_bits() < 3.4 * digits + 20
        return
    if ball.is_exact():
        assert found.low == found.high == value
        return
    assert found.low <= low <= value <= high <= found.high
    assert found.settles(digits)
    assert found.high - found.low <= abs(value) / Fraction(10) ** digits
