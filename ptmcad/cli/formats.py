"""The option ``--format``: a list of the kinds of output that a command knows.

Guarantee: a kind that the command does not know is refused before anything is computed.
"""

from __future__ import annotations

from collections.abc import Callable

import click

from ptmcad.cli.gathering import F, reading
from ptmcad.cli.values import formats as completed

Formats = tuple[str, ...]
"""Kinds of output."""


def format_option(known: Formats, help: str, default: str | None = None) -> Callable[[F], F]:
    """Add ``--format``, of which the command gets the kinds as ``formats``."""
    kinds = reading(lambda _, text: _kinds(text, known), absent=())
    return click.option(
        "--format", "formats", callback=kinds, shell_complete=completed(known),
        default=default, show_default=default is not None, metavar="LIST", help=help,
    )  # fmt: skip


def _kinds(text: str, known: Formats) -> Formats:
    """The kinds in a text such as ``json,png``, each once."""
    formats = tuple(dict.fromkeys(part.strip().lower() for part in text.split(",") if part.strip()))
    unknown = [part for part in formats if part not in known]
    if unknown or not formats:
        raise click.BadParameter(
            f"{', '.join(unknown) or 'nothing'} is not among {', '.join(known)}"
        )
    return formats
