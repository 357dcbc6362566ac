"""Rows and lists as lines of text."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence

WIDTH = 100
"""Characters of a line."""


def aligned(
    rows: Sequence[Sequence[str]], justified: Callable[[str, int], str] = str.ljust
) -> list[str]:
    """Rows as lines with columns of equal width."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(map(justified, row, widths)).rstrip() for row in rows]


def wrapped(label: str, parts: Sequence[str], separator: str = ", ") -> list[str]:
    """The parts after a label, on as many lines as they need; no part is broken."""
    whole = separator.join(part.replace(" ", "\0") for part in parts)
    lines = textwrap.wrap(
        whole, WIDTH, initial_indent=f"{label:8}", subsequent_indent=" " * 8, break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip
    return [line.replace("\0", " ") for line in lines]
