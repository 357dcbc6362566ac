"""Elements of real number fields: what a prime shows and what an expression encloses, against
residues over Q.
"""

from __future__ import annotations

import pytest
from flint import arb, arb_poly, ctx, fmpq, fmpq_poly, fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra import number_field
from ptmcad.algebra.number_field import (
    FieldElement,
    Modulus,
    RealField,
    RealPoint,
    rational_roots,
    value_at,
)
from ptmcad.algebra.real_roots import isolate
from ptmcad.text.flint_numbers import from_fraction, to_fraction

NUMBERS = st.fractions(-4, 4, max_denominator=12).map(from_fraction)
PRIMES = (2, 3, 5, 7, 11, 2**61 - 1)
"""Small ones divide denominators and leading coefficients, and vanish where nothing is zero."""


@st.composite
def fields(draw: st.DrawFn) -> RealField:
    p = fmpz_poly(draw(st.lists(st.integers(-9, 9), min_size=3, max_size=5)))
    assume(p.degree() > 0)
    factors = [f for f, _ in p.factor()[1] if f.degree() > 0]
    factor = draw(st.sampled_from(factors))
    roots = isolate(factor, fmpq(-100), fmpq(100))
    assume(roots)
    return RealField(Modulus(factor), draw(st.sampled_from(roots)))


@st.composite
def expressions(draw: st.DrawFn, field: RealField) -> tuple[FieldElement, fmpq_poly]:
    """An element and its residue, computed step by step over Q."""
    modulus = field.modulus.polynomial

    def leaf() -> tuple[FieldElement, fmpq_poly]:
        if draw(st.booleans()):
            c = draw(NUMBERS)
            return field.constant(c), fmpq_poly([c])
        p = fmpq_poly(draw(st.lists(NUMBERS, min_size=1, max_size=4)))
        return field.element(p), p % modulus

    (e, r), (f, s) = leaf(), leaf()
    for step in draw(st.lists(st.sampled_from("+-*/t2pc"), max_size=6)):
        if step == "+":
            e, r = e + f, r + s
        elif step == "-":
            e, r = f - e, s - r
        elif step == "*":
            e, r = e * f, r * s % modulus
        elif step == "/":
            assume(r != 0)
            g, u, _ = r.xgcd(modulus)
            e, r = f * e.inverse(), s * (u / g[0]) % modulus
        elif step == "t":
            c = draw(NUMBERS)
            e, r = e.times(c), r * c
        elif step == "2":
            e, r = e * e, r * r % modulus
        elif step == "c":  # cancels
            e, r = e - e + f, s
        else:
            c = draw(NUMBERS)
            e = value_at(
                RealPoint(field, (e, f), 1), {(2, 1): c, (0, 0): fmpq(1), (0, 3): fmpq(-1)}
            )
            r = (c * r * r * s + 1 - s * s * s) % modulus
    return e, r


@pytest.mark.parametrize(
    "prime", [pytest.param(p, marks=pytest.mark.slow) if 2 < p < 11 else p for p in PRIMES]
)
@pytest.mark.fast_cases("2", "11")
@pytest.mark.slow_cases("11")
def test_zero_rational_and_enclosure_agree_with_residues_over_q(
    prime: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(number_field, "PRIME", prime)

    @settings(deadline=None, max_examples=examples(50))
    @given(st.data())
    def check(data: st.DataObject) -> None:
        field = data.draw(fields())
        element, residue = data.draw(expressions(field))
        assert element.is_zero == (residue == 0)
        assert (element.rational is not None) == (residue.degree() <= 0)
        if element.rational is not None:
            assert from_fraction(element.rational) == residue[0]
        with ctx.workprec(128):
            at = field.evaluation()
            assert element.ball(at).overlaps(arb_poly(residue)(at.embed(fmpq_poly([0, 1]))))
        assert element.residue == residue

    check()


def test_zero_has_no_inverse() -> None:
    field = RealField(
        Modulus(fmpz_poly([-2, 0, 1])), isolate(fmpz_poly([-2, 0, 1]), fmpq(0), fmpq(2))[0]
    )
    root = field.element(fmpq_poly([0, 1]))
    with pytest.raises(ZeroDivisionError, match="has no inverse"):
        (root * root - field.constant(fmpq(2))).inverse()


@given(st.data(), fields(), NUMBERS)
def test_a_rational_eigenvalue_is_found_beside_an_irrational_one(
    data: st.DataObject, field: RealField, q: fmpq
) -> None:
    """Eigenvalues q and o: the characteristic polynomial is x^2 - (q + o) x + q o."""
    assume(field.modulus.degree > 1)
    other = field.element(
        fmpq_poly(data.draw(st.lists(NUMBERS, min_size=2, max_size=2).filter(lambda c: c[1] != 0)))
    )
    rational, one = field.constant(q), field.constant(fmpq(1))
    assert list(rational_roots([rational * other, -(rational + other)])) == [(to_fraction(q), 1)]
    assert not list(rational_roots([rational * other + one, -(rational + other)]))
    assert list(rational_roots([rational * rational, -(rational + rational)])) == [
        (to_fraction(q), 2)
    ]


def test_the_generator_is_enclosed_as_narrowly_as_the_precision_says() -> None:
    field = RealField(
        Modulus(fmpz_poly([-2, 0, 1])), isolate(fmpz_poly([-2, 0, 1]), fmpq(0), fmpq(2))[0]
    )
    for bits in (64, 1024):
        with ctx.workprec(bits):
            ball = field.evaluation().embed(fmpq_poly([0, 1]))
            assert ball.contains(arb(2).sqrt().mid())
            assert float(ball.rad()) < 2.0 ** (4 - bits)
