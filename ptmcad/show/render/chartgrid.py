"""Charts of maps side by side on a page, of two maps with their difference or of a family's members
(small multiples), which have one legend.

Guarantee: all charts of a page show the whole window, have the same sides and the same type, and a
colour stands for the same count in all of them; regions that they hide have arrows, or are counted.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
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
    Rows,
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


@dataclass(frozen=True, slots=True)
class PanelGrid:
    """Charts in rows from above, between a head and a foot of so many inches.

    Attributes
    ----------
    what : how an error speaks of the charts.
    least : inches of a chart's sides.
    shared : whether numbers and names stand at the outer charts alone.
    """

    columns: int
    how: Dress
    type: Type
    head: float
    foot: float
    what: str
    least: float
    shared: bool = True

    def draw(self, figure: Figure, panels: Sequence[Panel], **heads: Any) -> None:
        """All charts with their heads, which look as is asked for, and legends.

        Raises
        ------
        ConfigError
            When the page leaves too little to the charts.
        """
        rows = math.ceil(len(panels) / self.columns)
        places: Any = figure.subplots(rows, self.columns, squeeze=False).flat
        for number, (axes, panel) in enumerate(zip(places, panels, strict=False)):
            paint_map(axes, panel.seen, f"{number}-", panel.paint)
            view = panel.seen.view
            dress(axes, panel.seen.result.slice, view.x, view.y, self.how)
            draw_arrows(axes, panel.arrows, self.how.scale)
            for region, fill in (panel.outlined or {}).items():
                rims = [np.vstack([rim, rim[:1]]) for rim in panel.seen.polygons(region)]
                axes.add_artist(
                    LineCollection(
                        rims, transform=axes.transAxes, colors=fill.face, linewidths=0.1 * self.type.head,
                        joinstyle="round", zorder=4, gid=f"change-{region}",
                    )
                )  # fmt: skip
            if self.shared:
                _strip_inner(axes, number % self.columns > 0, number + self.columns < len(panels))
            look = {"loc": "left", "fontsize": self.type.head, "color": INK, **heads}
            axes.set_title("\n".join(panel.head), **look)
        for axes in places[len(panels) :]:
            axes.remove()
        lay_out(figure, self.head, self.foot, self.what, self.least)
        wide = float(figure.get_size_inches()[0])
        for axes, panel in zip(places, panels, strict=False):
            left = axes.get_position().x0 * wide
            draw_legend(figure, panel.legend, left, self.foot - 0.1, self.type)


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


def _strip_inner(axes: Any, has_left: bool, has_below: bool) -> None:
    """Leave out numbers and names that a chart beside or below has."""
    if has_left:
        axes.set_ylabel("")
        axes.tick_params(axis="y", labelleft=False)
    if has_below:
        axes.set_xlabel("")
        axes.tick_params(axis="x", labelbottom=False)


@dataclass(frozen=True, slots=True)
class HeadAndFoot:
    """The lines of a title over what a page shows, and the rows of a legend at its foot."""

    titles: Sequence[str]
    rows: Rows
    type: Type

    @classmethod
    def of(
        cls, title: str, legend: Sequence[Entry], wide: float, style: PictureStyle, type: Type
    ) -> HeadAndFoot:
        """On a page of a width in inches, as far as the style wants them."""
        inner = wide - 1.2 * type.head / 72
        titles = wrapped(title if style.title is None else style.title, inner, type.head, True)
        none = style.legend is LegendPlace.NONE
        return cls(titles, [] if none else in_rows(legend, inner, type), type)

    @property
    def head(self) -> float:
        """Inches that the title takes."""
        return (1.5 * len(self.titles) + 0.4) * self.type.head / 72

    @property
    def foot(self) -> float:
        """Inches that the legend takes."""
        return LINE * self.type.line * len(self.rows) + 0.7 * self.type.head / 72

    def draw(self, figure: Figure) -> None:
        """Both at their places."""
        em, step = self.type.head / 72, LINE * self.type.line
        high = float(figure.get_size_inches()[1])
        write_lines(
            figure, (0.6 * em, high - 0.9 * em), self.titles, self.type.head, 1.5 * em, fontweight="bold", color=INK
        )  # fmt: skip
        draw_rows(figure, self.rows, (0.6 * em, 0.5 * em + len(self.rows) * step), step, self.type)


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
    with settings(style):
        figure = _figure(family, dpi, style)
    figure.set_label(f"{title_of(family)}\n{in_words(family)}")
    return figure


def _figure(family: FamilyMap, dpi: int, style: PictureStyle) -> Figure:
    font = style.base_font
    em, small, scale = font / 72, max(MIN_FONT, 0.85 * font), font / 9
    type = Type.of(style)
    seen = [shapes(result) for result in family.members]
    columns = _columns(len(seen), style.size)
    rows = math.ceil(len(seen) / columns)
    wide = style.size[0] if style.size is not None else (0.5 + columns * (SIDE + 0.2)) * scale
    side = (wide - 0.5 * scale) / columns - 0.2 * scale
    marks = [arrows_of(shape, (side, side), dpi, small) for shape in seen]
    thin = any(seen_thin_walls(shape, (72 * side, 72 * side)) for shape in seen)
    paint = replace(paint_of(style, *family.members), thin_walls=thin)
    legend = family_entries(family, paint, thin, sum(hidden for _, hidden in marks))
    around = HeadAndFoot.of(title_of(family), legend, wide, style, type)
    named = 1 + (len(seen) > columns and len(seen) % columns > 0)
    height = around.head + around.foot + rows * (side + 0.25 * scale) + 0.45 * scale * named
    size = style.size or (wide, height)
    figure = Figure(figsize=size, dpi=dpi, facecolor="white", layout="constrained")
    heads = [(value_text(family, value),) for value in family.values]
    panels = [
        Panel(shape, paint, text, arrows=found)
        for shape, text, (found, _) in zip(seen, heads, marks, strict=True)
    ]
    how = Dress(small, 0.95 * font, (4, 4), scale=scale)
    what = f"{len(seen)} maps do" if len(seen) > 1 else "the map does"
    PanelGrid(columns, how, type, around.head, around.foot, what, 0.5 * MIN_SIDE * em).draw(
        figure, panels
    )
    around.draw(figure)
    return figure


def _columns(number: int, size: Size | None) -> int:
    """So that charts are about as wide as high."""
    if size is None:
        return min(
            number, 3 if number in (3, 5, 6, 9) else 4 if number in (7, 8, 12) else _MAX_COLUMNS
        )
    return max(1, min(number, round(math.sqrt(number * size[0] / size[1]))))
