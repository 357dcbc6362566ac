"""The layout of a map's picture: a title, the map, its legend at the right or below, and insets.

Guarantee: all text has the size that is asked for, none less than `ptmcad.show.style.MIN_FONT`
points; every part is on the page, and none overlaps another one. A page without a size grows with
what it shows. On one of a given size insets are left out first, then areas of the legend; what does
not fit even so is refused with the least size that would do.

All places are in inches from the page's lower left corner.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import inf

from ptmcad.errors import ConfigError
from ptmcad.question.slice import Slice
from ptmcad.show.render.axes import Dress, margins
from ptmcad.show.render.inches import Box, few, wrapped
from ptmcad.show.render.labels import Position
from ptmcad.show.render.legend import Entry, Type
from ptmcad.show.render.view import View
from ptmcad.show.style import MIN_FONT, LegendPlace, PictureStyle, Size

SIDE, MIN_SIDE, _WITH_INSETS = 36.8, 11.0, 20.0
"""Sides of the map on a page that grows, and the least: a smaller one is no picture, and one with
insets is larger. Like all that follows in widths of an m.
"""
_GOOD = 0.45
"""The share of the page's width that a map has if it can."""
_COLUMNS = (20.0, 14.0, 11.0, 8.5)
"""Widths tried for a legend at the right."""
_INSETS, _OVER = ((15.0, 9.6), (15.0, 6.0)), 2.9
"""An inset's sides, if there is room and if there is little, and what stands above."""
_RIM, _GAP = 0.4, 1.0
"""Around a page of a given size (three times as much around one that grows), and between columns."""
_TITLE = 1.22
"""Against the size of other text, that of a title and of the axes' names."""
_STEPS, _STEP = 60, 1.05
MAX_TITLE_LINES = 3


@dataclass(frozen=True, slots=True)
class PageParts:
    """What has to be laid out.

    Attributes
    ----------
    title : one line; empty for none.
    legend : the entries, with or without areas, and with or without the number of thin regions that
        have no label.
    views : of the whole map and of the insets.
    """

    slice: Slice
    title: str
    legend: Callable[[bool, bool], Sequence[Entry]]
    views: Sequence[View]
    style: PictureStyle


@dataclass(frozen=True, slots=True)
class Layout:
    """A page's parts.

    Attributes
    ----------
    size : of the page.
    chart : the map.
    title : lines.
    title_at, title_line : the left end of the first line's middle, and the distance of lines.
    legend : its entries, each with its upper left corner.
    insets : the places of views of slivers, as many as are shown.
    font : the size of text in points, with which other text is in proportion.
    axes, inset_axes : sizes of text at the axes.
    shortened : whether the legend has no areas because they have no room.
    """

    size: Size
    chart: Box
    title: Sequence[str]
    title_at: Position
    title_line: float
    legend: Sequence[tuple[Position, Entry]]
    insets: Sequence[Box]
    font: float
    axes: Dress
    inset_axes: Dress
    shortened: bool = False

    @property
    def title_size(self) -> float:
        return _TITLE * self.font

    @property
    def inset_size(self) -> float:
        """Of text above insets."""
        return _readable(0.83 * self.font)

    @property
    def arrow_size(self) -> float:
        """Of labels."""
        return _readable(0.89 * self.font)

    def moved(self, left: float, size: Size) -> Layout:
        """The same further to the right, on another page."""
        return replace(
            self,
            size=size,
            chart=(self.chart[0] + left, *self.chart[1:]),
            title_at=(self.title_at[0] + left, self.title_at[1]),
            legend=[((x + left, y), entry) for (x, y), entry in self.legend],
            insets=[(box[0] + left, *box[1:]) for box in self.insets],
        )


def fitted(parts: PageParts, size: Size | None) -> Layout:
    """The layout of the parts on a page of this size, in inches; within
    `ptmcad.show.render.printing.settings`.

    Raises
    ------
    ConfigError
        When they do not fit; the message has the least size of the same shape that would do.
    """
    style = parts.style
    fonts = _fonts(style)
    found = _first(parts, size, fonts)
    if found is not None:
        return found
    assert size is not None  # a page that grows has room for everything
    for least in larger(size):
        if _first(parts, least, fonts[-1:]) is not None:
            break
    raise ConfigError(
        f"axes and legend do not fit into {_inches(size)} in text of {fonts[-1]:g} points; "
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
    ticks, names = (_readable(k * font) for k in ((0.78, 0.78) if small else (1.0, _TITLE)))
    across, up = (
        int(max(2, min(4 if small else 8, side / (ems * ticks / 72))))
        for side, ems in zip(sides, (3.3, 2.0), strict=True)
    )
    return Dress(ticks, names, (across, up), small, font / 9)


def _readable(points: float) -> float:
    """A size of text, or the least that can be read."""
    return max(MIN_FONT, points)


def _first(parts: PageParts, size: Size | None, fonts: Sequence[float]) -> Layout | None:
    """The layout with as much as there is room for, and of those the one with the largest map, unless
    the first one's is large enough.
    """
    good = 0.0 if size is None else _GOOD * size[0]
    some = dict.fromkeys((bool(parts.views[1:]), False))
    for hidden, font, areas, insets in product((True, False), fonts, (True, False), some):
        page = _Page(parts, size, font, parts.legend(areas, hidden))
        found = list(page.layouts(_INSETS if insets else ((0.0, 0.0),)))
        if found:
            best = max(found, key=lambda of: (min(good, *of.chart[2:]), -of.size[1]))
            return replace(best, shortened=not areas)
    return None


Block = tuple[float, float, Entry | None]
"""A width, a height, and an entry of the legend; None for an inset."""


def _flowed(blocks: Sequence[Block], most: float) -> list[list[Block]]:
    """Columns of at most this height, if no block is higher."""
    columns: list[list[Block]] = []
    used = inf
    for block in blocks:
        if used + block[1] > most + 1e-9:
            columns.append([])
            used = 0.0
        columns[-1].append(block)
        used += block[1]
    return columns


@dataclass(frozen=True, slots=True)
class _Page:
    """What is laid out on a page, in text of one size."""

    parts: PageParts
    size: Size | None
    font: float
    legend: Sequence[Entry]

    @property
    def em(self) -> float:
        return self.font / 72

    @property
    def type(self) -> Type:
        return Type.of(self.parts.style, self.font)

    def layouts(self, insets: Sequence[Size]) -> Iterator[Layout]:
        """With the legend in all places that the style allows and that have room, and with insets of
        these sides.
        """
        place, views = self.parts.style.legend, self.parts.views
        right, below = (place in (None, where) for where in (LegendPlace.RIGHT, LegendPlace.BELOW))
        tried = [(width * self.em, 0) for width in _COLUMNS if right]
        tried += [(0.0, columns) for columns in (2, 3, 4, 1) if below or not right]
        for across, up in insets:
            sides = (across * self.em, up * self.em)
            # where there is no inset, what the map's own axes take
            small = self._around(views[1:] or views, sides, small=True)
            yield from filter(None, (self._layout(*each, sides, *small) for each in tried))

    def _layout(
        self, width: float, number: int, inset: Size, around: Box, small: Dress
    ) -> Layout | None:
        """With legend and insets at the right of the map, in columns of a width, or in a number of
        columns below; None where they have no room.
        """
        em, gap = self.em, _GAP * self.em
        rim = (_RIM if self.size else 3 * _RIM) * em
        most, line = inf if self.size else SIDE * em, 1.35 * _TITLE * self.em
        sides = (SIDE * em, SIDE * em)
        (left, below, after, above), axes = self._around(self.parts.views[:1], sides)
        wide, tall = self.size or (2 * rim + left + sides[0] + after, 0.0)
        title = wrapped(self.parts.title, wide - 2 * rim, _TITLE * self.font)
        title = few(title, MAX_TITLE_LINES)
        head = rim + above + len(title) * line
        blocks = self._blocks(width or (wide - 2 * rim + gap) / number - gap, inset, around)
        total = sum(height for _, height, _ in blocks)
        room = tall - rim - head if self.size else max(sides[1] + below, total / 3)
        if number:
            room = total / number
            while len(_flowed(blocks, room)) > number:
                room += em
        columns = _flowed(blocks, room)
        widths = [gap + max(each for each, _, _ in column) for column in columns]
        high = max((sum(each for _, each, _ in column) for column in columns), default=0.0)
        taken, foot = (0.0, high + em / 2) if number else (sum(widths), 0.0)
        if self.size is None:
            wide += max(0.0, taken - after)
            tall = head + rim + max(sides[1] + below + foot, high)
        for _ in range(3):  # what numbers take depends on how many there are, hence on the sides
            (left, below, after, above), axes = self._around(self.parts.views[:1], sides)
            head = rim + above + len(title) * line
            sides = (
                min(most, wide - 2 * rim - left - max(after, taken)),
                min(most, tall - rim - head - below - foot),
            )
        over = sum(widths) - gap - wide if number else high - tall + head - rim
        least = _WITH_INSETS if inset[0] else MIN_SIDE
        if min(sides) < least * em - 1e-9 or over > 1e-9 - 2 * rim:
            return None
        x, top = wide - rim - taken + gap, tall - head
        if number:
            x, top = max(rim, min(rim + left, x - sum(widths))), rim + high
        legend, insets = [], []
        for each, column in zip(widths, columns, strict=True):
            y = top
            for _, height, entry in column:
                y -= height
                if entry is not None:
                    legend.append(((x, y + height), entry))
                else:
                    inner = each - gap - around[0] - around[2]
                    insets.append((x + around[0], y + around[1], inner, inset[1]))
            x += each
        return Layout(
            (wide, tall), (rim + left, tall - head - sides[1], *sides), title, (rim, tall - rim - line / 2),
            line, legend, insets, self.font, axes, small,
        )  # fmt: skip

    def _blocks(self, width: float, inset: Size, around: Box) -> list[Block]:
        """The legend in lines of a width, and the insets."""
        type, (left, below, right, _) = self.type, around
        entries = [rewrapped(entry, width, type) for entry in self.legend]
        own = left + inset[0] + right, below + inset[1] + _OVER * self.em, None
        number = len(self.parts.views) - 1 if inset[0] else 0
        return [*((type.entry_width(e), type.entry_height(e), e) for e in entries), *[own] * number]

    def _around(self, views: Sequence[View], sides: Size, small: bool = False) -> tuple[Box, Dress]:
        """What numbers and names take at axes of these sides: the most of all views; and their sizes."""
        how = dressed(self.font, sides, small)
        found = [margins(self.parts.slice, view.x, view.y, how, sides) for view in views]
        left, below, right, above = (max(of[k] for of in found) for k in range(4))
        return (left, below, right, above), how


def rewrapped(entry: Entry, width: float, type: Type) -> Entry:
    """The entry with lines of at most this width, in inches, where words allow that."""
    room = width - (0.0 if entry.mark is None else type.indent)
    lines = [line.replace(" %", "\N{NO-BREAK SPACE}%") for line in entry.lines]
    head = wrapped(" ".join(lines[: entry.heads]), room, type.head, entry.strong)
    rest = wrapped(" ".join(lines[entry.heads :]), room, type.detail)
    return replace(entry, lines=(*head, *rest), heads=len(head))
