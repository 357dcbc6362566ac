"""Completion in bash, zsh and fish: what the shell asks the program when Tab is pressed, and what it may
propose for a value, as far as that is known: names, formats, files.

Guarantee: an answer is printed and nothing else: no message on standard error. Proposing computes
nothing, changes no file, and fails silently where a record cannot be read: whoever types sees why
when the command runs. The protocol is click's: a variable holds ``SHELL_source`` for the script
that a shell reads once, or ``SHELL_complete`` for what could be typed next; the words typed so far
are the context's ``obj``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ptmcad.errors import PtmcadError
from ptmcad.question.shipped import shipped_records

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ptmcad.model import Model

Complete = Callable[[click.Context, click.Parameter, str], "list[CompletionItem]"]
MAX_BYTES = 20_000_000
"""Of a result whose axes are looked up: of a larger one nothing is proposed."""
_FILE = "file"


def _item(name: str, type: str = "plain") -> CompletionItem:
    from click.shell_completion import CompletionItem  # which commands that run do not need

    return CompletionItem(name, type=type)


def _begun(names: Iterable[str], typed: str) -> list[CompletionItem]:
    """Those that begin as what was typed."""
    return [_item(name) for name in names if name.startswith(typed)]


def proposing(
    known: Callable[[click.Context], Iterable[str]], after: str = "", listed: bool = False
) -> Complete:
    """Names, each with a sign after it if there is one; of a list, separated by commas, those that
    it does not have.
    """

    def propose(
        context: click.Context, _parameter: click.Parameter, typed: str
    ) -> list[CompletionItem]:
        before, comma, last = typed.rpartition(",") if listed else ("", "", typed)
        if after and after in last:
            return []
        given = {part.partition("=")[0].strip() for part in before.split(",")}
        return _begun(
            (f"{before}{comma}{name}{after}" for name in known(context) if name not in given), typed
        )

    return propose


def formats(known: Iterable[str]) -> Complete:
    """The formats that a list does not have yet."""
    return proposing(lambda _: known, listed=True)


def palettes(
    context: click.Context, parameter: click.Parameter, typed: str
) -> list[CompletionItem]:
    """A palette, or colours by name."""
    from ptmcad.show.style import NAMED, PALETTES

    return [*_begun(PALETTES, typed), *(formats(NAMED)(context, parameter, typed) if typed else [])]


poses = proposing(lambda _: ("stable:", "unstable:", "saddle:", "maximum:", "pose:"))
"""KIND:, of which the number is for the user to say."""


def mechanisms(
    _context: click.Context, _parameter: click.Parameter, typed: str
) -> list[CompletionItem]:
    """The built-in mechanisms and systems; else a file."""
    from ptmcad.question.config.starters import NAMES

    return _begun(NAMES, typed) or [_item(typed, type=_FILE)]


def files(*suffixes: str) -> Complete:
    """The files of these suffixes, shipped records where those are asked for, and folders to look
    in; whatever there is where there are none of them."""

    def propose(
        _context: click.Context, _parameter: click.Parameter, typed: str
    ) -> list[CompletionItem]:
        folder, _, start = typed.rpartition("/")
        base = f"{folder}/" if "/" in typed else ""
        try:
            entries = sorted(os.scandir(base or "."), key=lambda entry: entry.name)
        except OSError:  # no such folder
            return []
        seen = [
            e for e in entries if e.name.startswith(start) and (start or not e.name.startswith("."))
        ]
        found = [f"{base}{e.name}" for e in seen if e.name.endswith(suffixes) and e.is_file()]
        found += [f"{base}{e.name}/" for e in seen if e.is_dir()]
        if ".yaml" in suffixes:
            found += [
                name for name in shipped_records() if name.startswith(typed) and name not in found
            ]
        return [_item(name) for name in found] or [_item(typed, type=_FILE)]

    return propose


def pair_of_names(
    context: click.Context, parameter: click.Parameter, typed: str
) -> list[CompletionItem]:
    """Two axes, such as rho,L2."""
    found = (
        proposing(_names, listed=True)(context, parameter, typed) if typed.count(",") < 2 else []
    )
    return found if "," in typed else [_item(f"{item.value},") for item in found]


def quantity_names(
    context: click.Context, parameter: click.Parameter, typed: str
) -> list[CompletionItem]:
    """What a pose of the record's model, or of the default one, can be asked for; barriers by
    ``--value`` alone.
    """
    from ptmcad.ask.quantities import quantities
    from ptmcad.model import ptm
    from ptmcad.question.config import load

    try:
        config = _typed_file(context, ".yaml", ".yml")
        model = _model_of_result(context) or ptm() if config is None else load(config).model
    except (
        PtmcadError,
        OSError,
        ValueError,
    ):  # the command itself will say what is wrong with the file
        return []
    further = model.criterion.differences if "--value" in parameter.opts else ()
    return _begun((*quantities(model), *further), typed)


def _names(context: click.Context) -> tuple[str, ...]:
    """The axes of the record or result that was typed, or else of the default, and the model's
    parameters.
    """
    try:
        if any(parameter.name == "result" for parameter in context.command.params):
            result = _typed_file(context, ".json")
            return () if result is None else _axes_of_result(result)
        return _names_of_question(
            _typed_file(context, ".yaml", ".yml"), context.params.get("mechanism")
        )
    except (
        PtmcadError,
        OSError,
        ValueError,
    ):  # the command itself will say what is wrong with the file
        return ()


def _typed_file(context: click.Context, *suffixes: str) -> Path | None:
    """The first file of these suffixes among the words typed so far.

    Click's own parser gives no arguments where the last word is an option that waits for its value.
    """
    known = shipped_records() if ".yaml" in suffixes else ()
    words = (word for word in context.obj or () if word[:1] != "-")
    return next((Path(word) for word in words if word.endswith(suffixes) or word in known), None)


def _model_of_result(context: click.Context) -> Model | None:
    """Of the stored result that was typed, if one was."""
    from ptmcad.answer.regionmap import RegionMap

    path = _typed_file(context, ".json")
    if path is None or path.stat().st_size > MAX_BYTES:
        return None
    return RegionMap.from_json(path.read_text(encoding="utf-8")).slice.model


def _axes_of_result(path: Path) -> tuple[str, ...]:
    if path.stat().st_size > MAX_BYTES:
        return ()
    data = json.loads(path.read_text(encoding="utf-8"))
    axes = (
        data["slice"]["axes"]
        if isinstance(data, dict) and isinstance(data.get("slice"), dict)
        else {}
    )
    return tuple(axes)


def _names_of_question(config: Path | None, mechanism: str | None) -> tuple[str, ...]:
    from ptmcad.model import ptm
    from ptmcad.question.config import load
    from ptmcad.question.config.modelkeys import model_of
    from ptmcad.question.config.starters import NAMES, starter_text
    from ptmcad.text.yamltree import read_text

    if config is not None:
        asked = load(config)
        return tuple(dict.fromkeys((*asked.axis_names, *asked.model.parameters)))
    if mechanism in NAMES:
        return tuple(model_of(read_text(starter_text(mechanism))).parameters)
    return tuple(ptm().parameters) if mechanism is None else ()


names = proposing(_names)
"""An axis or a parameter of the question's model."""

settings = proposing(_names, after="=")
"""NAME=, of which the value is for the user to say."""

point = proposing(_names, after="=", listed=True)
"""NAME=VALUE,NAME=VALUE, as far as names go."""


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
    if what == "source":
        # as click has it, but where a value goes on (NAME=, X, or a folder) no space follows in bash
        further = "\n            [[ $value == *[=,/] ]] && compopt -o nospace"
        taken = "COMPREPLY+=($value)"
        click.echo(completer.source().replace(taken, taken + further))
    else:
        completer.ctx_args = {"obj": tuple(completer.get_completion_args()[0])}
        click.echo(completer.complete())
    return 0
