"""``ptmcad animate``: the motion of a mechanism along a path of its map, through the snap, as GIF
or MP4.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from math import degrees, remainder
from pathlib import Path

import click

from ptmcad.answer.motion import Fall, Motion
from ptmcad.answer.words import assignments
from ptmcad.cli.commonoptions import (
    Formats,
    format_option,
    gathered,
    limit_options,
    name_option,
    option,
    out_option,
    report_deadline,
)
from ptmcad.cli.drawing import picture, report_written, style_of
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import question_of, slice_options
from ptmcad.cli.storedresults import made_map, stored_in, stored_map, tolerance_option
from ptmcad.errors import ConfigError
from ptmcad.extras import require_ffmpeg
from ptmcad.options import Options
from ptmcad.process.output import check_writable, write_files
from ptmcad.question.config import slice_from_typed
from ptmcad.question.config.typed import Typed
from ptmcad.question.shipped import FIRST, SECOND
from ptmcad.show import render
from ptmcad.show.drawable import no_drawing
from ptmcad.show.style import PictureStyle
from ptmcad.text.numerals import equalities

FORMATS = ("gif", "mp4")
MAX_FPS = 60


@click.command("animate")
@slice_options
@option(
    "--path",
    "Where the point of the map goes: for each axis one value, or one for each corner, as in "
    f"{SECOND}=3/4:6/5:3/4,{FIRST}=3/2.",
    "NAME=FROM:TO,NAME=VALUE",
    required=True,
)
@option(
    "--pose",
    "Which pose is followed, as `ptmcad map` numbers them, at the path's start.",
    "KIND:N",
    default="stable:1",
)
@option(
    "--frames",
    "Pictures along the path; each fall has a third of that in addition.",
    type=click.IntRange(2, 600),
    default=90,
)
@option("--fps", "Pictures in a second.", type=click.IntRange(1, MAX_FPS), default=20)
@option("--size", "Of the film, as 9x5in.  [default: 9x5.1in]", "WxH")
@option("--dpi", "Pixels to the inch.", type=click.IntRange(50, 400), default=100)
@option("--palette", "As of `ptmcad plot`.  [default: default]", "NAME|COLOUR,..")
@option("--title", "Title, '' for none.  [default: the slice's heading]", "TEXT")
@tolerance_option
@out_option
@name_option("NAME-motion")
@format_option(FORMATS, "Files to write, of {}; mp4 needs the program ffmpeg.", "gif")
@limit_options
@gathered(style=(("size", "palette", "title"), partial(style_of, style="default")))
def command(
    *, asked: Typed, path: str, pose: str, frames: int, fps: int, style: PictureStyle, dpi: int,
    tolerance: Fraction, out: Path, name: str | None, formats: Formats, timeout: float | None,
) -> None:  # fmt: skip
    """Show the mechanism moving along a path of parameters, and where it snaps.

    CONFIG is a problem record, or a stored result of `ptmcad classify`. The map is at the left, with the point that
    moves; at the right the mechanism, and below the energy of its pose. Each frame shows an equilibrium, one of as many
    as the exact map counts there. Where the pose vanishes, the frames show the way down to the next one by steepest
    descent, and say so.

    \b
    Examples:
        ptmcad animate fig4 --path rho=3/4:6/5,L2=3/2 --pose stable:2
        ptmcad animate --slice L2,rho --path L2=3/2:2/3:3/2,rho=1 --fps 10
    """
    if "mp4" in formats:
        require_ffmpeg()  # where it is missing, that is said before anything is computed
    report_deadline(timeout)
    with ProgressBar() as progress:
        options = Options(areas=False, progress=progress, timeout=timeout)
        stored = stored_map(asked)
        slice = stored.slice if stored else slice_from_typed(asked)
        if slice.model.drawable is None:
            raise ConfigError(no_drawing(slice.model))
        result = stored or made_map(slice, options, tolerance)
        stem = name or f"{slice.name}-motion"
        names = tuple(f"{stem}.{kind}" for kind in formats)
        check_writable(out, names)
        from ptmcad.workbench.fields.posemotion import motion_of

        with stored_in(asked.config if stored else None):
            motion = motion_of(result, path, pose, frames, progress)
            film = {
                each: picture(each, lambda path: render.save_film(motion, path, style, fps, dpi))
                for each in names
            }
            write_files(out, film)
    click.echo(f"{question_of(slice)}\n{summary(motion)}")
    report_written(out, names)


def summary(motion: Motion) -> str:
    """What the film shows, in words."""
    still = sum(not step.falling for step in motion.steps)
    counted = "each" if motion.counted == still else f"{motion.counted} of them"
    lines = [
        f"{motion.pose}: {len(motion.steps)} frames, {still} of equilibria, {counted} one of as many as are counted "
        "exactly there"
    ]
    lines += [_in_words(motion, fall) for fall in motion.falls]
    if motion.end:
        lines.append(f"the film ends early: {motion.end}")
    elif not motion.falls:
        lines.append("the pose does not vanish on this path")
    return "\n".join(lines)


def _in_words(motion: Motion, fall: Fall) -> str:
    slice = motion.result.slice
    model = slice.model
    where = equalities(dict(zip(slice.axis_names, fall.at, strict=True)), "{:.6g}".format)
    turns = len(model.angles)
    angles = (f"{remainder(degrees(angle), 360):.2f}°" for angle in fall.after[:turns])
    unknowns = assignments(model, angles, (f"{x:.6g}" for x in fall.after[turns:]))
    return (
        f"snap at {where}: the pose vanishes and falls to {', '.join(unknowns)}, where the energy is lower by "
        f"{fall.drop:.4g} (steepest descent, floating point)"
    )
