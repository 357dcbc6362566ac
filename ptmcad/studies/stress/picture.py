"""The plot of a stress campaign: the error of double precision against what is extreme, family by family.

Guarantee: every point that has an error is drawn; where the count of double precision is wrong it is drawn as such,
also where no error exists.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import log10

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ptmcad.show.render.printing import settings
from ptmcad.studies.stress.judgement import Row
from ptmcad.text.numerals import magnitude

MIN_DRAWN_ERROR = 1e-20
"""Errors below are drawn here: enclosures of 12 digits have middles about 1e-19 off."""
NOTE = "Of poses in radians, of lines relative to the window. At 1e-20: none or less; at the top: no pose found."
COLUMNS = 4
TITLE = "Error of double precision against what is extreme"
MARKS = (
    ("double precision, count right", "double_error", True, "o", "#385880"),
    ("double precision, count wrong", "double_error", False, "X", "#c1440e"),
    ("ptmcad, middle of the enclosure", "error", None, "_", "#45917d"),
)
"""What is drawn: label, number, of which rows by whether the double's count is right, mark and colour."""


def draw_stress(outcomes: Sequence[Row]) -> Figure:
    """One small plot for each family of points; the figure's label is its description."""
    points = [o for o in outcomes if o["condition"] is not None or o["error"] is not None]
    families = list(dict.fromkeys(o["family"] for o in points))
    rows = max(1, -(-len(families) // COLUMNS))
    double, ours = (sum(not o[key] for o in points) for key in ("double_right", "right"))
    with settings():
        figure = Figure(figsize=(12, 2.6 * rows + 1.1), layout="constrained")
        figure.set_label(
            f"{TITLE}\n{len(points)} cases; the count of double precision is wrong in {double}, ptmcad's in {ours}."
        )
        figure.suptitle(TITLE, fontsize=13)
        for k, family in enumerate(families):
            axes = figure.add_subplot(rows, COLUMNS, k + 1)
            axes.set_title(family, fontsize=10)
            axes.set_ylabel("" if k % COLUMNS else "error", fontsize=8)
            _family(axes, [o for o in points if o["family"] == family])
        if families:
            figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False,
                          fontsize=9, title=NOTE, title_fontsize=9)  # fmt: skip
        return figure


def _family(axes: Axes, outcomes: Sequence[Row]) -> None:
    for label, key, right, marker, color in MARKS:
        drawn = [o for o in outcomes if right in (None, o["double_right"])]
        # no pose at all is as bad as can be
        heights = [10.0 if o[key] is None else max(o[key], MIN_DRAWN_ERROR) for o in drawn]
        places = [exponent(Fraction(o["stiffness"])) for o in drawn]
        axes.semilogy(places, heights, linestyle="none", markersize=6.5, label=label, marker=marker, color=color)
    axes.set_ylim(MIN_DRAWN_ERROR / 10, 30)
    axes.set_yticks([1e-20, 1e-15, 1e-10, 1e-5, 1], ["1e-20", "1e-15", "1e-10", "1e-5", "1"])
    axes.minorticks_off()
    axes.margins(x=0.15)
    axes.tick_params(labelsize=8)
    axes.xaxis.set_major_formatter(lambda value, _: f"1e{value:g}")
    axes.locator_params(axis="x", nbins=4, integer=True)
    axes.grid(True, color="#dddddd", linewidth=0.5)


def exponent(value: Fraction) -> float:
    """The logarithm to base 10 of a positive number, beyond a float's range too."""
    whole = magnitude(value)
    return whole + log10(float(value / Fraction(10) ** whole))
