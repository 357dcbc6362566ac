"""Completion in bash, zsh and fish: what the shell asks the program when Tab is pressed.

Guarantee: an answer is printed and nothing else: no message on standard error, no computation. The protocol is click's:
the variable `VARIABLE` holds ``SHELL_source`` for the script that a shell reads once, or ``SHELL_complete`` for what
could be typed next.
"""

from __future__ import annotations

import click
from click.shell_completion import BashComplete, ShellComplete, get_completion_class

VARIABLE = "_PTMCAD_COMPLETE"


class _Bash(BashComplete):
    """As click has it, but where a value goes on (NAME=, X, or a folder) no space follows."""

    source_template = BashComplete.source_template.replace(
        "COMPREPLY+=($value)", "COMPREPLY+=($value)\n            [[ $value == *[=,/] ]] && compopt -o nospace"
    )


def answer(group: click.Group, instruction: str, program: str) -> int:
    """Print what the shell asks for, and return the exit status.

    Parameters
    ----------
    instruction : the value of `VARIABLE`.
    """
    shell, _, what = instruction.partition("_")
    kind: type[ShellComplete] | None = _Bash if shell == "bash" else get_completion_class(shell)
    if kind is None or what not in ("source", "complete"):
        click.echo(f"error: {VARIABLE} is no request of bash, zsh or fish: unset it", err=True)
        return 2
    completer = kind(group, {}, program, VARIABLE)
    if what == "source":
        click.echo(completer.source())
    else:
        completer.ctx_args = {"obj": tuple(completer.get_completion_args()[0])}
        click.echo(completer.complete())
    return 0
