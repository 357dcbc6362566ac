"""What the options of several commands share: putting them together into objects, reading their
values, folders and files, formats of output, notes on options without effect, and the limits
``--timeout`` and ``--max-memory``.

Guarantee: a kind of output that a command does not know is refused before anything is computed. One
line on standard error says of each option that was typed that it has no effect, and the computation
goes on as without it. In a watched process (`ptmcad.process.supervisor`) the limits hold whatever
code runs; elsewhere the memory limit holds, and the time limit where the command itself looks at
the clock.
"""

from __future__ import annotations

import inspect
import math
import os
import re
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, nullcontext
from fractions import Fraction
from functools import wraps
from pathlib import Path
from typing import Any, TypeVar

import click
from click.core import ParameterSource

from ptmcad.cli.completion import files
from ptmcad.cli.completion import formats as completed
from ptmcad.errors import ConfigError
from ptmcad.options import Progress
from ptmcad.process.handover import Topic, send, watched
from ptmcad.process.memory import Bound, bounded, kernel_lines
from ptmcad.process.output import check_writable
from ptmcad.question.config import file_name

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


def option(
    name: str,
    help: str,
    metavar: str | None = None,
    type: Any = None,
    *,
    read: Callable[[str, Any], Any] | None = None,
    **how: Any,
) -> Callable[[F], F]:
    """An option of a command, as `click.option` has it, whose help ends with its default.

    Parameters
    ----------
    name : of the option, and of the command's parameter where that differs.
    metavar, type : of its value; without either, and without a default, it is a flag.
    read : what the command gets, as a function of the option's name and the value, if one is given.
    """
    has_default = "default" in how
    if metavar is None and type is None and not has_default:
        how["is_flag"] = True
    if read is not None:
        how["callback"] = reading(read)
    return click.option(
        *name.split(), help=help, metavar=metavar, type=type,
        show_default=has_default and "[default: " not in help, **how,
    )  # fmt: skip


def together(*added: Callable[[F], F]) -> Callable[[F], F]:
    """Decorators as one, as if they stood one below the other."""

    def decorate(command: F) -> F:
        for add in reversed(added):
            command = add(command)
        return command

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
    said = f"Start of the files' names.  [default: {default}]"
    return option("--name", said, "NAME", read=lambda key, name: file_name(name, key))


out_option = option("--out", "Folder for the files.  [default: .]", type=PATH, default=Path())
"""The folder for what a command writes."""


def file_option(name: str, suffix: str, metavar: str, help: str) -> Callable[[F], F]:
    """An option for a file, of which the shell proposes those of a suffix."""
    return option(name, help, metavar, PATH, shell_complete=files(suffix))


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
    how: dict[str, Any] = {} if default is None else {"default": default}
    return option(
        "--format formats", help, "LIST", callback=kinds, shell_complete=completed(known), **how
    )


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


def check_output(folder: Path, files: tuple[str, ...]) -> None:
    """Prove that the files can be written; where there are none, say that options for them have no
    effect.

    Raises
    ------
    OutputError
    """
    if files:
        check_writable(folder, files)
    report_idle((name, not files, "no file is written, see --format") for name in ("out", "name"))


def idle_style(formats: Iterable[str]) -> tuple[Idle, ...]:
    """The options of a picture's look where none of these formats is a picture."""
    drawn = bool(set(formats) - {"json", "csv", "npz", "table", "obj", "ply"})
    return tuple((name, not drawn, "no picture is written") for name in (*STYLE, "dpi", "samples"))


def idle_drawing(formats: Iterable[str]) -> tuple[Idle, ...]:
    """The options of `ptmcad.cli.drawing` that none of these formats heeds."""
    numbers = {"csv", "npz"} & set(formats)
    return (
        *idle_style(formats),
        ("pixels", "npz" not in numbers, "only NPZ has a grid, see --format"),
        ("boundary_tolerance", not numbers, "only CSV and NPZ have boundaries, see --format"),
    )


MIN_BOUND = 64 << 20
"""The exact engine's libraries alone need about half of this."""

_GROUPS = "/sys/fs/cgroup"
_SIZE = re.compile(r"([0-9]{1,12}(?:\.[0-9]{1,12})?)\s*([KMGT])(?:I?B)?", re.IGNORECASE)
_UNITS = {"K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}


def seconds_of(_key: str, value: float) -> float:
    """A positive number of seconds."""
    if not 0 < value < 1e9:
        raise click.BadParameter(f"{value} is not a positive number of seconds")
    return value


def bound_of(text: str) -> Bound:
    """A bound as it is written: a number and a unit K, M, G or T (powers of 1024).

    Raises
    ------
    ConfigError
        When it is not of that form, or no sensible size.

    Examples
    --------
    >>> bound_of("500M")[0], bound_of("1.5 GiB")[0]
    (524288000, 1610612736)
    """
    match = _SIZE.fullmatch(text.strip())
    shown = text if len(text) <= 30 else f"{text[:30]}..."
    if match is None:
        raise ConfigError(
            f"'{shown}' is not a size: write a number and a unit, such as 500M or 2G",
            key="--max-memory",
        )
    size = int(Fraction(match[1]) * _UNITS[match[2].upper()])
    if size < MIN_BOUND:
        raise ConfigError(
            f"{shown} is too little to start with: at least {MIN_BOUND >> 20}M", key="--max-memory"
        )
    if size >= 1 << 60:
        raise ConfigError(f"{shown} is more than any machine has", key="--max-memory")
    return size, text.strip()


def default_bound() -> Bound:
    """Nine tenths of the memory of the machine, or of the container if that is less."""
    machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    group = Path(
        _GROUPS,
        *(line[4:] for line in kernel_lines("/proc/self/cgroup") if line.startswith("0::/")),
    )
    older = Path(_GROUPS, "memory", "memory.limit_in_bytes")  # of the first kind of control groups
    paths = [*(place / "memory.max" for place in (group, *group.parents)), older]
    texts = [text for path in paths for text in kernel_lines(path)]
    least, whose = min(
        [(machine, "machine"), *((int(text), "container") for text in texts if text.isdigit())]
    )
    size = least * 9 // 10
    return (
        size,
        f"{size / (1 << 30):.3g}G, nine tenths of this {whose}'s (--max-memory sets another),",
    )


def limit_options(command: F) -> F:
    """Add ``--timeout`` and ``--max-memory``, within which the command runs.

    One that has a parameter ``timeout`` gets the seconds, and starts their clock itself, by
    `report_deadline` or `clock_stopped`, once it has read what it is asked.
    """
    passed = {"timeout"} & inspect.signature(command).parameters.keys()

    @wraps(command)
    def limited(*, timeout: float | None, max_memory: Bound | None, **given: Any) -> Any:
        with held(None if passed else timeout, max_memory):
            return command(**given, **dict.fromkeys(passed, timeout))

    return together(
        option("--timeout", "Stop after S seconds (exit status 3); loading the certified engine, and compiling it "
               "once on a machine, are not counted.", "S", float, read=seconds_of),
        option("--max-memory", "Stop before using more memory, such as 500M or 2G (exit status 3; 2 when it is "
               "too little to start with).  [default: 9/10 of the machine's]", "SIZE",
               read=lambda _, text: bound_of(text)),
    )(limited)  # type: ignore[return-value]  # fmt: skip


def report_deadline(timeout: float | None, spent: float = 0.0) -> None:
    """The time limit starts now, or started so many seconds ago."""
    if timeout is not None:
        send(Topic.DEADLINE, repr(time.monotonic() + timeout - spent), f"{timeout:g} s")


@contextmanager
def clock_stopped(timeout: float | None, spent: float = 0.0) -> Iterator[None]:
    """The time limit does not run inside; it starts at the end, or has started so many seconds
    before.
    """
    if timeout is not None:
        send(Topic.DEADLINE, repr(math.inf), "")
    yield
    report_deadline(timeout, spent)


def compile_certified(timeout: float | None, progress: Progress) -> None:
    """Load the certified engine, and compile it where that is needed, outside of the time limit."""
    from ptmcad.ask.classification import load_certified

    with clock_stopped(timeout):
        load_certified(progress)


@contextmanager
def held(timeout: float | None, max_memory: Bound | None) -> Iterator[None]:
    """Set limits for what is done inside: seconds and memory, None for no limit of its own."""
    report_deadline(timeout)
    bound = max_memory or (default_bound() if watched() else None)
    # NumPy's linear algebra would reserve memory for every processor; the small matrices here are
    # no faster on several
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if bound is not None:
        send(Topic.MEMORY, str(bound[0]), bound[1])
    with nullcontext() if bound is None else bounded(bound):
        yield
