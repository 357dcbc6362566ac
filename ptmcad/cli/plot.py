"""``ptmcad plot``: pictures of a stored result, drawn again without computing anything."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from ptmcad.cli.formats import formats_of
from ptmcad.cli.limits import Limits, held, limit_options
from ptmcad.cli.pictures import picture
from ptmcad.cli.stored import read_result
from ptmcad.errors import ConfigError, PictureError, shown_path
from ptmcad.process.output import check_writable, write_files
from ptmcad.question.config import portable_file

FORMATS = ("png", "svg", "pdf")


@click.command("plot")
@click.argument("result", type=click.Path(path_type=Path))
@click.option("--format", "formats", callback=partial(formats_of, known=FORMATS), default="png", show_default=True,
              metavar="LIST", help=f"What to draw, of {', '.join(FORMATS)}.")  # fmt: skip
@click.option("--out", type=click.Path(path_type=Path), help="Folder for the pictures.  [default: that of RESULT]")
@click.option("--dpi", type=click.IntRange(50, 1200), default=150, show_default=True,
              help="Resolution of a PNG; regions that it hides are shown zoomed, in every format.")  # fmt: skip
@click.option("--samples", is_flag=True, help="Draw the cells' sample points.")
@limit_options
def command(
    *,
    result: Path,
    formats: tuple[str, ...],
    out: Path | None,
    dpi: int,
    samples: bool,
    limits: Limits,
) -> None:
    """Draw RESULT, a JSON file of `ptmcad classify`.

    \b
    Example:
        ptmcad classify --slice L2,rho --format json
        ptmcad plot slice-L2-rho.json --format png,svg --dpi 300
    """
    with held(limits):
        stored = read_result(result)
        folder = result.parent if out is None else out
        portable_file(f"{result.stem}.{formats[0]}", "RESULT")
        check_writable(folder, tuple(f"{result.stem}.{suffix}" for suffix in formats))

        def draw(path: Path) -> None:
            from ptmcad.show.render import draw as drawn  # brings matplotlib

            drawn(stored, path, samples=samples, dpi=dpi)

        names = [f"{result.stem}.{suffix}" for suffix in formats]
        try:
            written = write_files(folder, {name: picture(name, draw) for name in names})
        except PictureError as error:
            cause = error.__cause__
            if not isinstance(cause, (ValueError, IndexError, ArithmeticError)):
                raise
            reason = f"the map contradicts itself ({cause}); check it with ptmcad verify"
            raise ConfigError(reason, file=str(result)) from error
    for path in written:
        click.echo(shown_path(path))
