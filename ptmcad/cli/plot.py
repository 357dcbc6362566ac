"""``ptmcad plot``: pictures and tables of a stored result, made again without computing the map."""

from __future__ import annotations

from pathlib import Path

import click

from ptmcad.cli.drawing import DATA, PICTURES, Drawing, drawing_options, names_of
from ptmcad.cli.idle import idle_drawing, report_idle
from ptmcad.cli.limits import Limits, held, limit_options
from ptmcad.cli.stored import read_result
from ptmcad.cli.values import files
from ptmcad.errors import ConfigError, PictureError, shown_path
from ptmcad.process.output import check_writable, write_files
from ptmcad.question.config import portable_file


@click.command("plot")
@click.argument("result", type=click.Path(path_type=Path), shell_complete=files(".json"))
@click.option("--out", type=click.Path(path_type=Path), help="Folder for the files.  [default: that of RESULT]")
@drawing_options((*PICTURES, *DATA), "png", "What to make")
@limit_options
def command(*, result: Path, out: Path | None, formats: tuple[str, ...], drawing: Drawing, limits: Limits) -> None:
    """Draw RESULT, a JSON file of `ptmcad classify`, or write it as numbers.

    \b
    Example:
        ptmcad classify --slice L2,rho --format json
        ptmcad plot slice-L2-rho.json --format png,svg --dpi 300
        ptmcad plot slice-L2-rho.json --format csv
    """
    report_idle(idle_drawing(formats))
    with held(limits):
        stored = read_result(result)
        folder = result.parent if out is None else out
        portable_file(f"{result.stem}.{formats[0]}", "RESULT")
        check_writable(folder, names_of(result.stem, formats))
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
