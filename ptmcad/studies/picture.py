"""The picture of measurements: panels of curves or loose marks on logarithmic axes.

Guarantee: every mark is drawn, none is moved. Below its least decade the ordinate is linear, so
that it has a zero; it is the same in all panels.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from math import ceil, floor, log10
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from ptmcad.show.render.colours import INK
from ptmcad.show.render.printing import settings
from ptmcad.text.numerals import power_of_ten

DPI = 110
COLUMNS = 4
BESIDE = 1.6
"""Factor of what is beside the marks, so that one of 1, 2 and 5 is seen at least."""
LETTERS = 15
"""In an inch of what stands below."""
COLORS = ("#0b5394", "#38761d", "#741b47", "#b45f06", "#555555", "#8a7d00", "#009e73", "#c00000")
STYLES: tuple[dict[str, Any], ...] = (
    *({"color": color, "marker": marker} for color, marker in zip(COLORS, "osD^PXv*", strict=True)),
    {"color": COLORS[0], "marker": "o", "markerfacecolor": "white", "linestyle": (0, (2, 2))},
)
"""Of curves that are joined."""
WIDE = 1e4
"""Factor between the ends of a single panel from which on not every decade has marks."""


Mark = tuple[float, float, float, float, str]
"""A place, the spread of its abscissa, and what is written beside it."""


class Curve(NamedTuple):
    """Marks in the order in which they are joined, and how matplotlib draws them."""

    name: str
    style: Mapping[str, Any]
    marks: Sequence[Mark]


def draw(
    title: str, x: str, y: str, panels: Mapping[str, Sequence[Curve]], below: Sequence[str] = ()
) -> Figure:
    """The picture of panels by their titles, with what the axes show and sentences below; each has
    a mark at least.

    The figure's label is its description.
    """
    curves = [curve for panel in panels.values() for curve in panel]
    heights = [y for curve in curves for _, y, *_ in curve.marks]
    least = 10.0 ** floor(log10(min((y for y in heights if y > 0), default=1e-3)))
    columns = min(len(panels), COLUMNS) or 1
    rows = ceil(len(panels) / columns)
    width = 9.2 if columns == 1 else 3.0 * columns
    notes = [line for sentence in below for line in textwrap.wrap(sentence, int(LETTERS * width))]
    words = [
        f"{c.name}: {', '.join(f'{x:.3g}: {y:.3g}' for x, y, *_ in c.marks)}."
        for c in curves
        if c.marks
    ]
    with settings():
        figure = Figure((width, 6.4 if columns == 1 else 2.6 * rows + 1.5), layout="constrained")
        figure.set_label(f"{title}\n{' '.join([*words, *below])}")
        figure.suptitle(title, fontsize=12)
        for number, (name, panel) in enumerate(panels.items()):
            axes = figure.add_subplot(rows, columns, number + 1)
            for curve in panel:
                _curve(axes, curve)
            axes.set_title(name, fontsize=10)
            axes.set(xscale="log", xlabel=x, ylabel="" if number % columns else y)
            axes.set_yscale("symlog", linthresh=least, linscale=0.5)
            axes.set_ylim(
                -0.4 * least if min(heights) <= 0 else least / 2, 4 * max(least, *heights)
            )
            axes.axhspan(-least, least, color="#eef3e6", zorder=0)
            low, high = axes.get_xlim()
            axes.set_xlim(low / BESIDE, high * BESIDE)
            axes.yaxis.get_major_locator().set_params(numticks=8)  # type: ignore[call-arg]
            axes.yaxis.set_major_formatter(_decade)
            axes.xaxis.set_major_locator(
                LogLocator(numticks=4)
                if columns > 1 or high > WIDE * low
                else LogLocator(subs=(1.0, 2.0, 5.0))
            )
            axes.xaxis.set_major_formatter("{x:g}")
            axes.xaxis.set_minor_locator(NullLocator())
            axes.grid(color="#dddddd", linewidth=0.6)
            axes.set_axisbelow(True)
        shown = figure.axes[0].get_legend_handles_labels() if panels else ([], [])
        figure.legend(*shown, loc="outside lower center", ncols=3 if rows > 1 else 2, frameon=False, fontsize=9,
                      labelcolor=INK, title="\n".join(notes), title_fontsize=8.5)  # fmt: skip
    return figure


def _decade(y: float, _place: object) -> str:
    return power_of_ten(round(log10(y))) if y > 0 else "0"


def _curve(axes: Axes, curve: Curve) -> None:
    color = curve.style["color"]
    x, y, least, most, labels = zip(*curve.marks, strict=True) if curve.marks else ((),) * 5
    axes.plot(x, y, label=curve.name, linewidth=1.3, markersize=6, zorder=4, **curve.style)
    axes.hlines(y, least, most, color=color, linewidth=0.8, zorder=2)
    for label, place in zip(labels, zip(x, y, strict=True), strict=True):
        axes.annotate(
            label,
            place,
            xytext=(5, 5),
            textcoords="offset points",
            fontsize=7.5,
            color=color,
            zorder=5,
        )
