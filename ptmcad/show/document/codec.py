"""Codecs: how a value is written into a JSON document and read from it, both from one description.

Guarantee: what a codec reads from what it has written is equal to what was written; every fault of a document is a
ValueError that names its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from fractions import Fraction
from operator import attrgetter
from typing import Any, Generic, NamedTuple, TypeVar

from ptmcad.show.document.node import Node
from ptmcad.text.numerals import shortest_text, text_of

T = TypeVar("T")
Choice = TypeVar("Choice", bound=Enum)


class Codec(NamedTuple, Generic[T]):
    """From a value to what `json` writes, and from a place in a document to the value."""

    write: Callable[[T], Any]
    read: Callable[[Node], T]


def _itself(value: Any) -> Any:
    return value


TEXT: Codec[str] = Codec(_itself, Node.text)
TRUTH: Codec[bool] = Codec(_itself, Node.truth)
NATURAL: Codec[int] = Codec(_itself, Node.natural)
RATIONAL: Codec[Fraction] = Codec(text_of, Node.fraction)
SHARE: Codec[Fraction] = Codec(text_of, Node.size)
"""A number that is not negative."""
SHORT_DECIMAL: Codec[Fraction] = Codec(shortest_text, Node.fraction)
"""As a decimal where one is exact."""


def line(most: int) -> Codec[str]:
    """A short text that a terminal shows as it is."""
    return Codec(_itself, lambda node: node.line(most))


def choice(kind: type[Choice]) -> Codec[Choice]:
    """A member of an enumeration, by its value."""
    return Codec(lambda member: member.value, lambda node: node.choice(kind))


def optional(codec: Codec[T]) -> Codec[T | None]:
    """The same or None."""
    convert = codec.write
    write = _itself if convert is _itself else lambda value: None if value is None else convert(value)
    return Codec(write, lambda node: node.optional(codec.read))


COUNT = optional(NATURAL)


def listed(codec: Codec[T], length: int | None = None) -> Codec[tuple[T, ...]]:
    """Several of the same, or so many."""
    convert = codec.write
    write = _itself if convert is _itself else lambda values: [convert(v) for v in values]
    return Codec(write, lambda node: node.each(codec.read, length))


def named(codec: Codec[T]) -> Codec[Mapping[str, T]]:
    """Several of the same by names of any kind."""
    return Codec(
        lambda values: {name: codec.write(v) for name, v in values.items()},
        lambda node: {name: codec.read(place) for name, place in node.mapping().items()},
    )


class Key(NamedTuple):
    """One key of a record.

    Attributes
    ----------
    get : what is written, of the record's object; its attribute of the key's name when None.
    default : is not written, and read where the key is missing.
    """

    codec: Codec[Any]
    get: Callable[[Any], Any] | None = None
    default: object = ...


def record(make: Callable[..., T], **keys: Codec[Any] | Key) -> Codec[T]:
    """An object with these keys, in this order.

    Parameters
    ----------
    make : of the keys' values, by their names.
    """
    entries = [(name, key if isinstance(key, Key) else Key(key)) for name, key in keys.items()]
    getters = [(name, key.get or attrgetter(name), key.codec.write, key.default) for name, key in entries]
    expected = [name if key.default is ... else f"{name}?" for name, key in entries]

    def write(value: T) -> dict[str, Any]:
        found = {}
        for name, get, convert, default in getters:
            part = get(value)
            if default is ... or part != default:
                found[name] = part if convert is _itself else convert(part)
        return found

    def read(node: Node) -> T:
        given = node.record(*expected)
        return make(**{name: key.codec.read(given[name]) if name in given else key.default for name, key in entries})

    return Codec(write, read)
