"""What the commands share that ask about a slice: the record and the options that change it.

Guarantee: every such command takes the same words for the same slice.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

F = TypeVar("F", bound=Callable[..., Any])


def slice_options(command: F) -> F:
    """Add ``config``, ``axes``, ``sets`` and ``ranges``, as `ptmcad.question.config.slice_from_options` takes them."""
    for add in (
        click.option("--range", "ranges", multiple=True, metavar="NAME=LO:HI", help="The range of an axis."),
        click.option("--set", "sets", multiple=True, metavar="NAME=VALUE",
                     help="Fix a parameter: a number or an expression."),
        click.option("--slice", "axes", metavar="X,Y", help="The two axes, the horizontal one first."),
        click.argument("config", required=False, type=click.Path(path_type=Path)),
    ):  # fmt: skip
        command = add(command)
    return command
