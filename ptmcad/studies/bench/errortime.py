"""The picture of a benchmark: error against seconds on logarithmic axes, one curve for each method.

Guarantee: every measurement that has an error and a time is drawn, none is moved. An error of zero, which a logarithmic
axis does not have, is in a band of its own at the bottom, marked so.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import ceil, floor, log10
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from ptmcad.show.render.legend import INK
from ptmcad.show.render.printing import save, settings
from ptmcad.studies.bench.study import Study
from ptmcad.studies.bench.words import Curve, Spot, curves, sentences
from ptmcad.text.numerals import power_of_ten

WIDE, TALL = 9.2, 6.4
DPI = 110
BAND = 0.3
"""Height of the band of zero error, as a share of what is above it."""
RIM = 0.06
"""The same of the space above the largest error, for its label."""
_STYLES: tuple[tuple[str, str, str, Any], ...] = (
    ("#0b5394", "#0b5394", "o", "-"),
    ("#38761d", "#38761d", "s", "-"),
    ("#741b47", "#741b47", "D", "-"),
    ("#b45f06", "#b45f06", "^", "-"),
    ("#555555", "#555555", "P", "-"),
    ("#8a7d00", "#8a7d00", "X", "-"),
    ("#0b5394", "white", "o", (0, (2, 2))),
)
"""Line, face, mark and dashes."""


def draw(study: Study, path: Path) -> None:
    """Draw a study with at least one measurement to a file whose suffix gives the format."""
    save(draw_error_time(f"{study.slice}: {study.heading}", sentences(study), curves(study)), path, dpi=DPI)


def draw_error_time(title: str, below: Sequence[str], curves: Sequence[Curve]) -> Figure:
    """The picture.

    Parameters
    ----------
    title : of one line.
    below : what is to be read off, in sentences.
    """
    positive = [x for c in curves for s in c.spots for x in s.error if x > 0]
    low, high = floor(log10(min(positive, default=1e-3))), min(0, ceil(log10(max(positive, default=1.0))))
    high = max(high, low + 1)
    left = 0.75 * min(s.seconds.minimum for c in curves for s in c.spots)
    right = 1.6 * max(s.seconds.maximum for c in curves for s in c.spots)
    exact = [k for k, c in enumerate(curves) if any(s.error[1] <= 0 for s in c.spots)]
    band = BAND * (high - low)
    bottom = 10.0 ** (low - band)
    # each method with its own height in the band, so that equal times do not hide one another
    zero = {k: 10.0 ** (low - band * (n + 1) / (len(exact) + 1)) for n, k in enumerate(exact)}
    notes = [line for sentence in below for line in textwrap.wrap(sentence, 145)]
    tall = TALL + 0.2 * len(notes)
    with settings():
        figure = Figure(figsize=(WIDE, tall), facecolor="white")
        figure.set_label(f"{title}\n{_words(curves)} {' '.join(below)}")
        axes = figure.add_axes((0.09, (0.66 + 0.2 * len(notes)) / tall, 0.885, (TALL - 2.2) / tall))
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlim(left, right)
        axes.set_ylim(bottom, 10.0 ** (high + RIM * (high - low)))
        axes.axhspan(bottom, 10.0**low, color="#eef3e6", zorder=0)
        axes.axhline(10.0**low, color=INK, linewidth=0.8, zorder=1)
        above = (1 + RIM) * (high - low)
        axes.text(0.006, (band - 0.04 * (high - low)) / (above + band), "no error (0)", transform=axes.transAxes,
                  ha="left", va="center", fontsize=9, color=INK)  # fmt: skip
        every = max(1, (high - low) // 8)
        axes.set_yticks([10.0**k for k in range(low, high + 1, every)])
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: power_of_ten(round(log10(y)))))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.set_xlabel("seconds of whole processes, start-up included: medians, least and largest")
        axes.set_ylabel("share of the window")
        entries = [_draw(axes, c, zero.get(k, bottom)) for k, c in enumerate(curves)]
        figure.text(0.02, 1 - 0.27 / tall, title, fontsize=12, va="center")
        figure.legend(handles=entries, loc="upper left", bbox_to_anchor=(0.01, 1 - 0.44 / tall), ncol=2, frameon=False,
                      fontsize=9, labelcolor=INK)  # fmt: skip
        for k, line in enumerate(notes):
            figure.text(0.02, (0.2 * (len(notes) - k) - 0.06) / tall, line, fontsize=8.5, va="center")
    return figure


def _draw(axes: Any, curve: Curve, zero: float) -> Line2D:
    colour, face, marker, dash = _STYLES[curve.style]
    x = [s.seconds.median for s in curve.spots]
    y = [_height(s, zero) for s in curve.spots]
    spread = [
        [s.seconds.median - s.seconds.minimum for s in curve.spots],
        [s.seconds.maximum - s.seconds.median for s in curve.spots],
    ]
    axes.errorbar(x, y, xerr=spread, fmt="none", ecolor=colour, elinewidth=0.8, capsize=2, zorder=2)
    axes.plot(x, y, color=colour, linestyle=dash, linewidth=1.3, zorder=3)
    axes.plot(x, y, color=colour, marker=marker, markerfacecolor=face, linestyle="none", markersize=6, zorder=4)
    for s, at in zip(curve.spots, y, strict=True):
        if s.label:
            axes.annotate(s.label, (s.seconds.median, at), xytext=(5, 5), textcoords="offset points", fontsize=7.5,
                          color=colour, zorder=5)  # fmt: skip
    return Line2D([], [], color=colour, marker=marker, markerfacecolor=face, linestyle=dash, label=curve.name)


def _height(spot: Spot, zero: float) -> float:
    low, high = spot.error
    return (low + high) / 2 if high > 0 else zero


def _words(curves: Sequence[Curve]) -> str:
    """The description for who does not see the picture."""
    parts = []
    for c in curves:
        points = ", ".join(f"{s.seconds.median:.3g} s: {(s.error[0] + s.error[1]) / 2:.3g}" for s in c.spots)
        parts.append(f"{c.name}: {points}.")
    return " ".join(parts)
