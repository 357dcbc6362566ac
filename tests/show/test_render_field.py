"""Contour lines of a quantity over a map."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.text import Text
from support.few import few
from support.maps import CONFIGS, shipped
from support.replacing import replace

import ptmcad
from ptmcad.cli.plot import poses_at
from ptmcad.cover.rectangles import Cover
from ptmcad.show.render.fieldpicture import (
    MIN_PIECE,
    MIN_RING,
    contour_lines,
    field_figure,
    pixel_edges,
)
from ptmcad.show.render.printing import settings
from ptmcad.show.style import MIN_FONT, styled


@pytest.mark.slow
def test_contours_have_their_values_at_the_scale_and_are_no_tiny_rings() -> None:
    result = shipped("fig4")
    field = result.field("energy", columns=60)
    rows, columns = np.indices(field.values.shape)
    ridge = 1.02 - ((rows - 30) / 30) ** 2 + 0.05 * np.cos(columns * 1.5)
    field = replace(field, values=ridge, region=np.zeros_like(field.region))
    figure = field_figure(result, field, (), 8, 100)
    axes: Any = figure.axes[0]
    lines = [c for c in axes.collections if isinstance(c, LineCollection)]
    assert lines
    for segment in (s for c in lines for s in c.get_segments()):
        least = MIN_RING if (segment[0] == segment[-1]).all() else MIN_PIECE
        assert np.hypot(*np.diff(segment / (2 / 60), axis=0).T).sum() >= least - 1e-6
    marks = next(c for c in figure.axes[1].collections if c.get_gid() == "levels")
    values = [s[0][1] for s in marks.get_segments()]
    assert len(values) == len([c for c in lines if c.get_segments()])
    # lines that were left out have their values there, too: the whole scale has numbers
    ticks = figure.axes[1].get_yticks()
    assert ticks[0] == 0.0 < values[0] and np.ptp(np.diff(ticks)) < 1e-9
    np.testing.assert_allclose(ticks[1:], values)


@pytest.mark.slow
def test_where_the_branch_changes_is_an_edge_which_no_contour_crosses() -> None:
    result = ptmcad.classify(CONFIGS / "mechanisms" / "platform.yaml", areas=False)
    field = result.field("angle:phi", columns=70)
    assert field.jumps is not None
    right, above = field.jumps
    assert not right.any() and above.shape == (69, 70)
    # another way to know: the exact poses below the two lines on which it changes, between them and
    # above
    exact = [
        poses_at(result, (Fraction(2), w)).equilibria[0]
        for w in (Fraction(-1, 2), Fraction(-1, 10), Fraction(1, 2))
    ]
    assert [float(pose.degrees[1].center) > 0 for pose in exact] == [True, False, True]
    rows = np.nonzero(above.any(axis=1))[0]
    assert len(rows) == 2
    (low, high) = ((field.y[r], field.y[r + 1]) for r in rows)
    assert low[0] < -0.25 < low[1] and high[0] < 0 < high[1]
    axes: Any = Figure().add_axes((0, 0, 1, 1))
    extent = (0.0, 3.0, -2.0, 2.0)
    found = [line for lines in contour_lines(axes, field, extent, 8).values() for line in lines]
    points = np.vstack(found)
    beyond = points[points[:, 0] > 1.4, 1]
    assert len(found) > 5 and len(beyond) > 50
    for start, end in (low, high):
        assert not ((start + 1e-9 < beyond) & (beyond < end - 1e-9)).any()
    heights = {y for side in pixel_edges(right, above, extent) for _, y in side}
    assert sorted(heights) == pytest.approx([sum(low) / 2, sum(high) / 2])


def test_an_angle_that_turns_once_more_is_no_other_branch_and_has_no_contour_there() -> None:
    result = shipped("fig4")
    field = result.field("angle:th1", columns=40)
    rows, columns = np.indices(field.values.shape)
    turning = np.remainder(columns * 15.0 + rows, 360) - 180
    field = replace(field, values=turning, region=np.zeros_like(field.region), jumps=None)
    found = contour_lines(Figure().add_axes((0, 0, 1, 1)), field, (0.0, 40.0, 0.0, 40.0), 8)
    # lines of the turn's slope only: none along the line of 180 degrees
    assert sum(map(len, found.values())) >= 7
    for level, lines in found.items():
        for line in lines:
            at = line - 0.5
            away = np.remainder(at[:, 0] * 15 + at[:, 1] - 180 - level + 180, 360) - 180
            assert np.abs(away).max() < 1e-6


def test_edges_are_the_sides_between_pixels_of_different_branches() -> None:
    right, above = np.zeros((3, 2), dtype=bool), np.zeros((2, 3), dtype=bool)
    right[0, 0] = above[1, 2] = True
    assert pixel_edges(right, above, (0.0, 3.0, 0.0, 3.0)) == [
        ((1.0, 0.0), (1.0, 1.0)),
        ((2.0, 2.0), (3.0, 2.0)),
    ]


@pytest.mark.parametrize("preset", few(["ieee", "poster"], "ieee"))
@pytest.mark.usefixtures("coarse")
def test_a_quantitys_map_has_all_text_on_the_page_and_none_too_small(preset: str) -> None:
    result = shipped("fig4")
    field = result.field("energy", "pose:3", 20)
    style = styled(preset)
    with settings(style):
        made = field_figure(result, field, result.boundaries(Fraction(1, 20)), 8, 60, style)
        canvas = FigureCanvasAgg(made)
        canvas.draw()
        renderer = canvas.get_renderer()
    shown = [text for text in made.findobj(Text) if text.get_text().strip() and text.get_visible()]
    assert {"the count changes", "the branch of pose 3 changes"} <= {
        text.get_text() for text in shown
    }
    assert min(text.get_fontsize() for text in shown) >= MIN_FONT
    boxes = [text.get_window_extent(renderer) for text in shown]
    width, height = made.bbox.width, made.bbox.height
    assert all(b.x0 >= 0 and b.y0 >= 0 and b.x1 <= width and b.y1 <= height for b in boxes)
    assert not [
        1 for a, b in combinations(boxes, 2) if a.shrunk(0.9, 0.9).overlaps(b.shrunk(0.9, 0.9))
    ]


@pytest.mark.slow
def test_a_contour_goes_on_over_a_curve_at_which_its_branch_does_not_change() -> None:
    """The bistable slider's 140 degrees, by symmetry at both sides of F = 0, cross the astroid to
    where c is 0.33.
    """
    result = ptmcad.classify(CONFIGS / "mechanisms" / "bistable-slider.yaml", areas=False)
    field = result.field("angle:th", columns=100, rows=100)
    axes: Any = Figure().add_axes((0, 0, 1, 1))
    found = contour_lines(axes, field, (-1.5, 1.5, 0.0, 1.0), 8)
    inside = [line for line in found[140.0] if abs(line[:, 0]).max() < 0.09]
    assert len(inside) == 1
    assert inside[0][np.argmax(inside[0][:, 0])] == pytest.approx([-0.03, 0.33], abs=0.02)


def test_edges_of_what_is_undetermined_are_no_curves_at_which_the_count_changes() -> None:
    """Nothing says that the counts on both sides of a certified map's gaps differ."""
    result = shipped("fig4")
    field = result.field("energy", "stable:1", 8, 8)
    curves = result.boundaries(tolerance=0.1)
    for given, words in (
        (result, "the count changes"),
        (replace(result, cover=Cover(1, ())), "edge of the undetermined part"),
    ):
        with settings():
            drawn = field_figure(given, field, curves, 0, 100)
        said = {text.get_text() for text in drawn.texts}
        assert said & {"the count changes", "edge of the undetermined part"} == {words}
