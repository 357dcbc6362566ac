"""Tables for pages and terminals, and what the figures in them were measured with."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Iterable, Sequence


def markdown(rows: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a Markdown table, whose first row is its header."""
    return [
        "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
        for cells in (rows[0], ("---",) * len(rows[0]), *rows[1:])
    ]


def page(*blocks: str | Iterable[str]) -> str:
    """A Markdown page: paragraphs, headings, and tables and lists as their lines, with blank lines
    between them.
    """
    texts = (block if isinstance(block, str) else "\n".join(block) for block in blocks)
    return "\n\n".join(text.strip("\n") for text in texts if text) + "\n"


def installed(packages: Iterable[str]) -> dict[str, str]:
    """The packages' versions."""
    found = {}
    for package in packages:
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            found[package] = "not installed"
    return found
