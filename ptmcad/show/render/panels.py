"""Charts of maps side by side on a page: of a family, of two maps with their difference, of a film.

Guarantee: all charts of a page have the same sides and the same type; regions that they hide have
arrows, or are counted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ptmcad.show.render.axes import Dress
from ptmcad.show.render.clearance import Position
from ptmcad.show.render.colours import Fill
from ptmcad.show.render.inches import Box, write_lines
from ptmcad.show.render.legend import INK, Entry, Rows, Type, draw_legend, draw_rows, in_rows
from ptmcad.show.render.painting import Paint
from ptmcad.show.render.textwidth import wrapped
from ptmcad.show.render.thinmarks import Marks, draw_chart
from ptmcad.show.render.view import Shapes
from ptmcad.show.style import LegendPlace, PictureStyle, Size

LINE = 1.35
"""Between lines, in sizes of their type."""
NO_MARKS = Marks()


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
    marks: Marks = NO_MARKS


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
            axes = draw_chart(
                figure, box, panel.seen, panel.paint, panel.marks, self.how, f"{number}-"
            )
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
        cls, title: str, told: Sequence[Entry], wide: float, style: PictureStyle, type: Type
    ) -> HeadAndFoot:
        """On a page of a width in inches, as far as the style wants them."""
        inner = wide - 1.2 * type.head / 72
        titles = wrapped(title if style.title is None else style.title, inner, type.head, True)
        none = style.legend is LegendPlace.NONE
        return cls(titles, [] if none else in_rows(told, inner, type), type)

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
