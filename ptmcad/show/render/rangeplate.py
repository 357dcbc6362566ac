"""What the pictures of ranges, paths and branches have in common: sizes, a heading, axes in inches
and their names.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from matplotlib.figure import Figure

from ptmcad.answer.intervals import End
from ptmcad.answer.paths import Branches, PosePaths
from ptmcad.question.slice import Axis, Slice
from ptmcad.show.render.axes import heading_of, scale_of, symbol
from ptmcad.show.render.inches import TITLE_LINE, Box, axes_at, titled, wrapped
from ptmcad.show.render.legend import Entry, Type, draw_legend
from ptmcad.show.style import Size
from ptmcad.show.units import unit, with_unit
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import Numbers, shortest_text

WIDE, LEFT, RIGHT, MARGIN = 6.2, 0.85, 0.3, 0.15
"""In inches: the axes, the space at their sides, the rim."""
PANEL, GAP, FOOT = 2.0, 0.25, 0.55
"""Of a panel of several, the space between two, and that below the last."""
SIZE = 8.0
TITLE = 11.0
"""In points: text, and a title's."""
LOOKS: dict[str, dict[str, Any]] = {
    "stable": {"color": "#0b5394", "linewidth": 2.0, "linestyle": "-"},
    "saddle": {"color": "#b45f06", "linewidth": 1.2, "linestyle": (0, (5, 2))},
    "unstable": {"color": "#b45f06", "linewidth": 1.2, "linestyle": (0, (5, 2))},
    "maximum": {"color": "#666666", "linewidth": 1.2, "linestyle": (0, (1, 1.5))},
}
"""Lines of solutions, by what these are called: stable ones are solid, and no others are."""
EACH = ("#0b5394", "#2a9d8f", "#741b47", "#7d9be0", "#274e13", "#c27ba0")
"""Of solutions of one kind that are distinguished from each other; no other kind has one of these colours.
"""


def beside(heading: str, key: float, tall: float, words: str) -> Figure:
    """A figure for axes with a legend of this width beside them, under a heading in at most three
    lines.
    """
    wide = LEFT + WIDE + RIGHT + key + RIGHT
    return figure_of(wrapped(heading, wide - LEFT - MARGIN, TITLE)[:3], (wide, tall), words)


def figure_of(title: Sequence[str], size: Size, words: str) -> Figure:
    """A figure under a title of these lines, its size in inches that of what is below it."""
    tall = size[1] + TITLE_LINE * len(title) + 2 * MARGIN
    figure: Figure = titled(title, words, (size[0], tall), LEFT, MARGIN)
    return figure


def heading(slice: Slice, at: Numbers) -> str:
    """Of what is shown along a line of a slice."""
    return f"{heading_of(slice)}; {', '.join(f'{symbol(name)} = {short(value)}' for name, value in at.items())}"


def panelled(
    slice: Slice,
    found: PosePaths | Branches,
    names: Sequence[str],
    entries: Sequence[Entry],
    words: str,
) -> tuple[Figure, list[Any]]:
    """A figure with a legend beside panels one below the other, for what has these names; and the
    panels' axes.
    """
    last = len(names) - 1
    tall = max((last + 1) * PANEL + last * GAP + FOOT, Type().height(entries) + 0.2)
    figure = beside(heading(slice, found.at), Type().width(entries), tall, words)
    panels = []
    for number, name in enumerate(names):
        axes = axes_in(figure, (LEFT, tall - (number + 1) * PANEL - number * GAP, WIDE, PANEL))
        axes.margins(y=0.08)
        axes.tick_params(labelsize=SIZE, labelbottom=number == last)
        axes.set_ylabel(name, fontsize=SIZE + 2)
        known = unit_along(slice, found.along) if number == last else None
        scaled_axis(axes.xaxis, found.along, known, 2)
        panels.append(axes)
    draw_legend(figure, entries, LEFT + WIDE + RIGHT, tall - 0.05)
    return figure, panels


def axes_in(figure: Figure, box: Box) -> Any:
    """Axes in a box, above the rim."""
    return axes_at(figure, (box[0], box[1] + MARGIN, box[2], box[3]))


def scaled(value: Fraction, axis: Axis) -> float:
    """Where a value stands on an axis whose numbers are scaled as `scale_of` says."""
    scale = scale_of(axis.low, axis.high)
    return float((value - scale.offset) / Fraction(10) ** scale.exponent)


def middle_of(end: End | Enclosure) -> Fraction:
    """A number on or near an end."""
    return end if isinstance(end, Fraction) else (end.low + end.high) / 2


def scaled_axis(shown: Any, axis: Axis, unit: str | None, pad: float = 4) -> None:
    """Limits of one of matplotlib's axes and, unless the unit is None, its name with scale and unit."""
    scale = scale_of(axis.low, axis.high)
    shown.axes.set(**{f"{shown.axis_name}lim": (scale.low, scale.high)})
    if unit is not None:
        shown.set_label_text(with_unit(scale.name(symbol(axis.name)), unit), fontsize=SIZE + 2)
        shown.labelpad = pad


def unit_along(slice: Slice, axis: Axis) -> str:
    """The unit of one of a slice's axes."""
    return unit(slice, slice.axis_names.index(axis.name))


def short(value: Fraction) -> str:
    """A fixed value in a heading."""
    text = shortest_text(value)
    return text if len(text) <= 14 else f"{float(value):.8g}"
