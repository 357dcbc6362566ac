"""``ptmcad sweep``: every member of a record's sweep classified, by all processors or a cluster,
into a folder.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import click

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.sweep import State, Sweep
from ptmcad.cli.commonoptions import (
    PATH,
    Formats,
    format_option,
    gathered,
    limit_options,
    option,
    record_argument,
    report_deadline,
)
from ptmcad.cli.completion import names
from ptmcad.cli.drawing import picture, report_written, writer
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import engine_option, question_in
from ptmcad.errors import ConfigError, shown_path
from ptmcad.extras import require, require_ffmpeg
from ptmcad.process.handover import Topic, send
from ptmcad.process.output import check_writable, write_files
from ptmcad.question.config.sweeps import sweep_from
from ptmcad.show import render
from ptmcad.show.style import DEFAULT
from ptmcad.text.parsing import share_for

FORMATS = ("csv", "html", "gif", "mp4")
MEMBER = (
    "engine", "tolerance", "area_tolerance", "no_areas", "along", "no_ranges", "member_timeout",
)  # fmt: skip
"""The options that say what is wanted of each member, by their parameters' names."""
RETRIES = 2
MAX_FRAMES = 240
"""Pictures of a film; of more members some at equal distances are shown."""


def _wanted(
    *, no_areas: bool, no_ranges: bool, member_timeout: float | None, **named: Any
) -> dict[str, Any]:
    """What is wanted of each member, by the names of `Wanted`."""
    if no_ranges and named["along"] is not None:
        raise ConfigError(
            "ranges are not asked for, but their axis is given: leave one out", key="--no-ranges"
        )
    if no_areas and named["area_tolerance"] is not None:
        raise ConfigError(
            "areas are not asked for, but a tolerance is given: leave one out", key="--no-areas"
        )
    along = "" if no_ranges else named.pop("along")
    return {**named, "areas": not no_areas, "along": along, "timeout": member_timeout}


@click.command("sweep")
@record_argument(required=True)
@option("--out", "Folder of the sweep.  [default: NAME-sweep]", type=PATH)
@format_option(
    FORMATS,
    "What to write of the whole sweep besides the index and the results: csv (a line for each member), "
    "html (an atlas), gif or mp4 (a film of the maps).",
)
@option("--fps", "Pictures of a film in a second.", type=click.IntRange(1, 60), default=8)
@option(
    "--jobs",
    "Number of worker processes on this machine.  [default: all processors]",
    "N",
    click.IntRange(min=1),
)
@option(
    "--scheduler",
    "Address of a Dask scheduler, such as tcp://host:8786, whose workers compute instead; needs the "
    "extra ptmcad[distributed].",
    "URL",
)
@option(
    "--retries",
    "How often a member is tried again whose process died, or which a limit stopped.",
    type=click.IntRange(0, 100),
    default=RETRIES,
)
@engine_option
@option(
    "--along",
    "The axis along which the widest operation range is found.  [default: the first]",
    "NAME",
    shell_complete=names,
)
@option("--no-ranges", "Leave the widest operation ranges out, often most of the work.")
@option("--no-areas", "Leave the regions' areas out.")
@option(
    "--tolerance",
    "Stop a member when this share of the window is undetermined (certified engine).",
    "EPS",
    read=share_for,
)
@option(
    "--area-tolerance", "Relative width of the areas' bounds (exact engine).", "EPS", read=share_for
)
@option(
    "--member-timeout",
    "Stop a member after S seconds, which is then a failure.",
    "S",
    click.FloatRange(min=0, min_open=True, max=1e9),
)
@limit_options
@gathered(asked=(MEMBER, _wanted))
def command(
    *, config: Path, out: Path | None, formats: Formats, fps: int, asked: dict[str, Any], jobs: int | None,
    scheduler: str | None, retries: int, timeout: float | None,
) -> int:  # fmt: skip
    """Classify every member of a sweep.

    CONFIG is a record with the key `sweep`, which gives values to parameters: lists, ranges, and all combinations of
    several. The folder gets an index of all members (index.sqlite: counts, areas, operation ranges, status, time) and
    the result of each as JSON, which `locate`, `verify`, `report` and `plot` take. Members with the same slice are
    computed once.

    Stopped by whatever, the same command goes on: no member is computed again that is done. A member that fails is
    recorded with the reason, tried again, and stops no other; while there are such the exit status is 3.

    \b
    Examples:
        ptmcad sweep loads.yaml --format csv,html
        ptmcad sweep loads.yaml --jobs 2 --no-ranges --out family
        ptmcad sweep loads.yaml --scheduler tcp://localhost:8786
    """
    question = sweep_from(config)
    if scheduler is not None:
        require("distributed", key="--scheduler")
    if "mp4" in formats:
        require_ffmpeg()
    folder = out or Path(f"{question.name}-sweep")
    wanted_files = tuple(f"{question.name}.{kind}" for kind in formats)
    report_deadline(timeout)
    with ProgressBar() as progress:
        from ptmcad.workbench.sweeps.run import sweep, wanted_of

        wanted = wanted_of(question, asked)
        check_writable(folder, wanted_files)
        send(Topic.RESUMABLE, f"what is done is in {folder}; the same command goes on")
        found = sweep(question, folder, jobs, scheduler, wanted, retries, timeout, progress)
        if wanted_files:
            made: dict[str, Callable[[], str]] = {
                "csv": found.to_csv,
                "html": partial(_atlas, found, jobs, progress),
            }
            film = partial(_film, found, fps, progress)
            files = zip(wanted_files, formats, strict=True)
            write_files(
                folder,
                {n: writer(n, made[k]) if k in made else picture(n, film) for n, k in files},
            )
    click.echo(f"{question_in(question.record, question.name)}\n{found.table()}")
    report_written(folder, wanted_files)
    return _status(found)


def _atlas(sweep: Sweep, jobs: int | None, progress: ProgressBar) -> str:
    from ptmcad.show.report.atlas import atlas, chosen, frame_of
    from ptmcad.workbench.sweeps.index import members
    from ptmcad.workbench.sweeps.run import sketches

    shown = list(members(sweep, chosen(sweep)))
    done = [member.number for member in shown if member.state is State.DONE]
    drawn = dict(sketches(sweep.folder, done, jobs, progress))
    frame = frame_of(sweep, _some(sweep).slice, drawn.values())
    return atlas(sweep, frame, shown, drawn)


def _film(sweep: Sweep, fps: int, progress: ProgressBar, path: Path) -> None:
    done = [member for member in sweep if member.state is State.DONE]
    every = -(-len(done) // MAX_FRAMES)
    shown = done[::every]

    def seen(number: int) -> RegionMap:
        progress("pictures", number, len(shown))
        return sweep.result(shown[number].number)

    _some(sweep)
    values = [member.parameters for member in shown]
    render.save_pictures(lambda: render.sweep_pictures(seen, values), path, DEFAULT, fps)


def _some(sweep: Sweep) -> RegionMap:
    """The map of the first member that has one.

    Raises
    ------
    ConfigError
        When none has.
    """
    first = next((member for member in sweep if member.state is State.DONE), None)
    if first is None:
        raise ConfigError("no member has a map, so there is nothing to draw", key="--format")
    return sweep.result(first.number)


def _status(found: Sweep) -> int:
    """The exit status, after what there is to say of members without a result."""
    missing = {state: number for state, number in found.states.items() if state is not State.DONE}
    if not missing:
        return 0
    said = ", ".join(f"{number} {state.value}" for state, number in missing.items())
    first = next((member for member in found if member.state is not State.DONE), None)
    why = "" if first is None else f"; the first is member {first.number}: {first.error}"
    click.echo(
        f"stopped: {said} of {len(found)} members, see {shown_path(found.folder)}{why}", err=True
    )
    return 3
