"""The maps of a family's members side by side (small multiples), all in the same colours, with one
legend.

Guarantee: every chart shows the whole window to the same scale; a colour stands for the same count
in all of them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

from matplotlib.figure import Figure

from ptmcad.answer.family import FamilyMap
from ptmcad.errors import ConfigError
from ptmcad.show.render.axes import Dress, symbol
from ptmcad.show.render.fitting import MIN_SIDE, PageParts, overhang
from ptmcad.show.render.legend import STRONG, THIN, Entry, Type, head_of, hidden_words, thin_entry
from ptmcad.show.render.painting import Paint, fills_by_count, paint_of
from ptmcad.show.render.panels import HeadAndFoot, Panel, PanelGrid
from ptmcad.show.render.printing import settings
from ptmcad.show.render.shapes import shapes
from ptmcad.show.render.slivers import seen_thin_walls
from ptmcad.show.render.thinmarks import marks_of
from ptmcad.show.style import MIN_FONT, PictureStyle, Size
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
    marks = [marks_of(shape, (side, side), dpi, small) for shape in seen]
    thin = any(seen_thin_walls(shape, (72 * side, 72 * side)) for shape in seen)
    paint = replace(paint_of(style, *family.members), thin_walls=thin)
    told = family_entries(family, paint, thin, sum(mark.hidden for mark in marks))
    around = HeadAndFoot.of(title_of(family), told, wide, style, type)
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
        Panel(shape, paint, text, marks=mark)
        for shape, text, mark in zip(seen, heads, marks, strict=True)
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
