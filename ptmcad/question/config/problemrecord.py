"""A problem record whose keys are known and whose values are still text.

Guarantee: what is wrong with keys and shapes is a `ConfigError` with file, line and key; nothing
unknown is ignored.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from ptmcad.errors import ConfigError, Faults, HypothesisError, Place, PtmcadError, shown
from ptmcad.model import Model, ptm
from ptmcad.model.reading import MAX_TITLE, NUMBER, VALUE, text_in, title_in, two
from ptmcad.question.config.modelkeys import Described, described_in
from ptmcad.question.config.scalars import (
    AXIS_NAME,
    MAX_FILE_NAME,
    MAX_MEMBERS,
    MAX_VALUES,
    Window,
    axes_in,
    check_members,
    free_in,
    name_in,
    name_of_file,
    names_in_scalar,
    number_text,
)
from ptmcad.question.counts import USUAL, Count, phrases
from ptmcad.question.shipped import A_DESIGN, A_SWEEP, FORCE, SECOND, THIRD
from ptmcad.question.slice import MAX_UNIT, QUANTITIES
from ptmcad.text.codec import Codec, Key, choice, named, part, reading, record
from ptmcad.text.entry import Scalar, Sequence, Tree, Written, plain_data
from ptmcad.text.node import Node, unstorable
from ptmcad.text.syntax import did_you_mean

COUNT = choice(Count)

_NOTHING: Mapping[str, Any] = {}
"""What is not written; a plain mapping, as records go to other processes."""


class Record(NamedTuple):
    """A record whose keys are known and whose values are still text.

    Attributes
    ----------
    counting : which count distinguishes two regions; None of the mechanism's own choice.
    values_place : where the values are given, or would be; None of what is no record.
    sweep : what is swept, as it is written; `ptmcad.question.config.sweeps` reads it.
    design : what is designed, as it is written; `ptmcad.question.config.designkey` reads it, and no
        other command asks.
    unread : names that may stand in values and of which nothing can be said, because what says it
        is faulty.
    """

    model: Model
    name: str = ""
    title: str = ""
    values: Mapping[str, Scalar] = _NOTHING
    axes: Mapping[str, Window] = _NOTHING
    free: tuple[str, Window] | None = None
    members: Written | None = None
    counting: Count | None = None
    units: Mapping[str, str] = _NOTHING
    reference: Mapping[str, Any] = _NOTHING
    place: Place = Place()
    sweep: Written | None = None
    design: Written | None = None
    count_place: Place = Place("count")
    values_place: Place | None = None
    described: Described = Described(ptm())
    unread: frozenset[str] = frozenset()

    def place_of(self, name: str) -> Place:
        """Where a parameter's value is written, or what describes it, or where a value would be
        given.
        """
        if name in self.values:
            return self.values[name].place
        return self.described.place_of(name) or (self.values_place or self.place).below(name)

    def uses(self, name: str) -> bool:
        """Whether some value names it."""
        return any(name in names_in_scalar(scalar) for scalar in self.values.values())

    @property
    def doubtful(self) -> frozenset[str]:
        """Names of which nothing can be said, because what describes them is faulty."""
        return self.unread | self.described.doubtful

    def place_of_part(self, key: str) -> Place:
        """Where a part of the description stands, such as ``springs.2.k``."""
        return self.described.place_of_part(key) or Place(key)


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


def read_record(tree: Tree, faults: Faults) -> Record:
    """A record as far as its keys and shapes are right; what is not is noted, and left out or
    replaced by 1.

    Raises
    ------
    ConfigError
        At once for a file that ptmcad wrote itself: each of its keys would be a fault of its own.
        And without a model.
    """
    kind = tree.entries.get("format")
    if isinstance(kind, Scalar) and kind.text.startswith("ptmcad-"):
        raise tree.place.error(
            f"this is a {shown(kind.text, 40)} file, a result, not a problem record: `ptmcad plot`, `report`, "
            "`verify`, `locate` and `map` take results"
        )
    node = Node.of(tree, faults)
    name, described = "", None
    if "name" not in tree.entries:
        with faults:
            name = name_of_file(tree.place.file)
    with faults:
        described = described_in(tree, faults)
    read: dict[str, Any] = record_codec(None if described is None else described.model).read(node)
    if read["members"] is not None and "free" not in tree.entries:
        with faults:
            raise node.at("members").fault(
                "there are members where a parameter is free: add one, such as free: {F: [-20, 0]}"
            )
    if described is None:  # then nothing can be said of the values
        faults.check()
    assert described is not None
    return Record(
        described.model,
        **{**read, "name": read["name"] or name},
        described=described,
        place=tree.place,
        count_place=node.at("count").place,
        values_place=node.at("parameters").place,
    )


def record_codec(model: Model | None) -> Codec[dict[str, Any]]:
    """A record's keys, read in this order.

    Parameters
    ----------
    model : what the record is about; it has been read.
    """
    unit = reading(_unit, type="string", minLength=1, maxLength=MAX_UNIT)
    units = {
        "type": "object",
        "additionalProperties": False,
        "properties": {q: unit.schema for q in QUANTITIES},
    }
    return record(
        dict,
        name=part(
            reading(
                name_in,
                type="string",
                pattern="^[A-Za-z0-9]([A-Za-z0-9._-]*[A-Za-z0-9_-])?$",
                maxLength=MAX_FILE_NAME,
            ),
            "Start of the names of the files that are written; by default the record's own file name.",
            "",
        ),
        title=part(
            reading(title_in, type="string", maxLength=MAX_TITLE), "The picture's title.", ""
        ),
        notes=_elsewhere("Free text for the reader of the record.", type="string"),
        mechanism=_elsewhere(
            "A built-in mechanism's name, a file below the record's folder that describes one, or a description.",
            shown=ptm().name,
        ),
        system=_elsewhere("Another parametric system, in place of a mechanism."),
        parameters=part(
            reading(
                lambda node: _values(node, model),
                type=["object", "null"],
                additionalProperties=VALUE,
            ),
            f"Fixed values, or expressions in the axes and in other parameters ({FORCE}: F, {SECOND}: 2*{THIRD}). "
            f"Below are those of the mechanism {ptm().name}; others have their own.",
            {},
        )._replace(field="values"),
        **_question(),
        units=part(
            named(unit, _quantity, like="{length: mm}")._replace(schema=units),
            "Units that pictures and tables name; numbers are taken as they are.",
            {},
        ),
        reference=part(
            reading(_reference, type=["object", "null"]),
            "Published answers, for tests and benchmarks; never used by the computation.",
            {},
        ),
    )


def _elsewhere(help: str, shown: object = ..., **schema: Any) -> Key:
    """A key that is read elsewhere, or by nobody."""
    unread = reading(lambda node: None, **schema)
    return part(unread, help, None, shown=shown)._replace(made=False)


def _question() -> dict[str, Key]:
    """The keys of what is asked."""
    windows = {"type": "object", "propertyNames": AXIS_NAME, "additionalProperties": two(NUMBER)}
    return {
        "axes": part(
            reading(axes_in, **windows, minProperties=2, maxProperties=2),
            "The two axes with their ranges, the horizontal one first: parameters, or new names that expressions use.",
            {},
        ),
        "free": part(
            reading(free_in, **windows, minProperties=1, maxProperties=1),
            "A third parameter with its range: the record is one of a family, with a map for each of its members.",
            None,
        ),
        "members": part(
            reading(
                lambda node: check_members(node.value),
                anyOf=[
                    NUMBER,
                    {"type": "array", "items": NUMBER, "minItems": 1, "maxItems": MAX_MEMBERS},
                ],
            ),
            "Values of the free parameter at which there are maps, or how many, evenly spaced; 9 when it is not given.",
            None,
        ),
        "sweep": part(
            _kept((Sequence, Tree), f"parameters with their values, such as {A_SWEEP}"),
            "For ptmcad sweep: parameters, or names that expressions use, with the values that they take, in every "
            "combination; a list of such mappings is one after another.",
            None,
        ),
        "design": part(
            _kept((Tree,), f"what is designed, such as {A_DESIGN}"),
            "For ptmcad design: what is made as large as possible, over which parameters within which bounds, and "
            "under what conditions. Other commands take the record without it.",
            None,
        ),
        "count": part(
            COUNT,
            f"What distinguishes two regions: {phrases()}. Where nothing says what is stable, total is the default.",
            None,
            shown=USUAL.value,
        )._replace(field="counting"),
    }


def with_place(error: ConfigError | HypothesisError, record: Record) -> PtmcadError:
    """A fault that an engine finds, with file, line and key: those of a parameter, of a part, or of
    the whole slice.

    As it is where its place is known already, or nothing in the record is to blame.
    """
    if isinstance(error, ConfigError):
        if error.file is not None or error.line is not None or len(error.faults) > 1:
            return error
        if error.key == "count" and record.counting is not None:
            return record.count_place.error(error.message)
        key = error.key or "-"
        return (
            record.place_of_part(key).error(error.message)
            if record.described.has_part(key)
            else error
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
    if (place := record.described.place_of_part("")) is not None:
        return place
    axes = next(iter(record.axes.values()), None)
    if axes is None or axes.place.file is None:
        return None  # only options, or a mapping
    return Place("axes", axes.place.file, axes.place.line)


def _values(parameters: Node, model: Model | None) -> dict[str, Scalar]:
    """The values that are given; without a model any name is taken."""
    if isinstance(parameters.value, Scalar) and parameters.value.is_null:
        return {}
    values = {}

    def read(entry: Node) -> None:
        if model is not None and entry.name not in model.parameters:
            raise entry.fault(unknown_parameter(entry.name, model))
        values[entry.name] = Scalar("1", entry.place)  # known, whatever is wrong with it
        values[entry.name] = number_text(entry)

    some = [*(model or ptm()).parameters.values()][:2]
    example = ", ".join(f"{parameter.name}: {parameter.default or 1}" for parameter in some)
    expected = f"expected a mapping such as {{{example}}}"
    parameters.gathered(read, parameters.mapping(MAX_VALUES, expected=expected).values())
    return values


def _kept(kinds: tuple[type[Written], ...], expected: str) -> Codec[Written]:
    """What is kept as it is written, for the command that asks for it."""

    def read(node: Node) -> Written:
        if not isinstance(node.value, kinds):
            raise node.fault(f"expected {expected}")
        written: Written = node.value
        return written

    return reading(read)


def swept_names(record: Record) -> dict[str, Place]:
    """What a record sweeps, with its places, as far as that can be read."""
    node = record.sweep
    parts = node.items if isinstance(node, Sequence) else (node,)
    return {
        name: entry.place
        for part in parts
        if isinstance(part, Tree)
        for name, entry in part.entries.items()
    }


def unknown_parameter(name: str, model: Model) -> str:
    """The message for a name that is none of the model's parameters."""
    if not model.parameters:
        return f"unknown parameter '{name[:40]}': {model.name} has none"
    hint = did_you_mean(name, model.parameters, "; the parameters are ")
    return f"unknown parameter '{name[:40]}'{hint}"


def _quantity(entry: Node, name: str) -> str:
    if name not in QUANTITIES:
        hint = did_you_mean(name, QUANTITIES, "; units are those of ", " and ")
        raise entry.fault(f"unknown quantity{hint}")
    return name


def _unit(entry: Node) -> str:
    """The unit of a quantity, which pictures and tables name."""
    text = text_in(entry, MAX_UNIT).strip()
    if not text.isprintable() or re.fullmatch(r"[-+.\d]*", text):  # empty, or a number
        raise entry.fault("a unit is a short text such as mm")
    return text


def _reference(node: Node) -> dict[str, Any]:
    data = plain_data(node.value)
    if data is None:
        return {}
    if not isinstance(data, dict):
        raise node.fault("expected a mapping of published answers")
    if (found := unstorable(data)) is not None:
        raise node.fault(
            f"it has the character U+{ord(found):04X}, which a result cannot store: remove it"
        )
    return data
