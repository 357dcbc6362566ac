"""The picture of measurements: curves on logarithmic axes.

Guarantee: every point that has an abscissa and an ordinate is drawn, none is moved. Below its least
decade the axis is linear, so that it has a zero.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import floor, log10
from typing import Any, NamedTuple

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from ptmcad.show.render.legend import INK
from ptmcad.show.render.printing import settings
from ptmcad.text.numerals import power_of_ten

WIDE, TALL = 9.2, 6.4
DPI = 110
_STYLES: tuple[tuple[str, str, str, Any], ...] = (
    ("#0b5394", "#0b5394", "o", "-"),
    ("#38761d", "#38761d", "s", "-"),
    ("#741b47", "#741b47", "D", "-"),
    ("#b45f06", "#b45f06", "^", "-"),
    ("#555555", "#555555", "P", "-"),
    ("#8a7d00", "#8a7d00", "X", "-"),
    ("#009e73", "#009e73", "v", "-"),
    ("#c00000", "#c00000", "*", "-"),
    ("#0b5394", "white", "o", (0, (2, 2))),
)
"""Line, face, mark and dashes."""


class Spot(NamedTuple):
    """A point: median, least and largest abscissa, bounds of the ordinate, a label, which may be empty."""

    x: tuple[float, float, float]
    y: tuple[float, float]
    label: str = ""


class Curve(NamedTuple):
    """Points in order, and the number of their style."""

    name: str
    spots: Sequence[Spot]
    style: int


def draw(title: str, x: str, y: str, curves: Sequence[Curve], below: Sequence[str] = ()) -> Figure:
    """The picture of at least one curve, with a title of one line, what the axes show, and sentences below."""
    spots = [spot for curve in curves for spot in curve.spots]
    heights = [height for spot in spots for height in spot.y]
    least = 10.0 ** floor(log10(min((h for h in heights if h > 0), default=1e-3)))
    notes = [line for sentence in below for line in textwrap.wrap(sentence, 145)]
    tall = TALL + 0.2 * len(notes)
    with settings():
        figure = Figure(figsize=(WIDE, tall), facecolor="white")
        figure.set_label(f"{title}\n{_words(curves)} {' '.join(below)}")
        axes = figure.add_axes((0.09, (0.66 + 0.2 * len(notes)) / tall, 0.885, (TALL - 2.2) / tall))
        axes.set_xscale("log")
        axes.set_yscale("symlog", linthresh=least, linscale=0.5)
        axes.set_xlim(0.75 * min(s.x[1] for s in spots), 1.6 * max(s.x[2] for s in spots))
        axes.set_ylim(-0.4 * least if min(heights) <= 0 else least, 4 * max(least, *heights))
        axes.axhspan(-least, least, color="#eef3e6", zorder=0)
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: power_of_ten(round(log10(y))) if y > 0 else "0"))
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.set_xlabel(x)
        axes.set_ylabel(y)
        entries = [_draw(axes, c) for c in curves]
        figure.text(0.02, 1 - 0.27 / tall, title, fontsize=12, va="center")
        figure.legend(handles=entries, loc="upper left", bbox_to_anchor=(0.01, 1 - 0.44 / tall), ncol=2,
                      frameon=False, fontsize=9, labelcolor=INK)  # fmt: skip
        for k, line in enumerate(notes):
            figure.text(0.02, (0.2 * (len(notes) - k) - 0.06) / tall, line, fontsize=8.5, va="center")
    return figure


def _draw(axes: Any, curve: Curve) -> Line2D:
    colour, face, marker, dash = _STYLES[curve.style % len(_STYLES)]
    x = [s.x[0] for s in curve.spots]
    y = [sum(s.y) / 2 for s in curve.spots]
    spread = [[s.x[0] - s.x[1] for s in curve.spots], [s.x[2] - s.x[0] for s in curve.spots]]
    axes.errorbar(x, y, xerr=spread, fmt="none", ecolor=colour, elinewidth=0.8, capsize=2, zorder=2)
    axes.plot(x, y, color=colour, linestyle=dash, linewidth=1.3, zorder=3)
    axes.plot(x, y, color=colour, marker=marker, markerfacecolor=face, linestyle="none", markersize=6, zorder=4)
    for s, *at in zip(curve.spots, x, y, strict=True):
        if s.label:
            axes.annotate(s.label, at, xytext=(5, 5), textcoords="offset points", fontsize=7.5, color=colour,
                          zorder=5)  # fmt: skip
    return Line2D([], [], color=colour, marker=marker, markerfacecolor=face, linestyle=dash, label=curve.name)


def _words(curves: Sequence[Curve]) -> str:
    """The description for who does not see the picture."""
    parts = []
    for curve in curves:
        points = ", ".join(f"{s.x[0]:.3g}: {sum(s.y) / 2:.3g}" for s in curve.spots)
        parts.append(f"{curve.name}: {points}.")
    return " ".join(parts)
