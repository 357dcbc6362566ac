"""Pictures of the best design: what was evaluated, what bounds it, and where the best one is.

Guarantee: what is drawn is said in words, and each figure's label holds a title and a description.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact
answer.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PatchCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ptmcad.answer.design import BestDesign
from ptmcad.show.designtable import design_table, value_text
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.colours import INK
from ptmcad.show.render.panels import SIZE, panels, scaled, scaled_axis
from ptmcad.show.render.printing import settings

TALL = 3.6
"""Inches of the panel."""
BEST, BOUND = "#b45f06", "#377eb8"
COLOURS = "viridis"


def figure_of_design(found: BestDesign) -> Figure:
    """The values over one design parameter, or over the first two, with the bounds and the best
    one.
    """
    proof = design_table(found).splitlines()[-2].split(maxsplit=1)
    words = [*_words(found), ": ".join(proof)]
    with settings():
        figure, (axes,) = panels(
            _title(found), "\n".join(words), found.over[0], "", [TALL], notes=words
        )
        if len(found.over) == 1:
            _draw_curve(axes, found)
        else:
            _draw_plane(figure, axes, found)
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
    known = sorted(
        (scaled(p.at[0], over), float(p.value)) for p in found.points if p.value is not None
    )
    axes.plot(*np.reshape(known, (-1, 2)).T, ".", color=INK, markersize=3)
    for box in found.boxes:
        ends = [scaled(end, over) for end in box.ranges[0]]
        axes.plot(ends, [float(box.bound)] * 2, color=BOUND, linewidth=1.2)
    if found.bound is not None and not found.boxes:
        axes.axhline(float(found.bound), color=BOUND, linewidth=0.8, linestyle="--")
    if found.best is not None and found.value is not None:
        at = scaled(found.best[over.name], over)
        axes.plot(at, float(found.value), "D", color=BEST, fillstyle="none", clip_on=False)
    axes.set_ylabel(_value_name(found), fontsize=SIZE + 2)


def _draw_plane(figure: Figure, axes: Any, found: BestDesign) -> None:
    first, second = found.over[:2]
    known = [
        (scaled(p.at[0], first), scaled(p.at[1], second), float(p.value))
        for p in found.points
        if p.value is not None
    ]
    bounds = [float(box.bound) for box in found.boxes]
    values = [value for _, _, value in known] + bounds
    if values:
        low, high = min(values), max(values)
        norm = Normalize(low, high if high > low else low + 1)
        look: dict[str, Any] = {"cmap": COLOURS, "norm": norm}
        patches = []
        for box in found.boxes:
            (a, b), (c, d) = (
                [scaled(end, axis) for end in ends]
                for ends, axis in zip(box.ranges, (first, second), strict=False)
            )
            patches.append(Rectangle((a, c), b - a, d - c))
        boxes = PatchCollection(patches, edgecolor="white", linewidth=0.3, **look)
        boxes.set_array(bounds)
        axes.add_collection(boxes)
        xs, ys, colours = np.reshape(known, (-1, 3)).T
        axes.scatter(xs, ys, 9, colours, edgecolors=INK, linewidths=0.3, zorder=3, **look)
        bar = figure.colorbar(ScalarMappable(norm, COLOURS), ax=axes, aspect=23, pad=0.02)
        bar.set_label(_value_name(found), fontsize=SIZE + 1)
        bar.ax.tick_params(labelsize=SIZE)
    if found.best is not None:
        x, y = (scaled(found.best[axis.name], axis) for axis in (first, second))
        axes.plot(x, y, "D", color=BEST, markersize=8, markeredgewidth=1.6, fillstyle="none",
                  clip_on=False, zorder=4)  # fmt: skip
    scaled_axis(axes.yaxis, second, "")


def _value_name(found: BestDesign) -> str:
    return (
        f"length of the range of {symbol(found.along.name)}"
        if found.along is not None
        else found.maximise
    )
