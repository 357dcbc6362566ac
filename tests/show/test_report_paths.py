"""The page's lines take few bytes, and are where they belong."""

from __future__ import annotations

import re
from itertools import pairwise
from math import dist as distance

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.certified_maps import circle
from support.maps import part_of_free02

from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.shapes import shapes
from ptmcad.show.report import page
from ptmcad.show.report.frame import SIDE
from ptmcad.show.report.pathdata import GRID, path_data

NUMBER = r"-?(?:\d+(?:\.\d+)?|\.\d+)"


def corners(data: str) -> list[tuple[float, float]]:
    """The corners of one line, read as SVG's grammar says."""
    tokens = re.findall(rf"[MHVLZ]|{NUMBER}", data)
    assert re.fullmatch(rf"(?:[MHVLZ]|{NUMBER}| )+", data) and "".join(tokens) == data.replace(" ", "")
    found: list[tuple[float, float]] = []
    x = y = 0.0
    command, rest = "", iter(tokens)
    for token in rest:
        if token == "Z":
            break
        command, number = (token, next(rest)) if token.isalpha() else (command, token)
        x = x if command == "V" else float(number)
        y = y if command == "H" else float(number if command == "V" else next(rest))
        found.append((x, y))
    return found


COORDINATES = st.one_of(st.floats(-600, 1200), st.sampled_from([0.0, 1.0, 0.5, 99.99, 100.0, 600.0]))


@given(st.lists(st.tuples(COORDINATES, COORDINATES), min_size=1, max_size=30), st.booleans())
def test_each_corner_is_within_half_a_step(line: list[tuple[float, float]], closed: bool) -> None:
    data = path_data(np.array(line), closed=closed)
    assert data.endswith("Z") == closed
    rest = [tuple(round(v * GRID) for v in corner) for corner in line]
    found = [tuple(round(v * GRID) for v in corner) for corner in corners(data)]
    assert rest[0] == found[0] and rest[-1] == found[-1]
    for a, b in pairwise(found):
        # until the next corner that is written, all are on the side to it, one after another
        at = rest.index(b)
        for one, other in pairwise([*rest[:at], b]):
            assert all(min(a[k], b[k]) <= other[k] <= max(a[k], b[k]) for k in (0, 1))
            assert abs(b[0] - other[0]) + abs(b[1] - other[1]) <= abs(b[0] - one[0]) + abs(b[1] - one[1])
            assert other in (one, b) or a[0] == other[0] == b[0] or a[1] == other[1] == b[1]
        rest = rest[at:]
    assert set(rest) == {found[-1]}


def area(polygon: list[tuple[float, float]]) -> float:
    ends = zip(polygon, [*polygon[1:], polygon[0]], strict=True)
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in ends) / 2


def placed(polygon: np.ndarray) -> list[tuple[float, float]]:
    """A polygon's corners in the page's units."""
    return [(x * SIDE, (1 - y) * SIDE) for x, y in polygon.tolist()]


def test_the_cells_of_a_page_are_those_of_the_map() -> None:
    result = circle(6)
    text = page(result)
    for number, polygons in shapes(result).cells():
        (data,) = re.findall(rf'<path class="cell" data-cell="{number}"[^>]* d="([^"]*)"', text)
        parts = [corners(f"M{part}") for part in data.split("M")[1:]]
        assert len(parts) == len(polygons)
        for part, polygon in zip(parts, polygons, strict=True):
            wanted = placed(polygon)
            assert all(min(distance(p, q) for q in wanted) < 0.71 / GRID for p in part)
            assert area(part) == pytest.approx(area(wanted), rel=1e-3)


def of_rectangles(result: RegionMap) -> int:
    assert result.cover is not None
    return len(result.cover.rectangles)


def test_a_rectangle_takes_few_bytes() -> None:
    """A square of a curve's cover has about four corners; each is written twice, in seven characters."""
    small, large = circle(6), circle(9)
    further = len(page(large).encode()) - len(page(small).encode())
    assert further < 16 * (of_rectangles(large) - of_rectangles(small))


def test_the_page_of_a_certified_map_is_small() -> None:
    result = part_of_free02()
    assert len(page(result).encode()) < 100_000 + 40 * of_rectangles(result)
