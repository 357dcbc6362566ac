"""``ptmcad range``: intervals of constant count along one axis, and the operation range."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import click

from ptmcad.cli.limits import limit_options, limits
from ptmcad.cli.locate import point_of
from ptmcad.config import PARAMETERS, load, slice_from_options
from ptmcad.errors import ConfigError
from ptmcad.memory import Bound
from ptmcad.output import Writer, check_writable, text_writer, write_files
from ptmcad.slice import Slice

FORMATS = ("json", "png", "svg", "pdf")


def slice_and_line(
    config: Path | None,
    axes: str | None,
    along: str,
    at: dict[str, str],
    over: str | None,
    sets: tuple[str, ...],
    ranges: tuple[str, ...],
) -> tuple[Slice, dict[str, str]]:
    """The slice that holds the line, and the value of its other axis.

    Every name of ``at`` but that of the other axis fixes a parameter. The other axis is ``over``, or the record's when
    ``along`` is an axis of it, or else the first one of ``at``.

    Raises
    ------
    ConfigError
        For anything wrong with the record or the options.
    """
    given = _axes(config, axes)
    if over is not None:
        other = over
    elif along in given:
        other = given[1 - given.index(along)]
    else:
        other = next((n for n in given if n in at), next(iter(at), ""))
    if not other:
        raise ConfigError(f"give the values at which {along} varies, as in L2=3/2", key="--at")
    if along == other:
        raise ConfigError(f"{along} varies along the line: it has no fixed value", key="--at")
    if over is None and other not in at:
        raise ConfigError(f"the other axis, {other}, has no value: add {other}=VALUE", key="--at")
    fixed = tuple(f"{name}={value}" for name, value in at.items() if name != other)
    for name in at:
        if name != other and name not in PARAMETERS:
            raise ConfigError(f"'{name}' is neither an axis nor a parameter", key="--at")
    asked = None if {along, other} == set(given) else f"{along},{other}"
    slice = slice_from_options(config, axes if asked is None else asked, (*sets, *fixed), ranges)
    return slice, {other: at[other]} if other in at else {}


def _axes(config: Path | None, axes: str | None) -> tuple[str, ...]:
    """The axes' names before the options of the line are looked at."""
    if axes is not None:
        return tuple(name.strip() for name in axes.split(","))
    return () if config is None else load(config).axis_names


def _formats(_context: click.Context, _parameter: click.Parameter, value: str) -> tuple[str, ...]:
    formats = tuple(dict.fromkeys(part.strip().lower() for part in value.split(",") if part.strip()))
    unknown = [part for part in formats if part not in FORMATS]
    if unknown:
        raise click.BadParameter(f"{', '.join(unknown)} is not among {', '.join(FORMATS)}")
    return formats


@click.command("range")
@click.argument("config", required=False, type=click.Path(path_type=Path))
@click.option("--along", required=True, metavar="NAME", help="The parameter or axis that varies.")
@click.option("--at", "at", metavar="NAME=VALUE,...", help="What is fixed: the slice's other axis, any parameters.")
@click.option("--slice", "axes", metavar="X,Y", help="The slice's two axes, where a name is no parameter.")
@click.option("--set", "sets", multiple=True, metavar="NAME=VALUE", help="Fix a parameter: a number or an expression.")
@click.option("--range", "ranges", multiple=True, metavar="NAME=LO:HI", help="The range of an axis.")
@click.option("--digits", type=click.IntRange(1, 1000), default=10, show_default=True, help="Digits of decimals.")
@click.option("--out", type=click.Path(path_type=Path), default=Path(), help="Folder for the files.  [default: .]")
@click.option("--name", metavar="NAME", help="Start of the files' names.  [default: NAME-range]")
@click.option("--format", "formats", callback=_formats, default="", metavar="LIST",
              help=f"Files to write, of {', '.join(FORMATS)}.  [default: none]")  # fmt: skip
@limit_options
def command(
    *,
    config: Path | None,
    along: str,
    at: str | None,
    axes: str | None,
    sets: tuple[str, ...],
    ranges: tuple[str, ...],
    digits: int,
    out: Path,
    name: str | None,
    formats: tuple[str, ...],
    timeout: float | None,
    max_memory: Bound | None,
) -> None:
    """Find the intervals of constant count along one axis; the operation range is where two equilibria are stable.

    Ends are exact algebraic numbers: the JSON has the polynomial and an isolating interval of each. All digits of the
    table are right.

    \b
    Examples:
        ptmcad range --along rho --at L2=3/2
        ptmcad range --along rho --at L2=3/2,F3=-10,F4=-10 --format json,svg
    """
    slice, at_other = slice_and_line(config, axes, along, {} if at is None else point_of(at), None, sets, ranges)
    stem = name or f"{slice.name}-range"
    with limits(timeout, max_memory):
        if formats:
            check_writable(out, tuple(f"{stem}.{suffix}" for suffix in formats))
        from ptmcad.ranges import intervals
        from ptmcad.ranges.document import document, line_data
        from ptmcad.ranges.table import table

        found = intervals(slice, along, at_other)
        click.echo(slice.heading)
        click.echo(table(found, digits))
        if formats:
            text = document(slice.name, slice.mechanism, {"line": line_data(found, digits)})
            write_files(out, _writers(stem, formats, found, text))


def _writers(stem: str, formats: tuple[str, ...], found: Any, text: str) -> dict[str, Writer]:
    """The pictures' writers and, last, the JSON's."""
    writers: dict[str, Writer] = {}
    for suffix in formats:
        if suffix != "json":
            from ptmcad.render.ranges import draw_range

            writers[f"{stem}.{suffix}"] = partial(draw_range, found)
    if "json" in formats:
        writers[f"{stem}.json"] = text_writer(text)
    return writers
