"""The drawing of a mechanism's sketch: thick bars, zigzag springs, a fixed support, a slider, arrows for loads.

Guarantee: stable poses are strong and others pale, which grey prints and colour-blind eyes see as well: each colour's
pale version is lighter by at least 25 units of CIE L*, and the two bars differ in width and lightness.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Polygon, Rectangle

from ptmcad.show.render.clearance import Position
from ptmcad.show.render.legend import INK, SWATCH, Mark
from ptmcad.show.render.sketch import (
    AMPLITUDE,
    BAR_WIDTHS,
    BASE,
    GROUND,
    LABEL_SIZE,
    MECHANISM,
    PIN,
    SLIDER,
    SUPPORT,
    Sketch,
)


@dataclass(frozen=True, slots=True)
class Style:
    """Colours of the two bars, springs, loads, base and text."""

    bars: tuple[str, str]
    spring: str
    load: str
    base: str
    text: str


STRONG = Style(("#17365d", "#d0751b"), "#1f1f1f", "#a4133c", "#3a3a3a", INK)
PALE = Style(("#a9bacb", "#f3d9ba"), "#8f8f8f", "#d9a3b2", "#a3a3a3", "#666666")


def draw_sketch(axes: Any, seen: Sketch, style: Style, prefix: str) -> None:
    """Draw a sketch into axes of which a unit is a point."""
    _base(axes, seen.nodes[BASE[0]], seen.nodes[BASE[1]], style, prefix)
    drawn = zip(seen.bars, MECHANISM.bars, BAR_WIDTHS, style.bars, (2, 3), strict=True)
    for (start, end), names, width, colour, z in drawn:
        _line(axes, (start, end), colour, width, f"{prefix}bar-{''.join(names)}", z)
    for number, points in enumerate(seen.springs):
        _line(axes, points, "white", 2.4, "", 4)
        _line(axes, points, style.spring, 0.95, f"{prefix}spring-{number + 1}", 5)
    for name, (x, y) in seen.nodes.items():
        axes.add_artist(_pin(x, y, style.base, f"{prefix}node-{name}"))
    for arrow in seen.arrows:
        axes.add_artist(_arrow(arrow.start, arrow.end, style.load, f"{prefix}load-{arrow.name}"))
    for placed in seen.labels:
        if placed.leader is not None:
            _line(axes, (placed.label.at, placed.leader), style.text, 0.4, "", 8)
        axes.text(
            *placed.center, placed.label.text, fontsize=LABEL_SIZE, color=style.text, ha="center", va="center",
            zorder=9, gid=f"{prefix}label-{placed.label.text}",
        )  # fmt: skip


def _line(axes: Any, points: Sequence[Position], colour: str, width: float, gid: str, z: float) -> None:
    line = Line2D(
        *zip(*points, strict=True), color=colour, linewidth=width, solid_capstyle="round", solid_joinstyle="round",
        zorder=z, gid=gid or None, clip_on=False,
    )  # fmt: skip
    axes.add_artist(line)


def _pin(x: float, y: float, colour: str, gid: str | None = None) -> Any:
    from matplotlib.patches import Circle

    return Circle((x, y), PIN, facecolor="white", edgecolor=colour, linewidth=0.9, zorder=6, gid=gid, clip_on=False)


def _arrow(start: Position, end: Position, colour: str, gid: str | None = None) -> Any:
    return FancyArrowPatch(
        start, end, arrowstyle="-|>", mutation_scale=8, shrinkA=0, shrinkB=0, color=colour, linewidth=1.5, zorder=7,
        gid=gid, clip_on=False, joinstyle="miter",
    )  # fmt: skip


def _base(axes: Any, fixed: Position, sliding: Position, style: Style, prefix: str) -> None:
    """The telescopic base, the support under its fixed end and the slider around the other."""
    _line(axes, (fixed, sliding), style.base, 1.8, f"{prefix}base", 1)
    _line(axes, (fixed, sliding), "white", 0.7, "", 1.1)
    for artist in (*_support(*fixed, style.base), _slider(*sliding, style.base)):
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
        Line2D(*zip(*line, strict=True), color=colour, linewidth=0.7, zorder=1.5, clip_on=False) for line in lines
    ]
    return [triangle, *ground]


def _slider(x: float, y: float, colour: str) -> Any:
    width, height = SLIDER
    return Rectangle(
        (x - width, y - height), 2 * width, 2 * height, facecolor="white", edgecolor=colour, linewidth=0.9,
        zorder=1.6, clip_on=False,
    )  # fmt: skip


def bar_mark(number: int, style: Style = STRONG) -> Mark:
    """A bar in a legend."""
    return _line_mark([(0.0, 0.0), (SWATCH, 0.0)], style.bars[number], BAR_WIDTHS[number])


def spring_mark() -> Mark:
    """A spring in a legend."""
    ends, turns = 0.04, 5
    points = [(0.0, 0.0), (ends, 0.0)]
    for k in range(2 * turns):
        u = ends + (SWATCH - 2 * ends) * (k + 0.5) / (2 * turns)
        points.append((u, AMPLITUDE / 72 * (1 if k % 2 else -1)))
    return _line_mark([*points, (SWATCH - ends, 0.0), (SWATCH, 0.0)], STRONG.spring, 0.95)


def _line_mark(points: Sequence[Position], colour: str, width: float) -> Mark:
    def mark(figure: Any, left: float, middle: float) -> None:
        u, v = zip(*((left + x, middle + y) for x, y in points), strict=True)
        figure.add_artist(
            Line2D(
                u, v, transform=figure.dpi_scale_trans, color=colour, linewidth=width, solid_capstyle="butt",
                solid_joinstyle="round",
            )
        )  # fmt: skip

    return mark


def symbol_mark(kind: str) -> Mark:
    """The support, the slider or a load's arrow in a legend."""

    def mark(figure: Any, left: float, middle: float) -> None:
        x, y = (left + SWATCH / 2) * 72, middle * 72
        artists = {
            "support": lambda: [*_support(x, y + 6, STRONG.base), _pin(x, y + 6, STRONG.base)],
            "slider": lambda: [
                Line2D((x - 9, x + 9), (y, y), color=STRONG.base, linewidth=1.8, zorder=1),
                _slider(x, y, STRONG.base), _pin(x, y, STRONG.base),
            ],
            "load": lambda: [_arrow((x - 9, y), (x + 9, y), STRONG.load)],
        }[kind]()  # fmt: skip
        for artist in artists:
            artist.set_transform(_points(figure))
            figure.add_artist(artist)

    return mark


def _points(figure: Any) -> Any:
    """From points on the page to pixels."""
    from matplotlib.transforms import Affine2D

    return Affine2D().scale(1 / 72) + figure.dpi_scale_trans
