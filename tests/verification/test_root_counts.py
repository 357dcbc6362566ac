"""The verification's counts of real roots, and the roots that they number."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import fmpq, fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification import rootcounts


@st.composite
def with_roots(draw: st.DrawFn) -> tuple[fmpz_poly, list[Fraction]]:
    roots = draw(st.lists(st.fractions(-3, 3, max_denominator=4), min_size=1, max_size=8))
    p = fmpz_poly([1])
    for r in roots:
        p *= fmpz_poly([-r.numerator, r.denominator])
    for m in draw(st.lists(st.integers(-2, 2), max_size=3)):
        p *= fmpz_poly([m * m + 3, 2 * m, 1])
    return p, roots


@given(with_roots(), st.fractions(-4, 4, max_denominator=4), st.fractions(-4, 4, max_denominator=4))
@settings(max_examples=examples(60))
def test_roots_are_counted(
    found: tuple[fmpz_poly, list[Fraction]], low: Fraction, high: Fraction
) -> None:
    p, roots = found
    assume(low < high)
    ends = from_fraction(low), from_fraction(high)
    coefficients = tuple(int(c) for c in p.coeffs())
    assert rootcounts.roots_above(coefficients, ends[0]) == sum(low < r for r in set(roots))
    assert rootcounts.roots_between(p, *ends) == sum(low < r < high for r in set(roots))


@pytest.mark.parametrize("power", [2, 3])
def test_polynomials_in_a_power_of_the_variable(power: int) -> None:
    p = fmpz_poly([-2, 1]) * fmpz_poly([3, 1]) * fmpz_poly([-5, 7])
    raised = p.inflate(power)
    expected = {2: (2, 2), 3: (2, 1)}[power]
    assert rootcounts.roots_between(raised, fmpq(0), fmpq(2)) == expected[0]
    assert rootcounts.roots_between(raised, fmpq(-2), fmpq(0)) == expected[1]


def test_close_roots_ask_for_more_precision() -> None:
    p = (
        fmpz_poly([-1, 10**40])
        * fmpz_poly([-1, 10**40 + 1])
        * fmpz_poly([1, 0, 1])
        * fmpz_poly([2, 1, 1])
    )
    assert rootcounts.roots_between(p, fmpq(0), fmpq(1)) == 2
    assert rootcounts.roots_between(p, fmpq(1, 10**40 + 1), fmpq(1)) == 1


def test_a_root_in_the_middle_is_found() -> None:
    assert rootcounts.numbered_root(fmpz_poly([0, 1, 0, 1]), fmpq(-1), fmpq(1), 0) == 0
