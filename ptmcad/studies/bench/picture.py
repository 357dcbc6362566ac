"""The picture of measurements: curves on logarithmic axes.

Guarantee: every point that has an abscissa and an ordinate is drawn, none is moved. Below its least decade the axis is
linear, so that it has a zero.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import floor, log10
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from ptmcad.show.render.legend import INK
from ptmcad.show.render.printing import settings
from ptmcad.text.numerals import power_of_ten

WIDE, TALL = 9.2, 6.4
DPI = 110
STYLES: tuple[dict[str, Any], ...] = (
    {"color": "#0b5394", "marker": "o"},
    {"color": "#38761d", "marker": "s"},
    {"color": "#741b47", "marker": "D"},
    {"color": "#b45f06", "marker": "^"},
    {"color": "#555555", "marker": "P"},
    {"color": "#8a7d00", "marker": "X"},
    {"color": "#009e73", "marker": "v"},
    {"color": "#c00000", "marker": "*"},
    {"color": "#0b5394", "marker": "o", "markerfacecolor": "white", "linestyle": (0, (2, 2))},
)


def draw(title: str, x: str, y: str, points: pd.DataFrame, below: Sequence[str] = ()) -> Figure:
    """The picture of at least one point, with a title of one line, what the axes show, and sentences below.

    Parameters
    ----------
    points : in the order in which they are joined: ``curve``, its name, and ``style``, a number; ``x``, ``least`` and
        ``most``, the abscissa; ``low`` and ``high``, bounds of the ordinate; ``label``, which may be empty.
    """
    heights = points[["low", "high"]].to_numpy()
    least = 10.0 ** floor(log10(min(heights[heights > 0], default=1e-3)))
    notes = [line for sentence in below for line in textwrap.wrap(sentence, 145)]
    tall = TALL + 0.2 * len(notes)
    words = []
    with settings():
        figure = Figure(figsize=(WIDE, tall), facecolor="white")
        axes = figure.add_axes((0.09, (0.66 + 0.2 * len(notes)) / tall, 0.885, (TALL - 2.2) / tall))
        axes.set_xscale("log")
        axes.set_yscale("symlog", linthresh=least, linscale=0.5)
        axes.set_xlim(0.75 * points["least"].min(), 1.6 * points["most"].max())
        axes.set_ylim(-0.4 * least if heights.min() <= 0 else least, 4 * max(least, heights.max()))
        axes.axhspan(-least, least, color="#eef3e6", zorder=0)
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: power_of_ten(round(log10(y))) if y > 0 else "0"))
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.set_xlabel(x)
        axes.set_ylabel(y)
        for name, curve in points.groupby("curve", sort=False):
            at, middle = curve["x"], (curve["low"] + curve["high"]) / 2
            style = STYLES[curve["style"].iloc[0] % len(STYLES)]
            axes.errorbar(at, middle, xerr=[at - curve["least"], curve["most"] - at], fmt="none",
                          ecolor=style["color"], elinewidth=0.8, capsize=2, zorder=2)  # fmt: skip
            axes.plot(at, middle, label=name, linewidth=1.3, markersize=6, zorder=4, **style)
            for place, label in zip(zip(at, middle, strict=True), curve["label"], strict=True):
                axes.annotate(label, place, xytext=(5, 5), textcoords="offset points", fontsize=7.5,
                              color=style["color"], zorder=5)  # fmt: skip
            pairs = ", ".join(f"{u:.3g}: {v:.3g}" for u, v in zip(at, middle, strict=True))
            words.append(f"{name}: {pairs}.")
        figure.set_label(f"{title}\n{' '.join(words)} {' '.join(below)}")
        figure.text(0.02, 1 - 0.27 / tall, title, fontsize=12, va="center")
        figure.legend(loc="upper left", bbox_to_anchor=(0.01, 1 - 0.44 / tall), ncol=2,
                      frameon=False, fontsize=9, labelcolor=INK)  # fmt: skip
        for k, line in enumerate(notes):
            figure.text(0.02, (0.2 * (len(notes) - k) - 0.06) / tall, line, fontsize=8.5, va="center")
    return figure
