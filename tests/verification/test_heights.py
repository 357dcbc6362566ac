"""Points of curves over a critical value: the engine's discs and the checker's Sturm sequences find
the known ones.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import pytest
from flint import fmpq, fmpz_poly
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.curves_with_known_points import KnownCurves, known_curves
from support.examples import examples

from ptmcad.algebra.polynomials import from_plane
from ptmcad.algebra.real_roots import RealRoot
from ptmcad.answer.regionmap import CriticalValue
from ptmcad.exact.cad.criticalpoints import PointsOver
from ptmcad.exact.cad.projection import curve
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.projections import Heights
from ptmcad.verification.rootcounts import roots_between

SQRT2 = fmpz_poly([-2, 0, 1])
LOW, HIGH = fmpq(-7, 2), fmpq(10, 3)
"""No point is so low, none so high; 10/3 is no multiple of 1/9 in a way that matters."""


def engine(known: KnownCurves) -> PointsOver:
    """The engine's view of the curves."""
    curves = tuple(
        curve(n, from_plane(PlanePolynomial.of(t)), 0) for n, t in enumerate(known.terms)
    )
    return PointsOver(curves, RealRoot(SQRT2, fmpq(1), fmpq(2)))


def checker(known: KnownCurves) -> Heights:
    """The checker's view of the curves."""
    curves = [PlaneCurve.of(n, PlanePolynomial.of(t), 0) for n, t in enumerate(known.terms)]
    return Heights(
        curves, CriticalValue(polynomial=(-2, 0, 1), low=Fraction(1), high=Fraction(2), origin="")
    )


@given(known_curves())
def test_engine_encloses_each_point_once(known: KnownCurves) -> None:
    found = engine(known).between(LOW, HIGH, [])
    assert len(found) == len(known.heights)
    assert all(from_fraction(h) >= a and from_fraction(h) <= b
               for h, (a, b) in zip(known.heights, found, strict=True))  # fmt: skip
    assert all(one[1] < other[0] for one, other in pairwise(found))


@given(
    known_curves(),
    st.lists(st.fractions(-3, 3, max_denominator=9), min_size=2, max_size=2, unique=True),
)
def test_checker_counts_points_in_open_intervals(known: KnownCurves, ends: list[Fraction]) -> None:
    low, high = sorted(ends)
    number = checker(known).between(from_fraction(low), from_fraction(high))
    assert number == sum(low < h < high for h in known.heights)


@given(known_curves())
def test_checker_parts_the_points(known: KnownCurves) -> None:
    heights = [to_fraction(v) for v in checker(known).separated(LOW, HIGH)]
    assert [sum(a < h < b for h in known.heights) for a, b in pairwise(heights)] == [1] * len(
        known.heights
    )


def test_a_double_point_is_one_point_without_a_polynomial_in_v(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # (3 v - 1)^2 (v + 1) (v^2 + 1) + (u^2 - 2) (u v + 5 u)
    known = KnownCurves(
        (((0, 5, 9), (0, 4, 3), (0, 3, 4), (0, 2, 4), (0, 1, -5), (0, 0, 1),
          (3, 1, 1), (1, 1, -2), (3, 0, 5), (1, 0, -10)),),
        (Fraction(-1), Fraction(1, 3)),
    )  # fmt: skip

    def fail(*_: object) -> None:
        raise AssertionError("the long way")

    monkeypatch.setattr("ptmcad.verification.projections.points_over", fail)
    monkeypatch.setattr("ptmcad.exact.cad.criticalpoints.squarefree_part", fail)
    assert checker(known).between(LOW, HIGH) == 2
    assert len(engine(known).between(LOW, HIGH, [])) == 2


@pytest.mark.parametrize("digits", [20, 60, 200, 700])
def test_points_that_are_very_near_to_each_other_are_two(digits: int) -> None:
    # v (10^digits v - 1) + (u^2 - 2) u
    known = KnownCurves(
        (((0, 2, 10**digits), (0, 1, -1), (3, 0, 1), (1, 0, -2)),),
        (Fraction(0), Fraction(1, 10**digits)),
    )
    assert checker(known).between(LOW, HIGH) == 2
    assert len(engine(known).between(LOW, HIGH, [])) == 2


# ------------------------------------------------------------------------------------ real roots of long polynomials


@settings(max_examples=examples(20))
@example(
    [Fraction(7, 5)], [Fraction(0), Fraction(7, 5)], 2
)  # an end that is a root and no number of finitely many bits
@given(
    st.lists(st.fractions(-2, 2, max_denominator=12), min_size=1, max_size=5, unique=True),
    st.lists(st.fractions(-2, 2, max_denominator=12), min_size=2, max_size=2, unique=True),
    st.integers(1, 3),
)
def test_roots_of_long_polynomials_are_counted(
    roots: list[Fraction], ends: list[Fraction], power: int
) -> None:
    """Which may be multiple, or the interval's ends, or very near to each other."""
    x = fmpz_poly([0, 1])
    p = (x**62 + 1) * (10**12 * x - 3 * 10**12 - 1) * (x - 3) ** 2
    for root in roots:
        p *= (root.denominator * x - root.numerator) ** power
    assert p.degree() >= 64
    low, high = sorted(ends)
    inside = roots_between(p, from_fraction(low), from_fraction(high))
    assert inside == sum(low < r < high for r in roots)
    assert roots_between(p, fmpq(5, 2), fmpq(4)) == 2
    assert roots_between(p, fmpq(3), fmpq(4)) == 1


def test_a_point_at_an_end_that_balls_only_round_to_is_not_between() -> None:
    # (5 v - 7) (v + 1) + (u^2 - 2) u
    known = KnownCurves(
        (((0, 2, 5), (0, 1, -2), (0, 0, -7), (3, 0, 1), (1, 0, -2)),), (Fraction(-1), Fraction(7, 5))
    )  # fmt: skip
    heights = checker(known)
    assert heights._candidates_between(LOW, fmpq(7, 5)) == heights.between(LOW, fmpq(7, 5)) == 1
    assert heights._candidates_between(fmpq(7, 5), HIGH) == heights.between(fmpq(7, 5), HIGH) == 0
