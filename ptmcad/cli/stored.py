"""Reading a stored result for the commands that ask something of it.

Guarantee: a file that is missing, unreadable, too large, damaged or of another kind gives one
`ConfigError` with the file's name and what to do. Where a killed run has not put all of its files
into place, that is done first, if this user may.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from ptmcad.answer.consistency import check_numbers
from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import ConfigError, PictureError, PtmcadError, blamed, shown
from ptmcad.show.document.mapdocument import FORMAT
from ptmcad.show.style import PictureStyle
from ptmcad.text.node import NEWER, is_newer
from ptmcad.text.textfile import format_named, json_data, read_text

MAX_BYTES = 60_000_000
"""Twice what a certified map with a million rectangles takes."""
Answer = TypeVar("Answer")
_OF_A_RECORD = frozenset(("mechanism", "system", "axes"))
"""Keys of which a problem record has one at least, and no result has any at its top."""


def read_result(path: Path, *, whole: bool = True) -> RegionMap:
    """The region map in a JSON file.

    Parameters
    ----------
    whole : whether its parts have to be there to which others refer; `ptmcad verify` says itself
        which are not.

    Raises
    ------
    ConfigError
        When there is no such file, or it is not a whole region map.
    """
    result = read_other(path, RegionMap.from_json, FORMAT)
    if whole:
        with blamed(file=path):
            check_numbers(result)
    return result


def kind_of(path: Path) -> str:
    """What a JSON file is the document of, such as ``design``: its format without program and
    version; or nothing.
    """
    if path.suffix.lower() != ".json":
        return ""
    kind, _, _ = format_named(read_text(path, MAX_BYTES, "a result's JSON file")).partition("/")
    return kind.removeprefix("ptmcad-")


def read_other(path: Path, read: Callable[[str], Answer], kind: str) -> Answer:
    """The answer in a JSON file, of whatever kind.

    Parameters
    ----------
    read : what raises ValueError where a text is no such document.

    Raises
    ------
    ConfigError
        When it is not a whole document of one.
    """
    text = read_text(path, MAX_BYTES, f"a {kind} file")
    try:
        return read(text)
    except (ValueError, PtmcadError, ZeroDivisionError, RecursionError) as error:
        reason = shown(" ".join(str(error).split()), 300)
        what = _other_kind(text) if kind == FORMAT else ""
        raise ConfigError(
            what or f"is damaged or not a {kind} file: {reason}", file=str(path)
        ) from error


@contextmanager
def stored_in(path: Path | None) -> Iterator[None]:
    """What is asked of the map in a file, if it is in one: where the map contradicts itself, that
    is said of the file.

    Raises
    ------
    ConfigError
    """
    try:
        yield
    except (PictureError, ValueError, IndexError, ArithmeticError) as error:
        cause = error.__cause__ if isinstance(error, PictureError) else error
        if path is None:
            raise
        if isinstance(cause, ConfigError) and cause.key in (*PictureStyle._fields, "at"):
            # an option's fault, not the file's
            raise ConfigError(
                cause.message, key=f"--{(cause.key or '').replace('_', '-')}"
            ) from error
        if isinstance(cause, ConfigError):
            raise ConfigError(cause.message, file=str(path)) from error
        if not isinstance(cause, (ValueError, IndexError, ArithmeticError)):
            raise
        reason = f"the map contradicts itself ({cause}); check it with ptmcad verify"
        raise ConfigError(reason, file=str(path)) from error


def is_result(path: Path) -> bool:
    """Whether a file that stands for a record or a result is meant to be a result: JSON, and no
    record.

    Raises
    ------
    ConfigError
        When it cannot be read.
    """
    if path.suffix.lower() != ".json":
        return False
    text = read_text(path, MAX_BYTES, f"a {FORMAT} file")
    return _format_of(text) is not None or not _is_record(text)


def _other_kind(text: str) -> str:
    """What the text is if it is a file of ptmcad of another kind, as a message; empty if it is
    none.
    """
    kind = _format_of(text)
    if kind is None and _is_record(text):  # which may be written as JSON
        return "this is a problem record, not a result: run `ptmcad classify` on it first"
    own, _, version = FORMAT.partition("/")
    if not isinstance(kind, str) or not kind.startswith("ptmcad-") or kind == FORMAT:
        return ""
    if kind.partition("/")[0] == own:
        way = NEWER if is_newer(kind, FORMAT) else "make it anew"
        return f"this is a {shown(kind, 40)} file, and this program reads version {version}: {way}"
    if kind.startswith("ptmcad-family/"):
        return "this is a family: give the file of one of its members, which it names (plot and verify take it whole)"
    return f"this is a {shown(kind, 40)} file, not a region map: `ptmcad classify` makes one"


def _format_of(text: str) -> Any:
    """What a JSON text says that its format is."""
    if named := format_named(text):
        return named
    try:
        data = json_data(text)
    except ValueError:
        return None
    return data.get("format") if isinstance(data, dict) else None


def _is_record(text: str) -> bool:
    from ptmcad.text.yamltree import MAX_BYTES as MAX_RECORD_BYTES
    from ptmcad.text.yamltree import read_text as read_yaml

    if len(text) > MAX_RECORD_BYTES:
        return False
    try:
        tree = read_yaml(text)
    except PtmcadError:
        return False
    return not _OF_A_RECORD.isdisjoint(tree.entries)
