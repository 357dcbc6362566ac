"""What the pictures of ranges, paths and branches have in common: sizes, a heading, axes in inches and their names."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from matplotlib.figure import Figure

from ptmcad.question.slice import Axis, Slice
from ptmcad.show.render.axes import scale_of, symbol
from ptmcad.show.render.textwidth import wrapped
from ptmcad.show.units import unit, with_unit
from ptmcad.text.numerals import shortest_text

WIDE, LEFT, RIGHT, LINE, MARGIN = 6.2, 0.85, 0.3, 0.22, 0.15
"""In inches: the axes, the space at their sides, a line of the title, the rim."""
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
"""Of solutions of one kind that are told from each other; no other kind has one of these colours."""


def beside(heading: str, key: float, tall: float, words: str) -> Figure:
    """A figure for axes with a legend of this width beside them, under a heading in at most three lines."""
    wide = LEFT + WIDE + RIGHT + key + RIGHT
    return figure_of(wrapped(heading, wide - LEFT - MARGIN, TITLE)[:3], (wide, tall), words)


def figure_of(title: Sequence[str], size: tuple[float, float], words: str) -> Figure:
    """A figure under a title of these lines, its size in inches that of what is below it."""
    tall = size[1] + LINE * len(title) + 2 * MARGIN
    figure = Figure(figsize=(size[0], tall), facecolor="white")
    figure.set_label(f"{' '.join(title)}\n{words}")
    for k, line in enumerate(title):
        figure.text(LEFT, tall - MARGIN - LINE * (k + 0.5), line, transform=figure.dpi_scale_trans, fontsize=TITLE,
                    va="center")  # fmt: skip
    return figure


def axes_in(figure: Figure, box: tuple[float, float, float, float]) -> Any:
    """Axes in a box of inches: left, bottom, width, height."""
    wide, tall = figure.get_size_inches()
    return figure.add_axes((box[0] / wide, (box[1] + MARGIN) / tall, box[2] / wide, box[3] / tall))


def scaled(value: Fraction, axis: Axis) -> float:
    """Where a value stands on an axis whose numbers are scaled as `scale_of` says."""
    scale = scale_of(axis.low, axis.high)
    return float((value - scale.offset) / Fraction(10) ** scale.exponent)


def axis_name(slice: Slice, axis: Axis) -> str:
    """The name beside an axis, with its scale and unit."""
    name = scale_of(axis.low, axis.high).name(symbol(axis.name))
    return with_unit(name, unit(slice, slice.axis_names.index(axis.name)))


def short(value: Fraction) -> str:
    """A fixed value in a heading."""
    text = shortest_text(value)
    return text if len(text) <= 14 else f"{float(value):.8g}"
