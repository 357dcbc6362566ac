"""Pictures of a sweep's maps, one after another in one frame, for a film.

Guarantee: the frame, the colours and the legend are the same in all pictures, so that only the
regions move. The values above a map are exact.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.axes import Dress, symbol
from ptmcad.show.render.colours import Fill
from ptmcad.show.render.legend import Entry, Type, draw_legend, head_of
from ptmcad.show.render.painting import fills_by_count, paint_of
from ptmcad.show.render.panels import Panel, PanelGrid
from ptmcad.show.render.shapes import shapes
from ptmcad.show.render.stage import Pixels
from ptmcad.show.style import DEFAULT
from ptmcad.show.table import in_order
from ptmcad.text.numerals import fraction_of, shortest_text

SIZE, _DPI = (7.0, 5.2), 100
"""Inches of a picture."""
_GRID = PanelGrid((0.77, 4.58), (4.34, 3.95), (0.0, 0.0), 1, Dress(), Type(12))
_KEY = (5.25, 4.58)
"""The upper left corner of the legend."""
_MAX_LENGTH = 90
"""Characters of the values above a map."""


class SweepFilm:
    """The pictures; to be used within `printing.settings`.

    Parameters
    ----------
    maps : gives each map when it is drawn, so that only one of them is in memory.
    values : of what is swept, for each map.
    """

    def __init__(
        self, maps: Callable[[int], RegionMap], values: Sequence[Mapping[str, str]]
    ) -> None:
        self.maps, self.values = maps, values
        fills: dict[str, Fill] = {}
        head: tuple[str, ...] = ("",)
        for number in range(len(values)):
            result = maps(number)
            fills |= fills_by_count(paint_of(DEFAULT, result), result)
            head = head_of(result.slice)[:1]
        told = (Entry((text,), fills[text]) for text in sorted(fills, key=in_order))
        self.legend = [Entry(head, strong=True), *told]

    def __len__(self) -> int:
        return len(self.values)

    def frame(self, number: int) -> Pixels:
        figure = Figure(figsize=SIZE, dpi=_DPI, facecolor="white")
        result = self.maps(number)
        text = ",  ".join(
            f"{symbol(n)} = {shortest_text(fraction_of(v))}" for n, v in self.values[number].items()
        )
        head = text if len(text) <= _MAX_LENGTH else f"{text[:_MAX_LENGTH]}…"
        _GRID.draw(figure, [Panel(shapes(result), paint_of(DEFAULT, result), (head,))])
        draw_legend(figure, self.legend, *_KEY)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()
