"""Pictures beside the JSON of a result, and the names of what was written.

Guarantee: whatever a picture fails of, its result is saved as JSON, where that is asked for; the
message names the picture and where the result is, and the exit status is 2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import click

from ptmcad.errors import ConfigError, PictureError, PtmcadError, shown_path
from ptmcad.process.output import Writer, save_stopped, text_writer, write_files
from ptmcad.show import render
from ptmcad.show.style import PictureStyle


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


def figure(name: str, make: Callable[[], Any], **printing: Any) -> Writer:
    """The same of a figure that a function makes, printed as by `ptmcad.show.render.printing.save`."""
    return picture(name, lambda path: render.save(make(), path, **printing))


def _reason(error: Exception) -> str:
    """In words for somebody who does not read the program: names of exceptions are none."""
    if isinstance(error, ConfigError) and error.key in PictureStyle._fields:
        return f"--{error.key.replace('_', '-')}: {error.message}"
    if isinstance(error, PtmcadError):
        return str(error)
    said = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return (
        said
        if isinstance(error, OSError)
        else f"drawing failed unexpectedly{f': {said}' if said else ''}"
    )


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
