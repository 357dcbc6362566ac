"""Polynomials in two variables on lines: the same, but for a positive factor, as by evaluating each
coefficient.
"""

from __future__ import annotations

from flint import fmpq, fmpz_poly
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra.polynomials import Restrictions, univariate

ROWS = st.lists(
    st.lists(st.integers(-(2**70), 2**70), max_size=6).map(fmpz_poly), min_size=1, max_size=6
).filter(lambda rows: rows[-1] != 0)


@given(ROWS, st.integers(-(2**40), 2**40), st.integers(1, 2**40))
@settings(max_examples=examples(100))
def test_a_line_is_that_by_coefficients(rows: list[fmpz_poly], p: int, q: int) -> None:
    u = fmpq(p, q)
    found, expected = Restrictions(tuple(rows)).at(u), univariate(tuple(rows), u)
    assert found.degree() == expected.degree()
    if expected:
        # the leading coefficients' signs agree, so the factor is positive
        assert found.leading_coefficient() * expected.leading_coefficient() > 0
    assert found * expected.leading_coefficient() == expected * found.leading_coefficient()
