"""What the commands share that ask about a slice: the record and the options that change it.

Guarantee: every such command takes the same words for the same slice.
"""

from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple

import click

from ptmcad.cli.gathering import F, gathered
from ptmcad.cli.paths import record_argument
from ptmcad.cli.values import mechanisms, pair_of_names, settings
from ptmcad.errors import ConfigError, HypothesisError, PtmcadError
from ptmcad.question.config import (
    Family,
    question_from_options,
    record_from_options,
    slice_from_options,
    with_place,
)
from ptmcad.question.config.options import Typed
from ptmcad.question.config.record import Record
from ptmcad.question.slice import Slice

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


class SliceOptions(NamedTuple):
    """The record and what changes it, as they were typed."""

    config: Path | None
    axes: str | None
    sets: tuple[str, ...]
    ranges: tuple[str, ...]
    mechanism: str | None

    def slice(self, count: str | None = None) -> Slice:
        """The slice that is meant.

        Raises
        ------
        ConfigError
            For anything wrong with the record or the options.
        """
        return slice_from_options(
            self.config, self.axes, self.sets, self.ranges, count, self.mechanism
        )

    def record(self, free: str | None) -> Record:
        """The record that is meant, in which a parameter may be free.

        Raises
        ------
        ConfigError
            For anything wrong with the record's keys or the options.
        """
        return record_from_options(self._typed(None)._replace(free=free))

    def placed(self, error: ConfigError | HypothesisError, count: str | None = None) -> PtmcadError:
        """A fault of the question with its place, as far as the record or the options can still be
        read for it.
        """
        try:
            return with_place(error, record_from_options(self._typed(count)))
        except ConfigError:  # it is this one
            return error

    def question(self, count: str | None, third: Third) -> Slice | Family:
        """The slice that is meant, or the family where a third parameter is free.

        Raises
        ------
        ConfigError
            For anything wrong with the record or the options.
        """
        members = None if third.between else third.members
        return question_from_options(self._typed(count)._replace(free=third.free, members=members))

    def _typed(self, count: str | None) -> Typed:
        return Typed(self.config, self.axes, self.sets, self.ranges, count, self.mechanism)


def _with_places(command: F) -> F:
    @wraps(command)
    def placed(*, asked: SliceOptions, **given: Any) -> Any:
        try:
            return command(asked=asked, **given)
        except (ConfigError, HypothesisError) as error:
            raise asked.placed(error, given.get("count")) from error

    return placed  # type: ignore[return-value]


range_option = click.option(
    "--range",
    "ranges",
    multiple=True,
    metavar="NAME=LO:HI",
    shell_complete=settings,
    help="The range of an axis.",
)
set_option = click.option(
    "--set", "sets", multiple=True, metavar="NAME=VALUE", shell_complete=settings,
    help="Fix a parameter: a number or an expression.",
)  # fmt: skip


engine_option = click.option(
    "--engine", type=click.Choice(["auto", "exact", "certified"]), default="auto", show_default=True
)


def slice_options(command: F) -> F:
    """Add CONFIG, ``--mechanism``, ``--slice``, ``--set`` and ``--range``, which the command gets
    as ``asked``.

    What an engine finds wrong with the question is told with its place in the record.
    """
    command = gathered(asked=SliceOptions)(_with_places(command))
    for add in (
        range_option,
        set_option,
        click.option("--slice", "axes", metavar="X,Y", shell_complete=pair_of_names,
                     help="The two axes, the horizontal one first."),
        click.option("--mechanism", metavar="NAME|FILE", shell_complete=mechanisms,
                     help="Without CONFIG: the mechanism.  [default: ptm]"),
        record_argument(),
    ):  # fmt: skip
        command = add(command)
    return command
