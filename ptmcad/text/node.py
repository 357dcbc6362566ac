"""A value of a JSON document together with its place, read as one type or refused.

Guarantee: every reading method either returns a value of its type within the limits below, or raises ValueError with
the place of the fault, such as ``cells[3].sample``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from enum import Enum
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

from ptmcad.errors import ConfigError, ExpressionError
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

    def made(self, make: Callable[..., Item], *values: Any, **entries: Any) -> Item:
        """What a function makes of values that were read here; what it refuses is wrong with this part."""
        try:
            return make(*values, **entries)
        except (ValueError, ConfigError, ExpressionError) as error:
            raise self.fault(f"is wrong: {error}") from error

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

    def mapping(self, most: int = MAX_ITEMS) -> dict[str, Node]:
        if not isinstance(self.value, dict):
            raise self.fault("is not an object")
        if len(self.value) > most:
            raise self.fault(f"has more than {most} keys")
        for key in self.value:
            if not key.isprintable():
                raise self.fault(f"has the key {key[:40]!r} with a character that is not printable")
        start = f"{self.place}." if self.place else ""
        return {key: Node(value, start + key[:40]) for key, value in self.value.items()}

    def entry(self, key: str) -> Node:
        """What an object has under a key."""
        values = self.mapping()
        if key not in values:
            raise self.fault(f"lacks the key {key!r}")
        return values[key]

    def items(self, length: int | None = None, most: int = MAX_ITEMS) -> Iterator[Node]:
        if not isinstance(self.value, list):
            raise self.fault("is not a list")
        if len(self.value) > most:
            raise self.fault(f"has more than {most} entries")
        if length is not None and len(self.value) != length:
            raise self.fault(f"has {len(self.value)} entries, not {length}")
        return (Node(value, f"{self.place}[{k}]") for k, value in enumerate(self.value))

    def each(self, read: Callable[[Node], Item], length: int | None = None, most: int = MAX_ITEMS) -> tuple[Item, ...]:
        return tuple(read(item) for item in self.items(length, most))

    def text(self) -> str:
        """A text that can be shown as it is, on a terminal or in a page; in an expression, tabs are blanks."""
        if not isinstance(self.value, str):
            raise self.fault("is not a text")
        if not self.value.isprintable() and not self.value.replace("\t", " ").isprintable():
            raise self.fault("has a character that is not printable")
        return self.value

    def data(self) -> dict[str, Any]:
        """An object of any shape, whose texts and keys can be stored (`unstorable`)."""
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

    def natural(self, most: int | None = MAX_NUMBER) -> int:
        if not isinstance(self.value, int) or isinstance(self.value, bool):
            raise self.fault("is not an integer")
        if self.value < 0 or (most is not None and self.value > most):
            raise self.fault("is negative" if most is None else f"is not between 0 and {most}")
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
        return self.made(fraction_of, self.text())

    def integer(self) -> int:
        """A coefficient that is one, as text of any length."""
        value = self.coefficient()
        if value.denominator != 1:
            raise self.fault("is not an integer")
        return value.numerator

    def size(self) -> Fraction:
        """A number that is not negative."""
        value = self.fraction()
        if value < 0:
            raise self.fault("is negative")
        return value

    def choice(self, members: Mapping[str, Choice]) -> Choice:
        text = self.text()
        if text not in members:
            raise self.fault(f"is {text[:40]!r}, not one of {', '.join(members)}")
        return members[text]


def opened(text: str, expected: str, longest: int, command: str) -> Node:
    """The root of a JSON document of the expected format, without it; ``command`` makes such a document anew.

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
    return Node({key: value for key, value in data.items() if key != "format"}, "")


NEWER = "it needs a newer ptmcad"


def is_newer(found: Any, expected: str) -> bool:
    """Whether what a document says of its format is a later version of the expected one.

    >>> is_newer("ptmcad-poses/2", "ptmcad-poses/1"), is_newer("ptmcad-poses/0", "ptmcad-poses/1")
    (True, False)
    """
    (kind, _, version), (own, _, current) = str(found)[:40].partition("/"), expected.partition("/")
    return kind == own and version.isdecimal() and int(version) > int(current)


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        key = next(k for n, (k, _) in enumerate(pairs) if k in (other for other, _ in pairs[:n]))
        raise ValueError(f"the key {key[:40]!r} occurs twice")
    return found


def _refused(text: str) -> Any:
    raise ValueError(f"{text} is not a number of JSON")


def _is_control(c: str) -> bool:
    """Whether a character is of Unicode's categories Cc or Cs; a line break or a tab is allowed."""
    return (c < " " and c not in "\n\r\t") or "\x7f" <= c <= "\x9f" or "\ud800" <= c <= "\udfff"


def unstorable(data: Any) -> str | None:
    """A character that a result has no place for, in the texts and keys of a reference; None when there is none.

    Those are control characters, but for line breaks and tabs, and halves of surrogate pairs, which are not in UTF-8.
    """
    if isinstance(data, str):
        return next(filter(_is_control, data), None)
    if isinstance(data, Mapping):
        parts: Iterable[Any] = (part for entry in data.items() for part in entry)
    else:
        parts = data if isinstance(data, list | tuple) else ()
    return next((found for part in parts if (found := unstorable(part)) is not None), None)
