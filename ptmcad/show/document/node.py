"""A value of a JSON document together with its place, read as one type or refused.

Guarantee: every reading method either returns a value of its type within the limits below, or raises ValueError with
the place of the fault, such as ``cells[3].sample``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

from ptmcad.errors import ConfigError
from ptmcad.question.slice import unstorable
from ptmcad.text.numerals import fraction_of
from ptmcad.text.textfile import json_data

# Limits far beyond any slice's result; they bound the time in which a damaged document is refused.
MAX_ITEMS = 100_000
MAX_NUMBER = 10**6
"""Of cells, regions, equilibria."""
MAX_CHARACTERS = 40_000
"""Of a coordinate. A record's numbers have 2000 digits at most, and coordinates in its result a few times as many."""

Item = TypeVar("Item")
Choice = TypeVar("Choice", bound=Enum)


class Node(NamedTuple):
    """A value of the document with its place, such as ``cells[3].sample``."""

    value: Any
    place: str

    def fault(self, problem: str) -> ValueError:
        return ValueError(f"{self.place or 'the document'} {problem}")

    def record(self, *keys: str) -> dict[str, Node]:
        """An object with exactly these keys; those that end in ``?`` may be missing."""
        required = [key for key in keys if not key.endswith("?")]
        known = {key.rstrip("?") for key in keys}
        values = self.mapping()
        for key in required:
            if key not in values:
                raise self.fault(f"lacks the key {key!r}")
        for key in values:
            if key not in known:
                raise self.fault(f"has the unknown key {key[:40]!r}")
        return values

    def mapping(self) -> dict[str, Node]:
        if not isinstance(self.value, dict):
            raise self.fault("is not an object")
        if len(self.value) > MAX_ITEMS:
            raise self.fault(f"has more than {MAX_ITEMS} keys")
        for key in self.value:
            if not key.isprintable():
                raise self.fault(f"has the key {key[:40]!r} with a character that is not printable")
        start = f"{self.place}." if self.place else ""
        return {key: Node(value, start + key[:40]) for key, value in self.value.items()}

    def items(self, length: int | None = None) -> Iterator[Node]:
        if not isinstance(self.value, list):
            raise self.fault("is not a list")
        if len(self.value) > MAX_ITEMS:
            raise self.fault(f"has more than {MAX_ITEMS} entries")
        if length is not None and len(self.value) != length:
            raise self.fault(f"has {len(self.value)} entries, not {length}")
        return (Node(value, f"{self.place}[{k}]") for k, value in enumerate(self.value))

    def each(self, read: Callable[[Node], Item], length: int | None = None) -> tuple[Item, ...]:
        return tuple(read(item) for item in self.items(length))

    def text(self) -> str:
        """A text that can be shown as it is, on a terminal or in a page; in an expression, tabs are blanks."""
        if not isinstance(self.value, str):
            raise self.fault("is not a text")
        if not self.value.isprintable() and not self.value.replace("\t", " ").isprintable():
            raise self.fault("has a character that is not printable")
        return self.value

    def data(self) -> dict[str, Any]:
        """An object of any shape, whose texts and keys can be stored (`ptmcad.question.slice.unstorable`)."""
        if not isinstance(self.value, dict):
            raise self.fault("is not an object")
        if (found := unstorable(self.value)) is not None:
            raise self.fault(f"has the character U+{ord(found):04X}")
        return self.value

    def line(self, most: int) -> str:
        """A short text that a terminal shows as it is."""
        text = self.text()
        if len(text) > most or not text.isprintable():
            raise self.fault(f"is not a line of at most {most} printable characters")
        return text

    def truth(self) -> bool:
        if not isinstance(self.value, bool):
            raise self.fault("is not true or false")
        return self.value

    def natural(self) -> int:
        if not isinstance(self.value, int) or isinstance(self.value, bool):
            raise self.fault("is not an integer")
        if not 0 <= self.value <= MAX_NUMBER:
            raise self.fault(f"is not between 0 and {MAX_NUMBER}")
        return self.value

    def number(self) -> float:
        """For timings only."""
        if not isinstance(self.value, int | float) or isinstance(self.value, bool):
            raise self.fault("is not a number")
        if not 0 <= self.value < 1e9:
            raise self.fault("is not a number of seconds")
        return float(self.value)

    def optional(self, read: Callable[[Node], Item]) -> Item | None:
        return None if self.value is None else read(self)

    def fraction(self) -> Fraction:
        """A point's coordinate or the like: what is computed from it grows with its length."""
        if len(self.text()) > MAX_CHARACTERS:
            raise self.fault(f"is a number of more than {MAX_CHARACTERS} characters")
        return self.coefficient()

    def coefficient(self) -> Fraction:
        try:
            return fraction_of(self.text())
        except ValueError as error:
            raise self.fault(f"is wrong: {error}") from error

    def size(self) -> Fraction:
        """A number that is not negative."""
        value = self.fraction()
        if value < 0:
            raise self.fault("is negative")
        return value

    def choice(self, kind: type[Choice]) -> Choice:
        text = self.text()
        if text not in {member.value for member in kind}:
            raise self.fault(f"is {text[:40]!r}, not one of {', '.join(str(member.value) for member in kind)}")
        return kind(text)


def opened(text: str, expected: str, longest: int, command: str) -> Node:
    """The root of a JSON document of the expected format; ``command`` is what makes such a document anew.

    Raises
    ------
    ValueError
        For text that is too long, no JSON or nested too deeply, for a key that occurs twice, and for another format.
    """
    if len(text) > longest:
        raise ValueError(f"the document has {len(text)} characters, more than {longest}")
    data = json_data(text, object_pairs_hook=_distinct, parse_constant=_refused)
    found = data.get("format") if isinstance(data, dict) else None
    if found != expected:
        way = NEWER if is_newer(found, expected) else f"make it anew with {command}"
        raise ValueError(f"its format is {str(found)[:40]!r}, not {expected!r}; {way}")
    return Node(data, "")


NEWER = "it needs a newer ptmcad"


def is_newer(found: Any, expected: str) -> bool:
    """Whether what a document says of its format is a later version of the expected one.

    >>> is_newer("ptmcad-poses/2", "ptmcad-poses/1"), is_newer("ptmcad-poses/0", "ptmcad-poses/1")
    (True, False)
    """
    (kind, _, version), (own, _, current) = str(found)[:40].partition("/"), expected.partition("/")
    return kind == own and version.isdecimal() and int(version) > int(current)


@contextmanager
def placed(node: Node) -> Iterator[Any]:
    """A part's data for a reader that knows no places: what it raises names the part that was asked for last.

    Raises
    ------
    ValueError
        For a ValueError, and for what comes of a key that is missing or a value of another type.
    """
    trail = [node.place]
    try:
        yield _traced(node.value, node.place, trail)
    except (KeyError, TypeError, AttributeError, IndexError) as error:
        raise ValueError(f"{trail[0] or 'the document'} is missing or of another kind") from error
    except (ValueError, ConfigError) as error:
        raise ValueError(f"{trail[0]} is wrong: {error}" if trail[0] else str(error)) from error


def _traced(value: Any, place: str, trail: list[str]) -> Any:
    """The same, but that lists and objects write down in ``trail`` which part of them is asked for."""
    trail[0] = place
    kind = _Object if isinstance(value, dict) else _Items if isinstance(value, list) else None
    if kind is None:
        return value
    found = kind(value)
    found.place, found.trail = place, trail
    return found


class _Object(dict[str, Any]):
    place: str
    trail: list[str]

    def __getitem__(self, key: str) -> Any:
        place = f"{self.place}.{key[:40]}" if self.place else key[:40]
        self.trail[0] = place
        return _traced(super().__getitem__(key), place, self.trail)

    def get(self, key: str, default: Any = None) -> Any:
        if key not in self:
            return default
        return self[key]

    def items(self) -> Any:
        return [(key, self[key]) for key in self]


class _Items(list[Any]):
    place: str
    trail: list[str]

    def __getitem__(self, k: Any) -> Any:
        return _traced(super().__getitem__(k), f"{self.place}[{k}]", self.trail)

    def __iter__(self) -> Iterator[Any]:
        return (self[k] for k in range(len(self)))


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        key = next(k for n, (k, _) in enumerate(pairs) if k in (other for other, _ in pairs[:n]))
        raise ValueError(f"the key {key[:40]!r} occurs twice")
    return found


def _refused(text: str) -> Any:
    raise ValueError(f"{text} is not a number of JSON")
