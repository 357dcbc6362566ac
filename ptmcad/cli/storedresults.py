"""Results of earlier commands: read from their files, or made where CONFIG is a record.

Guarantee: a stored map is taken as it is; an option that would change its slice is refused by name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeVar

from ptmcad.answer.consistency import check_numbers
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli.commonoptions import clock_stopped, option, report_idle
from ptmcad.errors import ConfigError, PictureError, PtmcadError, blamed, shown
from ptmcad.options import Options
from ptmcad.question.config.typed import Typed
from ptmcad.question.slice import Slice
from ptmcad.show.document.mapdocument import FORMAT
from ptmcad.show.style import PictureStyle
from ptmcad.text.node import NEWER, is_newer
from ptmcad.text.parsing import share_for
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
def stored_in(path: str | Path | None) -> Iterator[None]:
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


def is_record(path: Path) -> bool:
    """Whether a file is a problem record."""
    return _is_record(read_text(path, MAX_BYTES, f"a {FORMAT} file"))


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


tolerance_option = option(
    "--tolerance",
    "With free lengths: the share of the window that may stay undetermined.",
    "EPS",
    read=share_for,
    default="1/100",
)


def stored_map(asked: Typed) -> RegionMap | None:
    """The map where CONFIG is a result, whose ``--tolerance`` has no effect.

    Raises
    ------
    ConfigError
        When the file is damaged, or an option would change the slice.
    """
    path = None if asked.config is None else Path(asked.config)
    if path is None or not is_result(path):
        return None
    given = {
        "--slice": asked.slice,
        "--set": asked.sets,
        "--range": asked.ranges,
        "--mechanism": asked.mechanism,
    }
    for name, value in given.items():
        if value:
            raise ConfigError(
                "a result has its slice already: give the problem record to change it", key=name
            )
    report_idle([("tolerance", True, "the map is made already")])
    return read_result(path)


def made_map(slice: Slice, options: Options, tolerance: Fraction) -> RegionMap:
    """The map of a slice; compiling the certified engine is no part of the time that it may take.

    Parameters
    ----------
    tolerance : the share of the window that may stay undetermined, with free lengths.
    """
    from ptmcad.ask.classification import prepare, region_map

    report_idle(
        [("tolerance", not slice.has_free_lengths, "the exact engine leaves nothing undetermined")]
    )
    if slice.has_free_lengths:
        options = replace(options, areas=True, tolerance=tolerance)
    with clock_stopped(options.timeout):
        prepare(slice, options)
    return region_map(slice, options)
