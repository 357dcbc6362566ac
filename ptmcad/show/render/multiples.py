"""The maps of a family's members side by side (small multiples), all in the same colours, with one
legend.

Guarantee: every chart shows the whole window to the same scale; a colour stands for the same count
in all of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from matplotlib.figure import Figure

from ptmcad.answer.family import FamilyMap
from ptmcad.errors import ConfigError
from ptmcad.show.render.axes import Dress, symbol
from ptmcad.show.render.fitting import MIN_SIDE, PageParts, overhang
from ptmcad.show.render.inches import write, write_lines
from ptmcad.show.render.legend import (
    INK,
    STRONG,
    THIN,
    Entry,
    Rows,
    Type,
    draw_rows,
    head_of,
    hidden_words,
    in_rows,
    thin_entry,
)
from ptmcad.show.render.painting import Paint, fills_by_count, paint_of
from ptmcad.show.render.printing import settings
from ptmcad.show.render.shapes import shapes
from ptmcad.show.render.slivers import seen_thin_walls
from ptmcad.show.render.textwidth import wrapped
from ptmcad.show.render.thinmarks import draw_chart, marks_of
from ptmcad.show.style import MIN_FONT, LegendPlace, PictureStyle, Size
from ptmcad.text.numerals import shortest_text

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
    told = [Entry(head, strong=True, heads=len(head))]
    told += [Entry((text,), fill) for text, fill in fills_by_count(paint, *family.members).items()]
    if any(result.cover is not None for result in family.members):
        told.append(Entry(("undetermined",), paint.undetermined))
    if any(result.cover is None and len(result.regions) > 1 for result in family.members):
        told.append(Entry(("the count changes",), STRONG))
    if thin:
        told.append(Entry((" ".join(thin_entry().lines),), THIN))
    if hidden:
        told.append(Entry((hidden_words(hidden),)))
    return told


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
    em = font / 72
    type = Type.of(style)
    how = Dress(max(MIN_FONT, 0.85 * font), 0.95 * font, (4, 4), scale=font / 9)
    seen = [shapes(result) for result in family.members]
    parts = PageParts(family.members[0].slice, "", ((), ()), (seen[0].view,))
    left, below, right, _ = overhang(parts, seen[0].view, (SIDE, SIDE), how)
    columns = _columns(len(seen), style.size)
    rows = math.ceil(len(seen) / columns)
    gap, head = max(right, 1.9 * em), 1.7 * em
    wide = style.size[0] if style.size is not None else left + columns * (SIDE * font / 9 + gap)
    side = (wide - left) / columns - gap
    paint = paint_of(style, *family.members)
    marks = [marks_of(shape, (side, side), dpi, max(MIN_FONT, 0.85 * font)) for shape in seen]
    thin = any(seen_thin_walls(shape, (72 * side, 72 * side)) for shape in seen)
    paint = replace(paint, thin_walls=thin)
    told = family_entries(family, paint, thin, sum(mark.hidden for mark in marks))
    titles, lines = titles_and_rows(family, style, told, wide, type)
    rest = (
        1.5 * em * len(titles)
        + 0.4 * em
        + rows * head
        + below
        + (type.line * 1.35) * len(lines)
        + 0.7 * em
    )
    between = 0.5 * em * (rows - 1)
    tall = (style.size[1] - rest - between) / rows if style.size is not None else side
    if min(side, tall) < 0.5 * MIN_SIDE * em:
        raise ConfigError(
            f"{len(seen)} maps do not fit: make it larger, or draw fewer members", key="size"
        )
    height = rest + between + rows * tall
    figure = Figure(figsize=(wide, height), dpi=dpi, facecolor="white")
    write_lines(
        figure, (0.6 * em, height - 0.9 * em), titles, font, 1.5 * em, fontweight="bold", color=INK
    )
    top = height - 1.5 * em * len(titles) - 0.4 * em
    for k, (value, shape) in enumerate(zip(family.values, seen, strict=True)):
        row, column = divmod(k, columns)
        box = (
            left + column * (side + gap),
            top - (row + 1) * (head + tall) - row * 0.5 * em,
            side,
            tall,
        )
        axes = draw_chart(figure, box, shape, paint, marks[k], how, f"{k}-")
        _strip_inner(axes, column > 0, k + columns < len(seen))
        write(
            figure, (box[0], box[1] + tall + 0.75 * em), value_text(family, value), font, color=INK
        )
    draw_flowed(figure, lines, em, type)
    return figure


def _columns(number: int, size: Size | None) -> int:
    """So that charts are about as wide as high."""
    if size is None:
        return min(
            number, 3 if number in (3, 5, 6, 9) else 4 if number in (7, 8, 12) else _MAX_COLUMNS
        )
    return max(1, min(number, round(math.sqrt(number * size[0] / size[1]))))


def _strip_inner(axes: Any, has_left: bool, has_below: bool) -> None:
    """Leave out numbers and names that a chart beside or below has."""
    if has_left:
        axes.set_ylabel("")
        axes.tick_params(axis="y", labelleft=False)
    if has_below:
        axes.set_xlabel("")
        axes.tick_params(axis="x", labelbottom=False)


def titles_and_rows(
    family: FamilyMap, style: PictureStyle, told: Sequence[Entry], wide: float, type: Type
) -> tuple[list[str], Rows]:
    """The lines of the title and the rows of the legend of a figure of a width in inches, as the
    style wants them.
    """
    title = title_of(family) if style.title is None else style.title
    inner = wide - 1.2 * style.base_font / 72
    titles = wrapped(title, inner, style.base_font, True)
    return titles, [] if style.legend is LegendPlace.NONE else in_rows(told, inner, type)


def draw_flowed(figure: Figure, lines: Rows, em: float, type: Type) -> None:
    """A legend in rows at the figure's foot."""
    step = 1.35 * type.line
    draw_rows(figure, lines, (0.6 * em, 0.5 * em + len(lines) * step), step, type)
