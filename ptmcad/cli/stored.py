"""Reading a stored result for the commands that ask something of it.

Guarantee: a file that is missing, unreadable, too large or damaged gives one `ConfigError` with the file's name. Where
a killed run has not put all of its files into place, that is done first, if this user may.
"""

from __future__ import annotations

from pathlib import Path

from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import ConfigError, PtmcadError, shown
from ptmcad.process.commit import recover
from ptmcad.show.document import FORMAT
from ptmcad.text.textfile import read_text

MAX_BYTES = 60_000_000
"""Twice what a certified map with a million rectangles takes."""


def read_result(path: Path) -> RegionMap:
    """The region map in a JSON file.

    Raises
    ------
    ConfigError
        When there is no such file, or it is not a whole region map.
    """
    recover(path.parent)
    text = read_text(path, MAX_BYTES, f"a {FORMAT} file")
    try:
        return RegionMap.from_json(text)
    except (ValueError, PtmcadError, ZeroDivisionError, RecursionError) as error:
        reason = shown(" ".join(str(error).split()), 300)
        raise ConfigError(f"is damaged or not a {FORMAT} file: {reason}", file=str(path)) from error
