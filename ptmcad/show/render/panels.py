"""A page of panels one below the other over one axis, in inches: a title above, a legend at their
right, and notes below.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from matplotlib.figure import Figure

from ptmcad.answer.intervals import AnyEnd
from ptmcad.question.slice import Axis, Slice
from ptmcad.show.render.axes import heading_of, scale_of, symbol
from ptmcad.show.render.inches import TITLE_LINE, titled, wrapped, write_lines
from ptmcad.show.render.legend import Entry, Type, draw_legend
from ptmcad.show.units import unit, with_unit
from ptmcad.text.numerals import Numbers, shortest_text

WIDE, LEFT, RIGHT, MARGIN = 6.2, 0.85, 0.3, 0.15
"""In inches: a panel, the space at its sides, the rim."""
GAP, FOOT, LINE = 0.25, 0.55, 0.2
"""Between two panels, for the numbers and the name of the axis, of a line of the notes."""
SIZE, TITLE, MAX_TITLE_LINES = 8.0, 11.0, 3
"""In points: text, and a title's; and how many lines this has at most."""


def panels(
    title: str,
    words: str,
    over: Axis,
    unit: str,
    heights: Sequence[float],
    gap: float = GAP,
    legend: Sequence[Entry] = (),
    notes: Sequence[str] = (),
) -> tuple[Figure, list[Any]]:
    """The page, and the panels' axes; to be called within `ptmcad.show.render.printing.settings`.

    Parameters
    ----------
    words : the description, for who cannot see the picture.
    unit : of the axis.
    heights, gap : of the panels and between them, in inches.
    """
    wide = LEFT + WIDE + RIGHT + (Type().width(legend) + RIGHT if legend else 0.0)
    head = wrapped(title, wide - LEFT - MARGIN, TITLE)[:MAX_TITLE_LINES]
    foot = [line for note in notes for line in wrapped(note, wide - LEFT - MARGIN, SIZE)]
    charts = sum(heights) + gap * (len(heights) - 1)
    top = MARGIN + max(charts + FOOT + LINE * len(foot), Type().height(legend) + 0.2)
    size = wide, top + TITLE_LINE * len(head) + MARGIN
    figure = titled(head, words, size, LEFT, MARGIN)
    column: list[Any] = figure.subplots(
        len(heights), sharex=True, squeeze=False, height_ratios=heights,
        gridspec_kw={
            "left": LEFT / wide, "right": (LEFT + WIDE) / wide,
            "bottom": (top - charts) / size[1], "top": top / size[1],
            "hspace": gap * len(heights) / sum(heights),
        },
    )[:, 0].tolist()  # fmt: skip
    for axes in column:
        axes.margins(y=0.08)
        axes.tick_params(labelsize=SIZE)
    scaled_axis(column[-1].xaxis, over, unit)
    draw_legend(figure, legend, LEFT + WIDE + RIGHT, top - 0.05)
    write_lines(figure, (LEFT, top - charts - FOOT), foot, SIZE, LINE)
    return figure, column


def scaled_axis(shown: Any, axis: Axis, unit: str) -> None:
    """Limits and the name of one of matplotlib's axes, with scale and unit."""
    scale = scale_of(axis.low, axis.high)
    shown.axes.set(**{f"{shown.axis_name}lim": (scale.low, scale.high)})
    shown.set_label_text(with_unit(scale.name(symbol(axis.name)), unit), fontsize=SIZE + 2)
    shown.labelpad = 2


def scaled(value: AnyEnd, axis: Axis) -> float:
    """Where a number, or one near an end, stands on an axis with the numbers of `scale_of`."""
    scale = scale_of(axis.low, axis.high)
    known = value if isinstance(value, Fraction) else (value.low + value.high) / 2
    return float((known - scale.offset) / Fraction(10) ** scale.exponent)


def heading(slice: Slice, at: Numbers) -> str:
    """Of what is shown along a line of a slice."""
    return f"{heading_of(slice)}; {', '.join(f'{symbol(name)} = {short(value)}' for name, value in at.items())}"


def unit_along(slice: Slice, axis: Axis) -> str:
    """The unit of one of a slice's axes."""
    return unit(slice, slice.axis_names.index(axis.name))


def short(value: Fraction) -> str:
    """A fixed value in a heading."""
    text = shortest_text(value)
    return text if len(text) <= 14 else f"{float(value):.8g}"
