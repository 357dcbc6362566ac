"""The legend: what each colour and each line means, with the regions of every count and their
areas.

Guarantee: every digit of an area is certified, and the same as in the table
(`ptmcad.show.table.area_text`).
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ptmcad.answer.counts import counted_by
from ptmcad.answer.regionmap import Region, RegionMap
from ptmcad.answer.words import count_words, counted, listed, noun
from ptmcad.question.counts import Shades
from ptmcad.question.slice import Slice
from ptmcad.show.render.colours import (
    INK,
    STRONG,
    THIN,
    UNDETERMINED,
    Fill,
    Paint,
    fill_of,
    fills_by_count,
)
from ptmcad.show.render.inches import stroke, text_width, write
from ptmcad.show.render.labels import Position
from ptmcad.show.style import MIN_FONT, PictureStyle
from ptmcad.show.table import area_by_count, area_text, areas_are_known, count_text
from ptmcad.text.numerals import percent

LINE, SWATCH, COLUMNS = 0.17, 0.26, 36
"""Inches between lines, width of a swatch, characters in a line."""
_MAX_AREAS, _MAX_TOTALS = 4, 3

FILL = 0.14
"""Height of a swatch."""

Mark = Callable[[Any, float, float], None]
"""Draws into a figure, from a place in inches (left, middle) to the right, no wider than a swatch.
"""


@dataclass(frozen=True, slots=True)
class Entry:
    """Some lines of text beside a fill, a line (`STRONG` or `THIN`), a drawing of its own or nothing.

    ``heads`` is the number of lines, from the first, in the larger type.
    """

    lines: tuple[str, ...]
    mark: Fill | float | Mark | None = None
    strong: bool = False
    heads: int = 1


@dataclass(frozen=True, slots=True)
class Type:
    """How a legend is set: sizes in points, the rest against that of a picture in 9 points."""

    head: float = 9
    detail: float = 8
    scale: float = 1.0
    strong: float = STRONG
    thin: float = THIN
    thin_lines: str = "solid"

    @classmethod
    def of(cls, style: PictureStyle, font: float | None = None) -> Type:
        """As large as a style's text, or text of another size, is."""
        font = style.base_font if font is None else font
        thin = style.strong * THIN / STRONG
        return cls(font, max(MIN_FONT, 0.89 * font), font / 9, style.strong, thin, style.thin_lines)

    @property
    def line(self) -> float:
        """Inches between lines."""
        return LINE * self.scale

    @property
    def indent(self) -> float:
        """Inches from a mark's left to its text."""
        return SWATCH * self.scale + 0.1 * self.scale

    def height(self, legend: Sequence[Entry]) -> float:
        """Of a legend, in inches."""
        return sum(self.entry_height(entry) for entry in legend)

    def width(self, legend: Iterable[Entry]) -> float:
        """Of a legend, in inches, in the family that is set."""
        return max(map(self.entry_width, legend), default=0.0)

    def entry_height(self, entry: Entry) -> float:
        """Of an entry, in inches, with the space below."""
        return self.line * len(entry.lines) + 0.07 * self.scale

    def entry_width(self, entry: Entry) -> float:
        """Of an entry with its mark, in inches."""
        indent = 0.0 if entry.mark is None else self.indent
        sizes = [self.head if k < entry.heads else self.detail for k in range(len(entry.lines))]
        texts = (
            text_width(line, size, entry.strong)
            for line, size in zip(entry.lines, sizes, strict=True)
        )
        return indent + max(texts, default=0.0)


def head_of(slice: Slice) -> tuple[str, ...]:
    """What is counted."""
    return tuple(textwrap.wrap(count_words(slice.count.kind.legend, slice.model), COLUMNS))


def count_entries(paint: Paint, *results: RegionMap) -> list[Entry]:
    """What the counts of some maps are filled with, and what they leave undetermined."""
    found = [Entry((text,), fill) for text, fill in fills_by_count(paint, *results).items()]
    some = any(result.cover is not None and result.undetermined for result in results)
    return [*found, Entry(("undetermined",), paint.undetermined)] if some else found


def entries(
    result: RegionMap, thin: bool, paint: Paint | None = None, areas: bool = True
) -> Iterator[Entry]:
    """The legend's entries, from above.

    Parameters
    ----------
    thin : whether the picture shows walls that separate nothing.
    areas : whether areas are among them.
    """
    count = result.slice.count
    paint = paint or Paint(lambda region: fill_of(region, count), UNDETERMINED)
    groups: dict[str, list[Region]] = {}
    for region in sorted(result.regions, key=lambda r: (counted_by(r, count), -r.area[0])):
        groups.setdefault(count_text(region, count), []).append(region)
    known = areas_are_known(result)
    head = head_of(result.slice)
    yield Entry(head, strong=True, heads=len(head))
    for text, regions in groups.items():
        bounds = _areas(result, text, regions) if areas and known else []
        yield Entry((_with_total(text, regions, result), *bounds), paint.fill(regions[0]))
    yield Entry(())
    if result.cover is not None and result.undetermined:
        note = ("the count may change within it",) if len(result.regions) > 1 else ()
        yield Entry((f"undetermined {percent(result.undetermined)}", *note), paint.undetermined)
    elif len(result.regions) > 1:
        yield Entry(("the count changes",), STRONG)
    for found in dict.fromkeys(result.continua.values()):
        yield Entry((f"{found.value} {noun(result.slice.model)}",), _dashed)
    if thin:
        yield thin_entry()


def line_mark(
    *looks: Mapping[str, Any], points: Sequence[Position] = ((0.0, 0.0), (SWATCH, 0.0))
) -> Mark:
    """A line through points in inches, or several on each other from below."""

    def mark(figure: Any, left: float, middle: float) -> None:
        xs, ys = zip(*((left + x, middle + y) for x, y in points), strict=True)
        for look in looks:
            stroke(figure, xs, ys, **look)

    return mark


def point_mark(**look: Any) -> Mark:
    """A marker."""

    def mark(figure: Any, left: float, middle: float) -> None:
        stroke(figure, (left + SWATCH / 2,), (middle,), **look)

    return mark


_dashed = line_mark({"color": INK, "linewidth": 1, "linestyle": "dashed"})


def hidden_entries(hidden: int) -> list[Entry]:
    """What is said of regions that are too thin to be seen and have neither inset nor label, if
    there are any.
    """
    many = "s are" if hidden > 1 else " is"
    return [Entry((f"{hidden} more region{many} too thin for a label",))] if hidden else []


def thin_entry() -> Entry:
    """Of curves where unstable solutions alone differ, or complex ones meet, or some leave every
    bounded set.
    """
    return Entry(("another curve of the variety,", "the count does not change"), THIN)


def _with_total(text: str, regions: list[Region], result: RegionMap) -> str:
    """The count, and of how many solutions in all; where these differ within it, of which numbers."""
    slice = result.slice
    totals = {result.cells[n].total for region in regions for n in region.cells}
    known = sorted(total for total in totals if total is not None)
    shades = slice.count.kind.shades
    if shades is Shades.TOTAL or not known or len(known) < len(totals) or len(known) > _MAX_TOTALS:
        return text
    numbers = listed([*map(str, known[:-1]), counted(slice.model, known[-1])], " or ")
    return f"{text}   {'' if shades is Shades.INDEX else 'of '}{numbers}"


def _areas(result: RegionMap, text: str, regions: list[Region]) -> list[str]:
    """The areas of the regions of a count, or what they have in all where they are many or their
    bounds are apart.
    """
    number = len(regions)
    if result.cover is None and 1 < number <= _MAX_AREAS:
        areas = ", ".join(area_text(result, region.area) for region in regions)
        return textwrap.wrap(f"{number} regions, areas {areas}", COLUMNS)
    together = area_text(result, area_by_count(result)[text])
    return textwrap.wrap(
        f"area {together}" if number == 1 else f"{number} regions, in all {together}", COLUMNS
    )


Rows = list[list[tuple[float, Entry]]]
"""A legend in rows, each entry with its place from the left in inches."""


def in_rows(entries: Sequence[Entry], width: float, type: Type) -> Rows:
    """The legend in rows of a width."""
    lines: Rows = [[]]
    at = 0.0
    for entry in entries:
        each = type.entry_width(entry) + 0.2 * type.scale
        if at and at + each > width:
            lines.append([])
            at = 0.0
        lines[-1].append((at, entry))
        at += each
    return lines


def draw_rows(figure: Any, rows: Rows, at: Position, step: float, type: Type) -> None:
    """A legend in rows from a place in inches downwards."""
    for k, row in enumerate(rows):
        for left, entry in row:
            draw_legend(figure, [entry], at[0] + left, at[1] - k * step, type)


def draw_legend(
    figure: Any, legend: Sequence[Entry], left: float, top: float, type: Type | None = None
) -> None:
    """Draw the entries from the place given in inches downwards."""
    type = type or Type()
    for entry in legend:
        middle = top - type.line / 2
        _draw_mark(figure, entry.mark, left, middle, type)
        for k, line in enumerate(entry.lines):
            size, colour = (type.head, INK) if k < entry.heads else (type.detail, "#444444")
            at = (left + (0 if entry.mark is None else type.indent), middle - k * type.line)
            weight = "bold" if entry.strong else "normal"
            write(figure, at, line, size, va="center_baseline", color=colour, fontweight=weight)
        top -= type.entry_height(entry)


def _draw_mark(
    figure: Any, mark: Fill | float | Mark | None, left: float, middle: float, type: Type
) -> None:
    from matplotlib.patches import Rectangle

    swatch, tall = SWATCH * type.scale, FILL * type.scale
    match mark:
        case Fill(face, hatch):
            figure.add_artist(
                Rectangle(
                    (left, middle - tall / 2), swatch, tall, transform=figure.dpi_scale_trans, facecolor=face,
                    hatch=hatch or None, edgecolor=INK, linewidth=0.4,
                )
            )  # fmt: skip
        case float(width):
            width, kind = (
                (type.strong, "solid") if width == STRONG else (type.thin, type.thin_lines)
            )
            stroke(
                figure,
                (left, left + swatch),
                (middle, middle),
                color=INK,
                linewidth=width,
                linestyle=kind,
            )
        case None:
            pass
        case draw:
            draw(figure, left, middle)
