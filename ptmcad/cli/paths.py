"""Arguments and options that are paths: records and files that are read, the folder that files are written to."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from ptmcad.cli.values import files

F = TypeVar("F", bound=Callable[..., Any])


def record_argument(name: str = "config", *, required: bool = False) -> Callable[[F], F]:
    """A problem record: a YAML file, or the name of one that is shipped."""
    complete = files(".yaml", ".yml")
    return click.argument(name, required=required, type=click.Path(path_type=Path), shell_complete=complete)


def out_option(command: F) -> F:
    """Add ``--out``, the folder for what a command writes."""
    return click.option(
        "--out", type=click.Path(path_type=Path), default=Path(), help="Folder for the files.  [default: .]"
    )(command)


def file_option(name: str, suffix: str, metavar: str, help: str) -> Callable[[F], F]:
    """An option for a file, of which the shell proposes those of a suffix."""
    return click.option(name, type=click.Path(path_type=Path), shell_complete=files(suffix), metavar=metavar, help=help)
