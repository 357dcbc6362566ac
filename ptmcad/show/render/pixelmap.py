"""Pixels as a picture of their own: the counts of a grid, or the values of a field, without the map
they are of.

Guarantee: every pixel has the colour of its own value. Lines are between pixels of different
regions; the map itself (`ptmcad.show.render.mappicture`, `ptmcad.show.render.fieldpicture`) has the exact
curves.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ptmcad.answer.boundaries import NONE, Grid
from ptmcad.answer.counts import Counts
from ptmcad.answer.field import Field
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.colours import INK, UNDETERMINED, fill_of_counts
from ptmcad.show.render.fieldpicture import (
    COLOURS,
    bar_text,
    description,
    fill_empty,
    pixel_edges,
    show_pixels,
)
from ptmcad.show.render.printing import printed, settings

SIZE, DPI = (5.2, 4.2), 100
"""Inches, and the resolution of a PNG."""
_LINE = 0.8


def grid_png(grid: Grid, dpi: int = DPI) -> bytes:
    """The numbers of stable equilibria, or of all where stability is not known, as the content of a
    PNG.
    """
    stability_known = bool((grid.stable != NONE).any())
    counts = grid.stable if stability_known else grid.total
    shown = np.unique(counts)
    look: dict[int, tuple[str, str]] = {NONE: ("undetermined", UNDETERMINED.face)}
    for n in set(shown.tolist()) - {NONE}:
        known = Counts(0, n, None) if stability_known else Counts(n, None, None)
        look[n] = str(n), fill_of_counts(known).face  # pixels show no hatch
    names, colours = zip(*(look[n] for n in shown.tolist()), strict=True)
    with settings():
        figure, axes = _chart(grid, dpi)
        steps = BoundaryNorm(np.arange(len(shown) + 1) - 0.5, len(shown))
        codes = np.searchsorted(shown, counts)
        image = show_pixels(axes, codes, grid.extent, cmap=ListedColormap(colours), norm=steps)
        _walls(axes, grid, grid.region)
        bar = figure.colorbar(image, ax=axes, ticks=range(len(shown)))
        bar.ax.set_yticklabels(names)
        bar.set_label("stable" if stability_known else "in all")
        return printed(figure, "png", dpi, repr(grid), "")


def field_png(field: Field, dpi: int = DPI) -> bytes:
    """The values as the content of a PNG."""
    with settings():
        figure, axes = _chart(field, dpi)
        if (field.region == NONE).any():
            fill_empty(axes, field, field.extent, UNDETERMINED)
        if np.isfinite(field.values).any():
            image = show_pixels(axes, field.values, field.extent, cmap=COLOURS)
            figure.colorbar(image, ax=axes).set_label(bar_text(field))
        _walls(axes, field, field.region)
        return printed(figure, "png", dpi, repr(field), description(field))


def _chart(pixels: Grid | Field, dpi: int) -> tuple[Figure, Any]:
    figure = Figure(figsize=SIZE, dpi=dpi, facecolor="white", layout="constrained")
    axes: Any = figure.add_subplot()
    left, right, bottom, top = pixels.extent
    across, up = map(symbol, pixels.names)
    axes.set(xlim=(left, right), ylim=(bottom, top), xlabel=across, ylabel=up)
    return figure, axes


def _walls(axes: Any, pixels: Grid | Field, region: NDArray[np.int64]) -> None:
    """Lines between neighbouring pixels of different regions."""
    edges = pixel_edges(region[:, 1:] != region[:, :-1], region[1:] != region[:-1], pixels.extent)
    axes.add_collection(LineCollection(edges, colors=INK, linewidths=_LINE), autolim=False)
