"""``ptmcad solve``: every equilibrium at one point, as a table, JSON and pictures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from ptmcad.answer.poses import MAX_DIGITS, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.cli.commonoptions import (
    Formats,
    ResourceLimits,
    clock_stopped,
    compile_certified,
    format_option,
    held,
    idle_output,
    limit_options,
    name_option,
    out_option,
    record_argument,
    report_idle,
)
from ptmcad.cli.completion import point
from ptmcad.cli.drawing import report_written, write_answer
from ptmcad.cli.locate import point_of
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import set_option
from ptmcad.errors import ConfigError
from ptmcad.model import Model
from ptmcad.process.output import check_writable
from ptmcad.question.config import file_name, point_from_options, units_of
from ptmcad.question.shipped import POINT
from ptmcad.show import render
from ptmcad.show.drawable import no_drawing, no_landscape

FORMATS = ("table", "json", "png", "svg", "pdf")
DIGITS = 10


def file_names(name: str, formats: Formats, landscape: bool) -> tuple[str, ...]:
    """The files that are written; the JSON file, which vouches for the pictures, comes last."""
    pictures = [suffix for suffix in formats if suffix not in ("table", "json")]
    names = [f"{name}.{suffix}" for suffix in pictures]
    if landscape:
        names += [f"{name}-landscape.{suffix}" for suffix in pictures or ["png"]]
    return (*names, *([f"{name}.json"] if "json" in formats else []))


def drawable(model: Model, names: tuple[str, ...], start: str, landscape: bool) -> tuple[str, ...]:
    """The files that can be written; the landscape may be asked for beside what there is, and is
    refused at the end.

    Raises
    ------
    ConfigError
        For pictures of a system's poses, where no landscape is asked for.
    """
    landscapes = tuple(name for name in names if name.startswith(f"{start}-landscape."))
    if model.whole is None:
        kept = tuple(name for name in names if name.endswith(".json") or name in landscapes)
        if kept != names and not landscape:
            further = ", or --landscape" if not no_landscape(model) else ""
            raise ConfigError(
                f"{no_drawing(model)}; ask for table or json{further}", key="--format"
            )
        names = kept
    return tuple(name for name in names if name not in landscapes) if no_landscape(model) else names


def save(poses: Poses, folder: Path, name: str, names: tuple[str, ...]) -> None:
    """Write the files of these names, all or none.

    Raises
    ------
    OutputError
        When a file cannot be written.
    """
    landscape = f"{name}-landscape."

    def make(file: str) -> Any:
        return (render.draw_landscape if file.startswith(landscape) else render.draw_poses)(poses)

    write_answer(folder, names, make, poses.to_json)


@click.command("solve")
@record_argument()
@click.option(
    "--at",
    "at",
    metavar="NAME=VALUE,...",
    shell_complete=point,
    help="The point: parameters, or axes of CONFIG, exact numbers.",
)
@set_option
@click.option("--digits", type=click.IntRange(1, MAX_DIGITS), default=DIGITS, show_default=True, metavar="N",
              help="Significant digits, all of them right.")  # fmt: skip
@format_option(FORMATS, "What to make, of {}; the table is printed.", "table")
@out_option
@name_option("poses")
@click.option(
    "--landscape",
    is_flag=True,
    help="Draw the energy over one or two unknowns too (NAME-landscape.png).",
)
@limit_options
def command(
    *,
    config: Path | None,
    at: str | None,
    sets: tuple[str, ...],
    digits: int,
    formats: Formats,
    out: Path,
    name: str | None,
    landscape: bool,
    limits: ResourceLimits,
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
    start = "poses" if name is None else file_name(name, "--name")
    names = file_names(start, formats, landscape)
    with held(limits):
        model, parameters = point_from_options(config, {} if at is None else point_of(at), sets)
        names = drawable(model, names, start, landscape)
        if names:
            check_writable(out, names)
        report_idle(idle_output(names))
        with clock_stopped(
            limits.timeout
        ):  # the time that the import takes is not the computation's
            from ptmcad.ask.solving import needs_intervals, poses_at
        with ProgressBar() as progress:
            if needs_intervals(model, parameters):
                compile_certified(limits.timeout, progress)
            progress("solutions ...", 0, 1)
            poses = replace(
                poses_at(model, parameters, digits),
                units={} if config is None else units_of(config),
            )
            if names:
                save(poses, out, start, names)
    if "table" in formats:
        click.echo(poses.table())
    report_written(out, names)
    if landscape and (reason := no_landscape(model)):
        raise ConfigError(reason, key="--landscape")
    if poses.status is not Status.UNDECIDED:
        return 0
    click.echo(f"undecided: {poses.remark}", err=True)
    return 3
