"""What stands on a page at places in inches from its lower left corner: axes, lines of text, strokes
and points; and how wide text is in the font of the settings, measured, not guessed.

Matplotlib is loaded when something is drawn or measured: the report's words do without it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

from ptmcad.show.render.labels import Position

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


TITLE_LINE = 0.22
"""Inches of a line of a title."""


def titled(title: Sequence[str], words: str, size: Position, left: float, rim: float) -> Any:
    """A page of a size in inches with a title in lines at its top, below a rim, and a description in
    words.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, facecolor="white")
    figure.set_label(f"{' '.join(title)}\n{words}")
    write_lines(figure, (left, size[1] - rim - TITLE_LINE / 2), title, 11, TITLE_LINE)
    return figure


def stroke(figure: Any, xs: Sequence[float], ys: Sequence[float], **look: Any) -> None:
    """A line through points, or one point with a marker."""
    from matplotlib.lines import Line2D

    figure.add_artist(Line2D(xs, ys, transform=figure.dpi_scale_trans, **look))


ALLOWANCE = 1.03
"""Text is taken to be so much wider than it is, for programs that set it by themselves."""


def wrapped(text: str, width: float, size: float, strong: bool = False) -> list[str]:
    """Lines of whole words, each as long as the width in inches allows; none ends within
    ``k = 100``.
    """
    lines: list[str] = []
    for word in re.findall(r"\S+(?: = \S+)*", text):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_width(longer, size, strong) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def few(lines: list[str], most: int) -> list[str]:
    """So many lines at most; the last one says where there are more."""
    return lines if len(lines) <= most else [*lines[: most - 1], f"{lines[most - 1]} …"]


def text_width(text: str, size: float, strong: bool = False) -> float:
    """Inches that a line of text takes in the font of the settings."""
    from matplotlib import rcParams

    return _text_width(text, strong, tuple(rcParams["font.family"])) * size / 72 * ALLOWANCE


@lru_cache(maxsize=4096)
def _text_width(text: str, strong: bool, families: tuple[str, ...]) -> float:
    """Against the font's size."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(family=list(families), size=100, weight="bold" if strong else "normal")
    width, _, _ = text_to_path.get_text_width_height_descent(text, font, False)
    return float(width) / 100
