"""Pictures of the best design: what was evaluated, what bounds it, and where the best one is.

Guarantee: what is drawn is said in words, and each figure's label holds a title and a description.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact
answer.
"""

from __future__ import annotations

import textwrap
from typing import Any

from matplotlib.cm import ScalarMappable
from matplotlib.collections import PatchCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ptmcad.answer.design import BestDesign
from ptmcad.show.designtable import design_table, value_text
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.colours import INK
from ptmcad.show.render.inches import write_lines
from ptmcad.show.render.printing import settings
from ptmcad.show.render.rangepicture import (
    LEFT,
    RIGHT,
    SIZE,
    WIDE,
    axes_in,
    figure_of,
    scaled,
    scaled_axis,
)

TALL = 3.6
BAR = 0.16
"""Width of a colour bar, in inches."""
BEST = "#b45f06"
COLOURS = "viridis"
_COLUMNS = 96


def figure_of_design(found: BestDesign) -> Figure:
    """The values over one design parameter, or over the first two, with the bounds and the best
    one.
    """
    words = [*_words(found), *design_table(found).splitlines()[-2:-1]]
    lines = [part for line in words for part in textwrap.wrap(line, _COLUMNS)]
    foot = 0.6 + 0.2 * len(lines)
    with settings():
        figure = figure_of(
            [_title(found)], (LEFT + WIDE + RIGHT + 0.8, foot + TALL + 0.1), "\n".join(lines)
        )
        axes = axes_in(figure, (LEFT, foot, WIDE, TALL))
        if len(found.over) == 1:
            _draw_curve(axes, found)
        else:
            _draw_plane(figure, axes, found, foot)
        axes.tick_params(labelsize=SIZE)
        write_lines(figure, (LEFT, 0.2), reversed(lines), SIZE, -0.2, va="baseline")
    return figure


def _title(found: BestDesign) -> str:
    name = f"range of {found.along.name}" if found.along is not None else found.maximise
    return f"{name} over {', '.join(axis.name for axis in found.over)}"


def _words(found: BestDesign) -> list[str]:
    words = "dots: designs that were evaluated exactly"
    if found.boxes:
        shade = "line" if len(found.over) == 1 else "colour"
        words += f"; {shade} of a box: what none of its designs exceeds"
        words += "; no box: a condition fails" if found.conditions else ""
    if len(found.over) > 2:
        words += f", over {found.over[0].name} and {found.over[1].name} whatever the others are"
    if found.best is None or found.value is None:
        return [words]
    place = ", ".join(f"{symbol(name)} = {float(value):.6g}" for name, value in found.best.items())
    return [words, f"diamond: the best design, {place}, with {value_text(found.value)}"]


def _draw_curve(axes: Any, found: BestDesign) -> None:
    (over,) = found.over
    known = sorted((p.at[0], float(p.value)) for p in found.points if p.value is not None)
    axes.plot(
        [scaled(at, over) for at, _ in known], [v for _, v in known], ".", color=INK, markersize=3
    )
    for box in found.boxes:
        low, high = box.ranges[0]
        axes.plot(
            [scaled(low, over), scaled(high, over)],
            [float(box.bound)] * 2,
            color="#377eb8",
            linewidth=1.2,
        )
    if found.bound is not None and not found.boxes:
        axes.axhline(float(found.bound), color="#377eb8", linewidth=0.8, linestyle="--")
    if found.best is not None and found.value is not None:
        at = scaled(found.best[over.name], over)
        axes.plot([at], [float(found.value)], "D", color=BEST, fillstyle="none", clip_on=False)
    scaled_axis(axes.xaxis, over, "")
    axes.set_ylabel(_value_name(found), fontsize=SIZE + 2)


def _draw_plane(figure: Figure, axes: Any, found: BestDesign, foot: float) -> None:
    first, second = found.over[:2]
    values = [float(p.value) for p in found.points if p.value is not None] + [
        float(b.bound) for b in found.boxes
    ]
    if values:
        norm = Normalize(min(values), max(values) if max(values) > min(values) else min(values) + 1)
        sides = [
            [
                [scaled(end, axis) for end in ends]
                for ends, axis in zip(box.ranges, (first, second), strict=False)
            ]
            for box in found.boxes
        ]
        patches = [Rectangle((a, c), b - a, d - c) for (a, b), (c, d) in sides]
        boxes = PatchCollection(patches, cmap=COLOURS, norm=norm, edgecolor="white", linewidth=0.3)
        boxes.set_array([float(box.bound) for box in found.boxes])
        axes.add_collection(boxes)
        known = [(p.at, float(p.value)) for p in found.points if p.value is not None]
        axes.scatter(
            [scaled(at[0], first) for at, _ in known], [scaled(at[1], second) for at, _ in known],
            c=[v for _, v in known], cmap=COLOURS, norm=norm, s=9, edgecolors=INK, linewidths=0.3, zorder=3,
        )  # fmt: skip
        bar = figure.colorbar(
            ScalarMappable(norm, COLOURS),
            cax=axes_in(figure, (LEFT + WIDE + 0.15, foot, BAR, TALL)),
        )
        bar.set_label(_value_name(found), fontsize=SIZE + 1)
        bar.ax.tick_params(labelsize=SIZE)
    if found.best is not None:
        place = [scaled(found.best[axis.name], axis) for axis in (first, second)]
        axes.plot(*[[x] for x in place], "D", color=BEST, markersize=8, markeredgewidth=1.6, fillstyle="none",
                  clip_on=False, zorder=4)  # fmt: skip
    scaled_axis(axes.xaxis, first, "")
    scaled_axis(axes.yaxis, second, "")


def _value_name(found: BestDesign) -> str:
    return (
        f"length of the range of {symbol(found.along.name)}"
        if found.along is not None
        else found.maximise
    )
