"""Curves that a reflection along the fibres maps to themselves: that it is found, and what it saves
is the same.
"""

from __future__ import annotations

from typing import Any

import pytest
from flint import fmpq, fmpq_poly, fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra import resultants
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
