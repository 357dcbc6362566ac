"""``ptmcad locate``: the cell, region and counts of rational points in a stored result."""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import click

from ptmcad.answer.regionmap import Location, RegionMap
from ptmcad.answer.words import index_words
from ptmcad.cli.commonoptions import (
    PATH,
    F,
    limit_options,
    option,
    result_argument,
)
from ptmcad.cli.completion import point as propose_point
from ptmcad.cli.storedresults import read_result
from ptmcad.errors import ConfigError, blamed, shown
from ptmcad.process.streams import reader_left
from ptmcad.question.counts import further_names
from ptmcad.question.shipped import POINT
from ptmcad.show.table import stability_in_words
from ptmcad.text.numerals import equalities
from ptmcad.text.textfile import lines_of

MAX_ROW = 100_000
"""Characters of a row of points, which may go over several lines."""
FIELDS = ("status", "region", "cell", "total", "stable", "index")


def fields_of(result: RegionMap) -> tuple[str, ...]:
    """What is reported of a point: also at how many stable equilibria predicates hold, where the
    map's cells say so.
    """
    exact = result.cells[0].further if result.cells else {}
    return (*FIELDS, *(exact if result.cover is None else further_names(result.slice.count)))


def answer(location: Location, fields: Sequence[str] = FIELDS) -> list[str]:
    """The entries of a location in the order of the fields; empty where there is none."""
    texts = {
        "status": location.status.value,
        "index": None if location.index is None else "-".join(map(str, location.index)),
        "region": location.region,
        "cell": location.cell,
        "total": location.total,
        "stable": location.stable,
        **location.further,
    }
    return ["" if texts.get(name) is None else str(texts[name]) for name in fields]


def point_of(text: str) -> dict[str, str]:
    """``rho=7/10,L2=3/2`` as a mapping.

    Raises
    ------
    ConfigError
        When the text is not of that form.
    """
    point: dict[str, str] = {}
    for part in text.split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if name in point:
            raise ConfigError(f"{shown(name, 40)} is given twice: leave one out", key="--at")
        if not (name and equals and value):
            raise ConfigError(f"'{shown(part, 60)}' is not NAME=VALUE: as in {POINT}", key="--at")
        point[name] = value
    return point


def point_option(help: str) -> Callable[[F], F]:
    """Add ``--at``, of which the command gets a point's texts by their names."""
    return option(
        "--at",
        help,
        "NAME=VALUE,...",
        read=lambda _, text: point_of(text),
        shell_complete=propose_point,
    )


CsvRow = tuple[int, dict[str, str]]
"""The line on which a row of a CSV file ends, from 1, and its texts by their columns' names."""


def rows_of(path: Path, result: RegionMap, further: tuple[str, ...] = ()) -> Iterator[CsvRow]:
    """The points of a CSV file whose first row names the two axes (other columns than the further
    ones are not looked at).

    The file may have any number of rows; one row at a time is held in memory.

    Raises
    ------
    ConfigError
        When the file cannot be read, an axis has no column, two columns or no value, or a row is
        longer than `MAX_ROW`.
    """
    names = result.slice.axis_names
    number = size = 0  # of the lines, and characters since the last row

    def lines() -> Iterator[str]:
        nonlocal number, size
        for line in lines_of(path, MAX_ROW, "a CSV file of points"):
            number += 1
            size += len(line)
            if line.strip() and size > MAX_ROW:
                raise ConfigError(f"the row that ends here has more than {MAX_ROW} characters: is a quotation mark "
                                  "missing?", file=str(path), line=number)  # fmt: skip
            yield line

    try:
        reader = csv.DictReader(lines(), skipinitialspace=True)
        columns = [c.strip() for c in reader.fieldnames or ()]
        for name in names:
            if columns.count(name) != 1:
                raise ConfigError(
                    f"the first row must name the axes {names[0]} and {names[1]}, each once",
                    file=str(path),
                    line=1,
                )
        reader.fieldnames = columns
        size = 0
        for row in reader:
            size = 0
            point = {name: (row[name] or "").strip() for name in names}
            if "" in point.values():
                raise ConfigError("a value is missing", file=str(path), line=reader.line_num)
            yield reader.line_num, point | {name: (row.get(name) or "").strip() for name in further}
    except csv.Error as error:
        raise ConfigError(f"is not a CSV file: {error}", file=str(path), line=number) from error


def _table(result: RegionMap, points: Iterator[CsvRow], path: Path) -> None:
    writer = csv.writer(sys.stdout, lineterminator="\n")
    fields = fields_of(result)
    writer.writerow([*result.slice.axis_names, *fields])
    for number, point in points:
        with blamed(file=path, line=number):
            location = result.locate(**point)
        writer.writerow(
            [*(point[name] for name in result.slice.axis_names), *answer(location, fields)]
        )
        if reader_left(sys.stdout):
            return


def _lines(
    location: Location, point: Mapping[str, str], fields: Sequence[str], unknown: bool = False
) -> Iterator[str]:
    """What is said of a point; ``unknown`` is whether the map does not know how many solutions are
    stable.
    """
    width = max(map(len, fields)) + 2
    yield f"{'point':{width}}{equalities(point)}"
    for name, value in zip(fields, answer(location, fields), strict=True):
        if value:
            note = (
                ""
                if name != "index" or location.index is None
                else f" ({index_words(len(location.index))})"
            )
            yield f"{name:{width}}{value}{note}"
        elif name == "stable" and unknown and location.cell is not None:
            note = "not known: it may change within the cell; `ptmcad solve` tells it of a point"
            yield f"{name:{width}}{note if location.total else 0}"
    if location.remark:
        yield f"{'remark':{width}}{location.remark}"


@click.command("locate")
@result_argument
@option(
    "--at",
    "A point: both axes, exact numbers.",
    "NAME=VALUE,NAME=VALUE",
    shell_complete=propose_point,
)
@option(
    "--csv table",
    "A CSV file whose first row names the axes; prints a CSV row for each of its points.",
    "FILE",
    PATH,
)
@limit_options
def command(*, result: Path, at: str | None, table: Path | None) -> None:
    """Tell in which cell and region of RESULT a rational point lies, and the number of equilibria there.

    The answer is exact, however near the point is to a boundary: "on the variety" exactly on a curve, unless no count
    changes across it and all solutions at the point are regular, "on the window's edge" where the map ends, "outside
    the window" beyond. In a certified map a point of its undetermined part is "undecided". Numbers such as 7/10, 0.7
    and 7e-1 are exact.

    \b
    Examples:
        ptmcad classify --slice L2,rho --format json
        ptmcad locate slice-L2-rho.json --at rho=7/10,L2=3/2
        ptmcad locate slice-L2-rho.json --csv points.csv
    """
    if (at is None) == (table is None):
        raise ConfigError(f"give a point, as in --at {POINT}, or --csv FILE")
    stored = read_result(result)
    if table is not None:
        _table(stored, rows_of(table, stored), table)
    elif at is not None:
        point = point_of(at)
        location = stored.locate(**point)
        for line in _lines(location, point, fields_of(stored), bool(stability_in_words(stored))):
            click.echo(line)
