"""Discriminants and resultants modulo primes: against the ones in integers, against factors that are known, and what a
planted fault does."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from itertools import chain

import pytest
from flint import fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra import heights, modular, orders, resultants
from ptmcad.algebra.resultants import nothing

COEFFICIENT = st.lists(st.integers(-9, 9) | st.integers(-(10**25), 10**25) | st.just(0), max_size=4)


@st.composite
def polynomials(draw: st.DrawFn, least: int = 1) -> list[fmpz_poly]:
    """Coefficients of v^0, v^1, ..., the last one not zero."""
    rows = [fmpz_poly(draw(COEFFICIENT)) for _ in range(draw(st.integers(least, 5)) + 1)]
    assume(rows[-1] != 0)
    return rows


def times(*factors: Sequence[fmpz_poly]) -> list[fmpz_poly]:
    """The product of polynomials in v."""
    product = [fmpz_poly([1])]
    for factor in factors:
        grown = [fmpz_poly([0])] * (len(product) + len(factor) - 1)
        for i, a in enumerate(product):
            for j, b in enumerate(factor):
                grown[i + j] += a * b
        product = grown
    return product


def clustered() -> list[fmpz_poly]:
    """Six roots close to 1 where u = 3, three close to infinity where u^2 = -1, two close to 0 where u is infinite."""
    u = fmpz_poly([0, 1])
    near_one = [[-1 - k * (u - 3), fmpz_poly([1])] for k in range(1, 7)]
    far = [[fmpz_poly([k]), u**2 + 1] for k in (2, 3, 5)]
    return times(*near_one, *far, [fmpz_poly([7]), u], [fmpz_poly([11]), u])


@given(polynomials(2))
@settings(max_examples=examples(60))
def test_discriminants_are_those_in_integers(p: list[fmpz_poly]) -> None:
    assert modular.discriminant(p, nothing) == resultants.discriminant(p)


@given(polynomials(), polynomials())
@settings(max_examples=examples(60))
def test_resultants_are_those_in_integers(p: list[fmpz_poly], q: list[fmpz_poly]) -> None:
    assert modular.resultant(p, q, nothing) == resultants.resultant(p, q)


@given(polynomials(2))
@settings(max_examples=examples(60))
def test_bounds_hold(p: list[fmpz_poly]) -> None:
    d = resultants.discriminant(p)
    assert orders.discriminant_degree(p) >= d.degree()
    assert modular.discriminant_bits(p) >= d.height_bits()
    for unit in (-7, 0, 9):
        closer = heights.discriminant_bits(p, orders.discriminant_degree(p), unit)
        assert closer is None or closer >= d.height_bits()
    assert d == 0 or all(d % f**e == 0 for f, e in orders.discriminant_factors(p))


@given(polynomials(), polynomials())
@settings(max_examples=examples(60))
def test_bounds_of_resultants_hold(p: list[fmpz_poly], q: list[fmpz_poly]) -> None:
    found = resultants.resultant(p, q)
    assert orders.resultant_degree(p, q) >= found.degree()
    assert modular.resultant_bits(p, q) >= found.height_bits()


@given(st.lists(st.lists(st.integers(0, 6), min_size=2, max_size=7), min_size=2, max_size=2))
@settings(max_examples=examples(60))
def test_bounds_of_degrees_are_sharp(degrees: list[list[int]]) -> None:
    """For leading coefficients at random the resultant has the degree, and it is no larger than by a single slope."""
    source = random.Random(1)
    p, q = ([fmpz_poly([0] * d + [source.getrandbits(40) + 1]) for d in ds] for ds in degrees)
    n, m = len(p) - 1, len(q) - 1
    found = orders.resultant_degree(p, q)
    assert found == resultants.resultant(p, q).degree()
    for a in (Fraction(k, 3) for k in range(-18, 19)):
        offsets = [max(d + a * i for i, d in enumerate(ds)) for ds in degrees]
        assert found <= m * offsets[0] + n * offsets[1] - a * n * m


def test_roots_that_meet_are_known_factors() -> None:
    p = clustered()
    known = {str(f): e for f, e in orders.discriminant_factors(p)}
    assert known["x + (-3)"] == 6 * 5  # fifteen pairs, squared
    assert known["x^2 + 1"] == 3 * 2
    d = modular.discriminant(p, nothing)
    assert d == resultants.discriminant(p)
    assert d.degree() <= orders.discriminant_degree(p)


def test_a_bound_from_the_circle_is_closer() -> None:
    # Chebyshev's roots: Sylvester's rows are far from orthogonal
    p = [fmpz_poly([c, c // 3, 1]) for c in map(int, fmpz_poly.chebyshev_t(24).coeffs())]
    true = resultants.discriminant(p).height_bits()
    closer = heights.discriminant_bits(p, orders.discriminant_degree(p), -1)
    assert closer is not None
    assert true <= closer < true + (modular.discriminant_bits(p) - true) / 2


def test_coefficients_too_far_apart_have_no_bound_in_doubles() -> None:
    assert heights.discriminant_bits([fmpz_poly([1]), fmpz_poly([1, 2**300]), fmpz_poly([3])], 2, 0) is None


@pytest.mark.parametrize("fault", ["prime", "degree", "bits", "factor"])
def test_a_planted_fault_is_caught(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    p = clustered()
    bound = orders.discriminant_degree(p)
    if fault == "prime":
        wrong, at = [2], modular._discriminant_at

        def faulty(fibre: fmpz_poly, n: int) -> modular.ValueModulo:
            value = at(fibre, n)

            def once(prime: int) -> int:
                if wrong:
                    return (value(prime) + wrong.pop()) % prime
                return value(prime)

            return once

        monkeypatch.setattr(modular, "_discriminant_at", faulty)
    elif fault == "degree":
        monkeypatch.setattr(orders, "discriminant_degree", lambda p: bound - 1)
    elif fault == "bits":
        monkeypatch.setattr(heights, "discriminant_bits", lambda *_: 3)
    else:
        monkeypatch.setattr(orders, "discriminant_factors", lambda p: ((fmpz_poly([-5, 1]), 1),))
    with pytest.raises(modular.FaultyValue):
        modular.discriminant(p, nothing)


def test_a_prime_that_divides_a_known_value_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    p = clustered()
    # among the points are such at which u^2 + 1 is divisible by 5 and by 17
    primes = modular.primes()
    monkeypatch.setattr(modular, "primes", lambda: chain([5, 17], primes))
    assert modular.discriminant(p, nothing) == resultants.discriminant(p)


def test_long_polynomials_go_modulo_primes(monkeypatch: pytest.MonkeyPatch) -> None:
    p = [fmpz_poly([(i * j + 3 * i + j * j) % 11 - 5 for j in range(24)]) for i in range(25)]
    asked: list[int] = []
    plain = modular.discriminant

    def spied(p: Sequence[fmpz_poly], check: modular.Check) -> fmpz_poly:
        asked.append(len(p))
        return plain(p, check)

    monkeypatch.setattr(modular, "discriminant", spied)
    found = resultants.discriminant(p)
    assert asked == [25]
    assert found(3) == fmpz_poly([c(3) for c in p]).discriminant()
    resultants.discriminant(clustered())
    assert asked == [25]
