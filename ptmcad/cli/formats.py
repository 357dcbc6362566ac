"""The option ``--format``: a list of the kinds of output that a command knows.

Guarantee: a kind that the command does not know is refused before anything is computed.
"""

from __future__ import annotations

import click


def formats_of(
    _context: click.Context, _parameter: click.Parameter, value: str, *, known: tuple[str, ...]
) -> tuple[str, ...]:
    """The kinds in a text such as ``json,png``, each once."""
    formats = tuple(dict.fromkeys(part.strip().lower() for part in value.split(",") if part.strip()))
    unknown = [part for part in formats if part not in known]
    if unknown or not formats:
        raise click.BadParameter(f"{', '.join(unknown) or 'nothing'} is not among {', '.join(known)}")
    return formats
