"""The drawing of a mechanism's sketch: thick bars, zigzag springs, spirals, supports, sliders,
arrows for loads.

Guarantee: stable poses are strong and others pale, which grey prints and colour-blind eyes see as
well: each colour's pale version is lighter by at least 25 units of CIE L*, and two bars differ in
width and lightness.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle

from ptmcad.model import Mechanism, Support
from ptmcad.show.linedrawing import approximate_places, fitted
from ptmcad.show.render.colours import INK
from ptmcad.show.render.inches import axes_at
from ptmcad.show.render.labels import Position
from ptmcad.show.render.legend import SWATCH, Mark, line_mark
from ptmcad.show.render.printing import settings
from ptmcad.show.render.sketch import (
    AMPLITUDE,
    BAR_WIDTHS,
    GROUND,
    LABEL_SIZE,
    MANY_BARS,
    PIN,
    SLIDER,
    SPIRAL,
    SUPPORT,
    Sketch,
    bar_width,
    sketched,
)
from ptmcad.show.spiral import spiral

SketchColours = Mapping[str, str]
"""Colours of a first and a second bar (of more all have the first), springs, loads, supports and
text.
"""
STRONG = {
    "bar-0": "#17365d", "bar-1": "#d0751b", "spring": "#1f1f1f", "load": "#a4133c", "base": "#3a3a3a", "text": INK,
}  # fmt: skip
PALE = {
    "bar-0": "#a9bacb", "bar-1": "#f3d9ba", "spring": "#8f8f8f", "load": "#d9a3b2", "base": "#a3a3a3",
    "text": "#666666",
}  # fmt: skip


def draw_sketch(axes: Any, seen: Sketch, style: SketchColours, prefix: str) -> None:
    """Draw a sketch into axes of which a unit is a point."""
    _supports(axes, seen, style, prefix)
    few = len(seen.bars) <= len(BAR_WIDTHS)
    for number, ((start, end), names) in enumerate(
        zip(seen.bars, seen.mechanism.bars, strict=True)
    ):
        kind = number if few else 0
        width = bar_width(seen.mechanism, number)
        _line(
            axes,
            (start, end),
            style[f"bar-{kind}"],
            width,
            f"{prefix}bar-{''.join(names)}",
            2 + kind,
        )
    for name, points in seen.coils.items():
        _line(axes, points, "white", 2.4, "", 4)
        _line(axes, points, style["spring"], 0.95, f"{prefix}{name}", 5)
    for name, (x, y) in seen.nodes.items():
        axes.add_artist(_pin(x, y, style["base"], f"{prefix}node-{name}"))
    for name, start, end in seen.arrows:
        axes.add_artist(_arrow(start, end, style["load"], f"{prefix}load-{name}"))
    for placed in seen.labels:
        if placed.leader is not None:
            _line(axes, (placed.at, placed.leader), style["text"], 0.4, "", 8)
        axes.text(
            *placed.center, placed.text, fontsize=LABEL_SIZE, color=style["text"], ha="center", va="center",
            zorder=9, gid=f"{prefix}label-{placed.text}",
        )  # fmt: skip


_SIDE, _MARGIN = 360.0, 50.0
"""In points, of the drawing of a mechanism in no pose of its own."""


def draw_mechanism(mechanism: Mechanism) -> Figure:
    """A mechanism at the parameters' defaults, in any pose."""
    inner = _SIDE - 2 * _MARGIN
    nodes = {
        name: (_MARGIN + inner * x, _MARGIN + inner * y)
        for name, (x, y) in fitted(approximate_places(mechanism), 1.0).items()
    }
    with settings():
        figure = Figure(figsize=(_SIDE / 72, _SIDE / 72), facecolor="white")
        figure.set_label(mechanism.name)
        axes = axes_at(figure, (0.0, 0.0, _SIDE / 72, _SIDE / 72))
        axes.set(xlim=(0, _SIDE), ylim=(0, _SIDE))
        axes.set_axis_off()
        draw_sketch(axes, sketched(mechanism, nodes, (_SIDE, _SIDE), {}), STRONG, "")
    return figure


def _line(
    axes: Any, points: Sequence[Position], colour: str, width: float, gid: str, z: float
) -> None:
    line = Line2D(
        *zip(*points, strict=True), color=colour, linewidth=width, solid_capstyle="round", solid_joinstyle="round",
        zorder=z, gid=gid or None, clip_on=False,
    )  # fmt: skip
    axes.add_artist(line)


def _pin(x: float, y: float, colour: str, gid: str | None = None) -> Any:
    return Circle(
        (x, y),
        PIN,
        facecolor="white",
        edgecolor=colour,
        linewidth=0.9,
        zorder=6,
        gid=gid,
        clip_on=False,
    )


def _arrow(start: Position, end: Position, colour: str, gid: str | None = None) -> Any:
    return FancyArrowPatch(
        start, end, arrowstyle="-|>", mutation_scale=8, shrinkA=0, shrinkB=0, color=colour, linewidth=1.5, zorder=7,
        gid=gid, clip_on=False, joinstyle="miter",
    )  # fmt: skip


def _supports(axes: Any, seen: Sketch, style: SketchColours, prefix: str) -> None:
    """Rails or the telescopic base, a support under each fixed point and a slider around each
    sliding one.
    """
    for number, ends in enumerate(seen.rails, 1):
        _line(
            axes,
            ends,
            style["base"],
            1.8,
            f"{prefix}base" + (f"-{number}" if number > 1 else ""),
            1,
        )
        _line(axes, ends, "white", 0.7, "", 1.1)
    for name, kind in seen.mechanism.supports.items():
        x, y = seen.nodes[name]
        fixed = kind is Support.PIN
        for artist in (
            _support(x, y, style["base"])
            if fixed
            else [_slider(x, y, style["base"], kind is Support.SLIDER_Y)]
        ):
            axes.add_artist(artist)


def _support(x: float, y: float, colour: str) -> list[Any]:
    """A triangle on hatched ground."""
    width, height = SUPPORT
    bottom = y - height
    triangle = Polygon(
        [(x, y), (x - width, bottom), (x + width, bottom)], facecolor="white", edgecolor=colour, linewidth=0.9,
        zorder=1.5, clip_on=False, joinstyle="round",
    )  # fmt: skip
    lines = [((x - width - 2, bottom), (x + width + 2, bottom))]
    for k in range(5):
        right = x - width + 2 + k * 3.6
        lines.append(((right, bottom), (right - GROUND, bottom - GROUND)))
    ground = [
        Line2D(*zip(*line, strict=True), color=colour, linewidth=0.7, zorder=1.5, clip_on=False)
        for line in lines
    ]
    return [triangle, *ground]


def _slider(x: float, y: float, colour: str, upright: bool = False) -> Any:
    width, height = SLIDER[::-1] if upright else SLIDER
    return Rectangle(
        (x - width, y - height), 2 * width, 2 * height, facecolor="white", edgecolor=colour, linewidth=0.9,
        zorder=1.6, clip_on=False,
    )  # fmt: skip


def bar_mark(number: int, style: SketchColours = STRONG, many: bool = False) -> Mark:
    """A bar in a legend: of two a number, or one of many."""
    width = MANY_BARS if many else BAR_WIDTHS[number]
    return line_mark(
        {"color": style[f"bar-{number}"], "linewidth": width, "solid_capstyle": "butt"}
    )


def spring_mark() -> Mark:
    """A spring in a legend."""
    ends, turns = 0.04, 5
    points = [(0.0, 0.0), (ends, 0.0)]
    for k in range(2 * turns):
        u = ends + (SWATCH - 2 * ends) * (k + 0.5) / (2 * turns)
        points.append((u, AMPLITUDE / 72 * (1 if k % 2 else -1)))
    look = {"color": STRONG["spring"], "linewidth": 0.95, "solid_joinstyle": "round"}
    return line_mark(look, points=[*points, (SWATCH - ends, 0.0), (SWATCH, 0.0)])


_SMALL_SPIRAL = 6.8
"""In points, the radius in a legend, whose lines are no higher."""


def symbol_mark(kind: str) -> Mark:
    """The support, the slider, a load's arrow, or a spiral about its joint in a legend."""

    def mark(figure: Any, left: float, middle: float) -> None:
        x, y = (left + SWATCH / 2) * 72, middle * 72
        artists = {
            "support": lambda: [*_support(x, y + 6, STRONG["base"]), _pin(x, y + 6, STRONG["base"])],
            "slider": lambda: [
                Line2D((x - 9, x + 9), (y, y), color=STRONG["base"], linewidth=1.8, zorder=1),
                _slider(x, y, STRONG["base"]), _pin(x, y, STRONG["base"]),
            ],
            "load": lambda: [_arrow((x - 9, y), (x + 9, y), STRONG["load"])],
            "spiral": lambda: [
                Line2D(
                    *zip(*spiral((x, y), (x + 1, y), SPIRAL[0] - 0.4, _SMALL_SPIRAL), strict=True),
                    color=STRONG["spring"], linewidth=0.95, solid_capstyle="round", solid_joinstyle="round",
                ),
                _pin(x, y, STRONG["base"]),
            ],
        }[kind]()  # fmt: skip
        for artist in artists:
            artist.set_transform(_points(figure))
            figure.add_artist(artist)

    return mark


def _points(figure: Any) -> Any:
    """From points on the page to pixels."""
    from matplotlib.transforms import Affine2D

    return Affine2D().scale(1 / 72) + figure.dpi_scale_trans
