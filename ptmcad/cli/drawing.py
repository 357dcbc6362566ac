"""What commands write in addition to the JSON of a result: pictures, and tables of numbers for other programs;
and the names of what was written.

Guarantee: the names of all files are known before anything is computed. Whatever a picture fails
of, its result is saved as JSON, where that is asked for; the message names the picture and where
the result is, and the exit status is 2.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from ptmcad.cli.commonoptions import STYLE, F, Formats, format_option, gathered, option, together
from ptmcad.cli.completion import palettes
from ptmcad.errors import ConfigError, PictureError, PtmcadError, blamed, shown_path
from ptmcad.process.output import Writer, save_stopped, text_writer, write_files
from ptmcad.show import render
from ptmcad.show.style import DEFAULT, LINES, PALETTES, PRESETS, LegendPlace, PictureStyle, styled
from ptmcad.text.parsing import share_for

if TYPE_CHECKING:
    from ptmcad.answer.poses import Poses
    from ptmcad.show.render.painting import Measured


def report_written(folder: Path, names: Iterable[str]) -> None:
    """Name the files that are there now, where there are any."""
    paths = [shown_path(folder / name) for name in names]
    if paths:
        click.echo(f"written   {', '.join(paths)}")


def picture(name: str, draw: Writer) -> Writer:
    """A writer of the picture of this name, which is drawn by a function of the path.

    Its failures are of one kind, `PictureError`, but for lack of memory.
    """

    def write(path: Path) -> None:
        try:
            draw(path)
        except MemoryError:
            raise
        except (
            Exception
        ) as error:  # a library's, of any kind: fonts, caches, the disk; raised as one kind
            raise PictureError(f"{name} cannot be drawn: {_reason(error)}") from error

    return write


def writer(name: str, make: Callable[[], Any], **printing: Any) -> Writer:
    """The same of what a function makes: a text, bytes, or a figure, which is printed as by
    `ptmcad.show.render.printing.save`.
    """

    def draw(path: Path) -> None:
        made = make()
        if isinstance(made, str):
            text_writer(made)(path)
        elif isinstance(made, bytes):
            path.write_bytes(made)
        else:
            render.save(made, path, **printing)

    return picture(name, draw)


def _reason(error: Exception) -> str:
    """In words for somebody who does not read the program: names of exceptions are none."""
    if isinstance(error, ConfigError) and error.key in PictureStyle._fields:
        return f"--{error.key.replace('_', '-')}: {error.message}"
    if isinstance(error, PtmcadError):
        return str(error)
    said = str(error)
    if isinstance(error, OSError):
        return error.strerror or said
    return f"drawing failed unexpectedly{said and f': {said}'}"


def write_result(
    folder: Path, pictures: Mapping[str, Writer], name: str, text: str
) -> tuple[Path, ...]:
    """Write pictures and, last, the JSON, where it has a name; all of them or, when a picture
    fails, the JSON alone.

    The JSON then goes where the result of a stopped run goes: older pictures beside it would not be
    its own.

    Parameters
    ----------
    pictures : as of `write_files`.
    name, text : of the JSON; an empty name where none is wanted.

    Raises
    ------
    PictureError
        After the JSON has been saved.
    OutputError
        When a file cannot be written.
    """
    if not name:
        return write_files(folder, pictures)
    try:
        return write_files(folder, {**pictures, name: text_writer(text)})
    except PictureError as error:
        place, why = save_stopped(folder / name, text, whole=True, beside=tuple(pictures))
        raise PictureError(f"{error}; the result, without pictures, is in {place}{why}") from error


def write_answer(
    folder: Path,
    names: Iterable[str],
    make: Callable[[str], Any],
    text: Callable[[], str],
) -> None:
    """Write an answer's files, if any, as `write_result`: the JSON, where one of the names is its, and a
    writer of what is made for each other name.

    Parameters
    ----------
    make : gives what a name stands for, as of `writer`.
    text : gives the JSON.
    """
    known = tuple(names)
    if not known:
        return
    file = next((name for name in known if name.endswith(".json")), "")
    pictures = {name: writer(name, partial(make, name)) for name in known if name != file}
    write_result(folder, pictures, file, text() if file else "")


PICTURES = ("png", "svg", "pdf", "eps")
DATA = ("csv", "npz")
MESHES = ("obj", "ply")
"""Of a family's boundary surface."""
TABLES = ("boundaries", "regions", "cells")
"""Each is a file of its own in CSV."""
MAX_SIDE = 10_000


def names_of(stem: str, formats: Formats) -> tuple[str, ...]:
    """The files of these formats."""
    return tuple(
        name
        for kind in formats
        for name in (
            [f"{stem}-{table}.csv" for table in TABLES] if kind == "csv" else [f"{stem}.{kind}"]
        )
    )


_DRAWING = ("samples", "style", "dpi", "boundary_tolerance", "pixels")


class DrawingOptions(NamedTuple):
    """How a map is drawn and tabulated.

    Attributes
    ----------
    samples : whether pictures show the cells' sample points.
    style : what pictures look like.
    dpi : resolution of a PNG.
    boundary_tolerance : distance of polylines from their curves, as a share of the window's side.
    pixels : columns and rows of the grid in an NPZ.
    overlay : further points in pictures.
    poses : points whose stable poses stand around the map in pictures.
    """

    samples: bool = False
    style: PictureStyle = DEFAULT
    dpi: int = 150
    boundary_tolerance: Fraction = Fraction(1, 1000)
    pixels: tuple[int, int] = (400, 400)
    overlay: tuple[Measured, ...] = ()
    poses: tuple[tuple[tuple[Fraction, Fraction], Poses], ...] = ()

    def writers(self, result: Any, stem: str, formats: Formats) -> dict[str, Writer]:
        """For each file a function that writes it, in the order of the formats."""
        boundaries = cache(lambda: result.boundaries(self.boundary_tolerance))
        found: dict[str, Writer] = {}
        for name in names_of(stem, formats):
            if name.endswith(DATA):
                found[name] = writer(name, partial(self._numbers, result, name, boundaries))
            else:
                found[name] = picture(name, partial(self._picture, result, name))
        return found

    def _picture(self, result: Any, name: str, path: Path) -> None:
        how = {"dpi": self.dpi, "style": self.style, "overlay": self.overlay}
        if self.poses:
            missing = render.draw_with_poses(result, self.poses, path, **how)
        else:
            missing = render.draw(result, path, samples=self.samples, **how)
        if missing:
            click.echo(
                f"note: {name} has no room for {' and '.join(missing)}, which a larger --size has",
                err=True,
            )

    def _numbers(self, result: Any, name: str, boundaries: Callable[[], Any]) -> str | bytes:
        from ptmcad.show import data

        if name.endswith(".npz"):
            return data.npz_bytes(result, boundaries(), result.grid(*self.pixels))
        table = name.removesuffix(".csv").rpartition("-")[2]
        return data.csv_text(data.rows_of(result, table, boundaries))


class Output(NamedTuple):
    """What is to be printed and written besides the table, and where."""

    out: Path
    formats: Formats
    explain: bool
    no_timings: bool
    drawing: DrawingOptions

    def among(self, known: Formats) -> Formats:
        """The formats that are of some kind."""
        return tuple(kind for kind in self.formats if kind in known)

    @property
    def drawn(self) -> Formats:
        """The formats of pictures and tables of one map."""
        return self.among((*PICTURES, *DATA))

    def text(self, result: Any) -> str:
        """The result's JSON."""
        text: str = result.to_json(timings=not self.no_timings)
        return text


def pixels_for(key: str, value: str) -> tuple[int, int]:
    """Columns and rows, such as 400 or 400x300."""
    match = re.fullmatch(r"(\d{1,6})(?:x(\d{1,6}))?", value.strip(), re.ASCII)
    sides = (int(match[1]), int(match[2] or match[1])) if match else (0, 0)
    if not all(1 <= side <= MAX_SIDE for side in sides):
        raise ConfigError(
            f"{value!r} is not a size such as 400 or 400x300, of 1 to {MAX_SIDE} each", key=key
        )
    return sides


def style_of(*, style: str, **options: Any) -> PictureStyle:
    """The options of a style together."""
    try:
        made = styled(style, **options)
    except ConfigError as error:
        raise ConfigError(
            error.message, key=f"--{(error.key or 'style').replace('_', '-')}"
        ) from error
    if made.font_family:
        with blamed("--font-family"):
            render.check_families(made.font_family)
    return made


style_options = together(
    option("--style", "Size, font and lines for a journal's column, a slide or a poster. Other options override.",
           type=click.Choice(tuple(PRESETS)), default="default"),
    option("--size", "Of the whole picture, as 3.5x2.6in or 90x70mm.", "WxH"),
    option("--font-size", "Of the legend, at the printed size; none below 6 points.", "PT"),
    option("--font-family", "Fonts that are installed; the first that has a letter.", "NAME,.."),
    option("--palette", f"{', '.join(PALETTES)}, or colours for the counts, or values, in increasing order.  "
           "[default: default]", "NAME|COLOUR,..", shell_complete=palettes),
    option("--title", "Title, '' for none.  [default: the slice's heading; none in journals' styles]", "TEXT"),
    option("--legend", "Where the legend stands.  [default: where it fits]",
           type=click.Choice([place.value for place in LegendPlace])),
    option("--line-width", "Width of curves where the count changes, in points.", "PT"),
    option("--thin-lines", "Curves of the variety where the count does not change.  [default: solid]",
           type=click.Choice(LINES)),
    option("--dpi", "Resolution of a PNG; regions of a map that are too thin for it get insets, in every format.",
           type=click.IntRange(50, 1200), default=150),
    gathered(style=(STYLE, style_of)),
)  # fmt: skip
"""The options that make a `PictureStyle`, which the command gets as ``style``, and ``--dpi``."""


def drawing_options(known: Formats, default: str, what: str) -> Callable[[F], F]:
    """Add ``--format``, which the command gets as ``formats``, and the options that it gets as a
    `DrawingOptions`.

    Parameters
    ----------
    known, default : formats.
    what : the help's first words about the formats.
    """
    return together(
        format_option(known, what + ", of {}.", default),
        option("--samples", "Draw the cells' sample points."),
        option("--boundary-tolerance", "How far boundaries in CSV and NPZ may be from the true curves, as a share of "
               "the window's side.", "EPS", read=share_for, default="1/1000"),
        option("--pixels", "Columns and rows of the grid of exact counts in an NPZ.", "NxM",
               read=pixels_for, default="400x400"),
        style_options,
        gathered(drawing=(_DRAWING, DrawingOptions)),
    )  # fmt: skip
