"""The option ``--format``: a list of the kinds of output that a command knows.

Guarantee: a kind that the command does not know is refused before anything is computed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import click

from ptmcad.cli.gathering import F
from ptmcad.cli.values import formats as completed


def format_option(known: tuple[str, ...], help: str, default: str | None = None) -> Callable[[F], F]:
    """Add ``--format``, of which the command gets the kinds as ``formats``."""
    return click.option(
        "--format", "formats", callback=partial(formats_of, known=known), shell_complete=completed(known),
        default=default, show_default=default is not None, metavar="LIST", help=help,
    )  # fmt: skip


def formats_of(
    _context: click.Context, _parameter: click.Parameter, value: str | None, *, known: tuple[str, ...]
) -> tuple[str, ...]:
    """The kinds in a text such as ``json,png``, each once; none where nothing is given."""
    if value is None:
        return ()
    formats = tuple(dict.fromkeys(part.strip().lower() for part in value.split(",") if part.strip()))
    unknown = [part for part in formats if part not in known]
    if unknown or not formats:
        raise click.BadParameter(f"{', '.join(unknown) or 'nothing'} is not among {', '.join(known)}")
    return formats
