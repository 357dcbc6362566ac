"""``ptmcad check``: everything that is wrong with a record, or what it asks and would cost."""

from __future__ import annotations

from pathlib import Path

import click

from ptmcad.cli.commonoptions import (
    clock_stopped,
    limit_options,
    record_argument,
)
from ptmcad.cli.progress import ProgressBar
from ptmcad.errors import MAX_FAULTS, ConfigError, Faults, HypothesisError
from ptmcad.question.config import Family, with_place
from ptmcad.question.config.designed import Design
from ptmcad.question.config.designkey import checked_design
from ptmcad.question.config.familyquestion import checked_family
from ptmcad.question.config.problemrecord import record_of
from ptmcad.question.config.resolution import checked_slice
from ptmcad.question.config.sweeps import Sweeping, checked_sweep
from ptmcad.question.shipped import record_tree
from ptmcad.question.slice import Slice
from ptmcad.text.numerals import shortest_text


@click.command("check")
@record_argument("record", required=True)
@limit_options
def command(*, record: Path, timeout: float | None) -> int:
    """Say everything that is wrong with a problem record (a file, or the name of a shipped one), or what it asks.

    Prints each fault on a line of its own, with file, line and key, and ends with exit status 2. Of a record without
    one, it prints what is asked, how many complex solutions there are, and roughly what the map will cost. Of a
    sweep it prints that of the first member, how many there are, and how long they take, by one of them; of a design
    what is asked, too.

    \b
    Example:
        ptmcad check fig4
    """
    try:
        asked, sweeping, designed = _questions(record)
    except ConfigError as error:
        for fault in error.faults:
            click.echo(f"error: {fault}", err=True)
        if len(error.faults) >= MAX_FAULTS:
            click.echo("after so many faults no more were looked for", err=True)
        return 2
    with clock_stopped(timeout):  # the time that the import takes is not the computation's
        from ptmcad.ask.checking import asked_text, check, cost_text
    slice = (
        asked.member(asked.values[len(asked.values) // 2]) if isinstance(asked, Family) else asked
    )
    for line in asked_text(slice):  # whatever stops the rest, this is known
        click.echo(line)
    try:
        with ProgressBar():
            found = check(slice)
    except (ConfigError, HypothesisError) as error:
        raise with_place(error, record_of(record_tree(record))) from error
    for line in cost_text(found):
        click.echo(line)
    if isinstance(asked, Family):
        click.echo(f"{'family':<12}of {len(asked.values)} such slices, {asked.free.name} from {asked.free.low} to "
                   f"{asked.free.high}; above is the one in the middle")  # fmt: skip
    if designed is not None:
        over = ", ".join(
            f"{a.name} in [{shortest_text(a.low)}, {shortest_text(a.high)}]" for a in designed.over
        )
        of = f" of {designed.along}" if designed.along else ""
        click.echo(
            f"{'design':<12}{designed.maximise}{of} over {over}; above is the record without it"
        )
    if sweeping is not None:
        from ptmcad.workbench.sweeps.run import sweep_text

        for line in sweep_text(sweeping, found):
            click.echo(line)
    return 0


def _questions(path: Path) -> tuple[Slice | Family, Sweeping | None, Design | None]:
    """All that a record asks: the slice or the family, of a sweep its first member; the sweep; and
    the design.

    Raises
    ------
    ConfigError
        For anything wrong in it, with file, line and key; its ``faults`` are all there are.
    """
    tree, faults = record_tree(path), Faults()
    question: Slice | Family | None = None
    sweep = design = None
    with faults:
        if "sweep" in tree.entries:
            sweep = checked_sweep(tree)
            question = sweep.slice(0)
        else:
            question = checked_family(tree) if "free" in tree.entries else checked_slice(tree)
    with faults:
        design = checked_design(tree) if "design" in tree.entries else None
    faults.check()
    assert question is not None
    return question, sweep, design
