"""``ptmcad solve``: every equilibrium at one point, as a table, JSON and pictures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from ptmcad.answer.poses import MAX_DIGITS
from ptmcad.answer.regionmap import Status
from ptmcad.cli.commonoptions import (
    Formats,
    check_output,
    clock_stopped,
    compile_certified,
    format_option,
    limit_options,
    name_option,
    option,
    out_option,
    record_argument,
)
from ptmcad.cli.drawing import report_written, write_answer
from ptmcad.cli.locate import point_option
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import set_option
from ptmcad.errors import ConfigError
from ptmcad.model import Model
from ptmcad.question.config import point_from_options, units_of
from ptmcad.question.shipped import POINT
from ptmcad.show import render
from ptmcad.show.drawable import no_drawing, no_landscape

FORMATS = ("table", "json", "png", "svg", "pdf")
DIGITS = 10


def pictures_of(model: Model, stem: str, formats: Formats, landscape: bool) -> dict[str, str]:
    """The pictures that can be drawn, each with the function of `render` that draws it; a landscape
    may be asked for beside what there is, and is refused at the end.

    Raises
    ------
    ConfigError
        For pictures of a system's poses, where no landscape is asked for.
    """
    kinds = [kind for kind in formats if kind not in ("table", "json")]
    refused, found = no_landscape(model), dict[str, str]()
    if model.whole is not None:
        found |= {f"{stem}.{kind}": "draw_poses" for kind in kinds}
    elif kinds and not landscape:
        further = "" if refused else ", or --landscape"
        raise ConfigError(f"{no_drawing(model)}; ask for table or json{further}", key="--format")
    if landscape and not refused:
        found |= {f"{stem}-landscape.{kind}": "draw_landscape" for kind in kinds or ["png"]}
    return found


@click.command("solve")
@record_argument()
@point_option("The point: parameters, or axes of CONFIG, exact numbers.")
@set_option
@option(
    "--digits",
    "Significant digits, all of them right.",
    "N",
    click.IntRange(1, MAX_DIGITS),
    default=DIGITS,
)
@format_option(FORMATS, "What to make, of {}; the table is printed.", "table")
@out_option
@name_option("poses")
@option("--landscape", "Draw the energy over one or two unknowns too (NAME-landscape.png).")
@limit_options
def command(
    *,
    config: Path | None,
    at: dict[str, str] | None,
    sets: tuple[str, ...],
    digits: int,
    formats: Formats,
    out: Path,
    name: str | None,
    landscape: bool,
    timeout: float | None,
) -> int:
    """Find every equilibrium, or solution of a system, at one point, with stability, spring forces and energy.

    CONFIG is a problem record, by file or name. It gives the parameters that --at and --set do not. Without it,
    parameters that are not given have their defaults: L1 = L2 = rho = 1, k = 100, no load. Every digit that is shown is
    right; a zero or another number that is shown without trailing digits is exact; a degenerate equilibrium is named,
    with its multiplicity. Where not all equilibria are found, as where there are infinitely many, the answer says why,
    and the exit status is 3.

    \b
    Examples:
        ptmcad solve --at rho=1,L2=3/2
        ptmcad solve fig4 --at rho=7/10,L2=3/2 --format table,json,svg
        ptmcad solve fig4 --at rho=7/10,L2=3/2 --digits 30
    """
    if at is None and not sets and config is None:
        raise ConfigError(f"give a point, as in --at {POINT}")
    model, parameters = point_from_options(config, at or {}, sets)
    stem = name or "poses"
    pictures = pictures_of(model, stem, formats, landscape)
    names = (*pictures, *[f"{stem}.json"] * ("json" in formats))  # which vouches for the pictures
    check_output(out, names)
    with clock_stopped(timeout):  # the time that the import takes is not the computation's
        from ptmcad.ask.solving import needs_intervals, poses_at
    with ProgressBar() as progress:
        if needs_intervals(model, parameters):
            compile_certified(timeout, progress)
        progress("solutions ...", 0, 1)
        poses = replace(
            poses_at(model, parameters, digits),
            units={} if config is None else units_of(config),
        )
        write_answer(out, names, lambda file: getattr(render, pictures[file])(poses), poses.to_json)
    if "table" in formats:
        click.echo(poses.table())
    report_written(out, names)
    if landscape and (reason := no_landscape(model)):
        raise ConfigError(reason, key="--landscape")
    if poses.status is not Status.UNDECIDED:
        return 0
    click.echo(f"undecided: {poses.remark}", err=True)
    return 3
