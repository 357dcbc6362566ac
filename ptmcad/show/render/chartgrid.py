"""Charts of maps side by side on a page, of two maps with their difference or of a family's members
(small multiples), which have one legend.

Guarantee: all charts of a page show the whole window, have the same sides and the same type, and a
colour stands for the same count in all of them; regions that they hide have arrows, or are counted.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ptmcad.answer.family import FamilyMap
from ptmcad.errors import ConfigError
from ptmcad.show.render.axes import Dress, dress, symbol
from ptmcad.show.render.colours import INK, STRONG, THIN, Fill, Paint, fills_by_count, paint_of
from ptmcad.show.render.fitting import MIN_SIDE, PageParts, overhang
from ptmcad.show.render.inches import Box, axes_at, wrapped, write_lines
from ptmcad.show.render.labels import Position
from ptmcad.show.render.legend import (
    Entry,
    Rows,
    Type,
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
    """The places of charts, in inches, row after row from the corner of the first chart.

    Attributes
    ----------
    corner : the upper left one of the first chart.
    pitch : from a chart to the next one in its row, and to the one below.
    key : from a chart down to its legend.
    shared : whether numbers and names stand at the outer charts alone.
    """

    corner: Position
    sides: Size
    pitch: Position
    columns: int
    how: Dress
    type: Type
    key: float = 0.0
    shared: bool = True

    def box(self, number: int) -> Box:
        """Of the chart with this number."""
        row, column = divmod(number, self.columns)
        left, top = self.corner
        return (
            left + column * self.pitch[0],
            top - self.sides[1] - row * self.pitch[1],
            *self.sides,
        )

    def draw(self, figure: Figure, panels: Sequence[Panel], **heads: Any) -> None:
        """All charts with their heads, which look as is asked for, and legends."""
        em = self.type.head / 72
        for number, panel in enumerate(panels):
            box = self.box(number)
            axes = axes_at(figure, box)
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
            above = (box[0], box[1] + box[3] + 0.75 * em)
            look = {"color": INK, **heads}
            write_lines(figure, above, reversed(panel.head), self.type.head, -LINE * em, **look)
            draw_legend(figure, panel.legend, box[0], box[1] - self.key, self.type)


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
    legend = [Entry(head, strong=True, heads=len(head))]
    legend += [
        Entry((text,), fill) for text, fill in fills_by_count(paint, *family.members).items()
    ]
    if any(result.cover is not None for result in family.members):
        legend.append(Entry(("undetermined",), paint.undetermined))
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
    em, small = font / 72, max(MIN_FONT, 0.85 * font)
    type = Type.of(style)
    how = Dress(small, 0.95 * font, (4, 4), scale=font / 9)
    seen = [shapes(result) for result in family.members]
    parts = PageParts(family.members[0].slice, "", ((), ()), (seen[0].view,))
    left, below, right, _ = overhang(parts, seen[0].view, (SIDE, SIDE), how)
    columns = _columns(len(seen), style.size)
    rows = math.ceil(len(seen) / columns)
    gap, head = max(right, 1.9 * em), 1.7 * em
    wide = style.size[0] if style.size is not None else left + columns * (SIDE * font / 9 + gap)
    side = (wide - left) / columns - gap
    marks = [arrows_of(shape, (side, side), dpi, small) for shape in seen]
    thin = any(seen_thin_walls(shape, (72 * side, 72 * side)) for shape in seen)
    paint = replace(paint_of(style, *family.members), thin_walls=thin)
    legend = family_entries(family, paint, thin, sum(hidden for _, hidden in marks))
    around = HeadAndFoot.of(title_of(family), legend, wide, style, type)
    rest = around.head + rows * head + 0.5 * em * (rows - 1) + below + around.foot
    tall = (style.size[1] - rest) / rows if style.size is not None else side
    if min(side, tall) < 0.5 * MIN_SIDE * em:
        raise ConfigError(
            f"{len(seen)} maps do not fit: make it larger, or draw fewer members", key="size"
        )
    height = rest + rows * tall
    figure = Figure(figsize=(wide, height), dpi=dpi, facecolor="white")
    corner, pitch = (left, height - around.head - head), (side + gap, tall + head + 0.5 * em)
    grid = PanelGrid(corner, (side, tall), pitch, columns, how, type)
    heads = [(value_text(family, value),) for value in family.values]
    panels = [
        Panel(shape, paint, text, arrows=found)
        for shape, text, (found, _) in zip(seen, heads, marks, strict=True)
    ]
    grid.draw(figure, panels)
    around.draw(figure)
    return figure


def _columns(number: int, size: Size | None) -> int:
    """So that charts are about as wide as high."""
    if size is None:
        return min(
            number, 3 if number in (3, 5, 6, 9) else 4 if number in (7, 8, 12) else _MAX_COLUMNS
        )
    return max(1, min(number, round(math.sqrt(number * size[0] / size[1]))))
