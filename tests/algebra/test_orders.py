"""Bounds for the degrees of discriminants and resultants: that they hold, and that they are sharp."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from flint import fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra import resultants

COEFFICIENT = st.lists(st.integers(-9, 9) | st.integers(-(10**25), 10**25) | st.just(0), max_size=4)


@st.composite
def polynomials(draw: st.DrawFn, least: int = 1) -> list[fmpz_poly]:
    """Coefficients of v^0, v^1, ..., the last one not zero."""
    rows = [fmpz_poly(draw(COEFFICIENT)) for _ in range(draw(st.integers(least, 5)) + 1)]
    assume(rows[-1] != 0)
    return rows


@given(polynomials(2))
@settings(max_examples=examples(60))
def test_bounds_hold(p: list[fmpz_poly]) -> None:
    d = resultants.discriminant(p)
    assert resultants.discriminant_degree(p) >= d.degree()


@given(polynomials(), polynomials())
@settings(max_examples=examples(60))
def test_bounds_of_resultants_hold(p: list[fmpz_poly], q: list[fmpz_poly]) -> None:
    found = resultants.resultant(p, q)
    assert resultants.resultant_degree(p, q) >= found.degree()


@given(st.lists(st.lists(st.integers(0, 6), min_size=2, max_size=7), min_size=2, max_size=2))
@settings(max_examples=examples(60))
def test_bounds_of_degrees_are_sharp(degrees: list[list[int]]) -> None:
    """For leading coefficients at random the resultant has the degree, and it is no larger than by
    a single slope.
    """
    source = random.Random(1)
    p, q = ([fmpz_poly([0] * d + [source.getrandbits(40) + 1]) for d in ds] for ds in degrees)
    n, m = len(p) - 1, len(q) - 1
    found = resultants.resultant_degree(p, q)
    assert found == resultants.resultant(p, q).degree()
    for a in (Fraction(k, 3) for k in range(-18, 19)):
        offsets = [max(d + a * i for i, d in enumerate(ds)) for ds in degrees]
        assert found <= m * offsets[0] + n * offsets[1] - a * n * m


@given(polynomials(), polynomials())
@settings(max_examples=examples(60))
def test_discriminants_and_resultants_commute_with_values(
    p: list[fmpz_poly], q: list[fmpz_poly]
) -> None:
    """At an integer at which no degree falls, beyond the points from which they are interpolated."""
    u = 10**6 + 3
    left, right = (fmpz_poly([c(u) for c in r]) for r in (p, q))
    assume(left.degree() == len(p) - 1 and right.degree() == len(q) - 1)
    assert resultants.resultant(p, q)(u) == left.resultant(right)
    if len(p) > 2:
        assert resultants.discriminant(p)(u) == left.discriminant()


@given(polynomials(), polynomials())
@settings(max_examples=examples(60))
def test_values_modulo_primes_give_what_integers_give(
    p: list[fmpz_poly], q: list[fmpz_poly]
) -> None:
    """Also where leading coefficients vanish at points, or coefficients of v^0 do."""
    in_integers = resultants.discriminant(p), resultants.resultant(p, q)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(resultants, "LONG", 1)
        patch.setattr(resultants, "CALL", -(10**9))
        assert (resultants.discriminant(p), resultants.resultant(p, q)) == in_integers
