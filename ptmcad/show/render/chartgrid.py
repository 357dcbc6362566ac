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
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import ConfigError
from ptmcad.show.render.axes import dress, symbol
from ptmcad.show.render.colours import INK, STRONG, THIN, Fill, Paint, paint_of
from ptmcad.show.render.fitting import MIN_SIDE, dressed
from ptmcad.show.render.inches import few, wrapped, write_lines
from ptmcad.show.render.legend import (
    Entry,
    Type,
    count_entries,
    draw_rows,
    head_of,
    hidden_entries,
    in_rows,
    thin_entry,
)
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.painting import paint_map
from ptmcad.show.render.printing import settings
from ptmcad.show.render.slivers import arrows_of, draw_arrows, seen_thin_walls
from ptmcad.show.render.view import Shapes
from ptmcad.show.style import LegendPlace, PictureStyle, Size
from ptmcad.text.numerals import shortest_text

LINE = 1.35
"""Between lines, in sizes of their type."""
_MAX_HEAD = 3
"""Lines above a chart."""


@dataclass(frozen=True, slots=True)
class Chart:
    """A map with what stands above it.

    Attributes
    ----------
    names : of regions that have an arrow where they are too thin to be seen, as of `arrows_of`; None
        for their counts.
    outlined : regions that are seen however narrow they are, with what rims them.
    """

    seen: Shapes
    paint: Paint
    head: str
    names: Sequence[str] | None = None
    outlined: Mapping[int, Fill] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Page:
    """What charts have in common: title, description and legend in one, and their number in a row.

    Attributes
    ----------
    wide, tall : inches of the page; None for as many as it needs.
    side : inches of a chart in 9 points, where these are so many.
    """

    title: str
    words: str
    legend: Sequence[Entry]
    columns: int
    wide: float | None
    tall: float | None
    side: float


def grid_figure(charts: Sequence[Chart], page: Page, dpi: int, style: PictureStyle) -> Figure:
    """Charts in rows from above, with numbers and names at the outer ones alone.

    Raises
    ------
    ConfigError
        When they do not fit into the style's size.
    """
    font, type, columns = style.base_font, Type.of(style), page.columns
    scale, rows = font / 9, math.ceil(len(charts) / columns)
    wide = page.wide or (0.5 + columns * (page.side + 0.2)) * scale
    side = (wide - 0.5 * scale) / columns - 0.2 * scale
    how = dressed(font, (side, side))
    with settings(style):
        marks = [arrows_of(c.seen, (side, side), dpi, type.detail, c.names) for c in charts]
        thin = any(seen_thin_walls(c.seen, (72 * side, 72 * side)) for c in charts)
        lines = [Entry((" ".join(thin_entry().lines),), THIN)] if thin else []
        legend = [*page.legend, *lines, *hidden_entries(sum(hidden for _, hidden in marks))]
        head, foot, draw = head_and_foot(page.title, legend, wide, style)
        heads = [few(wrapped(c.head, side, type.head), _MAX_HEAD) for c in charts]
        row = side + LINE * type.head / 72 * max(map(len, heads)) + 0.1 * scale
        named = 1 + (len(charts) > columns and len(charts) % columns > 0)
        tall = page.tall or head + foot + rows * row + 0.45 * scale * named
        figure = Figure(figsize=(wide, tall), dpi=dpi, facecolor="white", layout="constrained")
        places: Any = figure.subplots(rows, columns, squeeze=False).flat
        for number, (axes, chart) in enumerate(zip(places, charts, strict=False)):
            paint = replace(chart.paint, thin_walls=thin and chart.paint.thin_walls)
            paint_map(axes, chart.seen, f"{number}-", paint)
            dress(axes, chart.seen.result.slice, chart.seen.view.x, chart.seen.view.y, how)
            draw_arrows(axes, marks[number][0], how.scale)
            outlines = chart.seen.polygons() if chart.outlined else []
            for region, fill in chart.outlined.items():
                rims = [np.vstack([rim, rim[:1]]) for rim in outlines[region]]
                axes.add_artist(
                    LineCollection(
                        rims, transform=axes.transAxes, colors=fill.face, linewidths=0.1 * type.head,
                        joinstyle="round", zorder=4, gid=f"change-{region}",
                    )
                )  # fmt: skip
            if number % columns:
                axes.set_ylabel("")
                axes.tick_params(axis="y", labelleft=False)
            if number + columns < len(charts):
                axes.set_xlabel("")
                axes.tick_params(axis="x", labelbottom=False)
            axes.set_title("\n".join(heads[number]), loc="left", fontsize=type.head, color=INK)
        for axes in places[len(charts) :]:
            axes.remove()
        what = f"{len(charts)} maps do" if len(charts) > 1 else "the map does"
        lay_out(figure, head, foot, what, 0.5 * MIN_SIDE * font / 72)
        draw(figure)
    figure.set_label(f"{page.title}\n{page.words}")
    return figure


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
        engine.set(
            rect=(side, foot / tall, 1 - 2 * side, room / tall), w_pad=0.03, h_pad=0.03, wspace=0.06
        )
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


def map_entries(paint: Paint, *results: RegionMap) -> list[Entry]:
    """The legend of some maps: a fill for each count that one of them has, and the line between two
    counts.
    """
    head = head_of(results[0].slice)
    legend = [Entry(head, strong=True, heads=len(head)), *count_entries(paint, *results)]
    if any(result.cover is None and len(result.regions) > 1 for result in results):
        legend.append(Entry(("the count changes",), STRONG))
    return legend


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
    paint = paint_of(style, *family.members)
    charts = [Chart(shapes(result), paint, value_text(family, value)) for value, result in family]
    columns, (wide, tall) = _columns(len(charts), style.size), style.size or (None, None)
    legend = map_entries(paint, *family.members)
    page = Page(title_of(family), in_words(family), legend, columns, wide, tall, SIDE)
    return grid_figure(charts, page, dpi, style)


def _columns(number: int, size: Size | None) -> int:
    """So that charts are about as wide as high."""
    if size is None:
        return min(
            number, 3 if number in (3, 5, 6, 9) else 4 if number in (7, 8, 12) else _MAX_COLUMNS
        )
    return max(1, min(number, round(math.sqrt(number * size[0] / size[1]))))
