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
RIGHT, WRONG, OURS = "#385880", "#c1440e", "#45917d"


def draw_stress(outcomes: Sequence[Row]) -> Figure:
    """One small plot for each family of points; the figure's label is its description."""
    points = [o for o in outcomes if o["condition"] is not None or o["error"] is not None]
    families = list(dict.fromkeys(o["family"] for o in points))
    rows = max(1, -(-len(families) // COLUMNS))
    with settings():
        figure = Figure(figsize=(12, 2.6 * rows + 1.1), layout="constrained")
        wrong = sum(not o["double_right"] for o in points)
        title = "Error of double precision against what is extreme"
        ours = sum(not o["right"] for o in points)
        summary = f"{len(points)} cases; the count of double precision is wrong in {wrong}, ptmcad's in {ours}."
        figure.set_label(f"{title}\n{summary}")
        figure.suptitle(title, fontsize=13)
        axes = [figure.add_subplot(rows, COLUMNS, k + 1) for k in range(len(families))]
        for k, (family, place) in enumerate(zip(families, axes, strict=True)):
            _family(place, family, [o for o in points if o["family"] == family])
            if k % COLUMNS == 0:
                place.set_ylabel("error", fontsize=8)
        if axes:
            figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False,
                          fontsize=9, title=NOTE, title_fontsize=9)  # fmt: skip
        return figure


def _family(axes: Axes, family: str, outcomes: Sequence[Row]) -> None:
    right, wrong = ([o for o in outcomes if o["double_right"] is good] for good in (True, False))
    for chosen, error, label, style in (
        (right, "double_error", "double precision, count right", {"marker": "o", "color": RIGHT}),
        (wrong, "double_error", "double precision, count wrong", {"marker": "X", "color": WRONG}),
        (outcomes, "error", "ptmcad, middle of the enclosure", {"marker": "_", "color": OURS}),
    ):
        heights = [_drawn(o[error]) for o in chosen]
        axes.semilogy([exponent(Fraction(o["stiffness"])) for o in chosen], heights, linestyle="none", markersize=6.5,
                      label=label, **style)  # fmt: skip
    axes.set_ylim(MIN_DRAWN_ERROR / 10, 30)
    axes.set_yticks([1e-20, 1e-15, 1e-10, 1e-5, 1], ["1e-20", "1e-15", "1e-10", "1e-5", "1"])
    axes.minorticks_off()
    axes.margins(x=0.15)
    axes.set_title(family, fontsize=10)
    axes.tick_params(labelsize=8)
    axes.xaxis.set_major_formatter(lambda value, _: f"1e{value:g}")
    axes.locator_params(axis="x", nbins=4, integer=True)
    axes.grid(True, color="#dddddd", linewidth=0.5)


def exponent(value: Fraction) -> float:
    """The logarithm to base 10 of a positive number, beyond a float's range too."""
    whole = magnitude(value)
    return whole + log10(float(value / Fraction(10) ** whole))


def _drawn(error: float | None) -> float:
    """An error's height: no pose at all is as bad as can be."""
    return 10.0 if error is None else max(error, MIN_DRAWN_ERROR)
