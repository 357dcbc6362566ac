"""A part of a record: a value with its key, and where all that is wrong with it is noted.

Guarantee: a value that is asked for in a shape or as something has that shape, or is it, or there is a `ConfigError`
with the key; where work goes on without it, the fault is noted.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from decimal import Decimal
from typing import Any, NamedTuple, TypeVar

from ptmcad.errors import ConfigError, ExpressionError, Faults, excerpt, quoted
from ptmcad.text.numerals import exactly, text_of
from ptmcad.text.syntax import did_you_mean

MAX_ENTRIES = 400
"""Of any list or mapping in a description, so that what is read is read, and proved, in a fraction of a second."""
T = TypeVar("T")


_NULLS = frozenset({"", "~", "null", "Null", "NULL"})
_BOOLEANS = frozenset({"true", "false", "yes", "no", "on", "off", "y", "n"})


class Place(NamedTuple):
    """Where something stands: file, line (from 1) and dotted key path; each may be unknown."""

    key: str | None = None
    file: str | None = None
    line: int | None = None

    def error(self, message: str) -> ConfigError:
        """A `ConfigError` that names this place."""
        return ConfigError(message, key=self.key, file=self.file, line=self.line)

    def located(self, error: ExpressionError, text: str) -> ConfigError:
        """What is wrong with an expression that stands here, with the part of its text that is meant."""
        at = error.position
        where = "" if at is None or len(text) < 2 else f" (character {at + 1} of {excerpt(text, at)})"
        return self.error(f"{error.message}{where}")

    def below(self, key: str, line: int | None = None) -> Place:
        """The place of an entry under this one."""
        path = key if self.key is None else f"{self.key}.{key}"
        return Place(path, self.file, self.line if line is None else line)


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

    items: tuple[Node, ...]
    place: Place


class Tree(NamedTuple):
    """A mapping, in the order in which it was written."""

    entries: Mapping[str, Node]
    place: Place


Node = Scalar | Sequence | Tree


def from_python(value: object, place: Place) -> Node:
    """The same tree from Python data: mappings, lists, tuples, str, bool, None, and numbers, as `exactly` takes them.

    Raises
    ------
    ConfigError
        For any other type, and for a float that is no number.
    """
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise place.error(f"the key {key!r} is not text")
        return Tree({key: from_python(entry, place.below(key)) for key, entry in value.items()}, place)
    if isinstance(value, list | tuple):
        return Sequence(tuple(from_python(item, place) for item in value), place)
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


def plain_data(node: Node) -> Any:
    """The tree as Python data: dict, list, int for plain integers, bool, None; every other scalar stays text."""
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


class Entry(NamedTuple):
    """A value of a record: plain data (texts, numbers, lists and mappings), or the same of nodes.

    Attributes
    ----------
    faults : where what is wrong with it is noted.
    name : the last step of the key.
    """

    value: Any
    place: Place
    faults: Faults
    name: Any = ""

    @classmethod
    def of(cls, value: Any, place: Place, faults: Faults, name: Any = "") -> Entry:
        """The entry of plain data, or of a node, which has its own place."""
        if isinstance(value, Scalar):
            return cls(value, value.place, faults, name)
        if isinstance(value, Tree):
            return cls(value.entries, value.place, faults, name)
        return cls(*value, faults, name) if isinstance(value, Sequence) else cls(value, place, faults, name)

    @property
    def key(self) -> str:
        """The path of keys to it."""
        return self.place.key or ""

    def error(self, message: str) -> ConfigError:
        """A fault of this entry."""
        return self.place.error(message)

    def below(self, step: str | int, value: Any) -> Entry:
        """An entry of this one."""
        return Entry.of(value, self.place.below(str(step)), self.faults, step)

    def entries(self, like: str = "", most: int = MAX_ENTRIES, expected: str = "") -> dict[str, Entry]:
        """Those of a mapping of at most so many entries.

        Parameters
        ----------
        like : an example for the message; or ``expected``, all of it.
        """
        if not isinstance(self.value, Mapping):
            raise self.error(expected or f"expected a mapping{like and f', such as {like}'}")
        self._check_size(most)
        return {name: self.below(name, value) for name, value in self.value.items()}

    def items(self, like: str = "", expected: str = "", most: int = MAX_ENTRIES) -> list[Entry]:
        """Those of a list of at most so many entries."""
        if not isinstance(self.value, list | tuple) or isinstance(self.value, Scalar):
            raise self.error(expected or f"expected a list{like and f', such as {like}'}")
        self._check_size(most)
        return [self.below(n, value) for n, value in enumerate(self.value, 1)]

    def pair(self, what: str, like: str, expected: str = "") -> tuple[Entry, Entry]:
        """The two entries of a list that has two; ``what`` it is, for the message."""
        found = self.items(like, expected)
        if len(found) != 2:
            raise self.error(f"expected {what} such as {like}")
        return found[0], found[1]

    def _check_size(self, most: int) -> None:
        if len(self.value) > most:
            raise self.error(f"{len(self.value)} entries, more than the {most} that can be computed with")

    def fields(self, known: Collection[str], needed: Collection[str] = (), like: str = "", expected: str = "") -> Entry:
        """This mapping, once every key of it that is not known, and every one that is missing, is noted."""
        found = self.entries(like, expected=expected)
        for name, entry in found.items():
            with self.faults:
                if name not in known:
                    hint = did_you_mean(str(name), known) or f"; the keys are {', '.join(known)}"
                    raise entry.error(f"unknown key{hint}")
        for name in needed:
            with self.faults:
                if name not in found:
                    raise self.below(name, None).error("is missing")
        return self

    def has(self, *names: str) -> bool:
        """Whether a mapping has all of these keys."""
        return all(name in self.value for name in names)

    def at(self, name: str, default: Any = None) -> Entry:
        """What a mapping has under a key."""
        return self.below(name, self.value.get(name, default))

    def read(self, name: str, read: Callable[[Entry], T], default: T) -> T:
        """What is read under a key of a mapping; the default where the key is missing, or wrong, which is noted."""
        with self.faults:
            return read(self.at(name)) if name in self.value else default
        return default

    def each_item(self, read: Callable[[Entry], T], like: str = "") -> tuple[T, ...]:
        """What is read of the entries of a list, without those that are wrong, which are noted."""
        return self._each(read, lambda: self.items(like))

    def each_entry(self, read: Callable[[Entry], T], like: str = "") -> tuple[T, ...]:
        """The same of a mapping."""
        return self._each(read, lambda: self.entries(like).values())

    def _each(self, read: Callable[[Entry], T], parts: Callable[[], Iterable[Entry]]) -> tuple[T, ...]:
        found = []
        with self.faults:
            for entry in parts():
                with self.faults:
                    found.append(read(entry))
        return tuple(found)


def as_written(value: object) -> str:
    """What a value is, for messages: a text in quotation marks, or the kind of what is none."""
    if value is None:
        return "an empty value"
    if isinstance(value, bool):
        return f"the yes-or-no value '{str(value).lower()}'"
    if isinstance(value, list | tuple):
        return "a list"
    return "a mapping" if isinstance(value, Mapping) else quoted(value) if isinstance(value, str) else f"{value!r:.60}"
