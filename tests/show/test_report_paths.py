"""The page's lines take few bytes, and are where they belong."""

from __future__ import annotations

import re

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
    tokens = re.findall(rf"[MhvlZ]|{NUMBER}", data)
    assert re.fullmatch(rf"(?:[MhvlZ]|{NUMBER}| )+", data) and "".join(tokens) == data.replace(" ", "")
    found: list[tuple[float, float]] = []
    x = y = 0.0
    command, rest = "", iter(tokens)
    for token in rest:
        if token == "Z":
            break
        command, number = (token, next(rest)) if token.isalpha() else (command, token)
        if command == "M":
            x, y = float(number), float(next(rest))
        else:
            x += float(number) if command in "hl" else 0.0
            y += float(next(rest)) if command == "l" else float(number) if command == "v" else 0.0
        found.append((x, y))
    return found


COORDINATES = st.one_of(st.floats(-600, 1200), st.sampled_from([0.0, 1.0, 0.5, 99.99, 100.0, 600.0]))


@given(st.lists(st.tuples(COORDINATES, COORDINATES), min_size=1, max_size=30), st.booleans())
def test_each_corner_is_within_half_a_step(line: list[tuple[float, float]], closed: bool) -> None:
    data = path_data(np.array(line), closed=closed)
    assert data.endswith("Z") == closed
    found = corners(data)
    rounded = [tuple(round(v * GRID) for v in p) for p in line]
    kept = [p for k, p in enumerate(line) if not k or rounded[k] != rounded[k - 1]]
    assert len(found) == len(kept)
    for one, other in zip(found, kept, strict=True):
        assert one == pytest.approx(other, abs=0.5 / GRID + 1e-6)


def test_the_cells_of_a_page_are_those_of_the_map() -> None:
    result = circle(6)
    text = page(result)
    for number, polygons in shapes(result).cells():
        (data,) = re.findall(rf'<path class="cell" data-cell="{number}"[^>]* d="([^"]*)"', text)
        parts = [corners(f"M{part}") for part in data.split("M")[1:]]
        assert len(parts) == len(polygons)
        for part, polygon in zip(parts, polygons, strict=True):
            placed = np.stack([polygon[:, 0], 1 - polygon[:, 1]], axis=1) * SIDE
            assert np.array(part) == pytest.approx(placed, abs=0.5 / GRID + 1e-6)


def of_rectangles(result: RegionMap) -> int:
    assert result.cover is not None
    return len(result.cover.rectangles)


def test_a_rectangle_takes_few_bytes() -> None:
    """A square of a curve's cover has about four corners; each is written twice, in five characters a coordinate."""
    small, large = circle(6), circle(9)
    further = len(page(large).encode()) - len(page(small).encode())
    assert further < 16 * (of_rectangles(large) - of_rectangles(small))


def test_the_page_of_a_certified_map_is_small() -> None:
    result = part_of_free02()
    assert len(page(result).encode()) < 110_000 + 40 * of_rectangles(result)
