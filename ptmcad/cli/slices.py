"""The options that ask about a slice, and the question as a terminal's answer begins with it: windows,
values that are not defaults, and the kind of count.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import wraps
from textwrap import fill
from typing import Any, NamedTuple

import click

from ptmcad.cli.commonoptions import F, gathered, option, record_argument, together
from ptmcad.cli.completion import mechanisms, pair_of_names, settings
from ptmcad.errors import ConfigError, HypothesisError, PtmcadError, shown
from ptmcad.model import Model
from ptmcad.question.config import (
    Family,
    question_from_options,
    record_from_options,
    with_place,
)
from ptmcad.question.config.problemrecord import Record
from ptmcad.question.config.typed import Typed
from ptmcad.question.slice import Slice, merged
from ptmcad.text.numerals import shortest_text

BETWEEN = "between"
"""In place of the members' values."""


class Third(NamedTuple):
    """What was typed of a family: its free parameter, its members, and whether its changes and
    surface are wanted.
    """

    free: str | None
    members: str | None
    changes: bool
    surface: bool

    @property
    def between(self) -> bool:
        """Whether a member is wanted between each two neighbouring changes."""
        return self.members == BETWEEN


LINE = ("config", "slice", "sets", "ranges")
"""The options of a record and of what changes it."""


def question_asked(asked: Typed, count: str | None, third: Third) -> Slice | Family:
    """The slice that is meant, or the family where a third parameter is free.

    Raises
    ------
    ConfigError
        For anything wrong with the record or the options.
    """
    members = None if third.between else third.members
    return question_from_options(asked._replace(counting=count, free=third.free, members=members))


def _with_places(command: F) -> F:
    @wraps(command)
    def placed(*, asked: Typed, **given: Any) -> Any:
        try:
            return command(asked=asked, **given)
        except (ConfigError, HypothesisError) as error:
            raise _placed(error, asked._replace(counting=given.get("count"))) from error

    return placed  # type: ignore[return-value]


def _placed(error: ConfigError | HypothesisError, asked: Typed) -> PtmcadError:
    """A fault of the question with its place, as far as the record or the options can still be read
    for it.
    """
    try:
        return with_place(error, record_from_options(asked))
    except ConfigError:  # it is this one
        return error


range_option = option(
    "--range ranges", "The range of an axis.", "NAME=LO:HI", multiple=True, shell_complete=settings
)
set_option = option(
    "--set sets",
    "Fix a parameter: a number or an expression.",
    "NAME=VALUE",
    multiple=True,
    shell_complete=settings,
)


engine_option = option(
    "--engine", "", type=click.Choice(["auto", "exact", "certified"]), default="auto"
)


def slice_options(command: F) -> F:
    """Add CONFIG, ``--mechanism``, ``--slice``, ``--set`` and ``--range``, which the command gets
    as ``asked``.

    What an engine finds wrong with the question is reported with its place in the record.
    """
    return together(
        record_argument(),
        option("--mechanism", "Without CONFIG: the mechanism.  [default: ptm]", "NAME|FILE", shell_complete=mechanisms),
        option("--slice", "The two axes, the horizontal one first.", "X,Y", shell_complete=pair_of_names),
        set_option,
        range_option,
        gathered(asked=((*LINE, "mechanism"), Typed)),
        _with_places,
    )(command)  # fmt: skip


MAX_VALUE = 40
"""Characters of a value."""


def question_of(slice: Slice) -> str:
    """The question that a slice is."""
    known, written = merged(slice.text, slice.model), slice.text
    # of a shorthand that a text names what was written, not its own name
    values = {
        n: written.get(n, known.get(n, ""))
        for n in (*written, *known)
        if n in known or n in slice.model.shorthands
    }
    windows = {
        axis.name: f"{shortest_text(axis.low)}, {shortest_text(axis.high)}" for axis in slice.axes
    }
    return _lines(slice.name, windows, values, slice.model, f"; count {slice.count.value}")


def question_in(record: Record, name: str) -> str:
    """The question of a record of which a family, a sweep or a design is made: values as they are
    written.
    """
    values = {name: scalar.text for name, scalar in record.values.items()}
    windows = {
        name: f"{window.low.text}, {window.high.text}" for name, window in record.axes.items()
    }
    return _lines(
        name,
        windows,
        values,
        record.model,
        f"; count {record.counting.value}" if record.counting else "",
    )


def _lines(
    name: str, windows: Mapping[str, str], values: Mapping[str, str], model: Model, counted: str
) -> str:
    defaults = {name: parameter.default for name, parameter in model.parameters.items()}
    fixed = [
        f"{n} = {shown(v, MAX_VALUE)}"
        for n, v in values.items()
        if n not in windows and v != defaults.get(n)
    ]
    axes = ", ".join(f"{axis} in [{window}]" for axis, window in windows.items())
    text = f"{name}: {axes}{'; ' * bool(fixed)}{', '.join(fixed)}{counted}"
    for inside in (" = ", " in [", "count "):  # a line does not end there
        text = text.replace(inside, inside.replace(" ", "\N{NO-BREAK SPACE}"))
    lines = fill(
        text, 80, initial_indent="question  ", subsequent_indent=" " * 10, break_long_words=False
    )
    return lines.replace("\N{NO-BREAK SPACE}", " ")
