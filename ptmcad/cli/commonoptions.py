"""What the options of several commands share: putting them together into objects, reading their
values, folders and files, formats of output, and notes on options without effect.

Guarantee: a kind of output that a command does not know is refused before anything is computed. One
line on standard error says of each option that was typed that it has no effect, and the computation
goes on as without it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterable
from functools import wraps
from pathlib import Path
from typing import Any, TypeVar

import click
from click.core import ParameterSource

from ptmcad.cli.completion import files
from ptmcad.cli.completion import formats as completed

F = TypeVar("F", bound=Callable[..., Any])


def reading(
    read: Callable[[str, Any], Any], absent: Any = None
) -> Callable[[Any, click.Parameter, Any], Any]:
    """What click calls with an option's value: a function of the option's name and its value, where
    one is given.
    """
    return lambda _context, parameter, value: (
        absent if value is None else read(parameter.opts[0], value)
    )


Gathering = Callable[..., Any] | tuple[tuple[str, ...], Callable[..., Any]]
"""A function of options, which are those of its parameters' names or those that are named."""


def gathered(**kinds: Gathering) -> Callable[[F], F]:
    """A decorator of a command that takes, for each name, what ``kinds`` makes of some options.

    It stands below the options that it gathers.
    """
    known = {
        name: kind if isinstance(kind, tuple) else (tuple(inspect.signature(kind).parameters), kind)
        for name, kind in kinds.items()
    }

    def decorate(command: F) -> F:
        @wraps(command)
        def with_fewer(**given: Any) -> Any:
            made = {
                name: kind(**{option: given.pop(option) for option in options})
                for name, (options, kind) in known.items()
            }
            return command(**given, **made)

        return with_fewer  # type: ignore[return-value]

    return decorate


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


Formats = tuple[str, ...]
"""Kinds of output."""


def format_option(
    known: Formats, help: str = "Files to write, of {}.", default: str | None = None
) -> Callable[[F], F]:
    """Add ``--format``, of which the command gets the kinds as ``formats``; braces in the help stand
    for those that are known.
    """
    help = help.format(", ".join(known)) + "  [default: none]" * (default is None)
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


STYLE = (
    "style", "size", "font_size", "font_family", "palette", "title", "legend", "line_width", "thin_lines",
)  # fmt: skip
"""The options that make a picture's style, by their parameters' names."""


Idle = tuple[str, bool, str]
"""An option by its parameter's name, whether it is without effect, and why it would be."""


def report_idle(cases: Iterable[Idle]) -> None:
    """Say which of the options that were typed have no effect here, and why."""
    context = click.get_current_context()
    flags = {p.name: p.opts[0] for p in context.command.params if isinstance(p, click.Option)}
    for parameter, idle, why in cases:
        if idle and context.get_parameter_source(parameter) is ParameterSource.COMMANDLINE:
            click.echo(f"note: {flags[parameter]} has no effect here: {why}", err=True)


def _has_picture(formats: Iterable[str]) -> bool:
    return bool(set(formats) - {"json", "csv", "npz", "table", "obj", "ply"})


def idle_output(files: Collection[str]) -> tuple[Idle, ...]:
    """The options that say where files go and what they are called, where there are none."""
    return tuple((name, not files, "no file is written, see --format") for name in ("out", "name"))


def idle_style(formats: Iterable[str]) -> tuple[Idle, ...]:
    """The options of a picture's style where none of these formats is a picture."""
    return tuple(
        (name, not _has_picture(formats), "no picture is written") for name in (*STYLE, "dpi")
    )


def idle_drawing(formats: Iterable[str]) -> tuple[Idle, ...]:
    """The options of `ptmcad.cli.drawing` that none of these formats heeds."""
    chosen = set(formats)
    return (
        *idle_style(formats),
        ("samples", not _has_picture(formats), "no picture is written"),
        ("pixels", "npz" not in chosen, "only NPZ has a grid, see --format"),
        (
            "boundary_tolerance",
            not chosen & {"csv", "npz"},
            "only CSV and NPZ have boundaries, see --format",
        ),
    )
