"""Charts of maps side by side on a page, of two maps with their difference or of a family's members
(small multiples), which have one legend.

Guarantee: all charts of a page show the whole window, have the same sides and the same type, and a
colour stands for the same count in all of them; regions that they hide have arrows, or are counted.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ptmcad.answer.family import FamilyMap
from ptmcad.errors import ConfigError
from ptmcad.show.render.axes import Dress, dress, symbol
from ptmcad.show.render.colours import INK, STRONG, THIN, Fill, Paint, paint_of
from ptmcad.show.render.fitting import MIN_SIDE
from ptmcad.show.render.inches import wrapped, write_lines
from ptmcad.show.render.legend import (
    Entry,
    Type,
    count_entries,
    draw_legend,
    draw_rows,
    head_of,
    hidden_entries,
    in_rows,
    thin_entry,
)
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.painting import paint_map
from ptmcad.show.render.printing import settings
from ptmcad.show.render.slivers import Arrow, arrows_of, draw_arrows, seen_thin_walls
from ptmcad.show.render.view import Shapes
from ptmcad.show.style import MIN_FONT, LegendPlace, PictureStyle, Size
from ptmcad.text.numerals import shortest_text

LINE = 1.35
"""Between lines, in sizes of their type."""


@dataclass(frozen=True, slots=True)
class Panel:
    """A chart with what stands above and below it.

    Attributes
    ----------
    outlined : regions that are seen however narrow they are, with what rims them.
    """

    seen: Shapes
    paint: Paint
    head: Sequence[str]
    legend: Sequence[Entry] = ()
    outlined: Mapping[int, Fill] | None = None
    arrows: Sequence[Arrow] = ()


def draw_panels(
    figure: Figure,
    panels: Sequence[Panel],
    columns: int,
    ends: tuple[float, float],
    style: PictureStyle,
    shared: bool = True,
) -> None:
    """Charts in rows from above, with their heads and legends.

    Parameters
    ----------
    ends : inches of the page's head and foot.
    shared : whether charts have one legend, and numbers and names stand at the outer ones alone.

    Raises
    ------
    ConfigError
        When the page leaves too little to the charts.
    """
    font, type = style.base_font, Type.of(style)
    how = Dress(max(MIN_FONT, 0.95 * font), 1.05 * font, (4, 5), scale=font / 9)
    what, look = "three maps with their legends do", {"fontweight": "bold"}
    if shared:
        how = Dress(max(MIN_FONT, 0.85 * font), 0.95 * font, (4, 4), scale=font / 9)
        what, look = f"{len(panels)} maps do" if len(panels) > 1 else "the map does", {}
    places: Any = figure.subplots(math.ceil(len(panels) / columns), columns, squeeze=False).flat
    for number, (axes, panel) in enumerate(zip(places, panels, strict=False)):
        paint_map(axes, panel.seen, f"{number}-", panel.paint)
        view = panel.seen.view
        dress(axes, panel.seen.result.slice, view.x, view.y, how)
        draw_arrows(axes, panel.arrows, how.scale)
        outlines = panel.seen.polygons() if panel.outlined else []
        for region, fill in (panel.outlined or {}).items():
            rims = [np.vstack([rim, rim[:1]]) for rim in outlines[region]]
            axes.add_artist(
                LineCollection(
                    rims, transform=axes.transAxes, colors=fill.face, linewidths=0.1 * type.head,
                    joinstyle="round", zorder=4, gid=f"change-{region}",
                )
            )  # fmt: skip
        if shared and number % columns:
            axes.set_ylabel("")
            axes.tick_params(axis="y", labelleft=False)
        if shared and number + columns < len(panels):
            axes.set_xlabel("")
            axes.tick_params(axis="x", labelbottom=False)
        axes.set_title("\n".join(panel.head), loc="left", fontsize=type.head, color=INK, **look)
    for axes in places[len(panels) :]:
        axes.remove()
    lay_out(figure, *ends, what, MIN_SIDE * font / 72 * (0.5 if shared else 1.0))
    wide = float(figure.get_size_inches()[0])
    for axes, panel in zip(places, panels, strict=False):
        left = axes.get_position().x0 * wide
        draw_legend(figure, panel.legend, left, ends[1] - 0.1, type)


def lay_out(figure: Figure, head: float, foot: float, what: str, least: float) -> None:
    """Place all axes of a page between a head and a foot of so many inches, by matplotlib's own
    layout.

    Raises
    ------
    ConfigError
        When a side of the first axes is shorter than the least, in inches.
    """
    wide, tall = figure.get_size_inches()
    side, room, sides = 0.06 / wide, tall - head - foot, (0.0, 0.0)
    if room > least:
        engine: Any = figure.get_layout_engine()
        engine.set(rect=(side, foot / tall, 1 - 2 * side, room / tall), w_pad=0.03, h_pad=0.03)
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            with suppress(UserWarning):  # that no room is left
                figure.draw_without_rendering()
                box = figure.axes[0].get_position()
                sides = box.width * wide, box.height * tall
    if min(sides) < least:
        spec: Any = figure.axes[0].get_subplotspec()
        rows, columns = spec.get_gridspec().get_geometry()
        needed = (
            wide + columns * max(0.0, least - sides[0]),
            tall + rows * max(0.0, least - sides[1]),
        )
        raise ConfigError(
            f"{what} not fit into {wide:.2f}x{tall:.2f}in; at least {needed[0] + 0.01:.2f}x{needed[1] + 0.01:.2f}in "
            "are needed", key="size",
        )  # fmt: skip


def head_and_foot(
    title: str, legend: Sequence[Entry], wide: float, style: PictureStyle
) -> tuple[float, float, Callable[[Figure], None]]:
    """A title over what a page of a width in inches shows and a legend at its foot, as far as the
    style wants them: the inches that they take, and what draws them.
    """
    type = Type.of(style)
    em, step, inner = type.head / 72, LINE * type.line, wide - 1.2 * type.head / 72
    titles = wrapped(title if style.title is None else style.title, inner, type.head, True)
    rows = [] if style.legend is LegendPlace.NONE else in_rows(legend, inner, type)

    def draw(figure: Figure) -> None:
        at = 0.6 * em, float(figure.get_size_inches()[1]) - 0.9 * em
        write_lines(figure, at, titles, type.head, 1.5 * em, fontweight="bold", color=INK)
        draw_rows(figure, rows, (0.6 * em, 0.5 * em + len(rows) * step), step, type)

    return (1.5 * len(titles) + 0.4) * em, step * len(rows) + 0.7 * em, draw


SIDE = 1.75
"""Inches of a chart in 9 points, in a picture that grows with what it shows."""
_MAX_COLUMNS = 6


def title_of(family: FamilyMap) -> str:
    shown = [shortest_text(end).replace("-", "−") for end in (family.free.low, family.free.high)]
    return (
        f"{family.title or family.name}, {symbol(family.free.name)} from {shown[0]} to {shown[1]}"
    )


def in_words(family: FamilyMap) -> str:
    """Each member's number of regions, for who cannot see the picture."""
    return ". ".join(
        f"At {family.free.name} = {shortest_text(value)}: {len(result.regions)} regions"
        for value, result in family
    )


def family_entries(
    family: FamilyMap, paint: Paint, thin: bool = False, hidden: int = 0
) -> list[Entry]:
    """The legend: a fill for each count that some member has.

    Parameters
    ----------
    thin : whether curves at which the count does not change are seen.
    hidden : number of regions that are not seen and have no label.
    """
    head = head_of(family.members[0].slice)
    legend = [Entry(head, strong=True, heads=len(head)), *count_entries(paint, *family.members)]
    if any(result.cover is None and len(result.regions) > 1 for result in family.members):
        legend.append(Entry(("the count changes",), STRONG))
    if thin:
        legend.append(Entry((" ".join(thin_entry().lines),), THIN))
    return legend + hidden_entries(hidden)


def value_text(family: FamilyMap, value: Fraction) -> str:
    """Such as ``F = -10``."""
    return f"{symbol(family.free.name)} = {shortest_text(value).replace('-', '−')}"


def multiples_figure(family: FamilyMap, dpi: int, style: PictureStyle) -> Figure:
    """The picture.

    Raises
    ------
    ConfigError
        When it does not fit into the style's size.
    """
    font = style.base_font
    small, scale = max(MIN_FONT, 0.85 * font), font / 9
    seen = [shapes(result) for result in family.members]
    columns = _columns(len(seen), style.size)
    rows = math.ceil(len(seen) / columns)
    wide = style.size[0] if style.size is not None else (0.5 + columns * (SIDE + 0.2)) * scale
    side = (wide - 0.5 * scale) / columns - 0.2 * scale
    with settings(style):
        marks = [arrows_of(shape, (side, side), dpi, small) for shape in seen]
        thin = any(seen_thin_walls(shape, (72 * side, 72 * side)) for shape in seen)
        paint = replace(paint_of(style, *family.members), thin_walls=thin)
        legend = family_entries(family, paint, thin, sum(hidden for _, hidden in marks))
        head, foot, draw = head_and_foot(title_of(family), legend, wide, style)
        named = 1 + (len(seen) > columns and len(seen) % columns > 0)
        height = head + foot + rows * (side + 0.25 * scale) + 0.45 * scale * named
        size = style.size or (wide, height)
        figure = Figure(figsize=size, dpi=dpi, facecolor="white", layout="constrained")
        panels = [
            Panel(shape, paint, (value_text(family, value),), arrows=found)
            for shape, value, (found, _) in zip(seen, family.values, marks, strict=True)
        ]
        draw_panels(figure, panels, columns, (head, foot), style)
        draw(figure)
    figure.set_label(f"{title_of(family)}\n{in_words(family)}")
    return figure


def _columns(number: int, size: Size | None) -> int:
    """So that charts are about as wide as high."""
    if size is None:
        return min(
            number, 3 if number in (3, 5, 6, 9) else 4 if number in (7, 8, 12) else _MAX_COLUMNS
        )
    return max(1, min(number, round(math.sqrt(number * size[0] / size[1]))))
