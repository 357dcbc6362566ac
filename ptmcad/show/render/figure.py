"""The figure of a region map with the stable poses at one of its points, as the paper shows them
side by side.

Guarantee: the point is marked where its exact coordinates are.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.axes import heading_of
from ptmcad.show.render.inches import stroke, write_lines
from ptmcad.show.render.layout import GAP, LEFT, SIDE
from ptmcad.show.render.legend import INK, Entry, Type, draw_legend
from ptmcad.show.render.mechanism import spring_mark, symbol_mark
from ptmcad.show.render.poses import (
    HEAD,
    assigned,
    below_panel,
    describe,
    panel,
    scale_bar,
    support_legend,
)
from ptmcad.show.render.printing import settings
from ptmcad.show.render.regionmap import FreeSpace, MapDrawing, description
from ptmcad.show.render.sketch import Scene, arrow_lengths, frame_of
from ptmcad.show.render.view import Point, View

_GAP, _RIM, _LINE = 0.2, 0.15, 0.2
_MAX_HEIGHT = 134.0
"""Of a panel, in points: two of them and the legend stand beside the map."""
_DPI = 150


def draw_figure(result: RegionMap, point: Point, poses: Poses) -> Figure:
    """The region map at the left, the stable poses at a point at the right; the point is marked in
    the map.

    Parameters
    ----------
    result : a map of a mechanism.
    point : of the map's window, in the order of its axes.
    poses : those there, of which one is stable at least.
    """
    shown = poses.working
    arrows = arrow_lengths(poses)
    mechanism = poses.model.whole
    assert mechanism is not None  # `arrow_lengths` has refused others
    parts = (Entry(("spring; bars are thick",), spring_mark()), *support_legend(mechanism))
    entries = (*parts, *_LOADS) if arrows else parts
    below = below_panel(shown[0], mechanism)
    values = [
        assigned(axis.name, value) for axis, value in zip(result.slice.axes, point, strict=True)
    ]
    head = textwrap.wrap(f"Stable poses at {', '.join(values)}", 34)
    frame = frame_of(shown, most_height=_MAX_HEIGHT)
    wide = 200.0 / 72
    panels = _LINE * len(head) + 0.1 + len(shown) * (HEAD + frame.height / 72 + below + 0.06)
    key = Type().height(entries) + 0.35
    with settings():
        # what the parts mean stands below the map's legend, unless that is long or insets are there
        figure = MapDrawing(result, dpi=_DPI).figure(FreeSpace(wide + _GAP + _RIM, panels))
        lowest = min(text.get_position()[1] for text in figure.texts)
        chart: Any = figure.axes[0]
        width, tall = (float(side) for side in figure.get_size_inches())
        bottom = chart.get_position().y0 * tall
        left, place = width - wide - _RIM, (LEFT + SIDE + GAP, bottom + key)
        if len(figure.axes) > 1 or lowest - 0.3 < bottom + key:
            figure = MapDrawing(result, dpi=_DPI).figure(
                FreeSpace(wide + _GAP + _RIM, panels + key)
            )
            chart = figure.axes[0]
            tall = float(figure.get_size_inches()[1])
            place = (left, chart.get_position().y1 * tall - panels)
        top = chart.get_position().y1 * tall
        figure.set_label(
            f"{heading_of(result.slice)}\n{description(result)} Beside it: {describe(poses)}"
        )
        _mark(chart, result, point)
        _write_head(figure, head, left, top)
        top -= _LINE * len(head) + 0.1
        for number, pose in enumerate(shown, 1):
            top -= HEAD + frame.height / 72
            panel(figure, Scene(mechanism, frame, arrows), pose, number, (left, top))
            top -= below + 0.06
        scale_bar(
            figure, frame, (place[0], place[1] - Type().height(entries) - 0.16), result.slice.units
        )
        draw_legend(figure, entries, *place)
    return figure


_POINT: dict[str, Any] = {
    "marker": "D", "markersize": 6.0, "markerfacecolor": "white", "markeredgecolor": INK, "markeredgewidth": 1.3,
    "linestyle": "none", "zorder": 7, "clip_on": False,
}  # fmt: skip


_LOADS = (Entry(("load",), symbol_mark("load")),)


def _write_head(figure: Figure, lines: Sequence[str], left: float, top: float) -> None:
    """Where the poses are, with the point's mark."""
    middle = top - _LINE / 2
    stroke(figure, (left + 0.04,), (middle,), gid="point-in-head", **_POINT)
    write_lines(figure, (left + 0.16, middle), lines, 9, _LINE, fontweight="bold", color=INK)


def _mark(chart: Any, result: RegionMap, point: Point) -> None:
    """A diamond at the point, in the axes' own scales."""
    x, y = View.whole(result).approximate_position(point)
    chart.add_artist(Line2D((x,), (y,), transform=chart.transAxes, gid="point", **_POINT))
