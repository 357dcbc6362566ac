"""The error of drawn maps: known areas, a second way to compute them, and what a grid of the
paper's slices gives.
"""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.maps import shipped
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.studies import byhand
from ptmcad.studies.bench.error import (
    COUNTS,
    Truth,
    cover_error,
    distance,
    grid_error,
    shown_areas,
    shown_count,
    truths,
)
from ptmcad.studies.bench.study import question

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
ZERO, ONE = Fraction(0), Fraction(1)
shares = st.fractions(0, 1, max_denominator=60)


@cache
def exact(name: str) -> tuple[RegionMap, dict[str, Truth]]:
    found = shipped(name, "index")
    known = truths(found)
    assert known is not None
    return found, known


@cache
def grid(name: str, n: int) -> np.ndarray:
    asked = json.loads(question(ptmcad.load(CONFIGS / f"{name}.yaml")))
    return (
        byhand.counts("companion", byhand.grid_values(asked, n)).reshape(2, n, n).astype(np.int16)
    )


def polyline(heights: list[Fraction]) -> Truth:
    """Count 1 below a polygonal line over equal parts of the base, 2 above it."""
    parts = len(heights) - 1
    points = np.array([[k / parts, float(a)] for k, a in enumerate(heights)])
    edge = np.array([[0.0, 1.0], [1.0, 1.0]])
    return Truth(0, (0, 1), (1, 2), ((points, 0.0, 0, 1), (edge, 0.0, 1, -1)), np.zeros((0, 3)))


def wrong_area(truth: Truth, picture: np.ndarray) -> float:
    """What a picture of pixels, the first index along the base, shows wrongly or not."""
    n = len(picture)
    i, j = np.indices(picture.shape).reshape(2, -1)
    pieces = np.stack([i, i + 1, j, j + 1], axis=1) / n
    return 1 - float(shown_areas(truth, pieces, picture.ravel()).sum())


def clipped(
    polygon: list[tuple[Fraction, Fraction]], a: Fraction, b: Fraction, c: Fraction
) -> list:
    """The part of a convex polygon where a x + b y <= c."""
    kept = []
    for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        at_p, at_q = a * p[0] + b * p[1] - c, a * q[0] + b * q[1] - c
        if at_p <= 0:
            kept.append(p)
        if at_p * at_q < 0:
            t = at_p / (at_p - at_q)
            kept.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
    return kept


def area_of(polygon: list) -> Fraction:
    return (
        abs(
            sum(
                (
                    p[0] * q[1] - q[0] * p[1]
                    for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True)
                ),
                ZERO,
            )
        )
        / 2
    )


def wrong_by_clipping(heights: list[Fraction], picture: np.ndarray) -> Fraction:
    """The same error by another method: each pixel cut by the line's pieces."""
    n, parts = len(picture), len(heights) - 1
    total = ZERO
    for k, (a, b) in enumerate(pairwise(heights)):
        left, right = Fraction(k, parts), Fraction(k + 1, parts)
        slope = (b - a) * parts
        for i in range(n):
            for j in range(n):
                low, high = max(left, Fraction(i, n)), min(right, Fraction(i + 1, n))
                if low >= high:
                    continue
                bottom, top = Fraction(j, n), Fraction(j + 1, n)
                pixel = [(low, bottom), (high, bottom), (high, top), (low, top)]
                below = clipped(pixel, -slope, ONE, a - slope * left)
                under = area_of(below) if len(below) > 2 else ZERO
                total += {1: area_of(pixel) - under, 2: under}.get(
                    int(picture[i, j]), area_of(pixel)
                )
    return total


@given(
    st.lists(shares, min_size=2, max_size=5), st.integers(1, 6), st.randoms(use_true_random=False)
)
def test_wrong_area_by_clipping_pixels(heights: list[Fraction], n: int, random: object) -> None:
    """Any picture of any piecewise linear boundary, the third count being wrong everywhere."""
    picture = np.array([[random.randint(1, 3) for _ in range(n)] for _ in range(n)], dtype=np.int16)  # type: ignore[attr-defined]
    assert abs(wrong_area(polyline(heights), picture) - wrong_by_clipping(heights, picture)) < 1e-12


@pytest.mark.parametrize(
    ("n", "expected"),
    [(1, Fraction(1, 2)), (2, Fraction(1, 4)), (10, Fraction(1, 20)), (25, Fraction(1, 50))],
    ids=lambda x: f"{x}",
)
def test_half_plane_of_known_error(n: int, expected: Fraction) -> None:
    """Below the diagonal 1, above it 2: of each pixel on the diagonal just half is wrong, so
    1 / (2 n).
    """
    centre = (np.arange(n) + 0.5) / n
    picture = np.where(centre[None, :] < centre[:, None], 1, 2).astype(np.int16)
    assert abs(wrong_area(polyline([ZERO, ONE]), picture) - expected) < 1e-12
    low, high = grid_error(polyline([ZERO, ONE]), np.zeros((n, n), dtype=int), picture)["wrong"]
    assert low <= expected <= high < low + 1e-5


def test_blank_picture_of_fig3_is_wrong_where_two_are_stable() -> None:
    """The reference's area 7.352277514 of 20; the other counts' regions add up to the rest."""
    found, known = exact("fig3")
    low, high = grid_error(known["stable"], found.grid(4).cell.T, np.ones((4, 4), dtype=np.int16))[
        "wrong"
    ]
    assert low <= 7.352277514 / 20 <= high
    assert high - low < 1e-5
    assert len(known["stable"].counts) == 3
    assert len(known["index"].counts) == 4 == 1 + max(known["index"].region_of)


def test_error_of_grids_shrinks_with_their_pixels() -> None:
    found, known = exact("fig3")
    errors = []
    for n in (10, 20, 40):
        stable, total = grid("fig3", n)
        errors.append(
            grid_error(known["index"], found.grid(n).cell.T, shown_count(stable, total, "index"))
        )
    assert [e["wrong_centres"] for e in errors] == [0, 0, 0]
    assert errors[0]["wrong"][0] > 1.5 * errors[1]["wrong"][1] > 2.25 * errors[2]["wrong"][1]
    assert [e["missed"] for e in errors] == [
        1,
        1,
        1,
    ]  # the sliver of (6, 1) near rho = 0 is between the centres
    assert errors[2]["faintest"] is not None and errors[2]["faintest"][0] == 0
    assert errors[2]["distance"] is not None and errors[2]["distance"][0] > 0.05


def test_wrong_counts_are_seen() -> None:
    """One pixel with a wrong count adds its area, where no wall meets it, and one wrong centre."""
    found, known = exact("fig3")
    stable, _ = grid("fig3", 20)
    damaged = stable.copy()
    damaged[19, 0] = 5
    cells = found.grid(20).cell.T
    before, after = (grid_error(known["stable"], cells, shown) for shown in (stable, damaged))
    assert abs(after["wrong"][0] - before["wrong"][0] - 1 / 400) < 1e-6
    assert (before["wrong_centres"], after["wrong_centres"]) == (0, 1)
    damaged[19, 0] = -1
    assert grid_error(known["stable"], cells, damaged)["undetermined"] == 1 / 400


@given(
    st.fractions(0, 1, max_denominator=97).filter(lambda h: 0 < h < 1),
    st.integers(1, 9),
    st.integers(1, 9),
)
def test_distance_of_two_levels(height: Fraction, n: int, row: int) -> None:
    """A level wall and a level boundary that is drawn at a pixel's edge are as far apart as their
    heights.
    """
    if row >= n:
        return
    picture = np.ones((n, n), dtype=np.int16)
    picture[:, row:] = 2
    found = grid_error(polyline([height, height]), np.zeros((n, n), dtype=int), picture)["distance"]
    assert found is not None
    apart = float(abs(height - Fraction(row, n)))
    assert found[0] <= apart <= found[1]
    assert found[1] - found[0] < 0.3 / n


def test_distance_without_a_drawn_boundary() -> None:
    assert distance(polyline([ZERO, ONE]), np.zeros((0, 4)), 0.02) is None


def test_companion_and_newton_agree_where_both_are_right() -> None:
    """Two rivals that share no code but the grid."""
    asked = json.loads(question(ptmcad.load(CONFIGS / "fig4.yaml")))
    values = byhand.grid_values(asked, 4)
    assert (byhand.counts("multistart", values) == byhand.counts("companion", values)).all()


@pytest.mark.parametrize(
    ("name", "n"),
    [
        ("fig2", 40),
        ("fig4", 40),
        ("forces", 30),
        ("horizontal", 30),
        *(
            pytest.param(name, 30, marks=pytest.mark.slow)
            for name in ("unequal-springs", "stiffness")
        ),
    ],
)
@pytest.mark.slow_cases("horizontal-30", "forces-30")
def test_companion_is_right_at_centres(name: str, n: int) -> None:
    """A rival worth beating: where no wall is near, floats do."""
    found = shipped(name, "index")
    stable, total = grid(name, n)
    cells = found.grid(n).cell.T
    known = cells >= 0
    assert known.mean() > 0.9
    for drawn, what in ((stable, "stable"), (total, "total")):
        truth = np.array([getattr(cell, what) for cell in found.cells])
        assert (truth[cells] == drawn)[known].all()


def test_error_of_a_certified_map() -> None:
    """Nothing but its cover is wrong, which is measured exactly; a count that is changed shows with
    its cell's area.
    """
    pytest.importorskip("numba")
    found, known = exact("fig3")
    result = ptmcad.classify(found.slice, engine="certified", tolerance="1/5")
    for count in COUNTS:
        error = cover_error(known[count], result, count)
        assert error is not None
        assert abs(error["wrong"][0] - result.undetermined) < 1e-6
        assert error["wrong"][1] - error["wrong"][0] < 1e-5
    largest = max(
        range(len(result.cells)), key=lambda n: result.regions[result.cells[n].region].area[0]
    )
    cells = list(result.cells)
    cells[largest] = replace(cells[largest], stable=7)
    damaged = cover_error(known["stable"], replace(result, cells=tuple(cells)), "stable")
    assert damaged is not None
    assert damaged["wrong"][0] > result.undetermined + Fraction(1, 20)
