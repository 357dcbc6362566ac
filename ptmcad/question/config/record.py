"""A problem record whose keys are known and whose values are still text.

Guarantee: what is wrong with keys and shapes is a `ConfigError` with file, line and key; nothing unknown is ignored.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ptmcad.errors import ConfigError, Faults, HypothesisError, PtmcadError, shown
from ptmcad.mechanism import Model, ptm
from ptmcad.mechanism.reading import MAX_TITLE, title_of
from ptmcad.question.config.model import Described, described_in
from ptmcad.question.config.parameters import unknown_parameter
from ptmcad.question.config.scalars import names_in_scalar, number_text
from ptmcad.question.examples import A_DESIGN, A_SWEEP, AXES
from ptmcad.question.slice import MAX_UNIT, QUANTITIES, Count
from ptmcad.text.entry import Entry, Node, Place, Scalar, Sequence, Tree, plain_data
from ptmcad.text.node import unstorable
from ptmcad.text.syntax import NAME, did_you_mean

RECORD_KEYS = ("name", "title", "notes", "mechanism", "system", "parameters", "axes", "free", "members", "sweep",
               "design", "count", "units", "reference")  # fmt: skip
MAX_MEMBERS = 400
"""Of a family."""
_MAX_NAME = 100
MAX_VALUES = 10_000
"""Of a record: more than a file may have."""
_FIELDS = {"parameters": "values", "count": "counting"}
"""Of a `Record`, where it is not named like its key."""
_PORTS = tuple(f"{port}{digit}" for port in ("COM", "LPT") for digit in "0123456789¹²³")
_DEVICES = frozenset(("CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$", *_PORTS))
"""Windows takes a file of such a name, in any case and with any suffix, for a device."""

_NOTHING: Mapping[str, Any] = {}
"""What is not written; a plain mapping, as records go to other processes."""


class Window(NamedTuple):
    """The range of an axis as written."""

    low: Scalar
    high: Scalar
    place: Place


class Record(NamedTuple):
    """A record whose keys are known and whose values are still text.

    Attributes
    ----------
    counting : which count distinguishes two regions; None of the mechanism's own choice.
    values_place : where the values are given, or would be; None of what is no record.
    sweep : what is swept, as it is written; `ptmcad.question.config.sweeps` reads it.
    design : what is designed, as it is written; `ptmcad.question.config.designs` reads it, and no other command asks.
    unread : names that may stand in values and of which nothing can be said, because what says it is faulty.
    """

    model: Model
    name: str = ""
    title: str = ""
    values: Mapping[str, Scalar] = _NOTHING
    axes: Mapping[str, Window] = _NOTHING
    free: tuple[str, Window] | None = None
    members: Node | None = None
    counting: Count | None = None
    units: Mapping[str, str] = _NOTHING
    reference: Mapping[str, Any] = _NOTHING
    place: Place = Place()
    sweep: Node | None = None
    design: Node | None = None
    count_place: Place = Place("count")
    values_place: Place | None = None
    described: Described | None = None
    unread: frozenset[str] = frozenset()

    def place_of(self, name: str) -> Place:
        """Where a parameter's value is written, or what describes it, or where a value would be given."""
        if name in self.values:
            return self.values[name].place
        found = self.described.place_of(name) if self.described is not None else None
        return found or (self.values_place or self.place).below(name)

    @property
    def doubtful(self) -> frozenset[str]:
        """Names of which nothing can be said, because what describes them is faulty."""
        return self.unread | (self.described.doubtful if self.described is not None else frozenset())

    def place_of_part(self, key: str) -> Place:
        """Where a part of the description stands, such as ``springs.2.k``."""
        found = self.described.place_of_part(key) if self.described is not None else None
        return found or Place(key)


def record_of(tree: Tree) -> Record:
    """Check the keys and shapes of a record.

    Raises
    ------
    ConfigError
        That knows all faults.
    """
    faults = Faults()
    record = read_record(tree, faults)
    faults.check()
    return record


def described_record(tree: Tree) -> tuple[Record, Faults]:
    """A record as `read_record` has it, and what is wrong with it, where there is a model.

    Raises
    ------
    ConfigError
        Without one: then nothing can be said of the values.
    """
    faults = Faults()
    record = read_record(tree, faults)
    if record.described is None:
        faults.check()
    return record, faults


def read_record(tree: Tree, faults: Faults) -> Record:
    """A record as far as its keys and shapes are right; what is not is noted, and left out or replaced by 1.

    Raises
    ------
    ConfigError
        At once for a file that ptmcad wrote itself: each of its keys would be a fault of its own.
    """
    kind = tree.entries.get("format")
    if isinstance(kind, Scalar) and kind.text.startswith("ptmcad-"):
        raise tree.place.error(
            f"this is a {shown(kind.text, 40)} file, a result, not a problem record: `ptmcad plot`, `report`, "
            "`verify`, `locate` and `map` take results"
        )
    whole = Entry.of(tree, tree.place, faults).fields(RECORD_KEYS)
    read: dict[str, Any] = {"place": tree.place}
    for part, key in (("values_place", "parameters"), ("count_place", "count")):
        read[part] = whole.at(key, Scalar("", tree.place.below(key))).place
    model = None
    with faults:
        read["described"] = described_in(tree, faults)
        model = read["model"] = read["described"].model
    readers: dict[str, Callable[[Entry], Any]] = {
        "name": _file_name,
        "title": _title,
        "parameters": lambda entry: _values(entry, model),
        "axes": _axes,
        "free": _free,
        "members": lambda entry: check_members(tree.entries["members"]),
        "sweep": lambda entry: _sweep(tree.entries["sweep"]),
        "design": lambda entry: _design(tree.entries["design"]),
        "count": lambda entry: count_of(tree.entries["count"]),
        "units": _units,
        "reference": lambda entry: _reference(tree.entries["reference"]),
    }
    for key, reader in readers.items():
        with faults:
            if whole.has(key):
                read[_FIELDS.get(key, key)] = reader(whole.at(key))
            elif key == "name":
                read[key] = _name_of_file(tree.place.file)
    if "members" in tree.entries and "free" not in tree.entries:
        with faults:
            raise whole.at("members").error(
                "there are members where a parameter is free: add one, such as free: {F: [-20, 0]}"
            )
    if model is None:  # of which nothing is known: the rest is read as if it were of the built-in one
        read["model"] = ptm()
    return Record(**read)


def with_place(error: ConfigError | HypothesisError, record: Record) -> PtmcadError:
    """A fault that an engine finds, with file, line and key: those of a parameter, of a part, or of the whole slice.

    As it is where its place is known already, or nothing in the record is to blame.
    """
    if isinstance(error, ConfigError):
        if error.file is not None or error.line is not None or len(error.faults) > 1:
            return error
        if error.key == "count" and record.counting is not None:
            return record.count_place.error(error.message)
        described = record.described
        return (
            error
            if described is None or not described.has_part(error.key or "-")
            else (record.place_of_part(error.key or "").error(error.message))
        )
    place = _place_of_fault(error, record)
    return error if place is None else place.error(str(error))


def _place_of_fault(error: HypothesisError, record: Record) -> Place | None:
    if error.part:
        return record.place_of_part(error.part)
    if name := error.parameter:
        if name not in record.values and name not in record.axes:
            name = record.model.parameters[name].alias_of or name
        return record.axes[name].place if name in record.axes else record.place_of(name)
    if record.described is not None and (place := record.described.place_of_part("")) is not None:
        return place
    axes = next(iter(record.axes.values()), None)
    if axes is None or axes.place.file is None:
        return None  # only options, or a mapping
    return Place("axes", axes.place.file, axes.place.line)


def _text(entry: Entry, limit: int) -> str:
    if not isinstance(entry.value, Scalar) or entry.value.is_null:
        raise entry.error("expected a text")
    if len(entry.value.text) > limit:
        raise entry.error(f"the text is longer than {limit} characters")
    return entry.value.text


def _title(entry: Entry) -> str:
    try:
        return title_of(_text(entry, MAX_TITLE))
    except ConfigError as error:
        raise entry.error(error.message) from error


def file_name(name: str, option: str) -> str:
    """A name for files that an option gives.

    Raises
    ------
    ConfigError
        When it is not safe as the start of a file's name.
    """
    place = Place(option)
    return _file_name(Entry(Scalar(name, place), place, Faults()))


def _file_name(entry: Entry) -> str:
    """A name that is safe as the start of a file's name."""
    name = _text(entry, _MAX_NAME)
    if not name or not name[0].isalnum() or not all(c.isalnum() or c in "._-" for c in name) or name.endswith("."):
        raise entry.error(
            f"{name!r} cannot name a file: use letters, digits, '.', '_' and '-', starting with a letter or digit"
        )
    return _portable(name, entry.place)


def portable_file(file: str, option: str) -> str:
    """The name of a file that an option gives, with its suffix: any that no system gives another meaning.

    Raises
    ------
    ConfigError
        When Windows keeps the name for a device, or would drop its end.
    """
    if file.endswith((".", " ")):
        raise Place(option).error(f"{file!r} cannot name a file: Windows drops dots and spaces at the end")
    return _portable(file, Place(option))


def _portable(name: str, place: Place) -> str:
    device = name.partition(".")[0].rstrip(" ").upper()
    if device in _DEVICES:
        raise place.error(f"{name!r} cannot name a file: Windows keeps {device} for a device, whatever the suffix")
    return name


def _name_of_file(file: str | None) -> str:
    """The file's stem, with characters that `_file_name` refuses replaced; empty when there is no file.

    Raises
    ------
    ConfigError
        When Windows keeps the name for a device.
    """
    stem = Path(file).stem if file else ""
    name = "".join(c if c.isalnum() or c in "._-" else "-" for c in stem).strip(".-_")[:_MAX_NAME]
    return _portable(name, Place("name", file))


def _values(parameters: Entry, model: Model | None) -> dict[str, Scalar]:
    """The values that are given; without a model any name is taken."""
    if isinstance(parameters.value, Scalar) and parameters.value.is_null:
        return {}
    values = {}
    expected = f"expected a mapping such as {{{_example(model or ptm())}}}"
    for name, entry in parameters.entries(most=MAX_VALUES, expected=expected).items():
        with parameters.faults:
            if model is not None and name not in model.parameters:
                raise entry.error(unknown_parameter(name, model))
            values[name] = Scalar("1", entry.place)  # known, whatever is wrong with it
            values[name] = number_text(entry)
    return values


def _example(model: Model) -> str:
    return ", ".join(f"{name}: {parameter.default or 1}" for name, parameter in list(model.parameters.items())[:2])


def _axes(entry: Entry) -> dict[str, Window]:
    axes = entry.entries(most=MAX_VALUES, expected=f"expected two axes with their ranges, such as {AXES}")
    if len(axes) != 2:
        with entry.faults:
            raise entry.error(f"{len(axes)} axes are given: a slice has two, the horizontal one first")
    return dict(entry.each_entry(lambda axis: (axis.name, _window(axis))))


def _free(entry: Entry) -> tuple[str, Window]:
    """The third parameter of a family with its range."""
    expected = "expected one parameter with its range, such as {F: [-20, 0]}"
    free = [*entry.entries(expected=expected).values()]
    if len(free) != 1:
        raise entry.error(expected)
    return free[0].name, _window(free[0])


def _window(entry: Entry) -> Window:
    check_axis_name(entry.name, entry.place)
    return window_of(entry, "a range", "[0, 2]")


def window_of(entry: Entry, what: str, like: str) -> Window:
    """The range that a list of two ends is; what it is, and an example, are for messages."""
    low, high = entry.pair(what, like, f"expected {what} such as {like}")
    return Window(number_text(low), number_text(high), entry.place)


def _sweep(node: Node) -> Node:
    if isinstance(node, Scalar):
        raise node.place.error(f"expected parameters with their values, such as {A_SWEEP}")
    return node


def swept_names(record: Record) -> dict[str, Place]:
    """What a record sweeps, with its places, as far as that can be read."""
    found: dict[str, Place] = {}
    node = record.sweep
    for part in node.items if isinstance(node, Sequence) else (node,):
        if isinstance(part, Tree):
            found |= {name: entry.place for name, entry in part.entries.items()}
    return found


def _design(node: Node) -> Node:
    if not isinstance(node, Tree):
        raise node.place.error(f"expected what is designed, such as {A_DESIGN}")
    return node


def check_members(node: Node) -> Node:
    """The members of a family as written; refuses what can neither be a list of values nor a number of members."""
    if isinstance(node, Tree):
        raise node.place.error("expected a list of values such as [-20, -10, 0], or how many, such as 9")
    if isinstance(node, Scalar) and (names := names_in_scalar(number_text(node))):
        raise node.place.error(
            f"{names[0][:40]} is neither how many members there are, 2 to {MAX_MEMBERS}, nor a list of values such as "
            "-20,-10,0, nor 'between', which --changes finds"
        )
    return node


def check_axis_name(name: str, place: Place) -> None:
    if not NAME.fullmatch(name) or len(name) > 40 or name.lower() in ("nan", "inf", "infinity"):
        raise place.error(
            f"{name[:40]!r} cannot name an axis: use ASCII letters, digits and '_', starting with a letter"
        )


def count_of(node: Node) -> Count:
    words = [member.value for member in Count]
    if not isinstance(node, Scalar) or node.text not in words:
        found = f"'{node.text[:40]}'" if isinstance(node, Scalar) else "a list or a mapping"
        raise node.place.error(f"{found} is not a count: write {', '.join(words[:-1])} or {words[-1]}")
    return Count(node.text)


def _units(units: Entry) -> dict[str, str]:
    """Units of quantities, which pictures and tables name."""

    def read(entry: Entry) -> tuple[str, str]:
        if entry.name not in QUANTITIES:
            hint = did_you_mean(entry.name, QUANTITIES) or f"; units are those of {' and '.join(QUANTITIES)}"
            raise entry.error(f"unknown quantity{hint}")
        text = _text(entry, MAX_UNIT).strip()
        if not text.isprintable() or re.fullmatch(r"[-+.\d]*", text):  # empty, or a number
            raise entry.error("a unit is a short text such as mm")
        return entry.name, text

    units.entries(expected=f"expected a mapping such as length: mm of {' and '.join(QUANTITIES)}")
    return dict(units.each_entry(read))


def _reference(node: Node) -> dict[str, Any]:
    data = plain_data(node)
    if data is None:
        return {}
    if not isinstance(data, dict):
        raise node.place.error("expected a mapping of published answers")
    if (found := unstorable(data)) is not None:
        raise node.place.error(f"it has the character U+{ord(found):04X}, which a result cannot store: remove it")
    return data
