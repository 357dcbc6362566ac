"""``ptmcad plot``: pictures and tables of a stored result, made again without computing the map."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli.drawing import DATA, PICTURES, Drawing, drawing_options, names_of
from ptmcad.cli.limits import Limits, held, limit_options
from ptmcad.cli.points import measured, places, poses_at
from ptmcad.cli.stored import read_result
from ptmcad.errors import ConfigError, PictureError, shown_path
from ptmcad.process.output import check_writable, write_files
from ptmcad.question.config import portable_file


def _with_points(stored: RegionMap, drawing: Drawing, overlay: Path | None, at: tuple[str, ...]) -> Drawing:
    """The drawing with measured points, and with the poses at points; both are checked before poses are computed."""
    chosen = places(stored, at)
    if overlay is not None:
        found, outside = measured(stored, overlay)
        drawing = replace(drawing, overlay=found)
        if outside:
            click.echo(f"{outside} of {outside + len(found)} points are outside of the window and left out", err=True)
    return replace(drawing, poses=tuple((place, poses_at(stored, place)) for place in chosen))


@click.command("plot")
@click.argument("result", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder for the files.  [default: that of RESULT]")
@drawing_options((*PICTURES, *DATA), "png", "What to make")
@click.option(
    "--overlay",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="A CSV file of points to draw on the map: columns named like the axes, and label and count if there are.",
)
@click.option(
    "--at",
    multiple=True,
    metavar="NAME=VALUE,NAME=VALUE",
    help="Draw the stable poses at a point beside the map, with a line to it. Repeatable.",
)
@limit_options
def command(
    *, result: Path, out: Path | None, formats: tuple[str, ...], drawing: Drawing, overlay: Path | None,
    at: tuple[str, ...], limits: Limits,
) -> None:  # fmt: skip
    """Draw RESULT, a JSON file of `ptmcad classify`, or write it as numbers.

    \b
    Example:
        ptmcad classify --slice L2,rho --format json
        ptmcad plot slice-L2-rho.json --format png,svg --dpi 300
        ptmcad plot slice-L2-rho.json --format csv
        ptmcad plot slice-L2-rho.json --style ieee --legend below --format pgf
        ptmcad plot slice-L2-rho.json --at L2=1,rho=1 --at L2=3,rho=1/2 --format pdf
        ptmcad plot slice-L2-rho.json --overlay measured.csv
    """
    with held(limits):
        stored = read_result(result)
        folder = result.parent if out is None else out
        portable_file(f"{result.stem}.{formats[0]}", "RESULT")
        check_writable(folder, names_of(result.stem, formats))
        drawing = _with_points(stored, drawing, overlay, at)
        try:
            written = write_files(folder, drawing.writers(stored, result.stem, formats))
        except PictureError as error:
            cause = error.__cause__
            if isinstance(cause, ConfigError):
                raise ConfigError(cause.message, file=str(result)) from error
            if not isinstance(cause, (ValueError, IndexError, ArithmeticError)):
                raise
            reason = f"the map contradicts itself ({cause}); check it with ptmcad verify"
            raise ConfigError(reason, file=str(result)) from error
    for path in written:
        click.echo(shown_path(path))
