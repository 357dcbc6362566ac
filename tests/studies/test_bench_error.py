"""The error of drawn maps: known areas, a second way to compute them, and what a grid of the paper's slices gives."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st
from support.maps import shipped

import ptmcad
from ptmcad.algebra.polynomials import from_plane
from ptmcad.exact.cad.curves import curve
from ptmcad.exact.cad.polyline import FLAT, Branch, Chord, chords
from ptmcad.exact.cad.stacks import roots_over
from ptmcad.studies.bench import companion, multistart
from ptmcad.studies.bench.cover_error import cover_error
from ptmcad.studies.bench.distance import distances, grid_boundary
from ptmcad.studies.bench.error import grid_error, wrong_areas
from ptmcad.studies.bench.methods import question
from ptmcad.studies.bench.reference import COUNTS, Reference, Walls, centres, reference, regions, shown_count, walls
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.plane import PlanePolynomial

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
ZERO, ONE = Fraction(0), Fraction(1)
shares = st.fractions(0, 1, max_denominator=60)


@cache
def exact(name: str) -> tuple[Reference, dict[str, Walls]]:
    found = reference(shipped(name, "index"))
    return found, walls(found)


@cache
def grid(name: str, n: int) -> np.ndarray:
    asked = json.loads(question(ptmcad.load(CONFIGS / f"{name}.yaml"), None))
    return (
        companion.counts(companion.grid_values(asked, n), companion.moments_of(asked)).reshape(2, n, n).astype(np.int16)
    )


def polyline(heights: list[Fraction]) -> Walls:
    """Count 1 below a polygonal line over equal parts of the base, 2 above it."""
    parts = len(heights) - 1
    pieces = [
        (Chord(Fraction(k, parts), Fraction(k + 1, parts), a, b, ZERO), 0, 1)
        for k, (a, b) in enumerate(pairwise(heights))
    ]
    area = sum((a + b for a, b in pairwise(heights)), ZERO) / (2 * parts)
    return Walls((1, 2), ((area, area), (1 - area, 1 - area)), tuple(pieces), ((ZERO, ONE, 1),), ())


def clipped(polygon: list[tuple[Fraction, Fraction]], a: Fraction, b: Fraction, c: Fraction) -> list:
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
        abs(sum((p[0] * q[1] - q[0] * p[1] for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True)), ZERO)) / 2
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
                total += {1: area_of(pixel) - under, 2: under}.get(int(picture[i, j]), area_of(pixel))
    return total


@given(st.lists(shares, min_size=2, max_size=5), st.integers(1, 6), st.randoms(use_true_random=False))
def test_wrong_area_by_clipping_pixels(heights: list[Fraction], n: int, random: object) -> None:
    """Any picture of any piecewise linear boundary, the third count being wrong everywhere."""
    picture = np.array([[random.randint(1, 3) for _ in range(n)] for _ in range(n)], dtype=np.int16)  # type: ignore[attr-defined]
    (low, high), by_region = wrong_areas(polyline(heights), picture)
    assert low == high == wrong_by_clipping(heights, picture)
    assert sum(b[0] for b in by_region) == low


@pytest.mark.parametrize(
    ("n", "expected"),
    [(1, Fraction(1, 2)), (2, Fraction(1, 4)), (10, Fraction(1, 20)), (25, Fraction(1, 50))],
    ids=lambda x: f"{x}",
)
def test_half_plane_of_known_error(n: int, expected: Fraction) -> None:
    """Below the diagonal 1, above it 2: of each pixel on the diagonal just half is wrong, so 1 / (2 n)."""
    centre = (np.arange(n) + 0.5) / n
    picture = np.where(centre[None, :] < centre[:, None], 1, 2).astype(np.int16)
    assert wrong_areas(polyline([ZERO, ONE]), picture)[0] == (expected, expected)


def disc() -> Walls:
    """Count 2 inside the circle of radius 3/8 around the middle of the unit square, whose chords are computed."""
    p = PlanePolynomial.of([(2, 0, 64), (1, 0, -64), (0, 2, 64), (0, 1, -64), (0, 0, 23)])
    source = curve(0, from_plane(p), 0)
    unit = (fmpq(0), fmpq(1))
    gap = Fraction(1, 2**32)
    span = (Fraction(1, 8) + gap, Fraction(7, 8) - gap)
    below, above = (
        chords(Branch(source, root, unit, unit), span, Fraction(1, 2**16), Fraction(1, 2**36)) for root in (0, 1)
    )
    pieces = [(c, 0, 1) for c in below] + [(c, 1, 0) for c in above]
    tops = ((ZERO, Fraction(1, 8), 0), (*span, 0), (Fraction(7, 8), ONE, 0))
    gaps = tuple((x - gap, x + gap, ((Fraction(1, 2), Fraction(1, 2)),)) for x in (Fraction(1, 8), Fraction(7, 8)))
    inside = Fraction(pi * 9 / 64)
    return Walls((1, 2), ((1 - inside, 1 - inside), (inside, inside)), tuple(pieces), tops, gaps)


@pytest.mark.slow
def test_disc_of_known_area() -> None:
    """A picture that shows 1 everywhere is wrong on the disc, pi 9/64, and one that shows 2 on the rest."""
    found = disc()
    for shown, wrong in ((1, pi * 9 / 64), (2, 1 - pi * 9 / 64), (7, 1.0)):
        (low, high), _ = wrong_areas(found, np.full((3, 3), shown, dtype=np.int16))
        assert low <= Fraction(wrong) + Fraction(1, 10**14) and Fraction(wrong) - Fraction(1, 10**14) <= high
        assert high - low < Fraction(1, 10**4)


def test_walls_that_leave_a_cusp_side_by_side_are_shut_in() -> None:
    """(2 v - 1)^2 = u^7: near 0 the walls are too close together for slopes to be proved, but not for heights."""
    source = curve(0, from_plane(PlanePolynomial.of([(0, 2, 4), (0, 1, -4), (0, 0, 1), (7, 0, -1)])), 0)
    unit = (fmpq(0), fmpq(1))
    span = (Fraction(1, 2**32), 1 - Fraction(1, 2**32))
    for root, side in ((0, -1), (1, 1)):
        found = chords(Branch(source, root, unit, unit), span, Fraction(1, 2**18), Fraction(1, 2**24))
        assert len(found) < 2000
        assert max(c.distance for c in found) <= FLAT
        assert sum(c.distance * (c.right - c.left) for c in found) < Fraction(1, 2**17)
        for c in found:
            for part in (Fraction(1, 9), Fraction(1, 2), Fraction(8, 9)):
                x = c.left + (c.right - c.left) * part
                line = c.at_left + (c.at_right - c.at_left) * part
                # the wall's v is 1/2 + side sqrt(u^7) / 2: both ends of the chord's band, squared exactly
                ends = [2 * side * (line + s * c.distance - Fraction(1, 2)) for s in (-1, 1)]
                low, high = min(ends), max(ends)
                assert (low < 0 or low**2 <= x**7) and high > 0 and x**7 <= high**2


def test_chords_hold_their_walls() -> None:
    """At many places the isolated roots are no further from their chords than is claimed."""
    found, sides = exact("fig3")
    height = found.fibre[1] - found.fibre[0]
    by_left = sorted(sides["index"].chords, key=lambda c: (c[0].left, c[0].at_left))
    for c, _, _ in by_left[:: len(by_left) // 60]:
        for part in (Fraction(1, 7), Fraction(1, 2), Fraction(6, 7)):
            x = c.left + (c.right - c.left) * part
            line = c.at_left + (c.at_right - c.at_left) * part
            u = found.base[0] + (found.base[1] - found.base[0]) * from_fraction(x)
            roots = [(r.middle - found.fibre[0]) / height for _, r in roots_over(found.curves, u, found.fibre)]
            nearest = min(abs(r - from_fraction(line)) for r in roots)
            # isolating intervals may be wide: refine by bisection on the curves' own sign change
            if nearest > from_fraction(c.distance):
                low, high = (found.fibre[0] + height * from_fraction(line + s * c.distance) for s in (-1, 1))
                assert any(_changes(source, u, low, high) for source in found.curves)


def _changes(source: object, u: fmpq, low: fmpq, high: fmpq) -> bool:
    p = source.fibre(u)  # type: ignore[attr-defined]
    return bool(fmpq(p(low)) * fmpq(p(high)) <= 0)


@pytest.mark.parametrize(("name", "n"), [("fig3", 9), ("fig4", 8), ("fig2", 2), ("fig2", 50)])
def test_centres_are_where_locate_finds_them(name: str, n: int) -> None:
    """fig2 with two or fifty columns has centres over a critical value and on walls."""
    found = reference(shipped(name, "index"))
    columns = centres(found, n)
    axes = found.result.slice.axes
    base = found.result.base
    rows = range(n) if n < 20 else (0, 7, 12, 24, 37)
    for k in range(0, n, 1 if n < 20 else 6):
        for j in rows:
            place = (k, j) if base == 0 else (j, k)
            at = {
                a.name: a.low + (a.high - a.low) * Fraction(2 * i + 1, 2 * n) for a, i in zip(axes, place, strict=True)
            }
            inside = [cell for cell, first, end in columns[k] if first <= j < end]
            assert inside == [c for c in [found.result.locate(**at).cell] if c is not None], at


@pytest.mark.parametrize("axes", [(0, 1)])
def test_blank_picture_of_fig3_is_wrong_where_two_are_stable(axes: tuple[int, int]) -> None:
    """The reference's area 7.352277514 of 20; the other counts' regions add up to the rest."""
    found, sides = exact("fig3")
    (low, high), _ = wrong_areas(sides["stable"], np.ones((4, 4), dtype=np.int16))
    assert low <= Fraction("7.352277514") / 20 <= high + Fraction(1, 10**9)
    assert high - low < Fraction(1, 10**5)
    assert len(sides["stable"].counts) == 3
    assert len(sides["index"].counts) == 4 == 1 + max(regions(found.result, "index"))


def test_error_of_grids_shrinks_with_their_pixels() -> None:
    found, sides = exact("fig3")
    errors = []
    for n in (10, 20, 40):
        stable, total = grid("fig3", n)
        errors.append(
            grid_error(found, sides["index"], centres(found, n), shown_count(stable, total, "index"), "index")
        )
    assert [e.wrong_centres for e in errors] == [0, 0, 0]
    assert errors[0].wrong[0] > 1.5 * errors[1].wrong[1] > 2.25 * errors[2].wrong[1]
    assert [e.missed for e in errors] == [1, 1, 1]  # the sliver of (6, 1) near rho = 0 is between the centres
    assert errors[2].faintest[0] == 0
    assert errors[2].distance is not None and errors[2].distance.missed[0] > 0.05


def test_wrong_counts_are_seen() -> None:
    """One pixel with a wrong count adds its area, where no wall meets it, and one wrong centre."""
    found, sides = exact("fig3")
    stable, _ = grid("fig3", 20)
    damaged = stable.copy()
    damaged[19, 0] = 5
    columns = centres(found, 20)
    before, after = (grid_error(found, sides["stable"], columns, shown, "stable") for shown in (stable, damaged))
    added = after.wrong[0] - before.wrong[0]
    assert abs(added - Fraction(1, 400)) < Fraction(1, 10**8)  # but for the strip along the window's edge
    assert (before.wrong_centres, after.wrong_centres) == (0, 1)
    damaged[19, 0] = -1
    assert grid_error(found, sides["stable"], columns, damaged, "stable").undetermined == Fraction(1, 400)


@given(st.fractions(0, 1, max_denominator=97).filter(lambda h: 0 < h < 1), st.integers(1, 9), st.integers(1, 9))
def test_distance_of_two_levels(height: Fraction, n: int, row: int) -> None:
    """A level wall and a level boundary that is drawn at a pixel's edge are as far apart as their heights."""
    if row >= n:
        return
    picture = np.ones((n, n), dtype=np.int16)
    picture[:, row:] = 2
    found = distances(polyline([height, height]), grid_boundary(picture), Fraction(1, n))
    assert found is not None
    apart = float(abs(height - Fraction(row, n)))
    for low, high in (found.missed, found.false):
        assert low <= apart <= high
        assert high - low < 0.3 / n


def test_distance_without_a_drawn_boundary() -> None:
    blank = grid_boundary(np.ones((5, 5), dtype=np.int16))
    assert distances(polyline([ZERO, ONE]), blank, Fraction(1, 5)) is None


def test_companion_and_scipy_agree_where_both_are_right() -> None:
    """Two rivals that share no code but the grid; the same seed gives the same counts."""
    asked = json.loads(question(ptmcad.load(CONFIGS / "fig4.yaml"), None))
    values, moments = companion.grid_values(asked, 4), companion.moments_of(asked)
    first = multistart.counts(values, moments, 7)
    assert (first == companion.counts(values, moments)).all()
    assert (first == multistart.counts(values, moments, 7)).all()


@pytest.mark.parametrize(
    ("name", "n"),
    [
        ("fig4", 40),
        ("forces", 30),
        ("horizontal", 30),
        *(pytest.param(name, 30, marks=pytest.mark.slow) for name in ("unequal-springs", "stiffness")),
    ],
)
@pytest.mark.slow_cases("horizontal-30")
def test_companion_is_right_at_centres(name: str, n: int) -> None:
    """A rival worth beating: where no wall is near, floats do."""
    found = reference(shipped(name, "index"))
    stable, total = grid(name, n)
    for k, runs in enumerate(centres(found, n)):
        for cell, first, end in runs:
            column = (stable[k], total[k]) if found.result.base == 0 else (stable[:, k], total[:, k])
            truth = found.result.cells[cell]
            assert (column[0][first:end] == truth.stable).all()
            assert (column[1][first:end] == truth.total).all()


def test_error_of_a_certified_map() -> None:
    """Nothing but its cover is wrong, which is measured exactly; a count that is changed shows with its cell's area."""
    pytest.importorskip("numba")
    found, sides = exact("fig3")
    result = ptmcad.classify(found.result.slice, engine="certified", tolerance="1/5")
    for count in COUNTS:
        error = cover_error(found, sides[count], result, count)
        assert error is not None
        assert error.wrong[0] == error.undetermined == result.undetermined
        assert error.wrong[1] - error.wrong[0] < Fraction(1, 1000)
    largest = max(range(len(result.cells)), key=lambda n: result.regions[result.cells[n].region].area[0])
    cells = list(result.cells)
    cells[largest] = replace(cells[largest], stable=7)
    damaged = cover_error(found, sides["stable"], replace(result, cells=tuple(cells)), "stable")
    assert damaged is not None
    assert damaged.wrong[0] > result.undetermined + Fraction(1, 20)
