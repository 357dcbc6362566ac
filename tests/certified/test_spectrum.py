"""Eigenvalues of symmetric matrices of balls in order, and equilibria whose Hessian has equal ones."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import arb, arb_mat, ctx, fmpq, fmpq_mat
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

pytest.importorskip("numba")

import ptmcad
from ptmcad.certified.plain.spectrum import ordered_eigenvalues
from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction

SMALL = st.integers(-3, 3)
NEAR = st.sampled_from([Q(0), Q(1, 10**40), Q(1, 3), Q(-2), Q(10**9)])


@given(
    st.lists(st.tuples(SMALL, NEAR), min_size=2, max_size=4),
    st.lists(SMALL, min_size=6, max_size=6),
)
@settings(max_examples=examples(60))
def test_eigenvalues_that_are_known_by_construction(
    chosen: list[tuple[int, Q]], turns: list[int]
) -> None:
    """Q D Q' with Cayley's rational rotation Q = (I - S) (I + S)^-1; D has entries that are equal,
    or nearly.
    """
    size = len(chosen)
    values = sorted(n + d for n, d in chosen)
    skew, rest = fmpq_mat(size, size), iter(turns)
    for i in range(size):
        for j in range(i):
            skew[i, j] = n = fmpq(next(rest))
            skew[j, i] = -n
    one = fmpq_mat(size, size, [fmpq(int(i == j)) for i in range(size) for j in range(size)])
    rotation = (one - skew) * (one + skew).inv()
    diagonal = fmpq_mat(size, size)
    for k, value in enumerate(values):
        diagonal[k, k] = from_fraction(value)
    matrix = rotation * diagonal * rotation.transpose()
    with ctx.workprec(200):
        balls = ordered_eigenvalues(arb_mat(matrix))
        assert all(ball.overlaps(ball_of(value)) for ball, value in zip(balls, values, strict=True))
        scale = max(abs(value) for value in values) + 1
        assert all(float(ball.rad()) < 1e-55 * float(scale) for ball in balls)


@pytest.mark.parametrize(
    ("corner", "ends"),
    [([-1, 1, 1, -1], (-2, 0)), ([1, 1, 1, 1], (0, 2)), ([1, 0, 0, -1], (-1, 1))],
)
def test_wide_balls_enclose_the_eigenvalues_of_their_corners(
    corner: list[int], ends: tuple[int, int]
) -> None:
    """All entries of 3 I are known to 1/4 only: corners move the eigenvalues by up to 1/2."""
    wide = arb_mat(2, 2, [arb(3 * (k in (0, 3)), 0.25) for k in range(4)])
    for ball, end in zip(ordered_eigenvalues(wide), ends, strict=True):
        assert ball.contains(3 + arb(end) / 4), corner


def test_nothing_is_said_of_a_matrix_that_is_not_finite() -> None:
    assert not any(
        ball.is_finite() for ball in ordered_eigenvalues(arb_mat(2, 2, [1, 0, 0, arb.nan()]))
    )


def test_two_pendulums_alike_have_equal_irrational_eigenvalues() -> None:
    """Two that do not know of each other: with the four poses of one, 16, of index 0, 1 and 2 as 4,
    8 and 4.
    """
    alike = {
        "parameters": {"l0": {"kind": "free length"}, "W": {"kind": "force"}},
        "unknowns": {"th": "angle", "phi": "angle"},
        "points": {"A": [1, 3], "P": ["sin(th)", "cos(th)"], "Q": ["sin(phi)", "cos(phi)"]},
        "springs": [{"between": ["A", end], "k": 1, "free": "l0"} for end in "PQ"],
        "loads": {end: {"weight": "W"} for end in "PQ"},
    }
    alone = {
        **alike,
        "unknowns": {"th": "angle"},
        "points": {n: alike["points"][n] for n in "AP"},
    } | {
        "springs": alike["springs"][:1],
        "loads": {"P": {"weight": "W"}},
    }
    one, both = (
        ptmcad.solve(model=ptmcad.Mechanism(record), l0=3, W="1/5").equilibria
        for record in (alone, alike)
    )
    texts = sorted(pose.eigenvalues[0].text(8) for pose in one)
    assert len(texts) == 4
    assert [sum(pose.index == n for pose in both) for n in range(3)] == [4, 8, 4]
    equal = [pose for pose in both if pose.angles[0].text(8) == pose.angles[1].text(8)]
    assert sorted(pose.eigenvalues[0].text(8) for pose in equal) == texts
    assert all(pose.eigenvalues[0].text(8) == pose.eigenvalues[1].text(8) for pose in equal)
