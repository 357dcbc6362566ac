"""Completion in bash, zsh and fish: what the shell asks the program when Tab is pressed.

Guarantee: an answer is printed and nothing else: no message on standard error, no computation. The
protocol is click's: a variable holds ``SHELL_source`` for the script that a shell reads once, or
``SHELL_complete`` for what could be typed next.
"""

from __future__ import annotations

import click
from click.shell_completion import BashComplete, ShellComplete, get_completion_class


class _Bash(BashComplete):
    """As click has it, but where a value goes on (NAME=, X, or a folder) no space follows."""

    source_template = BashComplete.source_template.replace(
        "COMPREPLY+=($value)",
        "COMPREPLY+=($value)\n            [[ $value == *[=,/] ]] && compopt -o nospace",
    )


def answer(group: click.Group, instruction: str, program: str, variable: str) -> int:
    """Print what the shell asks for, and return the exit status.

    Parameters
    ----------
    instruction : what the shell asks for.
    variable : the name of the variable in which it does.
    """
    shell, _, what = instruction.partition("_")
    kind: type[ShellComplete] | None = _Bash if shell == "bash" else get_completion_class(shell)
    if kind is None or what not in ("source", "complete"):
        click.echo(f"error: {variable} is no request of bash, zsh or fish: unset it", err=True)
        return 2
    completer = kind(group, {}, program, variable)
    if what == "source":
        click.echo(completer.source())
    else:
        completer.ctx_args = {"obj": tuple(completer.get_completion_args()[0])}
        click.echo(completer.complete())
    return 0
