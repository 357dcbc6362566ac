"""The page's lines take few bytes, and are where they belong."""

from __future__ import annotations

import re
from itertools import pairwise
from math import dist as distance

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.certified_maps import certified, circle, crossing, cusp
from support.maps import part_of_free02
from support.pages import corners

from ptmcad.answer.regionmap import RegionMap
from ptmcad.cover.rectangles import Cover
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.polylines import GRID, path_data
from ptmcad.show.report import page
from ptmcad.show.report.mapsvg import SIDE, SLACK

COORDINATES = st.one_of(
    st.floats(-600, 1200), st.sampled_from([0.0, 1.0, 0.5, 99.99, 100.0, 600.0])
)


@given(st.lists(st.tuples(COORDINATES, COORDINATES), min_size=1, max_size=30), st.booleans())
def test_each_corner_is_within_half_a_step(line: list[tuple[float, float]], closed: bool) -> None:
    data = path_data(np.array(line), closed=closed)
    assert data.endswith("z") == closed
    rest = [tuple(round(v * GRID) for v in corner) for corner in line]
    found = [tuple(round(v * GRID) for v in corner) for corner in corners(data)]
    if len(set(rest)) == 1:
        assert found == [rest[0], (rest[0][0] + 1, rest[0][1])]  # so that it is drawn
        return
    assert found == [b for a, b in pairwise([None, *rest]) if a != b]


def area(polygon: list[tuple[float, float]]) -> float:
    ends = zip(polygon, [*polygon[1:], polygon[0]], strict=True)
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in ends) / 2


def placed(polygon: np.ndarray) -> list[tuple[float, float]]:
    """A polygon's corners in the page's units."""
    return [(x * SIDE, (1 - y) * SIDE) for x, y in polygon.tolist()]


@pytest.mark.parametrize(
    "result", [circle(6), crossing(6), cusp(9)], ids=["circle", "crossing", "cusp"]
)
@pytest.mark.slow_cases("cusp")
def test_the_cells_of_a_page_are_those_of_the_map(result: RegionMap) -> None:
    """Every corner of the map's own outline is as near to what is drawn as `SLACK` says; and it is
    drawn once.
    """
    text = page(result)
    for number, polygons in shapes(result).cells(1e-9):
        (data,) = re.findall(rf'<path id="map-{number}" class="outline" d="([^"]*)"', text)
        parts = [corners(f"M{part}") for part in data.split("M")[1:]]
        assert len(parts) == len(polygons)
        for part, polygon in zip(parts, polygons, strict=True):
            assert farthest(np.array(placed(polygon)), np.array(part)) < SLACK
            assert area(part) == pytest.approx(area(placed(polygon)), rel=0.05, abs=2)
        assert text.count(data) == 1


def farthest(points: np.ndarray, polygon: np.ndarray) -> float:
    """The largest distance of a point from a polygon's sides."""
    along = (np.roll(polygon, -1, axis=0) - polygon)[None]
    offset = points[:, None] - polygon[None]
    share = np.clip((offset * along).sum(axis=2) / np.maximum((along**2).sum(axis=2), 1e-300), 0, 1)
    return float(np.hypot(*np.moveaxis(offset - share[:, :, None] * along, 2, 0)).min(axis=1).max())


def speck(side: int) -> RegionMap:
    """A window that is known but for a square of so many steps of 2^-12 around (3/8, 5/8)."""
    x, y = 3 * 2**9, 5 * 2**9
    return certified(Cover(2**12, ((x, x + side, y, y + side),)), lambda x, y: 2)


@pytest.mark.parametrize("side", [1, 2, 3, 40])
def test_no_speck_of_what_is_undetermined_is_left_out(side: int) -> None:
    """However small it is, a rim of its own is there, and at least twice as wide as the rims may be
    moved.
    """
    text = page(speck(side))
    (data,) = re.findall(r'<path id="map-0" class="outline" d="([^"]*)"', text)
    inner, outer = sorted(
        (corners(f"M{part}") for part in data.split("M")[1:]), key=lambda part: abs(area(part))
    )
    assert len(outer) == 4 and len(inner) >= 2
    assert min(distance(p, (600 * 3 / 8, 600 * 3 / 8)) for p in inner) < SLACK + 1e-9
    widths = re.findall(r'<use class="(?:rim|open)" [^>]*stroke-width="([^"]*)"', text)
    assert len(widths) == 2 and min(map(float, widths)) >= 2 * SLACK * GRID


def of_rectangles(result: RegionMap) -> int:
    assert result.cover is not None
    return len(result.cover.rectangles)


def test_a_curve_takes_no_more_bytes_in_smaller_rectangles() -> None:
    """Below what can be seen: four times as many rectangles."""
    small, large = circle(9), circle(11)
    further = len(page(large).encode()) - len(page(small).encode())
    assert further < (of_rectangles(large) - of_rectangles(small)) / 2


def test_the_page_of_a_certified_map_is_small() -> None:
    assert len(page(part_of_free02()).encode()) < 130_000
