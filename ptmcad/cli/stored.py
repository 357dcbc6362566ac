"""Reading a stored result for the commands that ask something of it.

Guarantee: a file that is missing, unreadable or damaged gives one `ConfigError` with the file's name.
"""

from __future__ import annotations

from pathlib import Path

from ptmcad.document import FORMAT
from ptmcad.errors import ConfigError, PtmcadError
from ptmcad.regionmap import RegionMap


def read_result(path: Path) -> RegionMap:
    """The region map in a JSON file.

    Raises
    ------
    ConfigError
        When there is no such file, or it is not a whole region map.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigError(f"can not be read: {error.strerror or error}", file=str(path)) from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"is not a {FORMAT} file: it is not UTF-8 text", file=str(path)) from error
    try:
        return RegionMap.from_json(text)
    except (ValueError, PtmcadError, ZeroDivisionError, RecursionError) as error:
        reason = " ".join(str(error).split())[:200]
        raise ConfigError(f"is damaged or not a {FORMAT} file: {reason}", file=str(path)) from error
