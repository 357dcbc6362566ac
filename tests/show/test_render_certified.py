"""Pictures and pages of certified maps: what is undetermined is seen, at its size, and the rest as
in exact maps.
"""

from __future__ import annotations

import re
from fractions import Fraction
from html import unescape
from math import ceil, pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.colors import to_rgb
from matplotlib.image import imread
from matplotlib.path import Path as Curve
from support.certified_maps import certified, circle, crossing, cusp
from support.pages import data_of
from support.replacing import replace

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.cover.rectangles import Cover
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Count, Point
from ptmcad.show.render import draw
from ptmcad.show.render.colours import CORE, ONE_MAXIMUM, RIM, TWO_MAXIMA, UNDETERMINED
from ptmcad.show.render.coveroutline import TOLERANCE
from ptmcad.show.render.mappicture import MapDrawing, _zoomed
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.polylines import simplified_polygon
from ptmcad.show.render.printing import settings as rendering
from ptmcad.show.render.view import View
from ptmcad.show.report import page

STEPS = 2**20


def tube(low: float, high: float) -> RegionMap:
    """An upright strip that is undetermined, between two regions of two stable equilibria."""
    return certified(
        Cover(STEPS, ((int(low * STEPS), int(high * STEPS), 0, STEPS),)), lambda x, y: 2
    )


def map_pixels(result: RegionMap, folder: Path, dpi: int) -> np.ndarray:
    """The map's part of the picture, from the top, shape (n, n, 3)."""
    draw(result, folder / "map.png", dpi=dpi)
    image = imread(folder / "map.png")[:, :, :3]
    with rendering():
        (chart,) = MapDrawing(result, dpi=dpi).figure().axes
    box = chart.get_window_extent()
    top, left = len(image) - round(box.y1), round(box.x0)
    return image[top : top + int(box.height), left : left + int(box.width)]


def test_what_is_undetermined_looks_like_no_count() -> None:
    grey = np.array(to_rgb(UNDETERMINED.face))
    for face in (*ONE_MAXIMUM, *TWO_MAXIMA, "#ffffff"):
        assert np.abs(np.array(to_rgb(face)) - grey).max() > 0.1


@pytest.mark.parametrize("dpi", [100, 150, 300])
@pytest.mark.parametrize("width", [1e-5, 1e-4, 1e-3])
@pytest.mark.fast_cases("0.0001-100")
def test_a_narrow_tube_is_seen_as_grey_between_its_rims(
    dpi: int, width: float, tmp_path: Path
) -> None:
    """Some pixel across it is of clearly another colour, and no more of them than a line with two
    rims touches; where pixels are small enough one of them is as grey as the legend's."""
    row = map_pixels(tube(0.4, 0.4 + width), tmp_path, dpi)[dpi]
    middle = np.abs(row - np.median(row, axis=0)).max(axis=1)[10:-10]
    assert middle.max() > 0.15
    assert (middle > 0.02).sum() <= ceil((CORE + 2 * RIM) * dpi / 72 + width * len(row)) + 1
    if dpi == 300:
        assert np.abs(row - np.array(to_rgb(UNDETERMINED.face))).max(axis=1).min() < 0.05


def test_the_legend_tells_the_undetermined_share(tmp_path: Path) -> None:
    result = tube(0.25, 0.25 + 2**-11)  # 1/2048 of the window
    texts = [text.get_text() for text in MapDrawing(result, dpi=100).figure().texts]
    assert "undetermined 0.049 %" in texts
    assert "the count changes" not in texts
    draw(result, tmp_path / "map.svg")
    assert "</svg>" in (tmp_path / "map.svg").read_text()


def test_admissible_counts_have_colours_and_a_legend() -> None:
    made = circle(6)
    result = replace(made, slice=replace(made.slice, count=Count.ADMISSIBLE))
    texts = [text.get_text() for text in MapDrawing(result, dpi=100).figure().texts]
    assert "Stable, all springs taut" in texts
    assert "3 of 8 equilibria" in texts


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
@pytest.mark.fast_cases("svg")
def test_the_same_map_gives_the_same_bytes(suffix: str, tmp_path: Path) -> None:
    for name in ("first", "second"):
        draw(crossing(6), tmp_path / f"{name}.{suffix}")
    assert (tmp_path / f"first.{suffix}").read_bytes() == (
        tmp_path / f"second.{suffix}"
    ).read_bytes()


def test_a_thin_region_is_marked_and_zoomed() -> None:
    cover = Cover(
        STEPS,
        ((STEPS // 2, STEPS // 2 + 64, 0, STEPS), (STEPS // 2 + 2000, STEPS // 2 + 2064, 0, STEPS)),
    )
    figure = MapDrawing(certified(cover, lambda x, y: 3 if 0.5 < x < 0.502 else 1)).figure()
    assert [axes.get_gid() for axes in figure.axes] == ["map", "sliver-2"]


@pytest.mark.parametrize(
    "result", [circle(6), crossing(6), cusp(7)], ids=["circle", "crossing", "cusp"]
)
@pytest.mark.slow_cases("circle", "crossing")
def test_polygons_and_raster_agree_with_the_exact_answer(result: RegionMap) -> None:
    """At points that are farther from any outline than simplification moves it."""
    seen = shapes(result).in_view(
        View((Fraction(1, 3), Fraction(3, 2)), (Fraction(2, 5), Fraction(7, 4)))
    )
    n = 41
    raster = seen.raster(n, n)
    polygons = seen.polygons()
    edges = np.concatenate([np.concatenate(p) for p in polygons if p])
    for i in range(n):
        for j in range(n):
            at = np.array([(j + 0.5) / n, (i + 0.5) / n])
            x = seen.view.x[0] + (seen.view.x[1] - seen.view.x[0]) * Fraction(2 * j + 1, 2 * n)
            y = seen.view.y[0] + (seen.view.y[1] - seen.view.y[0]) * Fraction(2 * i + 1, 2 * n)
            number = seen.complement.locate(*(v / 2 * seen.complement.cover.steps for v in (x, y)))  # type: ignore[attr-defined]
            exact = -1 if number is None else int(seen.region_at[number])  # type: ignore[attr-defined]
            assert raster[i, j] == exact
            if np.abs(edges - at).max(axis=1).min() < 0.02:
                continue
            inside = [
                k for k, p in enumerate(polygons) if sum(Curve(c).contains_point(at) for c in p) % 2
            ]
            assert inside == ([exact] if exact >= 0 else [])


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 60), st.integers(0, 60)), min_size=1, max_size=60))
def test_simplified_polygons_stay_near_and_keep_their_corners(
    corners: list[tuple[int, int]],
) -> None:
    points = np.array(corners, dtype=float) * 0.4 * TOLERANCE
    few = simplified_polygon(points, TOLERANCE)
    assert {tuple(p) for p in few.tolist()} <= {tuple(p) for p in points.tolist()}
    if len(few) < 2:
        return
    for p in points:
        a, b = few, np.roll(few, -1, axis=0)
        along = b - a
        share = np.clip(
            ((p - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300), 0, 1
        )
        assert np.hypot(*(p - a - share[:, None] * along).T).min() <= TOLERANCE * 1.000001


def test_a_triangle_stays_however_flat() -> None:
    flat = np.array([[0.0, 0.0], [9.0, 0.0], [4.0, 0.1]])
    assert simplified_polygon(flat, 1.5).tolist() == flat.tolist()


# ------------------------------------------------------------------------------------------------------- the page


def test_the_page_tells_status_undetermined_area_and_bounds() -> None:
    result = circle(8)
    text = page(result)
    plain = unescape(re.sub("<[^>]*>", " ", text))
    assert "Certified result." in plain
    share = f"{float(result.undetermined) * 100:.2f}"[:3]
    assert f"Undetermined: {share}" in plain
    bounds = [
        tuple(map(Fraction, pair)) for pair in re.findall(r"proved: ([0-9.]+) to ([0-9.]+)", plain)
    ]
    for (low, high), region in zip(bounds, result.regions, strict=True):
        assert low <= region.area[0] < region.area[1] <= high
        assert high - low < region.area[1] - region.area[0] + Fraction(1, 10**5)
    assert bounds[1][0] < pi / 4 < bounds[1][1]
    assert "Boundary curves" not in text and "polynomial" not in plain
    data = data_of(text)
    assert [cell["stack"] for cell in data["cells"]] == [None, None]
    assert text.count('<use class="cell" ') == 2
    assert 'class="undetermined"' in text and 'class="rim"' in text


def test_a_partial_map_says_so_on_its_page() -> None:
    text = page(certified(Cover(8, ((0, 4, 0, 8),)), lambda x, y: 2, status=Status.PARTIAL))
    assert "Partial result." in text
    assert "Undetermined: 50 %" in text


def test_a_map_without_any_cell_is_drawn_and_reported(tmp_path: Path) -> None:
    result = certified(Cover(4, ((0, 4, 0, 4),)), lambda x, y: 2, status=Status.PARTIAL)
    assert "No regions are known yet." in page(result)
    draw(result, tmp_path / "map.png")


@pytest.mark.parametrize("fault", ["in the cover", "twice", "stack"])
def test_a_damaged_certified_map_has_no_page(fault: str) -> None:
    result = circle(6)
    first, second = result.cells
    if fault == "in the cover":
        damaged = replace(first, sample=Point(result.slice.axis_names, Fraction(1, 2), Fraction(1)))
    elif fault == "twice":
        damaged = replace(first, sample=second.sample)
    else:
        damaged = replace(first, stack=0)
    with pytest.raises(ConfigError, match="contradicts itself"):
        page(replace(result, cells=(damaged, second)))


@pytest.mark.parametrize(
    ("area", "lines"),
    [
        ("", ("B: 3", "zoomed")),
        ("0.002", ("B: 3", "area 0.002, zoomed")),
        ("0.00000898 to 0.00001195", ("B: 3, zoomed", "area 0.00000898 to 0.00001195")),
        (
            "0.00001046712345 to 0.00001046712351",
            ("B: 3, zoomed, area 0.00001046712345", "to 0.00001046712351"),
        ),
    ],
)
def test_what_stands_over_a_zoomed_view_is_not_cut_off(area: str, lines: tuple[str, str]) -> None:
    """With the digits of a map to 1e-6 it once went beyond the picture's edge."""
    assert _zoomed("B: 3", area) == "\n".join(lines)
    assert max(map(len, lines)) < 37
