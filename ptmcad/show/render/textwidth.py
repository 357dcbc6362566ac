"""How wide text is in the font of the settings, and its lines of a width: measured, not guessed."""

from __future__ import annotations

import re
from functools import lru_cache

from matplotlib import rcParams
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

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
    return _text_width(text, strong, tuple(rcParams["font.family"])) * size / 72 * ALLOWANCE


@lru_cache(maxsize=4096)
def _text_width(text: str, strong: bool, families: tuple[str, ...]) -> float:
    """Against the font's size."""
    font = FontProperties(family=list(families), size=100, weight="bold" if strong else "normal")
    width, _, _ = text_to_path.get_text_width_height_descent(text, font, False)
    return float(width) / 100
