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
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.colours import Fill
from ptmcad.show.render.legend import head_of
from ptmcad.show.render.painting import fills_by_count, paint_of
from ptmcad.show.render.plotting import draw_on, handles_of
from ptmcad.show.render.stage import Pixels
from ptmcad.show.style import DEFAULT, LegendPlace
from ptmcad.show.table import in_order
from ptmcad.text.numerals import fraction_of, shortest_text

SIZE = (7.0, 5.2)
"""Inches of a picture."""
_BOX = (0.11, 0.12, 0.62, 0.76)
"""Of the map, as shares of the picture's sides: left, bottom, width, height."""
_STYLE, _DPI = DEFAULT._replace(legend=LegendPlace.NONE, title=""), 100

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
        self.head, fills = "", dict[str, Fill]()
        for number in range(len(values)):
            result = maps(number)
            fills |= fills_by_count(paint_of(DEFAULT, result), result)
            self.head = head_of(result.slice)[0]
        self.legend = handles_of({text: fills[text] for text in sorted(fills, key=in_order)})

    def __len__(self) -> int:
        return len(self.values)

    def frame(self, number: int) -> Pixels:
        figure = Figure(figsize=SIZE, dpi=_DPI, facecolor="white")
        axes: Any = figure.add_axes(_BOX)
        draw_on(axes, self.maps(number), False, _STYLE)
        text = ",  ".join(
            f"{symbol(n)} = {shortest_text(fraction_of(v))}" for n, v in self.values[number].items()
        )
        figure.text(
            _BOX[0],
            0.93,
            text if len(text) <= _MAX_LENGTH else f"{text[:_MAX_LENGTH]}…",
            fontsize=12,
        )
        figure.legend(
            handles=self.legend, title=self.head, loc="upper left",
            bbox_to_anchor=(_BOX[0] + _BOX[2] + 0.02, _BOX[1] + _BOX[3]), borderaxespad=0, frameon=False, fontsize=9,
        )  # fmt: skip
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()
