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
from matplotlib.transforms import Affine2D

from ptmcad.model import Mechanism, Support
from ptmcad.show.linedrawing import approximate_places, fitted
from ptmcad.show.render.colours import INK
from ptmcad.show.render.inches import axes_at
from ptmcad.show.render.labels import Position
from ptmcad.show.render.legend import SWATCH, Mark
from ptmcad.show.render.printing import settings
from ptmcad.show.render.sketch import (
    BAR_WIDTHS,
    GROUND,
    LABEL_SIZE,
    PIN,
    SLIDER,
    SPIRAL,
    SUPPORT,
    Sketch,
    bar_width,
    coil,
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
    mechanism, parts = seen.mechanism, list[Any]()
    for number, ends in enumerate(seen.rails, 1):
        gid = f"{prefix}base" + (f"-{number}" if number > 1 else "")
        parts += [_line(ends, style["base"], 1.8, 1, gid), _line(ends, "white", 0.7, 1.1)]
    for name, support in mechanism.supports.items():
        parts += _support(support, seen.nodes[name], style["base"])
    for number, (ends, names) in enumerate(zip(seen.bars, mechanism.bars, strict=True)):
        kind = number if len(seen.bars) <= len(BAR_WIDTHS) else 0
        width, gid = bar_width(mechanism, number), f"{prefix}bar-{''.join(names)}"
        parts.append(_line(ends, style[f"bar-{kind}"], width, 2 + kind, gid))
    for name, points in seen.coils.items():
        parts.append(_line(points, "white", 2.4, 4))
        parts.append(_line(points, style["spring"], 0.95, 5, f"{prefix}{name}"))
    parts += [_pin(at, style["base"], f"{prefix}node-{name}") for name, at in seen.nodes.items()]
    for name, start, end in seen.arrows:
        parts.append(_arrow((start, end), style["load"], f"{prefix}load-{name}"))
    for placed in seen.labels:
        if placed.leader is not None:
            parts.append(_line((placed.at, placed.leader), style["text"], 0.4, 8))
        axes.text(
            *placed.center, placed.text, fontsize=LABEL_SIZE, color=style["text"], ha="center", va="center",
            zorder=9, gid=f"{prefix}label-{placed.text}",
        )  # fmt: skip
    for part in parts:
        axes.add_artist(part)


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
    points: Sequence[Position], colour: str, width: float, z: float, gid: str | None = None
) -> Any:
    return Line2D(
        *zip(*points, strict=True), color=colour, linewidth=width, solid_capstyle="round", solid_joinstyle="round",
        zorder=z, gid=gid, clip_on=False,
    )  # fmt: skip


def _pin(at: Position, colour: str, gid: str | None = None) -> Any:
    look = {"facecolor": "white", "edgecolor": colour, "linewidth": 0.9, "clip_on": False}
    return Circle(at, PIN, zorder=6, gid=gid, **look)


def _arrow(ends: Sequence[Position], colour: str, gid: str | None = None) -> Any:
    return FancyArrowPatch(
        *ends, arrowstyle="-|>", mutation_scale=8, shrinkA=0, shrinkB=0, color=colour, linewidth=1.5, zorder=7,
        gid=gid, clip_on=False, joinstyle="miter",
    )  # fmt: skip


def _support(kind: Support, at: Position, colour: str) -> list[Any]:
    """A triangle on hatched ground, or a slider's box."""
    x, y = at
    look: dict[str, Any] = {
        "facecolor": "white",
        "edgecolor": colour,
        "linewidth": 0.9,
        "clip_on": False,
    }
    if kind is not Support.PIN:
        width, height = SLIDER if kind is Support.SLIDER_X else SLIDER[::-1]
        return [Rectangle((x - width, y - height), 2 * width, 2 * height, zorder=1.6, **look)]
    width, height = SUPPORT
    bottom = y - height
    corners = [at, (x - width, bottom), (x + width, bottom)]
    ground = [(x - width - 2, bottom)]
    for k in range(5):
        right = x - width + 2 + k * 3.6
        ground += [(right, bottom), (right - GROUND, bottom - GROUND), (right, bottom)]
    ground.append((x + width + 2, bottom))
    return [
        Polygon(corners, zorder=1.5, joinstyle="round", **look),
        _line(ground, colour, 0.7, 1.5),
    ]


_SMALL_SPIRAL = 6.8
"""In points, the radius in a legend, whose lines are no higher."""


def part_mark(part: str, style: SketchColours = STRONG, width: float = BAR_WIDTHS[0]) -> Mark:
    """A part in a legend: a support, a slider, a load's arrow, a spring, a spiral about its joint or,
    by its colour, a bar of a width.
    """

    def mark(figure: Any, left: float, middle: float) -> None:
        half, base = 36 * SWATCH, style["base"]
        ends = ((-half, 0.0), (half, 0.0))
        match part:
            case "support":
                drawn = [*_support(Support.PIN, (0, 6), base), _pin((0, 6), base)]
            case "slider":
                rail = _line(((-9, 0), (9, 0)), base, 1.8, 1)
                drawn = [rail, *_support(Support.SLIDER_X, (0, 0), base), _pin((0, 0), base)]
            case "load":
                drawn = [_arrow(((-9, 0), (9, 0)), style["load"])]
            case "spring":
                wound = coil(0j, 1 + 0j, 2 * half - 5.8, 5)
                drawn = [_line((ends[0], *wound, ends[1]), style["spring"], 0.95, 5)]
            case "spiral":
                turns = spiral((0, 0), (1, 0), SPIRAL[0] - 0.4, _SMALL_SPIRAL)
                drawn = [_line(turns, style["spring"], 0.95, 5), _pin((0, 0), base)]
            case _:
                drawn = [_line(ends, style[part], width, 2)]
                drawn[0].set_solid_capstyle("butt")
        place = Affine2D().translate(72 * left + half, 72 * middle).scale(1 / 72)
        for artist in drawn:
            artist.set_transform(place + figure.dpi_scale_trans)
            figure.add_artist(artist)

    return mark
