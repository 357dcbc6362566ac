"""A value of a JSON document or of a record together with its place, read as one type or refused.

Guarantee: every reading method either returns a value of its type within the limits below, or
raises what names the place of the fault: of a document ValueError, with a place such as
``cells[3].sample``, at the first fault; of a record `ConfigError`, with file, line and a key such
as ``springs.2.k``, where all faults are noted and work goes on behind.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from enum import Enum
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

from ptmcad.errors import ConfigError, ExpressionError, Faults, Place
from ptmcad.text.entry import Scalar, Sequence, Tree, Written, as_written, plain_data
from ptmcad.text.numerals import fraction_of
from ptmcad.text.syntax import did_you_mean
from ptmcad.text.textfile import json_data

# Limits far beyond any slice's result; they bound the time in which a damaged document is refused.
MAX_ITEMS = 100_000
MAX_NUMBER = 10**6
"""Of cells, regions, equilibria."""
MAX_CHARACTERS = 40_000
"""Of a coordinate. A record's numbers have 2000 digits at most, and coordinates in its result a few
times as many.
"""
MAX_ENTRIES = 400
"""Of any list or mapping in a description, so that what is read is read, and proved, in a fraction
of a second.
"""

Item = TypeVar("Item")
Part = TypeVar("Part")
Choice = TypeVar("Choice", bound=Enum)


class Node(NamedTuple):
    """A value with its place.

    Attributes
    ----------
    value : of a record what is written there, of a document JSON's data.
    place : of a record a `Place`, of a document a text such as ``cells[3].sample``.
    faults : of a record, where what is wrong is noted; None of a document.
    name : of a record, the last step of the place.
    """

    value: Any
    place: Any
    faults: Faults | None = None
    name: Any = ""

    @classmethod
    def of(cls, written: Written, faults: Faults | None, name: Any = "") -> Node:
        """A part of a record."""
        return cls(written, written.place, faults, name)

    @property
    def key(self) -> str:
        """The path of keys to it."""
        return str((self.place.key if isinstance(self.place, Place) else self.place) or "")

    @property
    def plain(self) -> Any:
        """Of a record, what is written as plain data, which is not nothing."""
        if isinstance(self.value, Scalar) and self.value.is_null:
            raise self._empty()
        return plain_data(self.value)

    @property
    def is_mapping(self) -> bool:
        """Whether it has entries by names."""
        return isinstance(self._inside, Mapping)

    @property
    def _inside(self) -> Any:
        """The entries of a list or mapping."""
        match self.value:
            case Tree(inside, _) | Sequence(inside, _):
                return inside
        return self.value

    def fault(self, problem: str) -> Exception:
        """What is raised of a problem: after a document's place, or as the message of a record's."""
        if isinstance(self.place, Place):
            return self.place.error(problem)
        return ValueError(f"{self.place or 'the document'} {problem}")

    def note(self, error: Exception) -> None:
        """Note a fault of a record; raise one of a document."""
        if self.faults is None:
            raise error
        with self.faults:
            raise error

    def noted(self) -> ConfigError:
        """What was noted last, to be raised where nothing can be read on: it is not noted twice."""
        assert self.faults is not None
        return self.faults.found[-1]

    def made(self, make: Callable[..., Item], *values: Any, **entries: Any) -> Item:
        """What a function makes of values that were read here; what it refuses is wrong with this
        part.
        """
        try:
            return make(*values, **entries)
        except (ValueError, ConfigError, ExpressionError) as error:
            if self.faults is not None:
                raise
            raise self.fault(f"is wrong: {error}") from error

    # ------------------------------------------------------------------------------------------------------- shapes

    def below(self, step: str | int, value: Any) -> Node:
        """An entry of this part of a record, or where one would be."""
        if isinstance(value, Scalar | Sequence | Tree):
            return Node.of(value, self.faults, step)
        return Node(value, self.place.below(str(step)), self.faults, step)

    def mapping(
        self, most: int | None = None, like: str = "", expected: str = ""
    ) -> dict[str, Node]:
        """The entries of a mapping of at most so many.

        Parameters
        ----------
        like : an example for a record's message; or ``expected``, all of it.
        """
        inside = self._inside
        if not isinstance(inside, Mapping):
            raise self._unlike("a mapping", like, expected, "is not an object")
        self._check_size(len(inside), most, "keys")
        if self.faults is not None:
            return {key: self.below(key, value) for key, value in inside.items()}
        for key in inside:
            if not key.isprintable():
                raise self.fault(f"has the key {key[:40]!r} with a character that is not printable")
        start = f"{self.place}." if self.place else ""
        return {key: Node(value, start + key[:40]) for key, value in inside.items()}

    def items(
        self, length: int | None = None, most: int | None = None, like: str = "", expected: str = ""
    ) -> list[Node]:
        """The entries of a list of at most so many, or of just so many."""
        inside = self._inside
        if not isinstance(inside, list | tuple) or isinstance(inside, Scalar):
            raise self._unlike("a list", like, expected, "is not a list")
        self._check_size(len(inside), most, "entries")
        if length is not None and len(inside) != length:
            raise self.fault(f"has {len(inside)} entries, not {length}")
        if self.faults is not None:
            return [self.below(k, value) for k, value in enumerate(inside, 1)]
        return [Node(value, f"{self.place}[{k}]") for k, value in enumerate(inside)]

    def pair(self, what: str, like: str) -> tuple[Node, Node]:
        """The two entries of a record's list that has two; ``what`` it is, for the message."""
        if not isinstance(self.value, Sequence) or len(self.value.items) != 2:
            raise self._unlike(what, like)
        first, second = self.items()
        return first, second

    def _unlike(self, shape: str, like: str, expected: str = "", problem: str = "") -> Exception:
        if self.faults is None:
            return self.fault(problem)
        if not expected and isinstance(self.value, Scalar) and self.value.is_null:
            return self._empty(like)
        return self.fault(expected or f"expected {shape}{like and f', such as {like}'}")

    def _empty(self, like: str = "") -> Exception:
        return self.fault(
            f"has no value: write one{like and f', such as {like}'}, or leave the key out"
        )

    def _check_size(self, size: int, most: int | None, what: str) -> None:
        limit = most or (MAX_ITEMS if self.faults is None else MAX_ENTRIES)
        if size > limit:
            number = f"{size} entries, more than the {limit} that can be computed with"
            raise self.fault(f"has more than {limit} {what}" if self.faults is None else number)

    def record(
        self, known: Collection[str], needed: Iterable[str] = (), like: str = ""
    ) -> dict[str, Node]:
        """The entries of a mapping; every key that is not known, and every one that is missing, is
        a fault.
        """
        found = self.mapping(like=like)
        if found.keys() >= {*needed} and found.keys() <= {*known}:
            return found
        for name in found:
            if name not in known:
                hint = did_you_mean(name, known, "; the keys are ")
                self._note(name, f"unknown key{hint}", f"has the unknown key {name[:40]!r}")
        for name in needed:
            if name not in found:
                self._note(name, "is missing", f"lacks the key {name!r}")
        return found

    def _note(self, key: str, problem: str, of_document: str) -> None:
        """Note a fault of a key, which a document has as a whole."""
        self.note(self.fault(of_document) if self.faults is None else self.at(key).fault(problem))

    def has(self, name: str) -> bool:
        """Whether a mapping has a key."""
        return name in self._inside

    def at(self, name: str) -> Node:
        """What a record's mapping has under a key, or where it would be."""
        return self.below(name, self._inside.get(name))

    def entry(self, key: str) -> Node:
        """What a document's object has under a key."""
        if (found := self.mapping().get(key)) is None:
            raise self.fault(f"lacks the key {key!r}")
        return found

    def each(
        self,
        read: Callable[[Node], Item],
        length: int | None = None,
        most: int | None = None,
        like: str = "",
    ) -> tuple[Item, ...]:
        """What is read of the entries of a list; of a record without those that are wrong, which
        are noted.
        """
        return tuple(self.gathered(read, self.items(length, most, like)))

    def attempt(self, read: Callable[[Part], Item], part: Part, instead: Any) -> Any:
        """What is read of a part; of a record something else where it is wrong, which is noted."""
        if self.faults is None:
            return read(part)
        with self.faults:
            return read(part)
        return instead

    def gathered(self, read: Callable[[Part], Item], parts: Iterable[Part]) -> list[Item]:
        """What is read of some entries; of a record without those that are wrong, which are noted."""
        found = (self.attempt(read, part, ...) for part in parts)
        return [one for one in found if one is not ...]

    # ------------------------------------------------------------------------------------- values of JSON's documents

    def text(self) -> str:
        """A text that can be shown as it is, on a terminal or in a page; in an expression, tabs are
        blanks.
        """
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
        """What a word stands for."""
        word = self.text() if self.faults is None else self.plain
        if isinstance(word, str) and word in members:
            return members[word]
        if self.faults is None:
            raise self.fault(f"is {word[:40]!r}, not one of {', '.join(members)}")
        raise self.fault(
            f"{as_written(word)} is none of {', '.join(members)}{did_you_mean(str(word), members)}"
        )


def opened(text: str, expected: str, longest: int, command: str) -> Node:
    """The root of a JSON document of the expected format, without it; ``command`` makes such a
    document anew.

    Raises
    ------
    ValueError
        For text that is too long, no JSON or nested too deeply, for a key that occurs twice, and
        for another format.
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
        keys = [key for key, _ in pairs]
        twice = next(key for n, key in enumerate(keys) if key in keys[:n])
        raise ValueError(f"the key {twice[:40]!r} occurs twice")
    return found


def _refused(text: str) -> Any:
    raise ValueError(f"{text} is not a number of JSON")


def _is_control(c: str) -> bool:
    """Whether a character is of Unicode's categories Cc or Cs; a line break or a tab is allowed."""
    return (c < " " and c not in "\n\r\t") or "\x7f" <= c <= "\x9f" or "\ud800" <= c <= "\udfff"


def unstorable(data: Any) -> str | None:
    """A character that a result has no place for, in the texts and keys of a reference; None when
    there is none.

    Those are control characters, but for line breaks and tabs, and halves of surrogate pairs, which
    are not in UTF-8.
    """
    if isinstance(data, str):
        return next(filter(_is_control, data), None)
    parts = data.items() if isinstance(data, Mapping) else data
    if not isinstance(data, Mapping | list | tuple):
        return None
    return next((found for part in parts if (found := unstorable(part)) is not None), None)
