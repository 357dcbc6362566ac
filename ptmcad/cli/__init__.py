"""The command line: one module per command, imported only when it is asked for.

A command module is listed in `COMMANDS` and defines ``command``, a click command that delegates to
plain functions.

Guarantee: the exit status is 0 when done, 1 when a check failed, 2 for bad input or output, 3 when
a limit stopped the computation or a point that `solve` was asked about is undecided, 130 after
Ctrl-C, 143 after SIGTERM and 129 after SIGHUP; bad input gets one message on standard error, no
traceback.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from errno import ENOMEM
from importlib import import_module
from typing import Any

import click

from ptmcad.errors import ConfigError, LimitReached, PtmcadError, PtmcadWarning, quoted, shown
from ptmcad.process.handover import watched
from ptmcad.text.syntax import did_you_mean
from ptmcad.version import __version__

COMPLETION = "_PTMCAD_COMPLETE"
"""The variable in which a shell asks for what could be typed next, as click has it."""
COMMANDS = ["animate", "bench", "check", "classify", "design", "explore", "init",
    "mechanisms", "locate", "map", "paper", "plot", "range", "report",
    "solve", "stress", "sweep", "variety", "verify", "warm-up"]  # fmt: skip
"""Each in the module of its name."""
MAX_ARGUMENTS = 10_000
"""The parser's time is quadratic in their number."""


class _LazyGroup(click.Group):
    """A group that imports a command's module when the command is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return COMMANDS

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        # click before 8.2 takes a name that begins with any sign for an option, and shows the help
        # as if all were well
        if args[0] not in COMMANDS and not ctx.resilient_parsing:
            raise click.UsageError(
                f"there is no command {quoted(args[0])}{did_you_mean(args[0], COMMANDS)}", ctx
            )
        return super().resolve_command(ctx, args)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f"ptmcad.cli.{cmd_name.replace('-', '_')}")
        command: click.Command = module.command
        return command


@click.group(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--version", is_flag=True, is_eager=True, expose_value=False,
              callback=lambda context, _parameter, value: _show_version(context, value),
              help="Show the version and exit.")  # fmt: skip
def group() -> None:
    """Proved region maps of planar mechanisms and parametric systems.

    Over a two-parameter slice, how many equilibria are there, how many of them are stable, and
    where do these numbers change?

    \b
    Examples: the paper's figure 4, its figure 2, a record of your own
        ptmcad classify fig4
        ptmcad classify --slice L2,rho
        ptmcad init --out mine.yaml
    """


def _show_version(context: click.Context, wanted: bool) -> None:
    if wanted and not context.resilient_parsing:
        click.echo(f"ptmcad {__version__}")
        context.exit()


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line in this process and return its exit status; `ptmcad.__main__` runs it in
    a watched one.
    """
    given = len(sys.argv) - 1 if arguments is None else len(arguments)
    if given > MAX_ARGUMENTS:
        click.echo(
            f"error: {given} arguments are given, more than {MAX_ARGUMENTS}: write a problem record",
            err=True,
        )
        return 2
    try:
        if COMPLETION in os.environ:
            from ptmcad.cli.completion import answer

            return answer(group, os.environ[COMPLETION], "ptmcad", COMPLETION)
        with _warnings_as_lines():
            status = group.main(
                args=arguments if given else ["--help"], prog_name="ptmcad", standalone_mode=False
            )
        if sys.stdout is not None:  # None when it was closed by the caller
            sys.stdout.flush()
    except click.ClickException as error:
        click.echo(f"error: {_one_line(error)}", err=True)
        return 2
    except click.Abort:
        return 130
    except LimitReached as error:
        click.echo(f"stopped: {error}", err=True)
        return 3
    except MemoryError:
        return _exhausted()
    except PtmcadError as error:
        more = len(error.faults) - 1 if isinstance(error, ConfigError) else 0
        click.echo(
            f"error: {error}{f' (and {more} more: ptmcad check lists them)' if more else ''}",
            err=True,
        )
        return 2
    except (
        OSError
    ) as error:  # mostly standard output that is full; files of results raise OutputError
        if error.errno == ENOMEM:
            return _exhausted()
        place = f": {error.filename}" if error.filename else ""
        click.echo(shown(f"error: {error.strerror or error}{place}"), err=True)
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - so that the exit does not try again
        return 2
    return status if isinstance(status, int) else 0


@contextmanager
def _warnings_as_lines() -> Iterator[None]:
    """What ptmcad warns of is one line each, every text once; Python's own warnings look as ever."""
    usual, said = warnings.showwarning, set[str]()

    def show(message: Warning | str, category: type[Warning], *place: Any, **further: Any) -> None:
        if not issubclass(category, PtmcadWarning):
            usual(message, category, *place, **further)
        elif str(message) not in said:
            said.add(str(message))
            from ptmcad.cli.progress import ProgressBar

            ProgressBar.say(f"warning: {shown(str(message))}", err=True)

    with warnings.catch_warnings():
        warnings.simplefilter("always", PtmcadWarning)
        warnings.showwarning = show
        yield


def _exhausted() -> int:
    """Report that memory has run out, and return the exit status."""
    if watched():  # the other process says so, and saves what there is
        raise MemoryError
    click.echo("stopped: memory ran out", err=True)
    return 3


def _one_line(error: click.ClickException) -> str:
    """What click refuses as a `ConfigError` would say it: the option or argument, and what is wrong
    with it.
    """
    context: click.Context | None = getattr(error, "ctx", None)
    command = context.command_path if context else "ptmcad"
    text = error.format_message()
    if isinstance(error, click.NoSuchOption):
        options = (
            [name for p in context.command.get_params(context) for name in p.opts]
            if context
            else []
        )
        text = f"{error.option_name}: there is no such option{did_you_mean(error.option_name, options)}"
    elif isinstance(error, click.BadParameter) and error.param is not None:
        key = (
            error.param.opts[0]
            if isinstance(error.param, click.Option)
            else error.param.human_readable_name
        )
        text = (
            f"{key}: {'is missing' if isinstance(error, click.MissingParameter) else error.message}"
        )
    text = shown(text[:1].lower() + text[1:] if " " in text.partition(":")[0] else text).rstrip(".")
    return text if text.endswith("?") else f"{text}; see {command} --help"
