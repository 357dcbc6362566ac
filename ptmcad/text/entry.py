"""What a record says, as a tree that knows where each part stands: of YAML's text (`yamltree`) or
of Python's objects.

Guarantee: scalars keep the text that was written, and numbers are exact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from typing import Any, NamedTuple

from ptmcad.errors import Place, quoted
from ptmcad.text.numerals import exactly, text_of

MAX_DEPTH = 20
"""Levels of lists and mappings."""
_NULLS = frozenset({"", "~", "null", "Null", "NULL"})
_BOOLEANS = frozenset({"true", "false", "yes", "no", "on", "off", "y", "n"})


class Scalar(NamedTuple):
    """A scalar as written; `plain` when it was not quoted."""

    text: str
    place: Place
    plain: bool = True

    @property
    def is_null(self) -> bool:
        return self.plain and self.text in _NULLS

    @property
    def is_boolean(self) -> bool:
        return self.plain and self.text.lower() in _BOOLEANS


class Sequence(NamedTuple):
    """A list."""

    items: tuple[Written, ...]
    place: Place


class Tree(NamedTuple):
    """A mapping, in the order in which it was written."""

    entries: Mapping[str, Written]
    place: Place


Written = Scalar | Sequence | Tree


def from_python(
    value: object,
    place: Place,
    convert: Callable[[object], object] = lambda value: value,
    depth: int = 0,
) -> Written:
    """The same tree from Python data: mappings, lists, tuples, str, bool, None, and numbers, as
    `exactly` takes them.

    Parameters
    ----------
    convert : what a value, or a key, of another kind stands for.

    Raises
    ------
    ConfigError
        For any other type, for a float that is no number, and for data that is nested deeper than a
        file may be, as what contains itself is.
    """
    if depth > MAX_DEPTH:
        raise place.error(f"more than {MAX_DEPTH} levels of nesting, or data that contains itself")
    value = convert(value)
    if isinstance(value, Mapping):
        entries = {}
        for given, entry in value.items():
            key = convert(given)
            if isinstance(key, int) and not isinstance(key, bool):
                key = str(key)  # as in YAML, where a key is the text that it is written as
            if not isinstance(key, str):
                raise place.error(f"the key {key!r} is not text")
            entries[key] = from_python(entry, place.below(key), convert, depth + 1)
        return Tree(entries, place)
    if isinstance(value, list | tuple):
        parts = (
            from_python(item, place.below(str(n)), convert, depth + 1)
            for n, item in enumerate(value, 1)
        )
        return Sequence(tuple(parts), place)
    if value is None or isinstance(value, bool):
        return Scalar({None: "null", True: "true", False: "false"}[value], place)
    if isinstance(value, str):
        return Scalar(value, place, plain=False)
    if isinstance(value, Decimal):
        return Scalar(str(value), place)
    try:
        return Scalar(text_of(exactly(value)), place)
    except (TypeError, ValueError) as error:
        raise place.error(str(error)) from error


def place_at(node: Written, key: str) -> Place:
    """Where a key below a part stands, such as ``springs.2.k``; below the nearest above it that is
    there.
    """
    inner = dict(node.entries) if isinstance(node, Tree) else {}
    if isinstance(node, Sequence):
        inner = {str(n): item for n, item in enumerate(node.items, 1)}
    for name, part in inner.items():
        if key == name or key.startswith(f"{name}."):
            return place_at(part, key[len(name) + 1 :])
    return node.place.below(key) if key else node.place


def scalars(node: Written) -> Iterator[Scalar]:
    """Those in a tree, in the order in which they are written."""
    if isinstance(node, Scalar):
        yield node
        return
    for part in node.entries.values() if isinstance(node, Tree) else node.items:
        yield from scalars(part)


def plain_data(node: Written) -> Any:
    """The tree as Python data: dict, list, int for plain integers, bool, None; every other scalar
    stays text.
    """
    if isinstance(node, Tree):
        return {key: plain_data(entry) for key, entry in node.entries.items()}
    if isinstance(node, Sequence):
        return [plain_data(item) for item in node.items]
    if node.is_null:
        return None
    if node.plain and node.text.lower() in ("true", "false"):
        return node.text.lower() == "true"
    digits = node.text.removeprefix("-")
    if node.plain and digits.isascii() and digits.isdecimal() and len(digits) < 100:
        return int(node.text)
    return node.text


def as_written(value: object) -> str:
    """What a value is, for messages: a text in quotation marks, or the kind of what is none."""
    if value is None:
        return "an empty value"
    if isinstance(value, bool):
        return f"the yes-or-no value '{str(value).lower()}'"
    if isinstance(value, list | tuple):
        return "a list"
    if isinstance(value, Mapping):
        return "a mapping"
    return quoted(value) if isinstance(value, str) else f"{value!r:.60}"
