"""The picture of a continuous quantity over a map's window: colours, contour lines, and the map's exact boundaries.

Guarantee: the same field gives the same bytes with the same matplotlib. Pixels are shown as they are, without any
smoothing, so that none shows a value from the other side of a boundary; contour lines are drawn within regions only.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ptmcad.answer.boundaries import Boundary
from ptmcad.answer.field import Field
from ptmcad.answer.regionmap import RegionMap
from ptmcad.mechanism import System
from ptmcad.show.render.axes import dress, scale_of, symbol
from ptmcad.show.render.legend import INK, STRONG
from ptmcad.show.render.printing import save, settings
from ptmcad.show.render.view import Floats, View
from ptmcad.show.units import with_unit

LEFT, BOTTOM, SIDE, GAP, BAR, RIGHT, TOP = 0.85, 0.65, 4.6, 0.2, 0.2, 0.95, 0.6
"""In inches: the space at the map's left and below, its side, the space before the scale, the scale, its numbers."""
COLOURS = "viridis"
"""Perceptually uniform, distinguishable to the colour-blind, and monotone on grey prints."""
MIN_LINE = 16.0
"""Pixels of the field: shorter contour lines are left out."""
_LINES: dict[str, Any] = {"colors": "white", "linewidths": 0.6, "alpha": 0.85}
_EMPTY = "#ffffff"
_WORDS = ("energy", "stiffness", "barrier")


def draw_field(
    result: RegionMap, field: Field, boundaries: Sequence[Boundary], path: Path, *, contours: int = 8, dpi: int = 150
) -> None:
    """Write the picture of a field over its map, as `ptmcad.show.render.printing.save` does.

    Parameters
    ----------
    boundaries : of the map.
    contours : about so many contour lines; none for 0.
    """
    with settings():
        figure = field_figure(result, field, boundaries, contours, dpi)
    save(figure, path, dpi=dpi)


def title_of(result: RegionMap, field: Field) -> str:
    """What is shown, of which slice."""
    text = _name(field)
    # others are names and expressions, which are written as they were asked for: u is not U
    text = text.capitalize() if text in _WORDS else text[0].upper() + text[1:] if ":" in field.quantity else text
    word, _, number = field.pose.partition(":")
    solution = "solution" if isinstance(result.slice.model, System) else "pose"
    pose = f"{solution} {number}" if word == "pose" else f"{word} {solution} {number}"
    return f"{text} of {pose}: {result.slice.name}"


def description(field: Field) -> str:
    """What the picture shows, in words."""
    known = field.values[~np.isnan(field.values)]
    if not known.size:
        return f"{_absent(field)[0].upper()}{_absent(field)[1:]}."
    share = 100 * known.size / field.values.size
    return (
        f"{field.quantity} of {field.pose} from {known.min():.6g} to {known.max():.6g}, "
        f"which {share:.3g} % of the window has."
    )


def field_figure(result: RegionMap, field: Field, boundaries: Sequence[Boundary], contours: int, dpi: int) -> Figure:
    """The picture, to be called within `settings`."""
    size = (LEFT + SIDE + GAP + BAR + RIGHT, BOTTOM + SIDE + TOP)
    figure = Figure(figsize=size, dpi=dpi, facecolor="white")
    axes: Any = figure.add_axes((LEFT / size[0], BOTTOM / size[1], SIDE / size[0], SIDE / size[1]))
    axes.set_gid("map")
    view = View.whole(result)
    extent = tuple(v for interval in (view.x, view.y) for s in [scale_of(*interval)] for v in (s.low, s.high))
    axes.set_facecolor(_EMPTY)
    known = field.values[~np.isnan(field.values)]
    axes.text(0, 1.03, title_of(result, field), transform=axes.transAxes, fontsize=11, va="bottom", color=INK)
    if known.size:
        low, high = float(known.min()), float(known.max())
        image = axes.imshow(
            field.values, origin="lower", extent=extent, aspect="auto", cmap=COLOURS, interpolation="nearest",
            vmin=low, vmax=high if high > low else low + 1.0, gid="values",
        )  # fmt: skip
        levels = _contours(axes, result, field, extent, contours, (low, high))
        bar_axes = figure.add_axes(((LEFT + SIDE + GAP) / size[0], BOTTOM / size[1], BAR / size[0], SIDE / size[1]))
        bar = figure.colorbar(image, cax=bar_axes)
        if levels:
            # the lines' values are those at the bar
            bar.set_ticks(levels)
            bar.ax.hlines(levels, 0, 1, transform=bar.ax.get_yaxis_transform(), gid="levels", **_LINES)
        bar.ax.tick_params(labelsize=9)
        bar.set_label(bar_text(field), fontsize=10)
    else:
        axes.text(0.5, 0.5, _absent(field), transform=axes.transAxes, ha="center", color=INK)
    for boundary in boundaries:
        if boundary.separates:
            axes.plot(*_shares(result, boundary.points).T, color=INK, linewidth=STRONG, transform=axes.transAxes)
    dress(axes, result.slice, view.x, view.y)
    figure.set_label(f"{title_of(result, field)}\n{description(field)}")
    return figure


def bar_text(field: Field) -> str:
    """The quantity with its unit, beside the scale."""
    return with_unit(_name(field), field.unit)


def _name(field: Field) -> str:
    """The quantity with the symbol of what it is of."""
    kind, colon, name = field.quantity.partition(":")
    return f"{kind} {symbol(name)}" if colon else field.quantity


def _absent(field: Field) -> str:
    """Why nothing is shown."""
    if field.beyond:
        return f"{field.quantity} is beyond doubles"
    return f"no {field.pose} in this window"


def _shares(result: RegionMap, points: Floats) -> Floats:
    """Points as fractions of the window's sides."""
    lows = np.array([float(a.low) for a in result.slice.axes])
    widths = np.array([float(a.high - a.low) for a in result.slice.axes])
    shares: Floats = (points - lows) / widths
    return shares


def _contours(
    axes: Any, result: RegionMap, field: Field, extent: Sequence[float], number: int, ends: tuple[float, float]
) -> list[float]:
    """Lines of equal value within each region, at round values; the values of those that are drawn."""
    from matplotlib.ticker import MaxNLocator

    if number < 1 or min(field.values.shape) < 2 or not ends[0] < ends[1]:
        return []
    levels = [v for v in MaxNLocator(nbins=number + 1).tick_values(*ends) if ends[0] < v < ends[1]]
    if not levels:
        return []
    rows, columns = field.values.shape
    x = extent[0] + (extent[1] - extent[0]) * (np.arange(columns) + 0.5) / columns
    y = extent[2] + (extent[3] - extent[2]) * (np.arange(rows) + 0.5) / rows
    pixel = np.array([(extent[1] - extent[0]) / columns, (extent[3] - extent[2]) / rows])
    found: dict[float, list[Floats]] = {}
    for region in np.unique(field.region[field.region >= 0]):
        own = np.where(field.region == region, field.values, np.nan)
        if (~np.isnan(own)).sum() > 3 and np.nanmin(own) < levels[-1] and np.nanmax(own) > levels[0]:
            traced = axes.contour(x, y, own, levels=levels)
            for level, lines in zip(traced.levels, traced.allsegs, strict=True):
                # along a ridge just above a level there are chains of rings, which pixels alone make
                found.setdefault(float(level), []).extend(line for line in lines if _length(line / pixel) >= MIN_LINE)
            traced.remove()
    for lines in found.values():
        axes.add_collection(LineCollection(lines, gid="contours", **_LINES), autolim=False)
    return [level for level, lines in sorted(found.items()) if lines]


def _length(points: Floats) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())
