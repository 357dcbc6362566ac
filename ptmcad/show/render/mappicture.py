"""The picture of a region map: regions coloured by count, walls, legend, and an inset for every
sliver.

Guarantee: the same map gives the same bytes (SVG and PNG) with the same matplotlib; regions that
the drawing's resolution hides are marked by an arrow and shown in insets. What a certified map
leaves undetermined is grey, with a hairline around it, so that it is seen however narrow it is.
Global state of matplotlib is neither used nor changed.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact
map.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import noun, several
from ptmcad.show.render.axes import dress, heading_of
from ptmcad.show.render.colours import INK, Paint, paint_of
from ptmcad.show.render.fitting import SIDE, Layout, PageParts, fitted
from ptmcad.show.render.inches import Box, axes_at, write_lines
from ptmcad.show.render.legend import Entry, Type, draw_legend, entries, hidden_entries, point_mark
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.painting import Overlay, draw_overlay, overlay_entries, paint_map
from ptmcad.show.render.printing import save, settings
from ptmcad.show.render.slivers import (
    MAX_ZOOMS,
    RESOLVED,
    Sliver,
    Zoom,
    arrows,
    draw_arrows,
    ranked,
    seen_thin_walls,
    thin_regions,
    unstable_zooms,
    zooms,
)
from ptmcad.show.render.view import Shapes
from ptmcad.show.style import DEFAULT, LegendPlace, PictureStyle, Size
from ptmcad.show.table import area_text, areas_are_known, count_text, region_area

_ZOOMED_COLUMNS = 34
"""Characters over an inset, most of them digits: as many as there is room for."""


def draw(
    result: RegionMap, path: Path, *, samples: bool = False, dpi: int = 150, style: PictureStyle = DEFAULT,
    overlay: Overlay = (),
) -> tuple[str, ...]:  # fmt: skip
    """Write the picture of a map.

    Parameters
    ----------
    path : its suffix gives the format, one of `ptmcad.show.render.printing.FORMATS`.
    samples : whether to draw the cells' sample points.
    dpi : resolution of a PNG; slivers are what is not seen at this resolution, in every format.
    style : what it looks like, and its size.
    overlay : further points.

    Returns
    -------
    What had no room and was left out, in words (see `left_out`).

    Raises
    ------
    ValueError
        For another suffix.
    ConfigError
        When it does not fit into the style's size.
    OSError
        When the file cannot be written.

    Guarantee
    ---------
    No region is invisible, unless the style sets a size in which its label has no room: the legend
    says of how many, if that has room.
    """
    with settings(style):
        figure, missing = MapDrawing(result, style, dpi, samples, overlay).drawn()
    save(figure, path, dpi=dpi, style=style)
    return missing


@dataclass(frozen=True, slots=True)
class _Seen:
    """What of a map is to be drawn: its shapes, and the views of the regions that its resolution
    hides.

    ``thin_lines`` says whether curves are seen at which the count does not change; if none is, none
    is drawn: a trace of one at the frame, which no legend explains, would look like a number's
    tick. ``unnamed`` is the number of thin parts in which unstable solutions differ that have
    neither inset nor label.
    """

    whole: Shapes
    thin: tuple[int, ...] = ()
    views: tuple[Zoom, ...] = ()
    thin_lines: bool = False
    unnamed: int = 0

    def with_room(self, sides: Size, size: float) -> _Seen:
        """The same but for what has no label of its own in a picture with sides in points, where no
        inset stands.
        """
        ranked = self.ranked
        result = self.whole.result
        named = [(sliver, _name_of(result, sliver, None)) for sliver in ranked]
        placed = arrows(self.whole, named, sides, size)
        kept = [sliver for sliver, clear, _ in placed if clear]
        if len(kept) == len(ranked):
            return self
        views = tuple(
            (outline, tuple(s for s in slivers if s in kept)) for outline, slivers in self.views
        )
        parts = [sum(sliver.cell is not None for sliver in each) for each in (ranked, kept)]
        lines = parts[1] > 0 or seen_thin_walls(self.whole, sides)
        views = tuple(zoom for zoom in views if zoom[1])
        return replace(
            self, views=views, thin_lines=lines, unnamed=self.unnamed + parts[0] - parts[1]
        )

    @property
    def ranked(self) -> list[Sliver]:
        """What is marked: first the largest region of each count that is seen nowhere else, then by
        size.
        """
        return ranked(self.whole, self.marked, self.thin)

    @property
    def hidden(self) -> int:
        """The number of regions that nothing shows."""
        return len(self.thin) - sum(sliver.cell is None for sliver in self.marked)

    @property
    def marked(self) -> list[Sliver]:
        return [sliver for _, slivers in self.views for sliver in slivers]


def _seen(whole: Shapes, sides: Size, dpi: int, earlier: _Seen | None = None) -> _Seen:
    """What is seen of a map with sides in inches."""
    pixels = round(min(sides) * min(dpi, RESOLVED))
    thin = thin_regions(whole, pixels)
    if earlier is not None and earlier.thin == thin:
        return earlier
    views = zooms(whole, thin)
    unstable = unstable_zooms(whole, pixels, MAX_ZOOMS - len(views))
    lines = bool(unstable) or seen_thin_walls(whole, (72 * sides[0], 72 * sides[1]))
    return _Seen(whole, thin, (*views, *unstable), lines)


class MapDrawing(NamedTuple):
    """A map and what it is to look like; to be drawn within `settings`.

    Attributes
    ----------
    dpi : resolution of a PNG, which says what is too thin to be seen.
    samples : whether the cells' sample points are drawn.
    overlay : further points.
    """

    result: RegionMap
    style: PictureStyle = DEFAULT
    dpi: int = 150
    samples: bool = False
    overlay: Overlay = ()

    @property
    def title(self) -> str:
        """The style's, or the slice's heading."""
        return whole_title(self.result) if self.style.title is None else self.style.title

    def figure(self) -> Figure:
        """The picture."""
        return self.drawn()[0]

    def drawn(self) -> tuple[Figure, tuple[str, ...]]:
        """The picture, and what it leaves out."""
        result = self.result
        seen, layout = self.fit()
        figure = Figure(figsize=layout.size, dpi=self.dpi, facecolor="white")
        figure.set_label(f"{whole_title(result)}\n{description(result)}")
        self.draw_parts(figure, seen, layout)
        return figure, left_out(seen, layout)

    def fit(self) -> tuple[_Seen, Layout]:
        """The contents of a page, and their places.

        Which regions are thin follows from the map's size, which follows from the text about thin
        regions.
        """
        style, whole = self.style, shapes(self.result)
        side = SIDE * style.base_font / 72
        wide, tall = style.size or (2 * side, 2 * side)
        seen = _seen(whole, (wide / 2, tall / 2), self.dpi)
        tries = 3
        while True:
            views = (whole.view, *(outline.view for outline, _ in seen.views))
            legend = partial(self.legend, seen)
            layout = fitted(
                PageParts(self.result.slice, self.title, legend, views, style), style.size
            )
            sides = layout.chart[2:]
            if seen.views and not layout.insets:
                # what no inset shows is named by a label that an arrow leads to it, if that has
                # room
                bare = seen.with_room((72 * sides[0], 72 * sides[1]), layout.arrow_size)
                if bare is not seen:
                    seen, tries = bare, 1
                    continue
            again = _seen(whole, sides, self.dpi, seen)
            tries -= 1
            if again is seen or not tries:
                return seen, layout
            seen = again

    def legend(self, seen: _Seen, areas: bool, hidden: bool) -> Sequence[Entry]:
        """The legend with or without areas; ``hidden`` says whether it states how many thin regions
        have no label.
        """
        if self.style.legend is LegendPlace.NONE:
            return ()
        paint = paint_of(self.style, self.result)
        dot = point_mark(color=INK, marker="o", markersize=2.5 * paint.scale)
        return [
            *entries(self.result, seen.thin_lines, paint, areas),
            *([Entry(("sample point of a cell",), dot)] if self.samples else []),
            *hidden_entries(seen.hidden * hidden),
            *overlay_entries(self.overlay),
        ]

    def draw_parts(self, figure: Figure, seen: _Seen, layout: Layout) -> Any:
        """Everything in its place; the map's axes."""
        result, paint = self.result, paint_of(self.style, self.result)
        on_map = replace(paint, thin_walls=seen.thin_lines)
        write_lines(figure, layout.title_at, layout.title, layout.title_size, layout.title_line)
        axes = axes_at(figure, layout.chart, "map")
        paint_map(axes, seen.whole, "", on_map)
        if self.samples:
            points = np.array(
                [seen.whole.view.approximate_position(c.sample) for c in result.cells]
            )
            axes.plot(
                *points.T, "o", markersize=2.5 * paint.scale, color=INK, transform=axes.transAxes, gid="samples",
                clip_on=False,
            )  # fmt: skip
        dress(axes, result.slice, seen.whole.view.x, seen.whole.view.y, layout.axes)
        type = Type.of(self.style, layout.font)
        for corner, entry in layout.legend:
            draw_legend(figure, [entry], *corner, type)
        marked = seen.marked if layout.insets else seen.ranked
        names = [
            _name_of(result, s, k if len(marked) > 1 and layout.insets else None)
            for k, s in enumerate(marked)
        ]
        rest = iter(names)
        for zoom, box in zip(seen.views, layout.insets, strict=False):
            _inset(figure, zoom, [next(rest) for _ in zoom[1]], box, layout, paint)
        sides, size = (layout.chart[2] * 72, layout.chart[3] * 72), layout.arrow_size
        named = list(zip(marked, names, strict=True))
        led = arrows(seen.whole, named, sides, size, not layout.insets)
        draw_arrows(axes, led, paint.scale)
        draw_overlay(axes, seen.whole.view, self.overlay, paint.scale, layout.arrow_size)
        return axes


def left_out(seen: _Seen, layout: Layout) -> tuple[str, ...]:
    """What a picture of this layout does not show for want of room, in words."""
    found = []
    lost, drawn = len(seen.views) + seen.unnamed, len(layout.insets)
    if lost > drawn and not drawn:
        found.append(f"{several(lost, 'inset')} of parts that are too thin to be seen")
    if seen.unnamed:
        found.append("labels of such parts, in which unstable ones differ")
    if layout.shortened:
        found.append("the areas in the legend")
    return tuple(found)


def whole_title(result: RegionMap) -> str:
    return "".join(c if c.isprintable() else " " for c in heading_of(result.slice))


def _name_of(result: RegionMap, sliver: Sliver, number: int | None) -> str:
    """A sliver's count, after a letter when there are several."""
    text = count_text(result.regions[sliver.region], result.slice.count)
    if sliver.cell is not None:
        text = f"{text} of {result.cells[sliver.cell].total}"
    if number is None:
        return text
    letters = ""
    while number >= 0:
        number, rest = divmod(number, 26)
        letters, number = chr(ord("A") + rest) + letters, number - 1
    return f"{letters}: {text}"


def _inset(
    figure: Figure, zoom: Zoom, names: Sequence[str], box: Box, layout: Layout, paint: Paint
) -> None:
    """Axes with the inset of one or more slivers."""
    outline, slivers = zoom
    result = outline.result
    number = slivers[0].region
    axes = axes_at(figure, box, f"sliver-{number}")
    paint_map(axes, outline, f"sliver-{number}-", paint)
    dress(axes, result.slice, outline.view.x, outline.view.y, layout.inset_axes)
    if any(sliver.cell is not None for sliver in slivers):
        title = f"{', '.join(names)}\nunstable ones differ, zoomed"
    elif len(names) == 1:
        title = _zoomed(names[0], region_area(result, number) if areas_are_known(result) else "")
    else:
        title = textwrap.shorten(", ".join(names), _ZOOMED_COLUMNS, placeholder=" …") + "\nzoomed"
    axes.set_title(title, fontsize=layout.inset_size, loc="left", pad=3)


def _zoomed(name: str, area: str) -> str:
    """The two lines over the inset of a region, as long as there is room for."""
    if not area:
        return f"{name}\nzoomed"
    if len(f"area {area}, zoomed") <= _ZOOMED_COLUMNS:
        return f"{name}\narea {area}, zoomed"
    if len(f"area {area}") <= _ZOOMED_COLUMNS:
        return f"{name}, zoomed\narea {area}"
    low, _, high = area.partition(" to ")
    return f"{name}, zoomed, area {low}\nto {high}"


def description(result: RegionMap) -> str:
    """What the picture shows, in words."""
    count = result.slice.count
    window = " and ".join(f"{a.name} from {a.low} to {a.high}" for a in result.slice.axes)
    known = areas_are_known(result)
    regions = "; ".join(
        count_text(r, count) + (f" ({area_text(result, r.area)})" if known else "")
        for r in result.regions
    )
    bracket = "; area in brackets" if known else ""
    return f"Regions of equal count ({count.value} {noun(result.slice.model)}{bracket}) over {window}: {regions}."
