"""Pictures of how cost grows: processor time, in all and by stage, and memory, in logarithms, with the fitted law.

Guarantee: every run is a dot, lines join medians, and the law is drawn over the range that it was fitted to and no
further; where none fits, none is drawn. Stages differ by marker and dash as well as by colour.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import log10
from statistics import median
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ptmcad.show.render.legend import INK
from ptmcad.show.render.printing import settings
from ptmcad.studies.bench.scaling.table import grouped, stages_of

SIZE = 9.5
_STYLES: tuple[tuple[str, str, Any], ...] = (
    ("#0072b2", "s", "-"),
    ("#d55e00", "^", (0, (5, 2))),
    ("#cc79a7", "v", (0, (1, 1.5))),
    ("#009e73", "D", (0, (6, 2, 1, 2))),
    ("#b8860b", "P", "-"),
    ("#56b4e9", "X", (0, (3, 1))),
)
_LAWS = ("power law", "fixed cost and power law", "does not grow")
_MIN_SECONDS = 2e-4
"""Seconds: stages that never take longer are not drawn."""
_MIN_PEAK = 2.0
"""MiB: memory that never grows by more is not drawn."""
_CURVE = 60

Groups = dict[float, list[Any]]


def draw_scaling(family: Mapping[str, Any]) -> Figure:
    """One family of a scaling report: time at the left, memory at the right where it was measured.

    Parameters
    ----------
    family : an item of the report's ``families``, see `ptmcad.studies.bench.scaling`.

    Raises
    ------
    ValueError
        When there are no runs.
    """
    runs = family["runs"]
    if not runs:
        raise ValueError(f"the family {family['name']} has no runs to draw")
    groups = grouped(family)
    memory = any(max(run["memory"].values(), default=0.0) >= _MIN_PEAK for run in runs)
    with settings():
        staged = len(stages_of(runs)) > 1  # then the legend needs a column of its own
        widths = (0.8, 3.7, 2.1 if staged else 1.0, 2.7 if memory else -0.15)
        wide = sum(widths) + 0.25
        figure = Figure(figsize=(wide, 4.1))
        figure.set_label(f"{family['title']}\n{_words(family)}")
        figure.text(0.02, 0.97, family["title"], fontsize=SIZE + 2.5, weight="bold", va="top", color=INK)
        _time(figure.add_axes((widths[0] / wide, 0.14, widths[1] / wide, 0.74)), groups, family)
        if memory:
            place = (sum(widths[:3]) / wide, 0.14, widths[3] / wide, 0.74)
            _memory(figure.add_axes(place), groups, family["fits"].get("memory"))
        for axes in figure.axes:
            _finish(axes, family["axis"], sorted(groups))
    return figure


def _time(axes: Axes, groups: Groups, family: Mapping[str, Any]) -> None:
    places = sorted(groups)
    stages = stages_of(family["runs"])
    drawn = [s for s in stages if len(stages) > 1 and any(r["stages"].get(s, 0) > _MIN_SECONDS for r in family["runs"])]
    for stage, (colour, marker, dash) in zip(drawn, _STYLES, strict=False):
        heights = [max(median(run["stages"].get(stage, 0.0) for run in groups[x]), 1e-5) for x in places]
        axes.plot(
            places, heights, color=colour, marker=marker, markersize=4, linestyle=dash, linewidth=1.1, label=stage
        )
    dots = [(x, run["seconds"]) for x in places for run in groups[x]]
    axes.plot(*zip(*dots, strict=True), color=INK, marker="o", markersize=3.2, linestyle="", alpha=0.45)
    axes.plot(places, [median(run["seconds"] for run in groups[x]) for x in places], color=INK, linewidth=1.6,
              marker="o", markersize=4.5, label="in all")  # fmt: skip
    _law(axes, family["fits"].get("seconds"), "s")
    axes.set_ylabel("processor time, s", fontsize=SIZE + 1, color=INK)
    handles, labels = axes.get_legend_handles_labels()
    place: dict[str, Any] = {"bbox_to_anchor": (1.01, 1.0)} if drawn else {}
    axes.legend(handles[::-1], labels[::-1], loc="upper left", fontsize=SIZE, frameon=False, handlelength=2.6, **place)


def _memory(axes: Axes, groups: Groups, fit: Mapping[str, Any] | None) -> None:
    places = sorted(groups)
    peaks = {x: [max(run["memory"].values()) for run in groups[x] if run["memory"]] for x in places}
    dots = [(x, y) for x in places for y in peaks[x] if y > 0]
    axes.plot(*zip(*dots, strict=True), color=INK, marker="o", markersize=3.2, linestyle="", alpha=0.45)
    joined = [(x, median(peaks[x])) for x in places if peaks[x] and median(peaks[x]) > 0]
    axes.plot(*zip(*joined, strict=True), color=INK, linewidth=1.6, marker="o", markersize=4.5, label="peak")
    _law(axes, fit, "MiB")
    axes.set_ylabel("memory beyond the start, MiB", fontsize=SIZE + 1, color=INK)
    axes.legend(loc="upper left", fontsize=SIZE, frameon=False)


def _law(axes: Axes, fit: Mapping[str, Any] | None, unit: str) -> None:
    """The fitted law, dashed, through the median it passes nearest to by construction: its own factor."""
    if fit is None or fit["verdict"] not in _LAWS or fit["verdict"] == "does not grow":
        return
    xs = [10 ** (log10(fit["first"]) + k / _CURVE * log10(fit["last"] / fit["first"])) for k in range(_CURVE + 1)]
    name = f"x^{fit['growth']:.2f}"
    if fit["fixed"]:
        name = f"{fit['fixed']:.2g} {unit} + c {name}"
    axes.plot(xs, [fit["fixed"] + fit["factor"] * x ** fit["growth"] for x in xs], color="#c00000", linewidth=1.3,
              linestyle=(0, (4, 2)), label=name)  # fmt: skip


def _finish(axes: Axes, name: str, places: Sequence[float]) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(name, fontsize=SIZE + 1, color=INK)
    few = len(places) <= 8
    if few:
        axes.set_xticks(places, [f"{x:g}" for x in places])
        axes.xaxis.set_minor_locator(LogLocator(subs=()))
    else:
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        subs = (1.0, 2.0, 5.0) if places[-1] / places[0] < 100 else (1.0,)
        axes.xaxis.set_major_locator(LogLocator(subs=subs))
    axes.xaxis.set_minor_formatter(NullFormatter())
    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high / low < 50 else (1.0,)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=SIZE)
    axes.grid(visible=True, which="major", color="#dddddd", linewidth=0.6)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _words(family: Mapping[str, Any]) -> str:
    """The fitted exponents in words, for those who do not see the picture."""
    said = []
    for name, what in (("seconds", "Processor time"), ("memory", "Memory")):
        f = family["fits"].get(name)
        if f is not None:
            said.append(f"{what} along {family['axis']}: exponent {f['exponent']:.2f}, {f['verdict']}.")
    return " ".join(said) or f"Cost along {family['axis']}."
