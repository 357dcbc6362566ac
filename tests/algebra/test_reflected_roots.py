"""Roots of a polynomial that a reflection maps to itself: the same as without its help."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import pytest
from flint import fmpq, fmpz_poly
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra.real_roots import RealRoot, isolate, sign_at
from ptmcad.algebra.reflections import isolate_reflected
from ptmcad.text.flint_numbers import from_fraction

SMALL = st.fractions(min_value=-4, max_value=4, max_denominator=6)
SQUARES = st.lists(
    st.fractions(min_value=-9, max_value=30, max_denominator=9), min_size=1, max_size=6, unique=True
)


def with_roots(squares: list[Fraction]) -> fmpz_poly:
    """The polynomial in W with these roots."""
    product = fmpz_poly([1])
    for square in squares:
        product *= fmpz_poly([-square.numerator, square.denominator])
    return product


def reflected(q: fmpz_poly, middle: fmpq, d: int) -> fmpz_poly:
    """q(d^2 (v - middle)^2), times a positive integer."""
    p, q_of = int(middle.p), int(middle.q)
    line = fmpz_poly([-p, q_of]) * d  # q_of d (v - middle)
    total = fmpz_poly([0])
    n = q.degree()
    for k, c in enumerate(q.coeffs()):
        total += c * line ** (2 * k) * q_of ** (2 * (n - k))
    return total


def the_same(found: tuple[RealRoot, ...], expected: tuple[RealRoot, ...]) -> bool:
    """Whether intervals are disjoint, in order, with ends that are no roots, and each meets its own
    one alone.
    """
    assert len(found) == len(expected)
    for a, b in pairwise(found):
        assert a.high <= b.low
        assert not (a.is_rational and b.is_rational and a.low == b.low)
    for root, other in zip(found, expected, strict=True):
        if root.is_rational:
            assert sign_at(root.polynomial, root.low) == 0
            assert other.low <= root.low <= other.high
        else:
            assert sign_at(root.polynomial, root.low) * sign_at(root.polynomial, root.high) == -1
            low, high = max(root.low, other.low), min(root.high, other.high)
            inside = (
                sign_at(root.polynomial, low) * sign_at(root.polynomial, high) <= 0
                if low < high
                else low == high
            )
            assert inside
    return True


@given(
    SQUARES,
    SMALL,
    st.integers(1, 4),
    SMALL,
    st.fractions(min_value=Fraction(1, 5), max_value=8, max_denominator=5),
)
@settings(max_examples=examples(200))
def test_roots_are_those_found_without_the_reflection(
    squares: list[Fraction], middle: Fraction, d: int, low: Fraction, width: Fraction
) -> None:
    q, m = with_roots(squares), from_fraction(middle)
    p, window = reflected(q, m, d), (from_fraction(low), from_fraction(low + width))
    try:
        expected = isolate(p, *window)
    except ValueError:
        with pytest.raises(ValueError, match="not squarefree"):
            isolate_reflected(p, q, m, d, *window)
        return
    assert the_same(isolate_reflected(p, q, m, d, *window), expected)


def test_a_multiple_root_outside_of_the_interval_is_no_matter() -> None:
    """(9 v^2 - 49)^2 (v^2 - 1), one of the double roots between the ends or none."""
    q = with_roots([Fraction(49, 9), Fraction(49, 9), Fraction(1)])
    p = reflected(q, fmpq(0), 1)
    found = isolate(p, fmpq(-2), fmpq(2))
    assert the_same(isolate_reflected(p, q, fmpq(0), 1, fmpq(-2), fmpq(2)), found)
    assert (
        isolate_reflected(p, q, fmpq(0), 1, fmpq(5, 2), fmpq(3)) == ()
    )  # a double root is within reach, and outside
    with pytest.raises(ValueError, match="not squarefree"):
        isolate_reflected(p, q, fmpq(0), 1, fmpq(-4), fmpq(2))
