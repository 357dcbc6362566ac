"""``ptmcad plot``: pictures and tables of a stored result, made again without computing the map."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.cli.commonoptions import (
    PATH,
    Formats,
    Idle,
    file_option,
    gathered,
    idle_drawing,
    limit_options,
    option,
    report_idle,
    result_argument,
)
from ptmcad.cli.drawing import (
    DATA,
    MESHES,
    PICTURES,
    DrawingOptions,
    drawing_options,
    names_of,
    writer,
)
from ptmcad.cli.familyfiles import family_writers, names_of_family, read_family_file
from ptmcad.cli.locate import point_of, rows_of
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.storedresults import kind_of, read_result, stored_in
from ptmcad.errors import ConfigError, blamed, shown, shown_path
from ptmcad.process.output import Writer, check_writable, write_files
from ptmcad.question.config import portable_file
from ptmcad.question.counts import Shades
from ptmcad.question.slice import Point
from ptmcad.show import render
from ptmcad.show.style import LegendPlace
from ptmcad.show.table import count_text, index_text
from ptmcad.text.expressions import values_at
from ptmcad.text.numerals import equalities, shortest_text
from ptmcad.text.parsing import number_for

if TYPE_CHECKING:
    from ptmcad.show.render.painting import Agreement, Measured

Place = tuple[Fraction, Fraction]
MAX_ROWS = 10_000
MAX_LABEL = 40
MAX_TOLD = 10
"""Points that are named one by one on the terminal."""
DIGITS = 10
"""Of the poses' numbers."""


def places(result: RegionMap, texts: Sequence[str]) -> tuple[Place, ...]:
    """The points of ``--at``, in the axes' order.

    Raises
    ------
    ConfigError
        When a text does not give both axes, exactly and within the window.
    """
    found = []
    for text in texts:
        point = point_of(text)
        if set(point) != set(result.slice.axis_names):
            raise ConfigError(
                f"{text}: give the axes {' and '.join(result.slice.axis_names)}", key="--at"
            )
        at = _numbers(result, point, "--at")
        if not _inside(result, at):
            raise ConfigError(f"{text} is outside of the window", key="--at")
        found.append(at)
    return tuple(found)


def poses_at(result: RegionMap, at: Place) -> Poses:
    """The equilibria of the map's mechanism at a point of its window."""
    from ptmcad.ask.solving import poses_at as solved

    slice = result.slice
    return replace(solved(slice.model, values_at(slice.parameters, *at), DIGITS), units=slice.units)


def measured(result: RegionMap, path: Path) -> tuple[tuple[Measured, ...], int]:
    """The points of a CSV file with columns named like the axes and, if there are, ``label`` and
    ``count``.

    A count is compared with the map's.

    Returns
    -------
    The points within the window, and the number of others.

    Raises
    ------
    ConfigError
        When the file is not such a table or has no points, a value is no exact number or no count,
        or there are more than `MAX_ROWS` points.
    """
    found: list[Measured] = []
    outside = 0
    for line, row in rows_of(path, result, ("label", "count")):
        if len(found) + outside == MAX_ROWS:
            raise ConfigError(f"has more than {MAX_ROWS} points", file=str(path), line=line)
        with blamed(file=path, line=line):
            at = _numbers(result, row, None)
            count = _count(result, row["count"])
        if _inside(result, at):
            label = "".join(c if c.isprintable() else " " for c in row["label"])[:MAX_LABEL]
            found.append((at, label, _agreement(result, at, count)))
        else:
            outside += 1
    if not found and not outside:
        raise ConfigError("has no points below its first row", file=str(path))
    return tuple(found), outside


def disagreements(result: RegionMap, found: Sequence[Measured]) -> list[str]:
    """The points that have another count than the map, in words; the first `MAX_TOLD` of them."""
    from ptmcad.show.render.painting import Agreement

    others = [(at, label) for at, label, agreement in found if agreement is Agreement.OTHER]
    lines = []
    for at, label in others[:MAX_TOLD]:
        where = equalities(dict(zip(result.slice.axis_names, at, strict=True)), shortest_text)
        lines.append(f"another count than in the map: {f'{label}, ' if label else ''}at {where}")
    if len(others) > MAX_TOLD:
        lines.append(f"and at {len(others) - MAX_TOLD} more points")
    return lines


def _count(result: RegionMap, text: str) -> str:
    """A count as the map writes its own, such as ``2``, or ``(1, 2, 1)`` of a map by index; empty
    for none.
    """
    if not text:
        return ""
    if result.slice.count.kind.shades is Shades.INDEX:
        numbers = text.removeprefix("(").removesuffix(")").split(",")
        if all(re.fullmatch(r"\s*\d{1,6}\s*", number, re.ASCII) for number in numbers):
            return index_text(map(int, numbers))
        raise ConfigError(f"'{shown(text, 40)}' is not a count by index such as (1, 2, 1)")
    if re.fullmatch(r"\d{1,6}(\.0*)?", text, re.ASCII):
        return str(int(text.partition(".")[0]))
    raise ConfigError(f"'{shown(text, 40)}' is not a count such as 2")


def _agreement(result: RegionMap, at: Place, count: str) -> Agreement:
    """Whether the map has this count there; untold where it, or the file, has none."""
    from ptmcad.show.render.painting import Agreement

    location = result.locate(Point(result.slice.axis_names, *at))
    if (
        not count
        or location.region is None
        or location.status in (Status.UNDECIDED, Status.ON_VARIETY)
    ):
        return Agreement.UNTOLD
    said = count_text(result.regions[location.region], result.slice.count)
    return Agreement.SAME if said == count else Agreement.OTHER


def _numbers(result: RegionMap, point: Mapping[str, str], key: str | None) -> Place:
    first, second = (number_for(key, point[name]) for name in result.slice.axis_names)
    return first, second


def _inside(result: RegionMap, at: Place) -> bool:
    return all(
        axis.low <= value <= axis.high for axis, value in zip(result.slice.axes, at, strict=True)
    )


class _Added(NamedTuple):
    """What is drawn beside the map itself."""

    overlay: Path | None
    at: tuple[str, ...]
    compare: Path | None
    surface: bool


def _with_points(stored: RegionMap, drawing: DrawingOptions, added: _Added) -> DrawingOptions:
    """The drawing with measured points, and with the poses at points; both are checked before poses
    are computed.
    """
    chosen = places(stored, added.at)
    if added.overlay is not None:
        found, outside = measured(stored, added.overlay)
        drawing = drawing._replace(overlay=found)
        if outside:
            click.echo(
                f"{outside} of {outside + len(found)} points are outside of the window and left out",
                err=True,
            )
        for line in disagreements(stored, found):
            click.echo(line)
    return drawing._replace(poses=tuple((place, poses_at(stored, place)) for place in chosen))


def _idle(is_family: bool, drawing: DrawingOptions, added: _Added) -> tuple[Idle, ...]:
    """Options that a picture of more than a map does not heed."""
    several = is_family or added.compare is not None
    below = several and drawing.style.legend is LegendPlace.RIGHT
    return (
        ("samples", several or bool(added.at), "sample points are drawn on a map alone"),
        ("legend", below, "a legend of several maps is below them"),
        ("surface", not is_family, "this is one map: a surface is of a family"),
    )


def _check_compared(added: _Added, formats: Formats) -> None:
    if added.compare is None:
        return
    if added.at or added.overlay is not None:
        raise ConfigError(
            "two maps are drawn without further points: leave out --at and --overlay",
            key="--compare",
        )
    if any(kind not in PICTURES for kind in formats):
        raise ConfigError(
            f"of a difference there are pictures only: {', '.join(PICTURES)}", key="--format"
        )


def _compared(
    first: RegionMap, result: Path, second: RegionMap, other: Path
) -> Callable[[DrawingOptions], Any]:
    """What draws the difference of two maps, which is printed.

    Raises
    ------
    ConfigError
        With the file of the map that contradicts itself.
    """
    from ptmcad.ask.comparison import compare

    try:
        found = compare(first, second)
    except ConfigError as error:
        blamed = {"first": result, "second": other}.get(error.key or "")
        if blamed is not None:
            raise ConfigError(error.message, file=str(blamed)) from error
        raise ConfigError(error.message, key="--compare") from error
    for path, each in ((result, first), (other, second)):
        with stored_in(path):
            render.traced(each)  # so that of two maps the one that contradicts itself is named
    click.echo(f"A is {shown_path(result)}; B is {shown_path(other)}")
    for line in render.difference_words(found):
        click.echo(line)
    return lambda drawing: render.comparison_figure(found, dpi=drawing.dpi, style=drawing.style)


def _of_family(
    result: Path, folder: Path, formats: Formats, drawing: DrawingOptions, added: _Added
) -> dict[str, Writer]:
    """A writer for each picture and mesh of a family."""
    if added.overlay or added.at or added.compare:
        raise ConfigError(
            "points and comparisons are for one map: give a member's file", file=str(result)
        )
    if any(kind in DATA for kind in formats):
        known = ", ".join((*PICTURES, *MESHES))
        raise ConfigError(
            f"of a family there are pictures and meshes only: {known}", key="--format"
        )
    family, surface = read_family_file(result), None
    if added.surface or any(kind in MESHES for kind in formats):
        from ptmcad.workbench.boundarymesh import boundary_surface

        # from members that are computed for it
        with blamed("", result), ProgressBar() as progress:
            surface = boundary_surface(family, progress=progress)
        click.echo(f"boundary surface: {surface.words()}")
    files = names_of_family(result.stem, formats)
    check_writable(folder, tuple(files))
    return family_writers(family, files, drawing, surface, added.surface)


def _of_map(
    result: Path, folder: Path, formats: Formats, drawing: DrawingOptions, added: _Added
) -> dict[str, Writer]:
    """A writer for each picture and table of a map, or of two that are compared."""
    if meshes := [kind for kind in formats if kind in MESHES]:
        raise ConfigError(
            f"{meshes[0]} is for a family's boundary surface, and this is one map", key="--format"
        )
    stored, other = read_result(result), added.compare
    stem = result.stem if other is None else f"{result.stem}-and-{other.stem}"
    portable_file(f"{stem}.{formats[0]}", "RESULT")
    _check_compared(added, formats)
    names = names_of(stem, formats)
    check_writable(folder, names)
    drawing = _with_points(stored, drawing, added)
    if (wide := drawing.style.wide) is not None and (added.at or other is not None):
        # what needs more room than a journal's column has gets both
        click.echo(f"over two columns, {wide:.3g} inches wide, which --size changes", err=True)
    if other is None:
        return drawing.writers(stored, stem, formats)
    draw = _compared(stored, result, read_result(other), other)
    how = {"dpi": drawing.dpi, "style": drawing.style}
    return {name: writer(name, partial(draw, drawing), **how) for name in names}


@click.command("plot")
@result_argument
@option("--out", "Folder for the files.  [default: that of RESULT]", type=PATH)
@drawing_options((*PICTURES, *DATA, *MESHES), "png", "What to make")
@file_option(
    "--overlay", ".csv", "FILE",
    "A CSV file of points to draw on the map: columns named like the axes, and label and count if there are.",
)  # fmt: skip
@option(
    "--at",
    "Draw the stable poses at a point beside the map, with a line to it. Repeatable.",
    "NAME=VALUE,NAME=VALUE",
    multiple=True,
)
@file_option(
    "--compare", ".json", "OTHER",
    "Draw RESULT, another map of the same window, and where their counts differ; print how large that is.",
)  # fmt: skip
@option(
    "--surface",
    "Of a family with its changes: draw NAME-3d as the surface between regions of different counts.",
)
@limit_options
@gathered(added=_Added)
def command(
    *,
    result: Path,
    out: Path | None,
    formats: Formats,
    drawing: DrawingOptions,
    added: _Added,
) -> None:
    """Draw RESULT, a JSON file of `ptmcad classify`, or write it as numbers.

    \b
    Example:
        ptmcad classify --slice L2,rho --format json
        ptmcad plot slice-L2-rho.json --format png,svg --dpi 300
        ptmcad plot slice-L2-rho.json --format csv
        ptmcad plot slice-L2-rho.json --style ieee --legend below --format pdf
        ptmcad plot slice-L2-rho.json --at L2=1,rho=1 --at L2=3,rho=1/2
        ptmcad plot slice-L2-rho.json --overlay measured.csv
        ptmcad plot slice-L2-rho.json --compare heavier.json
        ptmcad plot loads.json --surface --format pdf,ply
    """
    is_family = kind_of(result) == "family"
    report_idle((*idle_drawing(formats), *_idle(is_family, drawing, added)))
    make = _of_family if is_family else _of_map
    writers = make(result, out or result.parent, formats, drawing, added)
    alone = not is_family and added.compare is None
    with stored_in(result if alone else None), ProgressBar():
        for path in write_files(out or result.parent, writers):
            click.echo(shown_path(path))
