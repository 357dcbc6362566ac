"""What stands on a page at places in inches from its lower left corner: axes, lines of text,
strokes and points.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ptmcad.show.render.clearance import Position

Box = tuple[float, float, float, float]
"""Left, bottom, width, height."""


def axes_at(figure: Any, box: Box, gid: str | None = None) -> Any:
    """Axes in a box."""
    wide, tall = figure.get_size_inches()
    axes = figure.add_axes((box[0] / wide, box[1] / tall, box[2] / wide, box[3] / tall))
    axes.set_gid(gid)
    return axes


def write(figure: Any, at: Position, text: str, size: float, **look: Any) -> Any:
    """A line of text of a size in points, by default from the middle of its left end."""
    return figure.text(
        *at, text, transform=figure.dpi_scale_trans, fontsize=size, **{"va": "center", **look}
    )


def write_lines(
    figure: Any, at: Position, lines: Iterable[str], size: float, step: float, **look: Any
) -> None:
    """Lines of text below each other, the first one at a place."""
    for k, line in enumerate(lines):
        write(figure, (at[0], at[1] - k * step), line, size, **look)


def stroke(figure: Any, xs: Sequence[float], ys: Sequence[float], **look: Any) -> None:
    """A line through points, or one point with a marker."""
    from matplotlib.lines import Line2D

    figure.add_artist(Line2D(xs, ys, transform=figure.dpi_scale_trans, **look))
