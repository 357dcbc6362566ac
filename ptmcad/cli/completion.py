"""What could be typed next, for the shell: commands, options, names of parameters, formats and files.

Guarantee: an answer is printed and nothing else: no message on standard error. Proposing computes
nothing, changes no file, and fails silently where a record cannot be read: whoever types sees why
when the command runs. The protocol is click's: a variable holds ``SHELL_source`` for the script
that a shell reads once, or ``SHELL_complete`` for what could be typed next.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from glob import escape, glob
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ptmcad.errors import PtmcadError
from ptmcad.question.shipped import shipped_records

if TYPE_CHECKING:
    from ptmcad.question.slice import Slice

Complete = Callable[[click.Context, click.Parameter, str], list[Any]]
Known = Callable[[click.Context, click.Parameter], Iterable[str]]
MAX_BYTES = 20_000_000
"""Of a result whose axes are looked up: of a larger one nothing is proposed."""
_FILE = click.Path()
"""For which the shell proposes files."""


def proposing(known: Known, after: str = "", listed: bool = False) -> Complete:
    """Names, each with a sign after it if there is one; of a list, separated by commas, those that
    it does not have.
    """

    def propose(context: click.Context, parameter: click.Parameter, typed: str) -> list[str]:
        before, comma, last = typed.rpartition(",") if listed else ("", "", typed)
        if after and after in last:
            return []
        given = {part.partition("=")[0].strip() for part in before.split(",")}
        try:
            names = [name for name in known(context, parameter) if name not in given]
        except (PtmcadError, OSError, ValueError, LookupError, TypeError):  # of the file's content
            return []
        proposed = (f"{before}{comma}{name}{after}" for name in names)
        return [text for text in proposed if text.startswith(typed)]

    return propose


def formats(known: Iterable[str]) -> Complete:
    """The formats that a list does not have yet."""
    return proposing(lambda *_: known, listed=True)


def palettes(context: click.Context, parameter: click.Parameter, typed: str) -> list[Any]:
    """A palette, or colours by name."""
    from ptmcad.show.style import NAMED, PALETTES

    colours = formats(NAMED)(context, parameter, typed) if typed else []
    return [*proposing(lambda *_: PALETTES)(context, parameter, typed), *colours]


poses = proposing(lambda *_: ("stable:", "unstable:", "saddle:", "maximum:", "pose:"))
"""KIND:, of which the number is for the user to say."""


def mechanisms(context: click.Context, parameter: click.Parameter, typed: str) -> list[Any]:
    """The built-in mechanisms and systems; else a file."""
    from ptmcad.question.config.starters import NAMES

    found = proposing(lambda *_: NAMES)(context, parameter, typed)
    return found or _FILE.shell_complete(context, parameter, typed)


def files(*suffixes: str) -> Complete:
    """The files of these suffixes, shipped records where those are asked for, and folders to look
    in; whatever there is where there are none of them."""

    def propose(context: click.Context, parameter: click.Parameter, typed: str) -> list[Any]:
        paths = sorted(glob(f"{escape(typed)}*"))
        found = [path for path in paths if path.endswith(suffixes) and os.path.isfile(path)]
        found += [f"{path}/" for path in paths if os.path.isdir(path)]
        if ".yaml" in suffixes:
            found += [n for n in shipped_records() if n.startswith(typed) and n not in found]
        return found or _FILE.shell_complete(context, parameter, typed)

    return propose


def _names(context: click.Context, _parameter: click.Parameter) -> Iterable[str]:
    """The axes of the record or result that was typed, or else of the default, and the model's
    parameters.
    """
    from ptmcad.model import ptm
    from ptmcad.question.config.modelkeys import model_of
    from ptmcad.question.config.starters import NAMES, starter_text
    from ptmcad.text.yamltree import read_text

    slice, mechanism = _typed_slice(context), context.params.get("mechanism")
    if any(parameter.name == "result" for parameter in context.command.params):
        return () if slice is None else slice.axis_names
    if slice is not None:
        return dict.fromkeys((*slice.axis_names, *slice.model.parameters))
    if mechanism in NAMES:
        return model_of(read_text(starter_text(mechanism))).parameters
    return ptm().parameters if mechanism is None else ()


def _quantities(context: click.Context, parameter: click.Parameter) -> Iterable[str]:
    """What a pose of the record's model, or of the default one, can be asked for; barriers by
    ``--value`` alone.
    """
    from ptmcad.ask.quantities import quantities
    from ptmcad.model import ptm

    slice = _typed_slice(context)
    model = ptm() if slice is None else slice.model
    further = model.criterion.differences if "--value" in parameter.opts else ()
    return (*quantities(model), *further)


def _typed_slice(context: click.Context) -> Slice | None:
    """That of the record or result among the words typed so far, where there is one.

    Click's parser leaves words alone where the last one is an option that waits for its value.
    """
    words = map(str, chain(filter(None, map(context.params.get, _ARGUMENTS)), context.args))
    known = shipped_records()
    path = next((Path(w) for w in words if w.endswith(_SUFFIXES) or w in known), None)
    if path is None:
        return None
    if path.suffix == ".json":
        return _slice_of_result(path)
    from ptmcad.question.config import load

    return load(path)


_ARGUMENTS = ("config", "record", "result")
_SUFFIXES = (".yaml", ".yml", ".json")


def _slice_of_result(path: Path) -> Slice | None:
    import json

    from ptmcad.show.document.slicedocument import SLICE
    from ptmcad.text.node import Node

    if path.stat().st_size > MAX_BYTES:
        return None
    return SLICE.read(Node(json.loads(path.read_text(encoding="utf-8"))["slice"], "slice"))


names = proposing(_names)
"""An axis or a parameter of the question's model."""

quantity_names = proposing(_quantities)
"""A quantity of a pose."""

settings = proposing(_names, after="=")
"""NAME=, of which the value is for the user to say."""

point = proposing(_names, after="=", listed=True)
"""NAME=VALUE,NAME=VALUE, as far as names go."""


def pair_of_names(context: click.Context, parameter: click.Parameter, typed: str) -> list[Any]:
    """Two axes, such as rho,L2."""
    if typed.count(",") > 1:
        return []
    found = proposing(_names, listed=True)(context, parameter, typed)
    return found if "," in typed else [f"{name}," for name in found]


def answer(group: click.Group, instruction: str, program: str, variable: str) -> int:
    """Print what the shell asks for, and return the exit status.

    Parameters
    ----------
    instruction : what the shell asks for.
    variable : the name of the variable in which it does.
    """
    from click.shell_completion import get_completion_class

    shell, _, what = instruction.partition("_")
    kind = get_completion_class(shell)
    if kind is None or what not in ("source", "complete"):
        click.echo(f"error: {variable} is no request of bash, zsh or fish: unset it", err=True)
        return 2
    completer = kind(group, {}, program, variable)
    if what == "complete":
        click.echo(completer.complete())
        return 0
    # as click has it, but where a value goes on (NAME=, X, or a folder) no space follows in bash
    further = "\n            [[ $value == *[=,/] ]] && compopt -o nospace"
    taken = "COMPREPLY+=($value)"
    click.echo(completer.source().replace(taken, taken + further))
    return 0
