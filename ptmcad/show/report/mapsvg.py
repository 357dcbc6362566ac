"""The region map as inline SVG: fills, walls, axes, and one focusable area for every cell.

Guarantee: every cell of the view has an area with its number; nothing is drawn with a style
attribute, which the page's policy forbids. The same map gives the same text.

A certified map's rims are drawn within `SLACK` of their places, and at least twice as wide, over
all fills: what is seen of a fill, and what of an area can be pointed at, is in that cell of the map
itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from html import escape
from math import ceil

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ptmcad.answer.regionmap import Cell, Region
from ptmcad.answer.words import stable_of
from ptmcad.model import Model
from ptmcad.show.render.axes import scale_of, symbol, ticks
from ptmcad.show.render.colours import Fill, fill_of
from ptmcad.show.render.labels import Position
from ptmcad.show.render.polylines import GRID, path_data
from ptmcad.show.render.slivers import innermost, thin_regions, zooms
from ptmcad.show.render.view import Floats, Shapes, from_above
from ptmcad.show.table import count_text
from ptmcad.show.units import unit, with_unit
from ptmcad.text.numerals import approximate_text, shortest_text

SIDE, RIM = 600, 24
"""In the picture's own units: the window's side, the rim."""
_LEFT, _BOTTOM = 110, 100
"""The least room for the axes' numbers and names."""
_NUMBER, _NAME, _DETAIL = 29, 31, 36
"""The sizes of their type on phones, as page.css has them: in the map, and of both in a view of
thin regions.
"""
_WIDTHS = {".": 0.32, "−": 0.84}
"""Of characters against the type's size; digits are 0.64 wide."""
_MAX_NAME, _MAX_NUMBER = 24, 14
"""Characters of an axis's name and of a number in words."""

Mark = tuple[str, Position]
"""A letter and its place in the view, as fractions of the sides."""
Label = tuple[int, float, float]
"""A region and the place of its count."""

MAP_PIXELS = 300
"""Pixels of the map's side on a phone: regions thinner than three of them get a view of their own.
"""
_WALLS, _RIMS, SLACK = 0.1, 0.25, 0.3
"""By how much, in the picture's units, walls and a certified map's rims may depart to have fewer
corners, and these together with the rounding to the grid. A unit is less than a pixel where the
page is largest."""
RIM_WIDTH, CORE_WIDTH, _OPEN_WIDTH = 2.0, 1.0, 0.7
"""Of a certified map's rims, of what is undetermined between them at least, and of what keeps the
pointer from it, in the picture's units: no less than twice `SLACK`."""
LABEL, _LETTER = 42, 0.55
"""Size of the counts' type on phones, in the picture's units, and a character's width against it,
on the whole.
"""


def chart(seen: Shapes) -> tuple[str, tuple[str, ...], bool, int]:
    """The whole window and views of thin regions as SVG; whether walls are seen that separate nothing,
    and the number of thin regions without a view.
    """
    thin = thin_regions(seen, MAP_PIXELS)
    views = zooms(seen, thin)
    marks = [(chr(ord("A") + k), *zoom) for k, zoom in enumerate(views)]
    tips = [(letter, seen.view.approximate_position(slivers[0].at)) for letter, _, slivers in marks]
    continua = seen.result.continua
    return (
        _picture(seen, "map", tips, region_labels(seen)),
        tuple(_picture(outline, f"detail-{letter}", (), ()) for letter, outline, _ in marks),
        any(not separates and n not in continua for n, separates, _ in seen.walls()),
        len(thin) - sum(len(slivers) for _, slivers in views),
    )


def pattern_defs(fills: Sequence[Fill]) -> str:
    """The patterns that hatched fills refer to, as a hidden SVG."""
    hatches = sorted({fill.hatch for fill in fills if fill.hatch})
    if not hatches:
        return ""
    # the second is the same pattern for what is drawn in steps of the grid
    body = "".join(
        f'{_pattern(hatch)}<pattern id="map-{hatch_id(hatch)}" href="#{hatch_id(hatch)}" '
        f'patternTransform="scale({GRID})"/>'
        for hatch in hatches
    )
    return f'<svg class="defs" width="0" height="0" aria-hidden="true"><defs>{body}</defs></svg>'


def hatch_id(hatch: str) -> str:
    """The pattern's name: matplotlib's hatch character, which is repeated for density, as a number,
    and how often.
    """
    return f"hatch-{ord(hatch[0]):x}-{len(hatch)}"


_MARKS = {
    "/": '<path d="M0 12L12 0"/>',
    "\\": '<path d="M0 0L12 12"/>',
    "x": '<path d="M0 0L12 12M0 12L12 0"/>',
    "-": '<path d="M0 6H12"/>',
    "|": '<path d="M6 0V12"/>',
    "+": '<path d="M0 6H12M6 0V12"/>',
    ".": '<circle class="dot" cx="6" cy="6" r="1.5"/>',
    "o": '<circle cx="6" cy="6" r="3"/>',
    "*": '<path d="M6 2.4V9.6M2.4 6H9.6M3 3L9 9"/>',
}
"""Of matplotlib's hatch characters, a tile of 12 units, which is the size of four characters."""


def _pattern(hatch: str) -> str:
    """A tile whose density follows the number of characters, as in the other pictures."""
    size = round(48 / len(hatch), 1)
    return (
        f'<pattern id="{hatch_id(hatch)}" class="hatch" width="{size}" height="{size}" '
        f'viewBox="0 0 12 12" patternUnits="userSpaceOnUse">{_MARKS[hatch[0]]}</pattern>'
    )


def _picture(seen: Shapes, name: str, marks: Sequence[Mark], labels: Sequence[Label]) -> str:
    result = seen.result
    count = result.slice.count
    view, place, around = frame(seen, detail=name != "map")
    plate = "plate" if result.cover is None else "undetermined"
    parts = [
        f'<svg id="{name}" class="map" role="group" viewBox="{view}" aria-label="{escape(_window_text(seen))}">',
        f'<clipPath id="{name}-window"><rect width="{SIDE}" height="{SIDE}"/></clipPath>',
        f'<g transform="{place}">',
        f'<rect class="{plate}" width="{SIDE}" height="{SIDE}"/><g clip-path="url(#{name}-window)">',
    ]
    parts.append(f'<g transform="scale({1 / GRID:g})">')
    parts += _areas(seen) if result.cover is None else _rimmed_areas(seen, name)
    parts.append("</g>")
    for region_number, x, y in labels:
        text = count_text(result.regions[region_number], count)
        parts.append(
            f'<text class="count" x="{x * SIDE:.1f}" y="{(1 - y) * SIDE:.1f}" dy=".36em">{escape(text)}</text>'
        )
    parts.append("</g>")
    parts.append(around)
    for letter, (x, y) in marks:
        parts.append(
            f'<g class="mark" transform="translate({x * SIDE:.1f} {(1 - y) * SIDE:.1f})"><circle r="13"/>'
            f'<text dy=".36em">{letter}</text></g>'
        )
    parts.append('<circle class="sample" r="5" visibility="hidden"/></g></svg>')
    return "".join(parts)


def _window_text(seen: Shapes) -> str:
    axes = seen.result.slice.axes
    ends = (seen.view.x, seen.view.y)
    spans = (
        f"{a.name} from {shortened(e[0])} to {shortened(e[1])}"
        for a, e in zip(axes, ends, strict=True)
    )
    return "Region map over " + " and ".join(spans)


def shortened(value: Fraction) -> str:
    """A number, to nine digits where it is long."""
    text = shortest_text(value)
    return text if len(text) <= _MAX_NUMBER else approximate_text(value)


def paints(fill: Fill, prefix: str = "") -> list[str]:
    """What a shape is painted with, one over the other: a colour and a hatch.

    Parameters
    ----------
    prefix : ``map-`` for what is drawn in steps of the grid.
    """
    hatch = [f"url(#{prefix}{hatch_id(fill.hatch)})"] if fill.hatch else []
    return [escape(fill.face), *hatch]


def _areas(seen: Shapes) -> Iterator[str]:
    """An exact map's regions, walls and cells, these from the left and from below."""
    result = seen.result
    for number, outline in region_outlines(seen):
        for paint in paints(fill_of(result.regions[number], result.slice.count), "map-"):
            yield f'<path class="fill" fill="{paint}" d="{outline}"/>'
    for (separates, component), line in wall_lines(seen).items():
        kind = "wall strong" if separates or component in result.continua else "wall"
        kind += '" stroke-dasharray="6 4' if component in result.continua else ""
        yield f'<path class="{kind}" data-curve="{component}" d="{line}"/>'
    for number, polygons in seen.cells(_WALLS / SIDE):
        yield f'<path class="cell" data-cell="{number}" d="{outline_data(polygons)}"/>'


def region_outlines(seen: Shapes, simpler: bool = True) -> Iterator[tuple[int, str]]:
    """Every region that is seen, and its outline as the data of a path, in steps of the grid.

    Parameters
    ----------
    simpler : whether to look for corners that can be left out, of which a coarse outline has few.
    """
    tolerance = (_WALLS if seen.result.cover is None else _RIMS) / SIDE if simpler else 0.0
    for number, polygons in enumerate(seen.polygons(tolerance)):
        # one path for all parts: where two of them share an edge no seam is left
        outline = outline_data(polygons)
        if outline:
            yield number, outline


def outline_data(polygons: Iterable[Floats], side: float = SIDE) -> str:
    """Closed polygons as such data, of a picture whose sides are so many units."""
    return "".join(path_data(from_above(polygon, side), closed=True) for polygon in polygons)


def wall_lines(seen: Shapes, simpler: bool = True) -> dict[tuple[bool, int], str]:
    """The walls as such data: those that do not separate regions first, then by components."""
    tolerance = _WALLS / SIDE if simpler else 0.0
    lines: dict[tuple[bool, int], list[str]] = {}
    for component, separates, line in seen.walls(tolerance):
        lines.setdefault((separates, component), []).append(path_data(from_above(line, SIDE)))
    return {kind: "".join(pieces) for kind, pieces in sorted(lines.items())}


def _rimmed_areas(seen: Shapes, name: str) -> Iterator[str]:
    """A certified map's cells: their outlines once, what fills them, their rims, and what can be
    pointed at.

    Between two cells is what is undetermined, however narrow: it is seen within the rims, which are
    over all fills, and the last of them, which nobody sees, keeps the pointer from the areas below.
    """
    result = seen.result
    outlines = {n: outline_data(p) for n, p in seen.cells(_RIMS / SIDE)}
    body = "".join(f'<path id="{name}-{n}" class="outline" d="{d}"/>' for n, d in outlines.items())
    yield f'<defs><g id="{name}-rims">{body}</g></defs>'
    for region in result.regions:
        used = "".join(f'<use href="#{name}-{n}"/>' for n in region.cells if n in outlines)
        if used:
            for paint in paints(fill_of(region, result.slice.count), "map-"):
                yield f'<g class="fill" fill="{paint}">{used}</g>'
    rims = [
        f'<use class="{kind}" href="#{name}-rims" stroke-width="{width * GRID:g}"/>'
        for kind, width in (("rim", RIM_WIDTH), ("core", CORE_WIDTH), ("open", _OPEN_WIDTH))
    ]
    yield "".join(rims[:2])
    for n in outlines:
        yield f'<use class="cell" href="#{name}-{n}" data-cell="{n}"/>'
    yield rims[2]


def counts_text(part: Cell | Region, model: Model) -> str:
    """The counts in words, as far as they are known."""
    known = [f"{number} {name}" for name, number in part.further.items()]
    if part.total is not None:
        known.append(stable_of(model, part.stable, part.total))
    elif part.stable is not None:
        known.append(f"{part.stable} stable")
    return ", ".join(known) or "counts not known"


def region_labels(seen: Shapes) -> list[Label]:
    """For each region into which its count can be written, even in the larger type of phones, a
    point deep inside.
    """
    pixels = 60
    image = seen.raster(pixels, pixels)
    found = []
    for number, region in enumerate(seen.result.regions):
        half = (
            ceil(
                len(count_text(region, seen.result.slice.count))
                * LABEL
                * _LETTER
                / 2
                * pixels
                / SIDE
            )
            + 1
        )
        padded = np.pad(image == number, ((2, 2), (half, half)))
        room = np.asarray(sliding_window_view(padded, (5, 2 * half + 1)).all(axis=(2, 3)))
        depth, column, row = innermost(room)
        if depth >= 0:
            found.append((number, (column + 0.5) / pixels, (row + 0.5) / pixels))
    return found


def frame(seen: Shapes, detail: bool) -> tuple[str, str, str]:
    """The picture's own coordinates as SVG has them, where the window begins, and the frame with ticks,
    numbers and names, as elements of a group whose origin is its upper left corner.

    Parameters
    ----------
    detail : whether this is a view of thin regions, where the type is larger.
    """
    size, name_size = (_DETAIL, _DETAIL) if detail else (_NUMBER, _NAME)
    slice = seen.result.slice
    scales = [scale_of(*interval) for interval in (seen.view.x, seen.view.y)]
    across, up = map(ticks, (seen.view.x, seen.view.y), scales)
    wide = max((_width(text) for text, _ in up), default=0) * size
    beyond = max(
        ((float(at) - 1) * SIDE + _width(text) * size / 2 for text, at in across), default=0
    )
    left = ceil(max(_LEFT, 14 + wide + 6 + 1.3 * name_size))
    right = ceil(max(RIM, beyond + 2))
    bottom = ceil(max(_BOTTOM, 18 + 1.1 * size + 1.1 * name_size + 20))
    parts = [f'<rect class="frame" width="{SIDE}" height="{SIDE}"/>']
    places = (
        f'x="{SIDE / 2}" y="{SIDE + bottom - 16}"',
        f'transform="translate({name_size - left:g} {SIDE / 2}) rotate(-90)"',
    )
    for number, (scale, found) in enumerate(zip(scales, (across, up), strict=True)):
        for value, position in found:
            at = float(position) * SIDE
            if number == 0:
                parts.append(f'<path class="tick" d="M{at:.1f} {SIDE}v8"/>')
                place = f'class="number x" x="{at:.1f}" y="{SIDE + 18}" dy=".8em"'
            else:
                parts.append(f'<path class="tick" d="M0 {SIDE - at:.1f}h-8"/>')
                place = f'class="number y" x="-14" y="{SIDE - at:.1f}" dy=".36em"'
            parts.append(f"<text {place}>{value}</text>")
        name = slice.axes[number].name
        text = scale.name(symbol(name if len(name) <= _MAX_NAME else name[: _MAX_NAME - 1] + "…"))
        text = escape(with_unit(text, unit(slice, number)))
        parts.append(f'<text class="name" {places[number]}>{text}</text>')
    view = f"0 0 {left + SIDE + right} {RIM + SIDE + bottom}"
    return view, f"translate({left} {RIM})", "".join(parts)


def _width(text: str) -> float:
    """Of a number, against its type's size."""
    return sum(_WIDTHS.get(character, 0.64) for character in text)
