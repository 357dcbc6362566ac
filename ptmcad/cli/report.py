"""``ptmcad report``: a stored result as one HTML page that needs nothing else."""

from __future__ import annotations

from pathlib import Path

import click

from ptmcad.cli.commonoptions import (
    PATH,
    limit_options,
    option,
    result_argument,
)
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.storedresults import read_result
from ptmcad.errors import blamed, shown_path
from ptmcad.process.output import check_writable, text_writer, write_files
from ptmcad.question.config import file_name, portable_file


def _file_name(key: str, value: str) -> str:
    return file_name(value.removesuffix(".html"), key)


@click.command("report")
@result_argument
@option("--out", "Folder for the page.  [default: that of RESULT]", type=PATH)
@option("--name", "Name of the page.  [default: that of RESULT]", "NAME", read=_file_name)
@option(
    "--bench",
    "A measurement of error against time to show.  "
    "[default: NAME.error-time.json beside RESULT, if there is one]",
    "FILE",
    PATH,
)
@option("--no-timings", "Leave run times out, so that the page is the same every time.")
@limit_options
def command(
    *,
    result: Path,
    out: Path | None,
    name: str | None,
    bench: Path | None,
    no_timings: bool,
) -> None:
    """Write RESULT, a JSON file of `ptmcad classify`, as one HTML page.

    The page works from a file without a network: the map, the poses and the energy of every cell, the curves' formulas,
    what was left out, and how to compute and check the result again.

    \b
    Example:
        ptmcad classify --slice L2,rho --format json
        ptmcad report slice-L2-rho.json
    """
    with ProgressBar():
        stored = read_result(result)
        folder = out or result.parent
        file = portable_file(f"{name or result.stem}.html", "--name")
        check_writable(folder, (file,))
        from ptmcad.show.report import page
        from ptmcad.show.report.error_curve import read_error_curve

        beside = result.with_name(f"{stored.slice.name}.error-time.json")
        curve = bench or (beside if beside.is_file() else None)
        errors = None if curve is None else read_error_curve(curve)
        with blamed(file=result):
            text = page(stored, timings=not no_timings, errors=errors)
        (written,) = write_files(folder, {file: text_writer(text)})
    click.echo(f"{shown_path(written)}  {len(text.encode()) / 1e6:.2f} MB")
