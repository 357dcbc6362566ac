"""Where the parts of a map's picture stand, and how large its text is: a page that grows with what it shows.

Guarantee: none of its parts overlap. `ptmcad.show.render.fitting` lays the same parts out on a page of a given size.
All places are in inches from the page's lower left corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ptmcad.show.render.axes import SMALL, Dress
from ptmcad.show.render.legend import Entry, Type

SIDE, LEFT, BOTTOM, COLUMN, GAP, MARGIN = 4.6, 0.85, 0.65, 2.6, 0.25, 0.15
"""In inches: the map's side, the space at its left and below, a column at its right, the space before, the rim."""
INSET_WIDTH, INSET_HEIGHT, INSET_LEFT, INSET_BELOW, INSET_ABOVE = 1.75, 1.2, 0.62, 0.48, 0.42
BLOCK = INSET_ABOVE + INSET_HEIGHT + INSET_BELOW
TITLE_LINE = 0.22

Box = tuple[float, float, float, float]
"""Left, bottom, width, height."""
Corner = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Texts:
    """Sizes in points of what is neither in the legend nor at the axes."""

    title: float = 11
    inset: float = 7.5
    arrow: float = 8


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
    type, axes, inset_axes, texts : sizes of all text.
    """

    size: Corner
    chart: Box
    title: Sequence[str]
    title_at: Corner
    legend: Sequence[tuple[Corner, Sequence[Entry]]]
    insets: Sequence[Box]
    title_line: float = TITLE_LINE
    type: Type = field(default_factory=Type)
    axes: Dress = field(default_factory=Dress)
    inset_axes: Dress = SMALL
    texts: Texts = field(default_factory=Texts)


def flowing(
    title: Sequence[str], legend: Sequence[Entry], type: Type, insets: int, beside: float, tallest: float
) -> Layout:
    """The layout of a map of a fixed side, with the legend and insets at its right.

    Parameters
    ----------
    beside, tallest : so many inches are left free at the right, and it is at least so tall there.
    """
    below = type.height(legend) + 0.1
    top = max(SIDE + BOTTOM, below + 0.1, BLOCK, tallest)
    places = _places(insets, below, top)
    columns = 1 + max((column for column, _ in places), default=0)
    left = LEFT + SIDE + GAP
    size = (left + columns * COLUMN + MARGIN + beside, top + TITLE_LINE * len(title) + 2 * MARGIN)
    return Layout(
        size=size,
        chart=(LEFT, top - SIDE, SIDE, SIDE),
        title=title,
        title_at=(LEFT, size[1] - MARGIN - TITLE_LINE * 0.5),
        legend=(((left, top), legend),),
        insets=tuple(
            (left + column * COLUMN + INSET_LEFT, top - down - INSET_ABOVE - INSET_HEIGHT, INSET_WIDTH, INSET_HEIGHT)
            for column, down in places
        ),
        type=type,
    )


def _places(number: int, below: float, tall: float) -> list[tuple[int, float]]:
    """Columns and distances from the top for insets: the first ones go below the legend, others to further columns."""
    first = int((tall - below) // BLOCK)
    places = [(0, below + k * BLOCK) for k in range(first)]
    per_column = int(tall // BLOCK)
    places += [(1 + k // per_column, k % per_column * BLOCK) for k in range(max(0, number - first))]
    return places[:number]
