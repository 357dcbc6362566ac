"""Arguments and options that are paths: records and files that are read, the folder that files are
written to.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click

from ptmcad.cli.gathering import F
from ptmcad.cli.values import files

PATH = click.Path(path_type=Path)


def record_argument(name: str = "config", *, required: bool = False) -> Callable[[F], F]:
    """A problem record: a YAML file, or the name of one that is shipped."""
    complete = files(".yaml", ".yml")
    return click.argument(name, required=required, type=PATH, shell_complete=complete)


result_argument = click.argument("result", type=PATH, shell_complete=files(".json"))
"""A stored result."""


def name_option(default: str) -> Callable[[F], F]:
    """Add ``--name``, with which the names of all files begin."""
    return click.option(
        "--name", metavar="NAME", help=f"Start of the files' names.  [default: {default}]"
    )


def out_option(command: F) -> F:
    """Add ``--out``, the folder for what a command writes."""
    return click.option(
        "--out", type=PATH, default=Path(), help="Folder for the files.  [default: .]"
    )(command)


def file_option(name: str, suffix: str, metavar: str, help: str) -> Callable[[F], F]:
    """An option for a file, of which the shell proposes those of a suffix."""
    return click.option(name, type=PATH, shell_complete=files(suffix), metavar=metavar, help=help)
