"""What the studies say and ask, which is data beside their code; tables for pages and terminals, and
the versions that figures were measured with.
"""

from __future__ import annotations

import importlib.metadata
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import yaml


def texts_beside(module: str, name: str) -> dict[str, Any]:
    """The data in a file of this name beside a module, which is given by its own file."""
    found: dict[str, Any] = yaml.safe_load(Path(module).with_name(name).read_text(encoding="utf-8"))
    return found


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
