"""Where the parts of a map's picture stand, and how large its text is: a page that grows with what
it shows.

Guarantee: none of its parts overlap. `ptmcad.show.render.fitting` lays the same parts out on a page
of a given size. All places are in inches from the page's lower left corner.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, field

from ptmcad.show.render.axes import SMALL, Dress
from ptmcad.show.render.colours import STRONG, THIN
from ptmcad.show.render.inches import Box
from ptmcad.show.render.labels import Position
from ptmcad.show.render.legend import Entry, Type
from ptmcad.show.style import PictureStyle

SIDE, LEFT, BOTTOM, COLUMN, GAP, MARGIN = 4.6, 0.85, 0.65, 2.6, 0.25, 0.15
"""In inches: the map's side, the space at its left and below, a column at its right, the space
before, the rim.
"""
INSET_WIDTH, INSET_HEIGHT, INSET_LEFT, INSET_BELOW, INSET_ABOVE = 1.75, 1.2, 0.62, 0.48, 0.42
TITLE_COLUMNS, TITLE_LINES = 80, 3
BLOCK = INSET_ABOVE + INSET_HEIGHT + INSET_BELOW
TITLE_LINE = 0.22
WIDEST = LEFT + SIDE + GAP + 2 * COLUMN + MARGIN
"""Of a picture that grows with what it shows, whatever there is to zoom: what has no room beside
the map goes below.
"""


@dataclass(frozen=True, slots=True)
class Layout:
    """A page's parts.

    Attributes
    ----------
    size : of the page.
    chart : the map.
    title : lines.
    title_at, title_line : the left end of the first line's middle, and the distance of lines.
    legend : parts of it, each with its upper left corner.
    insets : the places of views of slivers, as many as are shown.
    type, axes, inset_axes : sizes of text in the legend and at the axes.
    title_size, inset_size, arrow_size : sizes in points of other text.
    shortened : whether the legend has no areas because they have no room.
    """

    size: Position
    chart: Box
    title: Sequence[str]
    title_at: Position
    legend: Sequence[tuple[Position, Sequence[Entry]]]
    insets: Sequence[Box]
    title_line: float = TITLE_LINE
    type: Type = field(default_factory=Type)
    axes: Dress = field(default_factory=Dress)
    inset_axes: Dress = SMALL
    title_size: float = 11
    inset_size: float = 7.5
    arrow_size: float = 8
    shortened: bool = False


def title_lines(title: str) -> list[str]:
    """Of a title over a picture that grows with what it shows."""
    return textwrap.wrap(title, TITLE_COLUMNS, max_lines=TITLE_LINES, placeholder=" …")


def flowing(heading: str, legend: Sequence[Entry], style: PictureStyle, insets: int) -> Layout:
    """The layout of a map of a fixed side on a page that grows, with the legend and insets at its
    right; `ptmcad.show.render.fitting` has that of a page of a given size.
    """
    title, thin = title_lines(heading), style.strong * THIN / STRONG
    type = Type(strong=style.strong, thin=thin, thin_lines=style.thin_lines)
    below = type.height(legend) + 0.1
    high = max(SIDE + BOTTOM, below + 0.1, BLOCK)
    right, under = _places(insets, below, high)
    columns = 1 + max((column for column, _ in right), default=0)
    left = LEFT + SIDE + GAP
    rows = 1 + max((row for row, _ in under), default=-1)
    top = high + rows * BLOCK
    size = (left + columns * COLUMN + MARGIN, top + TITLE_LINE * len(title) + 2 * MARGIN)
    corners = [(left + column * COLUMN, top - down) for column, down in right]
    corners += [(MARGIN + column * COLUMN, (rows - row) * BLOCK) for row, column in under]
    return Layout(
        size=size,
        chart=(LEFT, top - SIDE, SIDE, SIDE),
        title=title,
        title_at=(LEFT, size[1] - MARGIN - TITLE_LINE * 0.5),
        legend=(((left, top), legend),),
        insets=tuple(
            (x + INSET_LEFT, y - INSET_ABOVE - INSET_HEIGHT, INSET_WIDTH, INSET_HEIGHT)
            for x, y in corners
        ),
        type=type,
    )


def _places(
    number: int, below: float, tall: float
) -> tuple[list[tuple[int, float]], list[tuple[int, int]]]:
    """Places for insets: the first ones below the legend, then in a column at its right, others in
    rows below the map.

    Of the former the column and the distance from the top, of the latter the row and its column.
    """
    first = int((tall - below) // BLOCK)
    right = [(0, below + k * BLOCK) for k in range(first)]
    right += [(1, k * BLOCK) for k in range(int(tall // BLOCK))]
    across = int((WIDEST - 2 * MARGIN) // COLUMN)
    under = [divmod(k, across) for k in range(max(0, number - len(right)))]
    return right[:number], under
