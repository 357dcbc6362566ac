"""``ptmcad stress``: stiff and extreme cases, with the answers of ptmcad and of double precision."""

from __future__ import annotations

from math import inf
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from ptmcad.cli.commonoptions import (
    Formats,
    compile_certified,
    format_option,
    limit_options,
    option,
    out_option,
    report_deadline,
)
from ptmcad.cli.drawing import report_written, write_answer
from ptmcad.cli.progress import ProgressBar
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.process.output import check_writable

if TYPE_CHECKING:
    from ptmcad.studies.stress.case import Case
    from ptmcad.studies.stress.judgement import Row

FORMATS = ("table", "json", "csv", "md", "png", "svg")
NAME = "stress"
GRACE_SECONDS = 60.0
"""Seconds after the time limit for the case that is being run, before the process is ended from
outside.
"""


def save(found: Row, folder: Path, formats: Formats) -> tuple[str, ...]:
    """Write the files of these formats, all or none, and return their names.

    Raises
    ------
    OutputError
        When a file cannot be written.
    """
    from ptmcad.studies.stress.campaign import draw_stress, markdown, to_csv, to_json

    name = NAME if found["complete"] else f"{NAME}.partial"
    texts = {"csv": to_csv, "md": markdown}

    def make(file: str) -> Any:
        kind = file.rpartition(".")[2]
        return texts[kind](found) if kind in texts else draw_stress(found["cases"])

    kinds = [kind for kind in formats if kind not in ("table", "json")]
    kinds += ["json"] * ("json" in formats)
    names = tuple(f"{name}.{kind}" for kind in kinds)
    write_answer(folder, names, make, lambda: to_json(found))
    return names


@click.command("stress")
@click.argument("names", nargs=-1, metavar="[NAMES]...")
@option(
    "--random number",
    "Run N random extreme cases too, or alone when no name is given.",
    "N",
    click.IntRange(0, 100_000),
    default=0,
)
@option("--seed", "Of the random cases.", "N", click.IntRange(0, 2**31), default=1)
@option(
    "--repeats",
    "Timed runs of each case; slow cases have one.",
    "N",
    click.IntRange(1, 1000),
    default=5,
)
@format_option(FORMATS, "What to make; the table is printed.", "table,json,csv,png,svg")
@out_option
@option("--list only_list", "Print the cases with their sources, and run none.")
@limit_options
def command(
    *,
    names: tuple[str, ...],
    number: int,
    seed: int,
    repeats: int,
    formats: Formats,
    out: Path,
    only_list: bool,
    timeout: float | None,
) -> int:
    """Run stiff and extreme cases: springs, lengths and forces of very different size, points next to folds and cusps.

    NAMES are cases or families, or all; without any, all are run. Each case has an answer that is known beforehand,
    from a theorem, a construction or a second method; ptmcad's poses are held against 100 digits, and what double
    precision makes of the same question is shown next to it. Writes stress.json, .csv, .png and .svg, and .md when asked
    for. The exit status is 1 when ptmcad is wrong anywhere, or undecided.

    \b
    Examples:
        ptmcad stress --list
        ptmcad stress stiffness fold-many-1e-30 --format table
        ptmcad stress --random 100 --seed 7 --format table
        ptmcad stress all --random 100
    """
    limit = None if timeout is None else timeout + GRACE_SECONDS
    report_deadline(limit)  # of the process; the campaign looks at the clock itself
    from ptmcad.studies.stress.case import free_lengths  # the cases' numbers need no library

    cases = _cases(names, number, seed, everything=only_list)
    if only_list:
        from ptmcad.studies.stress.campaign import listing

        click.echo(listing(cases))
        return 0
    files = [kind for kind in formats if kind != "table"]
    if files:
        check_writable(out, tuple(f"{NAME}.{kind}" for kind in files))
    from ptmcad.studies.stress.campaign import campaign, summary, table

    if any(free_lengths(case.question.parameters) for case in cases):
        with ProgressBar() as progress:
            compile_certified(limit, progress)
    deadline = perf_counter() + (timeout or inf)
    with ProgressBar() as progress:
        found = campaign(cases, seed=seed, repeats=repeats, deadline=deadline, progress=progress)
    written = save(found, out, formats)
    click.echo(
        table(found, len(cases)) if "table" in formats else "\n".join(summary(found, len(cases)))
    )
    report_written(out, written)
    if not found["complete"]:
        raise LimitReached(
            f"the time limit was reached after {len(found['cases'])} of {len(cases)} cases"
        )
    return 0 if all(row["right"] for row in found["cases"]) else 1


def _cases(names: tuple[str, ...], number: int, seed: int, *, everything: bool) -> tuple[Case, ...]:
    """The named cases, unless only random ones are asked for, and the random ones."""
    from ptmcad.studies.stress.case import chosen

    found = chosen(names) if names or not number or everything else ()
    if number:
        from ptmcad.studies.stress.campaign import random_case

        found = (*found, *(random_case(seed, k) for k in range(number)))
    if not found:
        raise ConfigError("no case is asked for", key="NAMES")
    return found
