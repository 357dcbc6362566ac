"""A family as a JSON document: its free parameter, its surfaces, and the files of its members' maps.

Guarantee: numbers are exact; the maps themselves are documents of their own, in files beside this one.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from pathlib import PurePath
from typing import Any, NamedTuple

from ptmcad.answer.changes import Changes
from ptmcad.answer.family import FamilyMap, SpaceTerms
from ptmcad.question.slice import Axis
from ptmcad.show.document.changes import changes_from, written_changes
from ptmcad.show.document.node import opened, placed
from ptmcad.text.numerals import fraction_of, text_of

FORMAT = "ptmcad-family/1"
MAX_DOCUMENT = 60_000_000
MAX_MEMBERS = 10_000
MAX_TEXT = 10_000
"""Characters of a parameter."""


class StoredFamily(NamedTuple):
    """What a document says; ``files`` are the members', beside it."""

    name: str
    title: str
    free: Axis
    values: tuple[Fraction, ...]
    files: tuple[str, ...]
    surfaces: tuple[SpaceTerms, ...]
    text: Mapping[str, str]
    changes: Changes | None = None


def write_family(family: FamilyMap, files: Sequence[str]) -> str:
    """The document as JSON text.

    Parameters
    ----------
    files : names of the members' files.
    """
    data = {
        "format": FORMAT,
        "name": family.name,
        "title": family.title,
        "free": {"name": family.free.name, "low": text_of(family.free.low), "high": text_of(family.free.high)},
        "parameters": dict(family.text),
        "surfaces": [[[*powers, str(c)] for powers, c in terms] for terms in family.surfaces],
        "members": [{"value": text_of(value), "file": file} for value, file in zip(family.values, files, strict=True)],
    }
    if family.changes is not None:
        data["changes"] = written_changes(family.changes)
    lines = [f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}" for key, value in data.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def read_family(text: str) -> StoredFamily:
    """What `write_family` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document.
    """
    document = opened(text, FORMAT, MAX_DOCUMENT, "ptmcad classify")
    document.record("format", "name", "title", "free", "parameters", "surfaces", "members", "changes?")
    with placed(document) as data:
        name, title = _text(data["name"]), _text(data["title"])
        free = data["free"]
        axis = Axis(_text(free["name"]), fraction_of(free["low"]), fraction_of(free["high"]))
        members = data["members"]
        values = tuple(fraction_of(member["value"]) for member in members)
        files = tuple(_file(member["file"]) for member in members)
        surfaces = tuple(
            tuple(((int(i), int(j), int(k)), int(c)) for i, j, k, c in terms) for terms in data["surfaces"]
        )
        if not all(surfaces):
            raise ValueError("a surface has no terms")
        changes = changes_from(data["changes"], axis) if "changes" in data else None
        parameters = {_text(name): _text(written, MAX_TEXT) for name, written in data["parameters"].items()}
        if parameters.get(axis.name, axis.name) != axis.name:
            raise ValueError(f"the free parameter {axis.name} is another one")
    if not 1 <= len(values) <= MAX_MEMBERS or any(a >= b for a, b in pairwise(values)):
        raise ValueError("the members' values do not increase")
    if values[0] < axis.low or values[-1] > axis.high or len({*surfaces}) < len(surfaces):
        raise ValueError("a member is outside of the range, or a surface is listed twice")
    return StoredFamily(name, title, axis, values, files, surfaces, parameters, changes)


def _text(value: Any, most: int = 300) -> str:
    if not isinstance(value, str) or not value.isprintable() or len(value) > most:
        raise ValueError("expected a short text")
    return value


def _file(value: Any) -> str:
    """A name of a file beside the document, none elsewhere."""
    name = _text(value)
    if PurePath(name).name != name or not name.endswith(".json"):
        raise ValueError("expected the name of a file beside it")
    return name
