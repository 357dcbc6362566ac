"""The plane geometry of covers, against a flood fill on a grid whose pixels are squares, lines and
points.
"""

from __future__ import annotations

import math
import random
import tracemalloc
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from support.covers import covers
from support.examples import examples

from ptmcad.cover import components
from ptmcad.cover.complement import outlines, samples, simplest_between
from ptmcad.cover.connectivity import union_area
from ptmcad.cover.lattice import combined, from_boxes, gathered
from ptmcad.cover.rectangles import MAX_STEPS, Cover

UNIT = ((Fraction(0), Fraction(1)), (Fraction(0), Fraction(1)))
WINDOW = ((Fraction(1, 20), Fraction(2)), (Fraction(-7, 3), Fraction(5)))


@dataclass(frozen=True)
class Flood:
    """Pixel (2i+1, 2j+1) is a lattice square, pixels with an even coordinate are lines and points
    between them.

    ``closed`` shows what lies in a rectangle; ``label`` numbers the connected parts of both kinds,
    -1 on the rim.
    """

    closed: NDArray[np.bool_]
    label: NDArray[np.int64]

    def areas(self, closed: bool) -> dict[int, int]:
        squares = self.label[1::2, 1::2][self.closed[1::2, 1::2] == closed]
        numbers, areas = np.unique(squares, return_counts=True)
        return dict(zip(numbers.tolist(), areas.tolist(), strict=True))


def flood(cover: Cover) -> Flood:
    n = 2 * cover.steps + 1
    closed = np.zeros((n, n), dtype=np.bool_)
    for left, right, bottom, top in cover.rectangles:
        closed[2 * left : 2 * right + 1, 2 * bottom : 2 * top + 1] = True
    rim = np.ones_like(closed)
    rim[1:-1, 1:-1] = False
    label = np.full((n, n), -1, dtype=np.int64)
    fresh = 0
    for start in zip(*np.nonzero(label < 0), strict=True):
        if label[start] >= 0 or (rim[start] and not closed[start]):
            continue
        label[start], waiting = fresh, [start]
        while waiting:
            i, j = waiting.pop()
            for p, q in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
                if (
                    not (0 <= p < n and 0 <= q < n)
                    or label[p, q] >= 0
                    or closed[p, q] != closed[start]
                ):
                    continue
                if closed[p, q] or not rim[p, q]:
                    label[p, q] = fresh
                    waiting.append((p, q))
        fresh += 1
    return Flood(closed, label)


def check_against_flood(cover: Cover) -> None:
    found, grid = components(cover), flood(cover)
    assert sorted(grid.areas(False).values(), reverse=True) == list(found.areas)
    assert sorted(grid.areas(True).values(), reverse=True) == list(found.cluster_areas)
    assert union_area(cover) == sum(found.cluster_areas) == cover.steps**2 - sum(found.areas)

    label_of: dict[int, int] = {}
    for i in range(1, 2 * cover.steps):
        for j in range(1, 2 * cover.steps):
            number = found.locate(Fraction(i, 2), Fraction(j, 2))
            assert (number is None) == grid.closed[i, j]
            if number is not None:
                assert label_of.setdefault(number, grid.label[i, j]) == grid.label[i, j]
    assert len(set(label_of.values())) == len(label_of) == len(found.areas)
    cluster_label: dict[int, int] = {}
    for cluster, (left, _, bottom, _) in zip(found.cluster_of, cover.rectangles, strict=True):
        label = int(grid.label[2 * left + 1, 2 * bottom + 1])
        assert cluster_label.setdefault(cluster, label) == label
    assert len(set(cluster_label.values())) == len(cluster_label) == len(found.cluster_areas)

    near: set[tuple[int, int]] = set()
    n = len(grid.closed)
    for di in (-1, 0, 1):
        for dj in (-1, 0, 1):
            a = (slice(max(0, -di), n - max(0, di)), slice(max(0, -dj), n - max(0, dj)))
            b = (slice(max(0, di), n - max(0, -di)), slice(max(0, dj), n - max(0, -dj)))
            meet = ~grid.closed[a] & grid.closed[b] & (grid.label[a] >= 0)
            near |= set(
                zip(grid.label[a][meet].tolist(), grid.label[b][meet].tolist(), strict=True)
            )
    assert {(label_of[c], cluster_label[k]) for c, k in found.touching} == near


@settings(deadline=None, max_examples=examples(80))
@given(covers())
def test_components_and_clusters_are_those_of_a_flood_fill(cover: Cover) -> None:
    check_against_flood(cover)


@settings(deadline=None, max_examples=examples(50))
@given(covers(), st.sampled_from((1, 3, 2**20, 2**36 - 5, 2**36)))
def test_a_finer_lattice_scales_everything(cover: Cover, factor: int) -> None:
    """Coordinates of forty bits, and areas of eighty, are as exact as small ones."""
    finer = Cover(
        cover.steps * factor,
        tuple((factor * a, factor * b, factor * c, factor * d) for a, b, c, d in cover.rectangles),
    )
    first, second = components(cover), components(finer)
    assert second.areas == tuple(factor**2 * area for area in first.areas)
    assert second.rectangles == tuple(
        (factor * a, factor * b, factor * c, factor * d) for a, b, c, d in first.rectangles
    )
    assert second.clusters_at == first.clusters_at
    assert union_area(finer) == factor**2 * union_area(cover)


@settings(deadline=None, max_examples=examples(50))
@given(covers())
def test_samples_are_in_their_components_and_rectangles_can_not_grow(cover: Cover) -> None:
    found, grid = components(cover), flood(cover)
    for number, (left, right, bottom, top) in enumerate(found.rectangles):
        inside = (slice(2 * left + 1, 2 * right), slice(2 * bottom + 1, 2 * top))
        assert not grid.closed[inside].any()
        for grown in ((left - 1, right, bottom, top), (left, right + 1, bottom, top),
                      (left, right, bottom - 1, top), (left, right, bottom, top + 1)):  # fmt: skip
            a, b, c, d = grown
            assert (
                min(grown) < 0
                or max(grown) > cover.steps
                or grid.closed[2 * a + 1 : 2 * b, 2 * c + 1 : 2 * d].any()
            )
        (x0, x1), (y0, y1) = WINDOW
        across, up = (x1 - x0) / cover.steps, (y1 - y0) / cover.steps
        for x, y in samples(found, number, WINDOW):
            assert (
                found.locate((x - x0) / (x1 - x0) * cover.steps, (y - y0) / (y1 - y0) * cover.steps)
                == number
            )
            assert left * across < x - x0 < right * across and bottom * up < y - y0 < top * up


@settings(deadline=None, max_examples=examples(50))
@given(covers())
def test_samples_are_numbered_and_lattice_points_are_looked_up_as_single_points_are(
    cover: Cover,
) -> None:
    found, half = components(cover), Fraction(1, 2)
    own = [next(samples(found, number, WINDOW)) for number in range(len(found.areas))]
    known = {number: len(own) - 1 - number for number in range(len(own))}
    assert found.numbered(own[::-1], WINDOW) == known
    for sample in own[:1]:
        with pytest.raises(
            ValueError, match="sample of cell 1 is in the cover or in the component"
        ):
            found.numbered([sample, sample], WINDOW)
    steps = np.arange(cover.steps)
    image = found.raster(steps[:2], steps).tolist()
    for row, u, v in ((image[v], u, v) for v in steps.tolist() for u in steps[:2].tolist()):
        component = found.locate(u + half, v + half)
        assert row[u] == (-1 if component is None else component)


@settings(deadline=None, max_examples=examples(80))
@given(covers())
def test_a_combined_cover_covers_the_same_with_no_more_rectangles(cover: Cover) -> None:
    after = combined(cover)
    assert len(after.rectangles) <= len(cover.rectangles)
    assert (flood(after).closed == flood(cover).closed).all()
    assert list(after.rectangles) == sorted(set(after.rectangles))


def test_many_rectangles_over_each_other_take_little_memory() -> None:
    """As where a curve of solutions is double: 12 800 in 40 squares; each crosses all others of its
    square.
    """
    generator = random.Random(5)
    found = []
    for k in range(40):
        left, bottom = 512 * (k % 20), 1024 * (k // 20)
        for _ in range(320):
            a, b, c, d = (generator.randrange(200) for _ in range(4))
            found.append((left + a, left + 511 - b, bottom + c, bottom + 511 - d))
        found.append((left, left + 511, bottom, bottom + 511))
    cover = Cover(16384, tuple(sorted(set(found))))
    tracemalloc.start()
    try:
        after = combined(cover)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert len(after.rectangles) == 40
    assert peak < 20_000_000


@settings(deadline=None, max_examples=examples(80))
@given(covers(), st.integers(1, 20))
def test_gathered_rectangles_are_few_and_cover_at_least_the_same(cover: Cover, most: int) -> None:
    after = gathered(cover, most)
    assert len(after.rectangles) <= most
    assert (flood(after).closed >= flood(cover).closed).all()
    if len(cover.rectangles) <= most:
        assert after == cover


def test_gathered_rectangles_stay_close_to_a_line() -> None:
    diagonal = Cover(1024, tuple((k, k + 1, k, k + 1) for k in range(1024)))
    after = gathered(diagonal, 64)
    assert after.rectangles == tuple((k, k + 16, k, k + 16) for k in range(0, 1024, 16))


def test_where_finer_squares_are_more_than_asked_for_coarse_ones_stay() -> None:
    nested = Cover(64, ((0, 1, 0, 1), (0, 64, 0, 64)))
    assert gathered(nested, 1).rectangles == ((0, 64, 0, 64),)


@settings(deadline=None, max_examples=examples(80))
@given(covers())
def test_outlines_go_around_their_components(cover: Cover) -> None:
    """Their signed areas add up to the component's, and every corner turns by a right angle."""
    found = components(cover)
    for number, polygons in enumerate(outlines(found, range(len(found.areas)))):
        twice = 0
        for corners in polygons:
            x, y = corners.T.tolist()
            after = [*range(1, len(x)), 0]
            twice += sum(x[k] * y[a] - x[a] * y[k] for k, a in enumerate(after))
            for k, a in enumerate(after):
                assert (x[k] == x[a]) != (y[k] == y[a])
                assert (x[k] == x[a]) != (x[a] == x[after[a]])
        assert twice == 2 * found.areas[number]


def test_area_bounds_count_a_shared_cluster_once() -> None:
    ring = Cover(8, ((2, 6, 2, 3), (2, 6, 5, 6), (2, 3, 2, 6), (5, 6, 2, 6)))
    found = components(ring)
    assert found.areas == (48, 4)
    assert found.area_bounds(0, {0, 1}) == (48, 60)
    assert found.area_bounds(1, {0, 1}) == (4, 16)
    assert found.area_bounds(0, {0}) == (48, 64)


def test_two_rectangles_that_touch_in_a_corner_part_the_window() -> None:
    """The corner is in both closed rectangles, so no path goes through it."""
    found = components(Cover(4, ((0, 2, 0, 2), (2, 4, 2, 4))))
    assert found.areas == (4, 4)
    assert found.cluster_areas == (8,)
    assert found.locate(Fraction(2), Fraction(2)) is None
    assert found.rectangles == ((0, 2, 2, 4), (2, 4, 0, 2))


@pytest.mark.parametrize("steps", [1, 8, MAX_STEPS])
def test_an_empty_cover_leaves_the_whole_window(steps: int) -> None:
    found = components(Cover(steps, ()))
    assert found.areas == (steps**2,)
    assert found.rectangles == ((0, steps, 0, steps),)
    assert found.locate(Fraction(steps, 2), Fraction(steps, 3)) == 0


def test_a_full_cover_leaves_nothing() -> None:
    found = components(Cover(4, ((0, 4, 0, 4),)))
    assert found.areas == found.rectangles == ()
    assert found.locate(Fraction(1), Fraction(1)) is None


@pytest.mark.parametrize(
    "rectangle",
    [
        (1, 1, 0, 2),
        (2, 1, 0, 2),
        (-1, 1, 0, 2),
        (0, 5, 0, 2),
        (0, 2, 3, 3),
        (0, 2, 0, 2**70),
        (0, 2, 0),
    ],
)
def test_what_is_no_rectangle_of_the_window_is_refused(rectangle: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="rectangle"):
        components(Cover(4, (rectangle,)))  # type: ignore[arg-type]


@pytest.mark.parametrize("steps", [0, 2 * MAX_STEPS])
def test_a_lattice_without_steps_or_too_fine_is_refused(steps: int) -> None:
    with pytest.raises(ValueError, match="steps"):
        components(Cover(steps, ()))


@pytest.mark.parametrize("at", [(0, 1), (1, 0), (4, 1), (1, 4), (-1, 1)])
def test_a_point_outside_the_open_window_has_no_component(at: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="open window"):
        components(Cover(4, ())).locate(Fraction(at[0]), Fraction(at[1]))


def near_a_line(k: int, towards: float) -> float:
    """The float next to a line of WINDOW's first axis, or a plain fraction."""
    line = float(WINDOW[0][0] + (WINDOW[0][1] - WINDOW[0][0]) * k / 64)
    return math.nextafter(line, towards) if towards else k / 64


ends = st.one_of(
    st.floats(allow_nan=False),
    st.floats(-8, 8),
    st.builds(near_a_line, st.integers(-1, 65), st.sampled_from((-math.inf, 0, math.inf))),
)


@settings(max_examples=examples(300))
@given(
    st.lists(st.tuples(ends, ends, ends, ends), max_size=6),
    st.sampled_from((1, 64, 2**24, MAX_STEPS)),
)
def test_boxes_are_rounded_outward_by_less_than_two_steps(
    boxes: list[tuple[float, ...]], steps: int
) -> None:
    for a, b, c, d in boxes:
        low, high = (min(a, b), min(c, d)), (max(a, b), max(c, d))
        found = from_boxes(WINDOW, [low], [high], steps).rectangles
        sides: list[tuple[Fraction, Fraction]] = []
        for first, last, (start, end) in zip(low, high, WINDOW, strict=True):
            u, v = (
                (Fraction(min(max(x, -1e300), 1e300)) - start) / (end - start) * steps
                for x in (first, last)
            )
            sides.append((u, v))
        if not found:
            assert any(u >= steps or v <= 0 for u, v in sides)
            continue
        for (u, v), (left, right) in zip(sides, (found[0][:2], found[0][2:]), strict=True):
            assert max(u - 2, -1) < left <= max(u, 0)
            assert min(v, steps) <= right < min(v + 2, steps + 1)


def test_boxes_are_sorted_and_each_rectangle_is_kept_once() -> None:
    low, high = (
        [[0.6, 0.1], [0.1, 0.6], [0.6, 0.1], [2.0, 0.1]],
        [[0.7, 0.2], [0.2, 0.7], [0.7, 0.2], [3.0, 0.2]],
    )
    assert from_boxes(UNIT, low, high, 4).rectangles == ((0, 1, 2, 3), (2, 3, 0, 1))


@pytest.mark.parametrize(
    "scale", [Fraction(10) ** 400, Fraction(1, 10**400)], ids=["1e400", "1e-400"]
)
def test_a_window_beyond_the_range_of_floats_is_rounded_exactly(scale: Fraction) -> None:
    window = ((-scale, scale), (Fraction(-1), Fraction(1)))
    found = from_boxes(window, [[0.0, 0.1]], [[5e-324, 0.4]], 8)
    right = 5 if scale > 1 else 8
    assert found.rectangles == ((4, right, 4, 6),)
    assert from_boxes(window, [[0.0, 0.1]], [[0.0, 0.4]], 8).rectangles == ((4, 5, 4, 6),)


@pytest.mark.parametrize("box", [((0.0, math.nan), (1.0, 1.0)), ((0.5, 0.0), (0.25, 1.0))])
def test_boxes_that_are_none_are_refused(
    box: tuple[tuple[float, float], tuple[float, float]],
) -> None:
    with pytest.raises(ValueError, match="low end"):
        from_boxes(UNIT, [box[0]], [box[1]], 8)


@given(st.fractions(), st.fractions())
def test_the_simplest_fraction_has_the_least_denominator(a: Fraction, b: Fraction) -> None:
    low, high = min(a, b), max(a, b)
    found = simplest_between(low, high)
    assert low <= found <= high
    for denominator in range(1, min(found.denominator, 200)):
        assert math.floor(high * denominator) < math.ceil(low * denominator)


def test_many_rectangles_need_longer_arrays() -> None:
    """A diagonal of 5000 squares on the finest lattice: deep, and more parts than the arrays begin
    with.
    """
    side = MAX_STEPS // 8192
    cover = Cover(
        MAX_STEPS, tuple((k * side, (k + 1) * side, k * side, (k + 1) * side) for k in range(5000))
    )
    assert components(cover).cluster_areas == (5000 * side**2,)
