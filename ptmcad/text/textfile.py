"""The text of a file that someone hands to the program.

Guarantee: only regular files are read, and of them no more than a stated number of bytes, so that
reading ends in bounded time and memory: a device, a named pipe without a writer or a file of a
terabyte is refused at once. Nothing is executed. Every refusal is a `ConfigError` that names the
file.
"""

from __future__ import annotations

import errno
import json
import os
import re
import stat
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from ptmcad.errors import ConfigError

T = TypeVar("T")

MAX_UNNAMED = 1_000_000
"""Characters of a JSON text that does not begin with its format: in memory its data may take fifty
times as much.
"""
MAX_PARTS = 3_000_000
"""Lists and objects in a JSON text: more than a map has with as many slanted pieces as are read."""
_FORMAT = re.compile(r'\s*\{\s*"format"\s*:\s*"(ptmcad-[a-z-]{1,40}/[0-9]{1,9})"')


def read_bytes(path: str | Path, most: int, what: str) -> bytes:
    """The whole content of a regular file of at most ``most`` bytes.

    Parameters
    ----------
    what : what the file should be, such as "a problem record", for messages.

    Raises
    ------
    ConfigError
        If the file is missing, is no regular file, cannot be read, or is larger.
    """
    descriptor = _open(path, what)
    try:
        with open(descriptor, "rb") as stream:
            data = stream.read(most + 1)
            if (
                data is None
            ):  # a file that would keep its reader waiting, such as a log of the kernel
                raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
    except OSError as error:
        raise _unreadable(path, error) from error
    if len(data) > most:
        raise ConfigError(f"is larger than {most} bytes: this is not {what}", file=str(path))
    return data


def read_text(path: str | Path, most: int, what: str) -> str:
    """The same as UTF-8 text, without a byte order mark; the line of a byte that is not UTF-8 is
    named.
    """
    data = read_bytes(path, most, what)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise ConfigError(
            "is not UTF-8 text: save it as UTF-8", file=str(path), line=line
        ) from error


def read_as(path: str | Path, most: int, kind: str, decode: Callable[[str], T]) -> T:
    """What ``decode`` makes of a file's text; where that raises a ValueError, the file is said to
    be no ``kind`` file.

    Raises
    ------
    ConfigError
        As `read_text` does, and for such a text.
    """
    text = read_text(path, most, f"a {kind} file")
    try:
        return decode(text)
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"is not a {kind} file: {error}", file=str(path)) from error


def format_named(text: str) -> str:
    """The format with which a document of this program begins; empty for every other text.

    >>> format_named('{"format": "ptmcad-poses/1", "name": 1}'), format_named('{"name": "ptmcad-poses/1"}')
    ('ptmcad-poses/1', '')
    """
    found = _FORMAT.match(text)
    return found[1] if found else ""


def json_data(text: str, **hooks: Any) -> Any:
    """The data of a JSON text, in bounded memory: a long one that is no document of this program is
    not read.

    Parameters
    ----------
    hooks : as of `json.loads`.

    Raises
    ------
    ValueError
        For such a text, for no JSON, and for what is nested too deeply.
    """
    if len(text) > MAX_UNNAMED and not format_named(text):
        raise ValueError(
            f"it has more than {MAX_UNNAMED} characters and does not begin with a format of ptmcad"
        )
    if text.count("[") + text.count("{") > MAX_PARTS:
        raise ValueError(f"it has more than {MAX_PARTS} lists and objects")
    try:
        return json.loads(text, **hooks)
    except RecursionError as error:
        raise ValueError("the document is nested too deeply") from error


def lines_of(path: str | Path, longest: int, what: str) -> Iterator[str]:
    """The lines of a regular UTF-8 file of any size, with their ends (a line feed, or carriage
    return and line feed).

    Raises
    ------
    ConfigError
        As `read_text` does, and for a line of more than ``longest`` bytes.
    """
    descriptor = _open(path, what)
    number = 0
    try:
        with open(descriptor, "rb") as stream:
            while line := stream.readline(longest + 1):
                number += 1
                if len(line) > longest:
                    raise ConfigError(
                        f"the line has more than {longest} bytes", file=str(path), line=number
                    )
                yield line.decode("utf-8-sig" if number == 1 else "utf-8")
    except OSError as error:
        raise _unreadable(path, error) from error
    except UnicodeDecodeError as error:
        raise ConfigError(
            "is not UTF-8 text: save it as UTF-8", file=str(path), line=number
        ) from error


def _open(path: str | Path, what: str) -> int:
    """A descriptor of a regular file, opened without waiting for anyone at the other end."""
    # a pipe without a writer would hold a plain open() for ever
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        descriptor = os.open(path, flags)
    except FileNotFoundError as error:
        raise ConfigError("there is no such file", file=str(path)) from error
    except IsADirectoryError as error:
        raise _folder(path, what) from error
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise _unreadable(path, error) from error
    mode = os.fstat(descriptor).st_mode
    if stat.S_ISREG(mode):
        return descriptor
    os.close(descriptor)
    if stat.S_ISDIR(mode):
        raise _folder(path, what)
    raise ConfigError(f"is a device or a pipe: save {what} as a file and name that", file=str(path))


def _folder(path: str | Path, what: str) -> ConfigError:
    return ConfigError(f"is a folder: name {what} in it", file=str(path))


def _unreadable(path: str | Path, error: OSError | ValueError) -> ConfigError:
    reason = getattr(error, "strerror", None) or str(error)
    return ConfigError(f"cannot be read: {reason}", file=str(path))
