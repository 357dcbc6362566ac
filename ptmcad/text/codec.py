"""Codecs: how a value is written into a JSON document, how it is read, and the JSON Schema of what
is written.

Guarantee: all three come of one description, which is the class's annotations where nothing else is
said. What a codec reads from what it has written is equal to what was written; every fault names
its place. Records are read by codecs too (`part`, `reading`).
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import MISSING, fields
from enum import Enum
from fractions import Fraction
from functools import cache, reduce
from operator import attrgetter, or_
from types import MappingProxyType, NoneType
from typing import Any, Generic, NamedTuple, TypeVar, cast, get_args, get_origin, get_type_hints

from ptmcad.text.documents import CLASS, Schema
from ptmcad.text.node import Node
from ptmcad.text.numerals import integer_text, shortest_text, text_of

T = TypeVar("T")
S = TypeVar("S")
Choice = TypeVar("Choice", bound=Enum)


class Codec(NamedTuple, Generic[T]):
    """From a value to what `json` writes, from a place in a document to the value, and the schema
    of what is there.
    """

    write: Callable[[T], Any]
    read: Callable[[Node], T]
    schema: Schema = MappingProxyType({})

    def narrowed(self, **keywords: Any) -> Codec[T]:
        """The same with further keywords of the schema: of what is written, where a reader need not
        ask for it.
        """
        return self._replace(schema={**self.schema, **keywords})


Known = Mapping[Any, Codec[Any]]
"""Codecs of types."""
_ALIKE: Known = MappingProxyType({})


def _itself(value: Any) -> Any:
    return value


_RATIONAL = {"$ref": "#/$defs/rational"}

TEXT: Codec[str] = Codec(_itself, Node.text, {"type": "string"})
TRUTH: Codec[bool] = Codec(_itself, Node.truth, {"type": "boolean"})
NATURAL: Codec[int] = Codec(_itself, Node.natural, {"type": "integer", "minimum": 0})
POSITIVE = NATURAL.narrowed(minimum=1)
WHOLE: Codec[int] = Codec(_itself, lambda node: node.natural(most=None), NATURAL.schema)
"""Of any size, such as a seed."""
INTEGER: Codec[int] = Codec(integer_text, Node.integer, {"type": "string", "pattern": "^-?[0-9]+$"})
"""Of any length, as text."""
RATIONAL: Codec[Fraction] = Codec(text_of, Node.fraction, _RATIONAL)
SHARE: Codec[Fraction] = Codec(text_of, Node.size, _RATIONAL)
"""A number that is not negative."""
SHORT_DECIMAL: Codec[Fraction] = Codec(shortest_text, Node.fraction, _RATIONAL)
"""As a decimal where one is exact."""
SECONDS: Codec[float] = Codec(_itself, Node.number, {"type": "number", "minimum": 0})
DATA: Codec[Mapping[str, Any]] = Codec(dict, Node.data, {"type": "object"})


def line(most: int) -> Codec[str]:
    """A short text that a terminal shows as it is."""
    return Codec(_itself, lambda node: node.line(most), {"type": "string", "maxLength": most})


def choice(
    kind: type[Choice], word: Callable[[Choice], str] = attrgetter("value")
) -> Codec[Choice]:
    """A member of an enumeration, by its value or by another word."""
    members = {word(member): member for member in kind}
    return Codec(word, lambda node: node.choice(members), {"enum": [*members]})


def by_name(member: Enum) -> str:
    """The word of a member whose value is a sentence."""
    return member.name.lower()


def optional(codec: Codec[T]) -> Codec[T | None]:
    """The same or None."""
    convert = codec.write
    write = (
        _itself if convert is _itself else lambda value: None if value is None else convert(value)
    )
    return Codec(
        write,
        lambda node: None if node.value is None else codec.read(node),
        {"anyOf": [{"type": "null"}, codec.schema]},
    )


COUNT = optional(NATURAL)


def listed(
    codec: Codec[T], length: int | None = None, most: int | None = None, like: str = ""
) -> Codec[tuple[T, ...]]:
    """Several of the same, so many or at most so many; ``like`` is an example for a record's
    message.
    """
    convert = codec.write
    write = _itself if convert is _itself else lambda values: [convert(v) for v in values]
    sizes = {"minItems": length, "maxItems": length or most}
    limits = {keyword: size for keyword, size in sizes.items() if size is not None}
    schema = {"type": "array", "items": codec.schema, **limits}
    return Codec(write, lambda node: node.each(codec.read, length, most, like), schema)


def named(
    codec: Codec[T],
    name: Callable[[Node, str], str] = lambda _, key: key,
    most: int | None = None,
    like: str = "",
) -> Codec[Mapping[str, T]]:
    """Several of the same by at most so many names; ``name`` reads one, and may refuse it."""

    def read(node: Node) -> Mapping[str, T]:
        parts = node.mapping(most, like).items()
        return dict(
            node.gathered(lambda part: (name(part[1], part[0]), codec.read(part[1])), parts)
        )

    return Codec(
        lambda values: {name: codec.write(v) for name, v in values.items()}, read,
        {"type": "object", "additionalProperties": codec.schema, **({"maxProperties": most} if most else {})},
    )  # fmt: skip


def either(
    key: str, is_first: Callable[[T], bool], first: Codec[Any], other: Codec[Any]
) -> Codec[T]:
    """One of two records, of which only the first has this key."""
    return Codec(
        lambda value: (first if is_first(value) else other).write(value),
        lambda node: (first if key in node.mapping() else other).read(node),
        {"anyOf": [first.schema, other.schema]},
    )


def in_words(text: Callable[[Any], str | None], codec: Codec[Any] = TEXT) -> Codec[Any]:
    """A value as a text from which it is not read back."""
    return codec._replace(write=text)


def converted(codec: Codec[S], get: Callable[[T], S], make: Callable[[S], T]) -> Codec[T]:
    """What is written as another value; what ``make`` refuses is wrong with that place."""
    return Codec(
        lambda value: codec.write(get(value)),
        lambda node: node.made(make, codec.read(node)),
        codec.schema,
    )


class Key(NamedTuple):
    """One key of a record.

    Attributes
    ----------
    codec : that of the field's annotation when None (`record_of`).
    field : the attribute that is written, and the argument that is read; named like the key when
        empty.
    get : what is written, of the record's object; the attribute when None.
    default : is read where the key is missing; it is written only ``always``.
    made : whether what is read is handed to what makes the object.
    checked : whether what is read has to be what the object, once it is made, gives; not in a
        document that lacks one of the keys that are checked, as an earlier version wrote it.
    beside : where it is not empty, the codec writes an object with some of these keys, which stand
        beside the others.
    instead : of a record, what is taken where the key is wrong or missing; without it nothing is
        read of the object.
    entry_of : the field, a mapping, in which the key has its entry; in there is none where it is
        null.
    """

    codec: Codec[Any] | None = None
    get: Callable[[Any], Any] | None = None
    default: object = ...
    field: str = ""
    always: bool = False
    made: bool = True
    checked: bool = False
    beside: tuple[str, ...] = ()
    instead: object = ...
    entry_of: str = ""


_DEFAULT = object()


def part(
    codec: Codec[Any],
    help: str = "",
    default: object = ...,
    instead: object = _DEFAULT,
    shown: object = ...,
) -> Key:
    """A key of what a person writes; ``help`` is what it means, and ``shown`` its default, for
    people.
    """
    said = {"description": help, "default": shown}
    described = codec.narrowed(
        **{keyword: value for keyword, value in said.items() if value not in ("", ...)}
    )
    return Key(
        described, None, default, always=True, instead=default if instead is _DEFAULT else instead
    )


def reading(read: Callable[[Node], T], **schema: Any) -> Codec[T]:
    """What a person writes and the program only reads; ``schema`` has the keywords of what is
    valid.
    """
    return Codec(_itself, read, schema)


def derived(get: Callable[[Any], Any], codec: Codec[Any] = TEXT, default: object = ...) -> Key:
    """A key that says for people what others say exactly; a document in which they differ is
    refused.
    """
    return Key(codec, get, default, always=True, made=False, checked=True)


def record(make: Callable[..., T], like: str = "", /, **keys: Codec[Any] | Key) -> Codec[T]:
    """An object with these keys, in this order.

    Parameters
    ----------
    make : of the keys' values, by their names; what it refuses is wrong with the object.
    like : an example for a record's message.
    """
    entries = {name: key if isinstance(key, Key) else Key(key) for name, key in keys.items()}
    known = [name for key, entry in entries.items() for name in entry.beside or (key,)]
    needed = [name for name, key in entries.items() if key.default is ... and not key.beside]
    parts = [
        (n, key, cast(Codec[Any], key.codec), key.get or _getter(n, key), key.default)
        for n, key in entries.items()
    ]
    within = {name: key.entry_of for name, key in entries.items() if key.entry_of}
    checked = {name: (get, codec) for name, key, codec, get, _ in parts if key.checked}

    def write(value: T) -> dict[str, Any]:
        found = {}
        for name, key, codec, get, default in parts:
            part = get(value)
            if key.beside:
                found.update(codec.write(part))
            elif key.always or default is ... or part != default:
                found[name] = part if codec.write is _itself else codec.write(part)
        return found

    def read(node: Node) -> T:
        given = node.record(known, needed, like)
        values = {}
        for name, key, codec, _, default in parts:
            if not key.made:
                continue
            place = node if key.beside else given.get(name)
            if place is not None:
                values[key.field or name] = node.attempt(codec.read, place, key.instead)
            else:
                values[key.field or name] = key.instead if default is ... else default
        if ... in values.values():
            raise node.noted()
        for name, field in within.items():
            if (entry := values.pop(name)) is not None:
                values.setdefault(field, {})[name] = entry
        found = node.made(make, **values)
        if all(name in given for name in checked):
            for name, (get, codec) in checked.items():
                if given[name].value != (other := codec.write(get(found))):
                    raise given[name].fault(f"is not {str(other)[:60]!r}, as the rest says")
        return found

    properties, alternatives = dict[str, Any](), dict[str, Any]()
    for name, key, codec, _, default in parts:
        schema: Schema = {"const": True} if default is False and not key.always else codec.schema
        properties |= schema["properties"] if key.beside else {name: schema}
        alternatives |= {"oneOf": schema["oneOf"]} if key.beside else {}
    return Codec(write, read, {
        "type": "object", "properties": properties, "required": needed, "additionalProperties": False, **alternatives,
    })  # fmt: skip


def _getter(name: str, key: Key) -> Callable[[Any], Any]:
    """What is written of a record's object, where the key does not say it."""
    if key.entry_of:
        return lambda value: getattr(value, key.entry_of).get(name)
    return attrgetter(key.field or name)


# ---------------------------------------------------------------------------------------------- read off annotations

_KNOWN: Known = {str: TEXT, bool: TRUTH, int: NATURAL, float: SECONDS, Fraction: RATIONAL}


def codec_of(hint: Any, known: Known = _ALIKE) -> Codec[Any]:
    """The codec of a type: of text, numbers, enumerations, tuples, mappings, and of classes of such
    fields.

    Parameters
    ----------
    known : codecs of types that are written in another way, wherever they occur.
    """
    if (found := known.get(hint, _KNOWN.get(hint))) is not None:
        return found
    kind, parts = get_origin(hint), get_args(hint)
    if NoneType in parts:
        return optional(codec_of(_without_none(hint), known))
    if kind is tuple:
        return listed(codec_of(parts[0], known), None if parts[-1] is ... else len(parts))
    if kind is Mapping:
        return named(codec_of(parts[1], known))
    if issubclass(hint, Enum):
        return choice(hint)
    return record_of(hint, known)


def record_of(
    kind: type[T], known: Known = _ALIKE, make: Callable[..., T] | None = None, /,
    **keys: Codec[Any] | Key | None,
) -> Codec[T]:  # fmt: skip
    """An object with a key for each field of a frozen class, by its annotation, and further ones.

    Parameters
    ----------
    known : as of `codec_of`.
    make : of the keys' values; the class itself when None.
    keys : in place of those of fields, or further ones; None for a field that is not written.
    """
    renamed = {key.field: name for name, key in keys.items() if isinstance(key, Key) and key.field}
    own = {renamed.get(field, field): Key(field=field) for field in _fields(kind)}
    found = {**own, **keys}
    bare = {n: key for n, key in found.items() if isinstance(key, Key) and key.codec is None}
    hints = _hints(cast(Hashable, kind), tuple(key.field or name for name, key in bare.items()))
    for name, key in bare.items():
        found[name] = key._replace(codec=codec_of(hints[key.field or name], known))
    made = record(make or kind, **{name: key for name, key in found.items() if key is not None})
    return made.narrowed(**{CLASS: kind.__name__})


def row_of(kind: type[T], make: Callable[..., T] | None = None) -> Codec[T]:
    """A list of the fields of a frozen class, in their order; those with a default may be missing at
    its end.
    """
    names = tuple(_fields(kind))
    codecs = [codec_of(hint) for hint in _hints(cast(Hashable, kind), names).values()]

    def read(node: Node) -> T:
        return node.made(
            make or kind,
            *(c.read(p) for c, p in zip(codecs, node.items(most=len(names)), strict=False)),
        )

    return Codec(
        lambda value: [c.write(v) for c, v in zip(codecs, attrgetter(*names)(value), strict=True)],
        read,
    )


def unless_default(kind: type, *names: str, known: Known = _ALIKE) -> dict[str, Key]:
    """Keys of fields that are left out where a field has its default."""
    keys, hints = {}, _hints(kind, names)
    for name, default in _fields(kind).items():
        if name in names:
            written = _without_none(hints[name]) if default is None else hints[name]
            keys[name] = Key(codec_of(written, known), default=default)
    return keys


def _without_none(hint: Any) -> Any:
    return reduce(or_, (part for part in get_args(hint) if part is not NoneType))


def _fields(kind: Any) -> dict[str, object]:
    """The fields of a dataclass or a named tuple, in their order, each with its default or
    `MISSING`.
    """
    if issubclass(kind, tuple):
        return {name: kind._field_defaults.get(name, MISSING) for name in kind._fields}
    return {
        field.name: field.default if field.default_factory is MISSING else field.default_factory()
        for field in fields(kind)
    }


@cache
def _hints(kind: Any, names: tuple[str, ...]) -> dict[str, Any]:
    """The types of some fields: of others a module need not have the names while it runs."""
    written = {
        name: hint
        for base in reversed(kind.__mro__)
        for name, hint in vars(base).get("__annotations__", {}).items()
    }
    some = type(
        kind.__name__,
        (),
        {"__annotations__": {n: written[n] for n in names}, "__module__": kind.__module__},
    )
    return get_type_hints(some)
