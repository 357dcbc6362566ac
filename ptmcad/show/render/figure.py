"""The figure of a region map with the stable poses at one of its points, as the paper shows them side by side.

Guarantee: the point is marked where its exact coordinates are, and the poses belong to the map's mechanisms: every
parameter of the poses is what the slice says at that point.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.slice import Slice
from ptmcad.show.render.axes import heading_of
from ptmcad.show.render.inches import stroke, write_lines
from ptmcad.show.render.layout import GAP, LEFT, SIDE
from ptmcad.show.render.legend import INK, Entry, Type, draw_legend
from ptmcad.show.render.mechanism import spring_mark, symbol_mark
from ptmcad.show.render.poses import (
    BELOW,
    HEAD,
    assigned,
    below_panel,
    describe,
    panel,
    scale_bar,
    support_legend,
    value_text,
)
from ptmcad.show.render.printing import settings
from ptmcad.show.render.regionmap import FreeSpace, MapDrawing, description
from ptmcad.show.render.sketch import Scene, arrow_lengths, frame_of
from ptmcad.show.render.view import Point, View

_GAP, _RIM, _LINE = 0.2, 0.15, 0.2
_MAX_HEIGHT = 134.0
"""Of a panel, in points: two of them and the legend stand beside the map."""
_DPI = 150


def draw_figure(result: RegionMap, poses: Poses) -> Figure:
    """The region map at the left, the stable poses at a point at the right; the point is marked in the map.

    Parameters
    ----------
    result : a map of a mechanism.
    poses : at a point of the map's plane.

    Raises
    ------
    ValueError
        When the poses are those of no point of the map's window.
    """
    x, y = point_of(result.slice, poses)
    shown, told = poses.working, poses.known_stable is not None
    arrows = arrow_lengths(poses)
    mechanism = poses.model.whole
    assert mechanism is not None  # `arrow_lengths` has refused others
    parts = (Entry(("spring; bars are thick",), spring_mark()), *support_legend(mechanism))
    entries = (*parts, *_LOADS) if arrows else parts
    below = below_panel(shown[0], mechanism) if shown else BELOW
    values = [assigned(a.name, v) for a, v in zip(result.slice.axes, (x, y), strict=True)]
    head = textwrap.wrap(
        f"{('Stable poses' if told else 'Poses') if shown else 'No stable pose' if told else 'No pose'} at "
        + ", ".join(values),
        34,
    )
    frame = frame_of(shown, most_height=_MAX_HEIGHT) if shown else None
    wide = 200.0 / 72
    panels = _LINE * len(head) + 0.1
    if frame is not None:
        panels += len(shown) * (HEAD + frame.height / 72 + below + 0.06)
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
            figure = MapDrawing(result, dpi=_DPI).figure(FreeSpace(wide + _GAP + _RIM, panels + key))
            chart = figure.axes[0]
            tall = float(figure.get_size_inches()[1])
            place = (left, chart.get_position().y1 * tall - panels)
        top = chart.get_position().y1 * tall
        figure.set_label(f"{heading_of(result.slice)}\n{description(result)} Beside it: {describe(poses)}")
        _mark(chart, result, (x, y))
        _write_head(figure, head, left, top)
        top -= _LINE * len(head) + 0.1
        if frame is not None:
            for number, pose in enumerate(shown, 1):
                top -= HEAD + frame.height / 72
                panel(figure, Scene(mechanism, frame, arrows), pose, number, (left, top))
                top -= below + 0.06
            scale_bar(figure, frame, (place[0], place[1] - Type().height(entries) - 0.16), result.slice.units)
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


def point_of(slice: Slice, poses: Poses) -> Point:
    """The point of the slice's window whose mechanism the poses are of.

    Raises
    ------
    ValueError
        When there is none, or no parameter is a number times an axis, so that it cannot be read off.
    """
    found = []
    for axis, exponents in zip(slice.axes, ((1, 0), (0, 1)), strict=True):
        scaled = [
            (name, expression.numerator[0][2] / expression.denominator[0][2])
            for name, expression in slice.parameters.items()
            if name in poses.parameters
            and expression.is_polynomial
            and [term[:2] for term in expression.numerator] == [exponents]
        ]
        if not scaled:
            raise ValueError(f"no parameter of the slice {slice.name} is a number times {axis.name}")
        name, factor = scaled[0]
        value = poses.parameters[name] / factor
        if not axis.low <= value <= axis.high:
            raise ValueError(f"{axis.name} {value_text(value)} is not in the window of {slice.name}")
        found.append(value)
    x, y = found
    for name, value in poses.parameters.items():
        if name in slice.parameters and slice.parameters[name].evaluate(x, y) != value:
            raise ValueError(
                f"the poses have {name} {value_text(value)}, which {slice.name} does not have at that point"
            )
    return x, y
