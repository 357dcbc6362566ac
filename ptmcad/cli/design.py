"""``ptmcad design``: the best design within bounds, with a proof of what no design exceeds."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import click

from ptmcad.cli.commonoptions import (
    Formats,
    check_output,
    clock_stopped,
    format_option,
    gathered,
    limit_options,
    name_option,
    option,
    out_option,
    record_argument,
)
from ptmcad.cli.completion import names, settings
from ptmcad.cli.drawing import report_written, write_answer
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import question_in
from ptmcad.question.config.designkey import design_from_options
from ptmcad.question.shipped import FIRST, SECOND
from ptmcad.show import render
from ptmcad.text.parsing import share_for

FORMATS = ("json", "png", "svg", "pdf")
SEED, BOXES = 1, 100_000
_RESERVE = 0.9
"""Of the time limit for search and proof; the rest is for what is written."""


QUESTION = ("config", "maximise", "along", "over", "pose")
CONDITIONS = ("stable", "tension", "conditions")
"""The options that say what holds of every design."""


@click.command("design")
@record_argument(required=True)
@option(
    "--maximise",
    "range, area, barrier, a quantity such as force:SPRING, or an expression.  [default: range]",
    "WHAT",
)
@option(
    "--along",
    "The axis along which a range lies.  [default: the first]",
    "NAME",
    shell_complete=names,
)
@option(
    "--over",
    "A design parameter with its bounds, in place of all that the record has. Repeatable.",
    "NAME=LO:HI",
    multiple=True,
    shell_complete=settings,
)
@option(
    "--stable", "How many stable poses there are to be.  [default: 2]", "N", click.IntRange(0, 1000)
)
@option("--tension", "All springs are to be in tension.")
@option(
    "--condition conditions",
    f"An inequality of design parameters, such as '{FIRST} + {SECOND} <= 3'. Repeatable.",
    "TEXT",
    multiple=True,
)
@option("--pose", "Of which pose a barrier or a quantity is.  [default: stable:1]", "POSE")
@option(
    "--tolerance",
    "How far the proved bound may lie above the value, as a share of it.  [default: 1/100]",
    "EPS",
    read=share_for,
)
@option("--seed", "Of the global search.", type=click.IntRange(min=0), default=SEED)
@option(
    "--evaluations",
    "Designs that are evaluated before the proof, at most.  [default: by the number of parameters]",
    "N",
    click.IntRange(min=1),
)
@option(
    "--boxes",
    "Boxes of designs that the proof may take.",
    "N",
    click.IntRange(min=1),
    default=BOXES,
)
@out_option
@name_option("NAME-design")
@format_option(FORMATS)
@limit_options
@gathered(where=(CONDITIONS, dict), asked=(QUESTION, dict))
def command(
    *,
    asked: dict[str, Any],
    where: dict[str, Any],
    tolerance: Fraction | None,
    seed: int,
    evaluations: int | None,
    boxes: int,
    out: Path,
    name: str | None,
    formats: Formats,
    timeout: float | None,
) -> int:
    """Find the design that makes a range, an area, a barrier or an expression as large as possible.

    CONFIG is a record, of whose key `design` the options override parts. A global search (differential evolution) looks
    at designs by exact evaluations; then the value at the best one is proved, and, of a range over one or two
    parameters and of an area over one, a bound that no design exceeds. With a limit that ends the proof early
    (--timeout, --boxes) the bound is what is proved so far, and the exit status is 3.

    \b
    Examples:
        ptmcad design fig4 --maximise range --along rho --over L2=1/3:5/3
        ptmcad design fig4 --over L1=1/2:2 --over L2=1/2:2 --condition 'L1+L2<=2'
        ptmcad design fig4 --maximise area --over L1=1/2:1 --tolerance 1/10
        ptmcad design fig4 --maximise barrier --over rho=1/4:2 --over L2=1/4:2
    """
    question = design_from_options(where=where, **asked)
    stem = name or question.name
    wanted = tuple(f"{stem}.{kind}" for kind in sorted(formats, key=lambda kind: kind == "json"))
    check_output(out, wanted)
    with clock_stopped(timeout):  # the time that the import takes is not the computation's
        from ptmcad.workbench.designs.bestdesign import TOLERANCE, design
    with ProgressBar() as progress:
        found = design(
            question,
            tolerance=tolerance or TOLERANCE,
            seed=seed,
            evaluations=evaluations,
            boxes=boxes,
            timeout=None if timeout is None else timeout * _RESERVE,
            progress=progress,
        )
    click.echo(f"{question_in(question.record, question.record.name or stem)}\n{found.table()}")
    write_answer(out, wanted, lambda _: render.figure_of_design(found), found.to_json)
    report_written(out, wanted)
    return 3 if found.bound is not None and found.best is not None and not found.proved else 0
