"""Signs over the window: known by construction, against Sturm's theorem in sympy, and against exact
values.
"""

from __future__ import annotations

from fractions import Fraction
from math import comb

import pytest
import sympy
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.cases import cases
from support.dips import AXES, DIPS, NAMES, Q, X, Y, thin_dip
from support.examples import examples

from ptmcad.question.positivity import (
    Need,
    bernstein,
    decide,
    place,
    polynomial_value,
)
from ptmcad.question.slice import PROVED, Axis, Witness
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.parsing import parse

coefficients = st.dictionaries(
    st.tuples(st.integers(0, 3), st.integers(0, 3)),
    st.integers(-5, 5).filter(bool),
    min_size=1,
    max_size=6,
)
units = st.fractions(min_value=0, max_value=1, max_denominator=9)


@given(coefficients, units, units)
@settings(max_examples=examples(50))
def test_the_bernstein_form_has_the_polynomial_values(
    polynomial: dict[tuple[int, int], int], s: Fraction, t: Fraction
) -> None:
    terms = tuple((i, j, Fraction(c)) for (i, j), c in sorted(polynomial.items()))
    (m, n) = (max(i for i, _ in polynomial), max(j for _, j in polynomial))
    x, y = 2 * s, -3 + 4 * t
    form = bernstein(terms, ((AXES[0].low, AXES[0].high), (AXES[1].low, AXES[1].high)))
    total = sum(
        comb(m, p) * s**p * (1 - s) ** (m - p) * comb(n, q) * t**q * (1 - t) ** (n - q) * form[p][q]
        for p in range(m + 1)
        for q in range(n + 1)
    )
    assert total == sum(c * x**i * y**j for i, j, c in terms)


def check(expression: Expression, need: Need, axes: tuple[Axis, Axis] = AXES) -> str:
    """``proved``, ``refuted`` or ``undecided``; a witness is checked by exact evaluation."""
    verdict = decide(expression, axes, need)
    if not isinstance(verdict, Witness):
        return "proved" if verdict == PROVED else "undecided"
    for value, a in zip(verdict.point, axes, strict=True):
        assert a.low < value < a.high
    if need is Need.NO_POLE:
        seen = polynomial_value(expression.denominator, *verdict.point)
        if verdict.other is not None:
            assert polynomial_value(expression.denominator, *verdict.other) * seen < 0
        else:
            assert verdict.value == 0
    else:
        seen = expression.evaluate(*verdict.point)
        assert verdict.value < 0 or (verdict.value == 0 and need is Need.POSITIVE)
    assert seen == verdict.value
    return "refuted"


@pytest.mark.parametrize(("need", "verdict", "text"), cases("positivity", "signs"))
def test_known_signs(need: str, verdict: str, text: str) -> None:
    assert check(parse(text, NAMES), Need[need]) == verdict


@pytest.mark.parametrize("need", Need)
@pytest.mark.parametrize("kind", DIPS)
def test_no_thin_dip_is_taken_for_positive(kind: str, need: Need) -> None:
    """Each hypothesis broken narrowly: looking at some points, or at no degree over 12, took these
    for positive.
    """
    dip, fine = thin_dip(kind)
    if need is Need.NO_POLE:
        dip, fine = 1 / dip, 1 / fine
    negative = -1 / (X - 3)  # the same with a denominator that is negative in the window
    for factor in (constant(1), negative):
        assert check(dip * factor, need) in ("refuted", "undecided")
        assert check(fine * factor, need) in ("proved", "undecided")


def test_what_halving_leaves_is_undecided_with_its_places() -> None:
    valley = parse("(rho^3+F^3-rho*F-1/7)^2 + 1e-40", NAMES)
    verdict = decide(valley, AXES, Need.NOT_NEGATIVE)
    assert not isinstance(verdict, Witness) and verdict
    for (x0, x1), (y0, y1) in verdict:
        assert 0 <= x0 < x1 <= 2
        assert -3 <= y0 < y1 <= 1
    assert place(verdict, AXES).startswith("near rho = ")


small = st.integers(-4, 4)
univariate = st.lists(small, min_size=1, max_size=5)


def horner(values: list[int], variable: Expression) -> Expression:
    total = constant(0)
    for c in values:
        total = total * variable + c
    return total


@given(univariate, univariate, st.integers(0, 1))
@example([1, -1], [1, -1], 0)
@settings(deadline=None, max_examples=examples(50))
def test_one_variable_agrees_with_sturm_in_sympy(a: list[int], b: list[int], which: int) -> None:
    """As Sturm's theorem counts the roots of the squarefree factors."""
    p = horner(a, (X, Y)[which]) ** 2 * horner(b, (X, Y)[which])
    t = sympy.Symbol("t")
    q = sympy.Poly(sum(c * t**k for k, c in enumerate(reversed(a))), t) ** 2
    q *= sympy.Poly(sum(c * t**k for k, c in enumerate(reversed(b))), t)
    low, high = AXES[which].low, AXES[which].high

    def roots(f: sympy.Poly) -> int:
        """In the open interval, by Sturm sequences."""
        ends = sum(f.eval(sympy.Rational(e.numerator, e.denominator)) == 0 for e in (low, high))
        return int(f.count_roots(int(low), int(high))) - ends

    if q.is_zero:
        assert check(p, Need.POSITIVE) == "refuted"
        assert check(p, Need.NOT_NEGATIVE) == "proved"
        return
    factors = q.sqf_list()[1]
    changes = any(k % 2 and f.degree() > 0 and roots(f) for f, k in factors)
    zeros = any(f.degree() > 0 and roots(f) for f, _ in factors)
    sample = next(
        v
        for v in (low + (high - low) * Q(k, 97) for k in range(1, 97))
        if q.eval(sympy.Rational(v)) != 0
    )
    negative = bool(q.eval(sympy.Rational(sample)) < 0)
    expected = "refuted" if changes or negative else "proved"
    assert check(p, Need.NOT_NEGATIVE) in (expected, "undecided")
    expected = "refuted" if zeros or negative else "proved"
    assert check(p, Need.POSITIVE) in (expected, "undecided")


@given(coefficients, st.sampled_from(list(Need)[:2]))
@settings(deadline=None, max_examples=examples(40))
def test_a_proof_is_never_contradicted_by_values(
    polynomial: dict[tuple[int, int], int], need: Need
) -> None:
    p = sum((c * X**i * Y**j for (i, j), c in polynomial.items()), constant(0))
    proved = check(p, need) == "proved"
    values = [
        p.evaluate(Q(2 * k, 11), -3 + Q(4 * m, 13)) for k in range(1, 11) for m in range(1, 13)
    ]
    if proved:
        assert min(values) > 0 or (need is Need.NOT_NEGATIVE and min(values) == 0)
