"""Curves that a reflection along the fibres maps to themselves: that it is found, and what it saves
is the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from flint import acb, arb, arb_poly, ctx, fmpq, fmpq_poly, fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra import clusters, resultants
from ptmcad.algebra.reflections import axis_of, squared

SMALL = st.integers(-9, 9)
ROWS = st.lists(st.lists(SMALL, max_size=4).map(fmpz_poly), min_size=2, max_size=4).filter(
    lambda q: q[-1] != 0
)


def reflected_about(q: list[fmpz_poly], line: fmpz_poly, d: int) -> list[fmpz_poly]:
    """The coefficients of powers of v of q(u, (d v - line)^2)."""
    total = [fmpz_poly([0])] * (2 * len(q) - 1)
    power = [fmpz_poly([1])]
    for row in q:
        for i, c in enumerate(power):
            total[i] += row * c
        for _ in range(2):
            power = [
                d * a - line * b
                for a, b in zip([fmpz_poly([0]), *power], [*power, fmpz_poly([0])], strict=True)
            ]
    return total


@given(ROWS, st.tuples(SMALL, SMALL), st.integers(1, 5))
@settings(max_examples=examples(100))
def test_an_axis_is_found_and_the_discriminant_is_the_same(
    q: list[fmpz_poly], line: tuple[int, int], d: int
) -> None:
    axis = fmpq_poly(list(line)) / fmpq(d)
    p = reflected_about(q, fmpz_poly(list(line)), d)
    assert axis_of(p) == axis
    # in units of the axis's own denominator
    scale = (d // int(axis.denom())) ** 2
    assert squared(p, axis) == [
        c * scale**k * axis.denom() ** (len(p) - 1) for k, c in enumerate(q)
    ]
    direct = resultants.discriminant(p)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(resultants, "LONG", 0)
        assert resultants.discriminant(p) == direct


def test_the_shorter_discriminant_is_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    degrees = []

    def followed(p: Any, check: Any) -> fmpz_poly:
        degrees.append(len(p) - 1)
        return resultants.interpolate(
            lambda k: fmpz_poly([c(k) for c in p]).discriminant(), 8, check
        )

    q = [fmpz_poly([3, 1]), fmpz_poly([0, 5]), fmpz_poly([-2]), fmpz_poly([1])]
    p = reflected_about(q, fmpz_poly([1, 3]), 2)
    expected = resultants.discriminant(p)
    reflected = resultants._by_reflection
    monkeypatch.setattr(resultants, "LONG", 0)
    monkeypatch.setattr(resultants, "discriminant", followed)
    assert reflected(p, fmpq_poly([1, 3]) / 2, resultants.nothing) == expected
    assert degrees == [3]


@given(ROWS, st.tuples(SMALL, SMALL), st.integers(1, 5), st.integers(0, 6), SMALL)
@settings(max_examples=examples(50))
def test_a_curve_that_is_not_its_image_has_no_axis(
    q: list[fmpz_poly], line: tuple[int, int], d: int, at: int, by: int
) -> None:
    p = reflected_about(q, fmpz_poly(list(line)), d)
    assume(
        by != 0 and at % 2 == 1 and at < len(p) - 2
    )  # the roots' mean, so the only candidate, stays
    p[at] += fmpz_poly([by])
    assert axis_of(p) is None


def test_a_bent_axis_and_odd_degrees_are_left_alone() -> None:
    bent = [fmpz_poly([1, 0, 0, 0, 1]), fmpz_poly([0, 0, -2]), fmpz_poly([1])]  # (v - u^2)^2 + 1
    assert axis_of(bent) is None
    assert axis_of([fmpz_poly([0]), fmpz_poly([1]), fmpz_poly([0]), fmpz_poly([1])]) is None
    assert axis_of([fmpz_poly([1]), fmpz_poly([1])]) is None


def test_discs_over_an_abscissa_start_from_the_squares(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of real, complex and imaginary w, at a place where two of the squares are equal, and where
    one is zero.
    """
    u = fmpz_poly([0, 1])
    q = [fmpz_poly([1])]
    for factor in ([-u, 1], [fmpz_poly([-2]), 1], [u**2 + 3, 1], [fmpz_poly([5]), u, 1]):
        product = [fmpz_poly([0])] * (len(q) + len(factor) - 1)
        for i, a in enumerate(q):
            for j, b in enumerate(factor):
                product[i + j] += a * b
        q = product
    p = reflected_about(q, fmpz_poly([1, 3]), 2)
    degrees: list[int] = []
    approximate = clusters._approximate

    def followed(coefficients: Sequence[arb]) -> list[tuple[acb, int]]:
        degrees.append(len(coefficients) - 1)
        return approximate(coefficients)

    for place in (fmpq(1), fmpq(2), fmpq(0), fmpq(7, 3)):
        with ctx.workprec(200):
            abscissa = arb(place) + arb(0, 1) / 2**150
            direct = clusters.clusters([arb_poly(row)(abscissa) for row in p])
            with monkeypatch.context() as patch:
                patch.setattr(clusters, "_approximate", followed)
                found = clusters.clusters_over(p, abscissa)
        assert degrees.pop() == len(q) - 1
        assert not degrees
        assert found is not None
        assert direct is not None
        assert sorted(c.number for c in found) == sorted(c.number for c in direct)
        for c in found:
            assert [d.number for d in direct if c.meets(d)] == [c.number]
            assert [d.is_real for d in direct if c.meets(d)] == [c.is_real]
