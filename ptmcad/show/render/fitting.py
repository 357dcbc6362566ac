"""The layout of a map's picture on a page of a given size.

Guarantee: all text has the size that is asked for, none less than `ptmcad.show.style.MIN_FONT`
points, and every part is on the page. To that end insets are left out first, then the legend goes
below the map, then areas are left out of it; what does not fit even so is refused with the least
size that would do.

Measured, not guessed: widths of text in its font, and what numbers and names take beside the axes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

from matplotlib import rcParams
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ptmcad.answer.remembered import remembered
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Slice
from ptmcad.show.render.axes import Dress, dress
from ptmcad.show.render.inches import ALLOWANCE, Box, few, wrapped
from ptmcad.show.render.labels import Position
from ptmcad.show.render.layout import Layout
from ptmcad.show.render.legend import Entry, Type
from ptmcad.show.render.view import View
from ptmcad.show.style import MIN_FONT, LegendPlace, PictureStyle, Size

MIN_SIDE = 11.0
"""Sides of the map, in widths of an m: a smaller one is no picture."""
_GOOD = (0.5, 0.45, 0.4)
"""Shares of the page's width that the map has if it can."""
_NEARLY = 0.85
"""A map so much smaller is as good, with the legend where it is read first."""
_COLUMNS = (24.0, 18.0, 14.0, 11.0, 8.5)
"""Widths tried for a legend at the right, in widths of an m."""
_INSET = (9.0, 6.0)
"""An inset's least sides, in widths of an m."""
_STEPS, _STEP = 60, 1.05
MAX_TITLE_LINES = 2


@dataclass(frozen=True, slots=True)
class PageParts:
    """What has to be laid out, and on which page.

    Attributes
    ----------
    title : one line; empty for none.
    legends : the legend's entries with areas, and without.
    views : of the whole map and of the insets.
    size, font : of the page in inches, and of its text in points.
    """

    slice: Slice
    title: str
    legends: tuple[Sequence[Entry], Sequence[Entry]]
    views: tuple[View, ...]
    style: PictureStyle
    size: Size = (0.0, 0.0)
    font: float = 9.0

    @property
    def em(self) -> float:
        return self.font / 72

    @property
    def rim(self) -> float:
        return 0.4 * self.em

    @property
    def type(self) -> Type:
        return Type.of(self.style, self.font)

    @property
    def title_size(self) -> float:
        return 1.1 * self.font

    @property
    def inset_size(self) -> float:
        return _points(0.83 * self.font)

    def titles(self) -> list[str]:
        return few(
            wrapped(self.title, self.size[0] - 2 * self.rim, self.title_size), MAX_TITLE_LINES
        )

    @property
    def title_line(self) -> float:
        return 1.35 * self.title_size / 72

    @property
    def top(self) -> float:
        """Of what stands below the title."""
        lines = len(self.titles())
        return (
            self.size[1]
            - self.rim
            - (self.title_line * lines + 0.3 * self.em if lines else 0.35 * self.em)
        )

    def layout(
        self, chart: Box, legend: Sequence[tuple[Position, Sequence[Entry]]], insets: Sequence[Box]
    ) -> Layout:
        inset = insets[0] if insets else chart
        return Layout(
            size=self.size, chart=chart, title=self.titles(),
            title_at=(self.rim, self.size[1] - self.rim - self.title_line / 2), title_line=self.title_line,
            legend=legend, insets=insets, type=self.type, axes=dressed(self.font, chart[2:]),
            inset_axes=dressed(self.font, inset[2:], small=True), title_size=self.title_size,
            inset_size=self.inset_size, arrow_size=_points(0.89 * self.font),
        )  # fmt: skip


def fitted(parts: PageParts, size: Size) -> Layout:
    """The layout of the parts on a page of this size, in inches; within
    `ptmcad.show.render.printing.settings`.

    Raises
    ------
    ConfigError
        When they do not fit; the message has the least size of the same shape that would do.
    """
    style = parts.style
    for font in _fonts(style):
        found = _on(replace(parts, size=size, font=font))
        if found is not None:
            return found
    for least in larger(size):
        if _on(replace(parts, size=least, font=_fonts(style)[-1])) is not None:
            break
    raise ConfigError(
        f"axes and legend do not fit into {_inches(size)} in text of {_fonts(style)[-1]:g} points; "
        f"the least size of this shape that does is {_inches(least, up=True)}"
        + ("" if style.legend is LegendPlace.NONE else ", or leave the legend out"),
        key="size",
    )


def larger(size: Size) -> Iterator[Size]:
    """Sizes of the same shape, each a twentieth larger than the one before."""
    for step in range(1, _STEPS):
        yield size[0] * _STEP**step, size[1] * _STEP**step


def _inches(size: Size, up: bool = False) -> str:
    return "x".join(f"{side + (0.005 if up else 0):.2f}" for side in size) + "in"


def _fonts(style: PictureStyle) -> list[float]:
    """The sizes of text that are tried: the one that is asked for, or smaller and smaller ones."""
    first = style.base_font
    if style.font_size is not None:
        return [first]
    return [first, *(first - 0.5 * k for k in range(1, int(2 * (first - MIN_FONT)) + 1))]


def dressed(font: float, sides: Size, small: bool = False) -> Dress:
    """Sizes at axes of these sides beside text of this size, with as many numbers as there is room
    for.
    """
    ticks = _points((0.78 if small else 0.95) * font)
    names = _points((0.78 if small else 1.05) * font)
    most = 4 if small else 8
    across, up = (
        int(max(2, min(most, side / (ems * ticks / 72))))
        for side, ems in zip(sides, (3.3, 2.0), strict=True)
    )
    return Dress(ticks, names, (across, up), small, font / 9)


def _points(size: float) -> float:
    return max(MIN_FONT, size)


def _on(page: PageParts) -> Layout | None:
    """The first layout, in the order in which parts are given up, that has room for what it shows."""
    for legend in page.legends:
        for insets in dict.fromkeys((len(page.views) - 1, 0)):
            found = _placed(page, legend, insets)
            if found is not None:
                return replace(found, shortened=legend != page.legends[0])
    return None


def _placed(page: PageParts, legend: Sequence[Entry], insets: int) -> Layout | None:
    """The legend where it is asked for; else at the right unless the map is much larger when it is
    below.
    """
    place = page.style.legend
    if place is not None:
        return (_right if place is LegendPlace.RIGHT else _below)(page, legend, insets)
    right, below = _right(page, legend, insets), _below(page, legend, insets)
    if right is None or below is None:
        return right or below
    return right if min(right.chart[2:]) >= _NEARLY * min(below.chart[2:]) else below


def _right(page: PageParts, legend: Sequence[Entry], insets: int) -> Layout | None:
    """The legend, and insets below it, at the right of the map."""
    em, (width, _) = page.em, page.size
    for least in (*(max(share * width, MIN_SIDE * em) for share in _GOOD), MIN_SIDE * em):
        for columns in _COLUMNS:
            entries = [rewrapped(entry, columns * em, page.type) for entry in legend]
            column = page.type.width(entries)
            if column > columns * em * 1.01:
                continue  # a word is longer
            if insets:
                column = max(column, _INSET[0] * em + _inset_overhang(page)[0] + 0.5 * em)
            chart = _chart(page, width - 2 * page.rim - 0.9 * em - column, page.top - page.rim)
            if chart is None or chart[2] < least:
                continue
            left = width - page.rim - column
            bottom = page.top - page.type.height(entries)
            boxes = _stacked(page, (left, bottom - 0.4 * em, column), insets)
            if bottom < page.rim or boxes is None:
                continue
            return page.layout(chart, [((left, page.top), entries)], boxes)
    return None


def _below(page: PageParts, legend: Sequence[Entry], insets: int) -> Layout | None:
    """The legend in columns below the map, if there is one, and insets in a row between."""
    em, (width, _) = page.em, page.size
    best: tuple[float, list[list[Entry]]] | None = None
    for number in (4, 3, 2, 1):
        room = (width - 2 * page.rim - (number - 1) * em) / number
        entries = [rewrapped(entry, room, page.type) for entry in legend if entry.lines]
        if page.type.width(entries) > room * 1.01:
            continue
        most = ceil(len(entries) / number) or 1
        columns = [entries[k : k + most] for k in range(0, len(entries), most)]
        height = max(map(page.type.height, columns), default=0.0)
        if best is None or height < best[0] - 1e-9:
            best = (height, columns)
    if best is None:
        return None
    height, columns = best
    found = _over(page, page.rim + height + (0.5 * em if columns else 0.0), insets)
    if found is None:
        return None
    chart, boxes = found
    widths = [page.type.width(column) for column in columns]
    gap = min(2 * em, (width - 2 * page.rim - sum(widths)) / max(1, len(widths) - 1))
    # below the map where there is room for that
    left = max(page.rim, min(chart[0], width - page.rim - sum(widths) - gap * (len(widths) - 1)))
    starts = [left + sum(widths[:k]) + gap * k for k in range(len(widths))]
    return page.layout(
        chart,
        [((x, page.rim + height), column) for x, column in zip(starts, columns, strict=True)],
        boxes,
    )


def _over(page: PageParts, bottom: float, insets: int) -> tuple[Box, list[Box]] | None:
    """The map and a row of insets above a height."""
    em, width = page.em, page.size[0]
    boxes: list[Box] = []
    if insets:
        left, below, _, _ = _inset_overhang(page)
        each = (width - 2 * page.rim) / insets - left - 0.6 * em
        if each < _INSET[0] * em:
            return None
        each, tall = min(each, 14 * em), _INSET[1] * em
        boxes = [
            (page.rim + left + k * (each + left + 0.6 * em), bottom + below, each, tall)
            for k in range(insets)
        ]
        bottom += below + tall + _inset_head(page)
    chart = _chart(page, width - 2 * page.rim, page.top - bottom)
    return None if chart is None else (chart, boxes)


def _chart(page: PageParts, width: float, height: float) -> Box | None:
    """The map's place in a part of the page at its left and top; None where that is too small."""
    inner = (0.8 * width, 0.8 * height)
    for _ in range(3):  # what numbers take depends on how many there are, hence on the sides
        if min(inner) < MIN_SIDE * page.em:
            return None
        left, below, right, _above = overhang(page, page.views[0], inner, dressed(page.font, inner))
        inner = (width - left - right, height - below)
    if min(inner) < MIN_SIDE * page.em:
        return None
    return (page.rim + left, page.top - inner[1], *inner)


def _stacked(page: PageParts, place: tuple[float, float, float], insets: int) -> list[Box] | None:
    """Insets one below the other, from a left end and a top in a column of some width."""
    left, top, column = place
    boxes: list[Box] = []
    if not insets:
        return boxes
    before, below, after, _ = _inset_overhang(page)
    room = (top - page.rim) / insets - below - _inset_head(page)
    if room < _INSET[1] * page.em:
        return None
    wide = column - before - after
    tall = min(room, 0.75 * wide)
    for _ in range(insets):
        top -= _inset_head(page) + tall
        boxes.append((left + before, top, wide, tall))
        top -= below
    return boxes


def _inset_head(page: PageParts) -> float:
    """Inches of the two lines over an inset."""
    return 3.0 * page.inset_size / 72


def _inset_overhang(page: PageParts) -> Box:
    """What numbers and names of the insets' axes take: the most of all."""
    sides = (_INSET[0] * page.em, _INSET[1] * page.em)
    found = [
        overhang(page, view, sides, dressed(page.font, sides, small=True))
        for view in page.views[1:]
    ]
    left, below, right, above = (max(of[k] for of in found) for k in range(4))
    return left, below + 0.3 * page.em, right, above


def overhang(parts: PageParts, view: View, sides: Size, how: Dress) -> Box:
    """Inches that numbers and names take at the left, below, at the right and above axes of these
    sides.
    """
    family = tuple(rcParams["font.family"])
    (left, below, right, above), names = _measured(parts.slice, view, how, family)
    # a name may be longer than its axis
    beyond = [max(0.0, (name - side) / 2) for name, side in zip(names, sides, strict=True)]
    return max(left, beyond[0]), max(below, beyond[1]), max(right, beyond[0]), max(above, beyond[1])


@remembered(512)
def _measured(slice: Slice, view: View, how: Dress, _: tuple[str, ...]) -> tuple[Box, Size]:
    """The same for axes long enough for their names, and the lengths of these, in fonts of these
    families.
    """
    figure = Figure(figsize=(24.0, 24.0), dpi=72)
    canvas: Any = FigureCanvasAgg(figure)
    renderer = canvas.get_renderer()
    axes: Any = figure.add_axes((1 / 3, 1 / 3, 1 / 3, 1 / 3))
    dress(axes, slice, view.x, view.y, how)
    spaces = beside(figure, axes)
    names = (
        axes.xaxis.label.get_window_extent(renderer).width / 72,
        axes.yaxis.label.get_window_extent(renderer).height / 72,
    )
    return spaces, names


def beside(figure: Figure, axes: Any) -> Box:
    """Inches that numbers and names take at the left of axes, below, at the right and above."""
    canvas: Any = FigureCanvasAgg(figure)
    outer, inner = axes.get_tightbbox(canvas.get_renderer()), axes.get_window_extent()
    sides = (inner.x0 - outer.x0, inner.y0 - outer.y0, outer.x1 - inner.x1, outer.y1 - inner.y1)
    left, below, right, above = (max(0.0, float(side)) / figure.dpi * ALLOWANCE for side in sides)
    return left, below, right, above


def rewrapped(entry: Entry, width: float, type: Type) -> Entry:
    """The entry with lines of at most this width, in inches, where words allow that."""
    room = width - (0.0 if entry.mark is None else type.indent)
    if not entry.lines:
        return entry
    entry = replace(
        entry, lines=tuple(line.replace(" %", "\N{NO-BREAK SPACE}%") for line in entry.lines)
    )
    head = wrapped(" ".join(entry.lines[: entry.heads]), room, type.head, entry.strong)
    rest = (
        wrapped(" ".join(entry.lines[entry.heads :]), room, type.detail)
        if entry.lines[entry.heads :]
        else []
    )
    return replace(entry, lines=(*head, *rest), heads=len(head))
