"""The key ``sweep`` of a record: which values some parameters take together, as products of lists and
progressions, one after another, and the slice of each member.

Guarantee: whatever is wrong is a `ConfigError` with file, line and key. A member is the slice that
the options ``--set`` would ask for with the member's values. Values are exact rational numbers, a
range ends exactly where it says, and nothing is listed that a progression describes. Members are
numbered from 0 in the order of the record: products in their order, of each the last parameter's
value changing fastest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from typing import Any

from ptmcad.model import Model
from ptmcad.model.reading import NUMBER
from ptmcad.question.config.binding import with_numbers
from ptmcad.question.config.objects import tree_of
from ptmcad.question.config.problemrecord import Record, swept_names
from ptmcad.question.config.resolution import check_number, described_record, note_values, slice_of
from ptmcad.question.config.scalars import AXIS_NAME, check_axis_name, number_of, number_text
from ptmcad.question.shipped import A_SWEEP, FIRST, RecordSource
from ptmcad.question.slice import Slice
from ptmcad.text.codec import Codec, part, reading, record
from ptmcad.text.entry import Sequence, Tree
from ptmcad.text.node import Node
from ptmcad.text.syntax import did_you_mean


@dataclass(frozen=True, slots=True)
class _Spaced:
    """``number`` values, each a ``step`` from the one before; the step may be negative."""

    first: Fraction
    step: Fraction
    number: int

    def __len__(self) -> int:
        return self.number

    def __getitem__(self, number: int) -> Fraction:
        return self.first + number * self.step


Values = _Spaced | tuple[Fraction, ...]
Product = Mapping[str, Values]
"""Every combination of the parameters' values."""


def _size(product: Product) -> int:
    return prod(map(len, product.values()))


def _chosen(product: Product, number: int) -> dict[str, Fraction]:
    """The values of one combination, the last parameter's changing fastest."""
    chosen = {}
    for name, values in reversed(tuple(product.items())):
        number, place = divmod(number, len(values))
        chosen[name] = values[place]
    return chosen


MAX_MEMBERS = 1_000_000
"""Of a sweep; more would rather be asked in parts."""
_EXPECTED = f"expected parameters with their values, such as {A_SWEEP}"


@dataclass(frozen=True, slots=True)
class Sweeping:
    """A record and the values that its sweep gives to some of its parameters: products, one after
    another, all of the same parameters.
    """

    record: Record
    products: tuple[Product, ...]

    @property
    def name(self) -> str:
        """The start of the names of the files that are written."""
        return self.record.name or f"sweep-{'-'.join(self.names)}"

    @property
    def names(self) -> tuple[str, ...]:
        """What is swept, in the record's order."""
        return tuple(self.products[0])

    def __len__(self) -> int:
        return sum(map(_size, self.products))

    def values(self, number: int) -> dict[str, Fraction]:
        """The values of a member.

        Raises
        ------
        IndexError
            When there is no such member.
        """
        rest = number
        for product in self.products:
            if 0 <= rest < _size(product):
                chosen = _chosen(product, rest)
                return {name: chosen[name] for name in self.names}
            rest -= _size(product)
        raise IndexError(f"there is no member {number} of {len(self)}")

    def slice(self, number: int) -> Slice:
        """The slice of a member.

        Raises
        ------
        ConfigError
            When these values are not what the mechanism needs.
        """
        return slice_of(with_values(self.record, self.values(number)))


def with_values(record: Record, values: Mapping[str, Fraction]) -> Record:
    """The record with values for what it sweeps; its title and its published answers are those of
    another slice.
    """
    return with_numbers(record, values, {})._replace(sweep=None, title="", reference={})


def sweep_from(question: RecordSource | Sweeping) -> Sweeping:
    """The sweep that is meant by a record's file, by a mapping like a record, or by itself.

    Raises
    ------
    ConfigError
        For anything wrong, with file, line and key; its ``faults`` are all there are.
    """
    if isinstance(question, Sweeping):
        return question
    return checked_sweep(tree_of(question))


def checked_sweep(tree: Tree) -> Sweeping:
    """The sweep of a record.

    Raises
    ------
    ConfigError
        That knows all faults of the record; of the members the first is looked at, and every
        value's sign.
    """
    record, faults = described_record(tree)
    sweep = None
    if record.sweep is not None:
        sweep = _read(Node.of(record.sweep, faults), record)
    elif "sweep" not in tree.entries:
        with faults:
            raise tree.place.below("sweep").error(
                f"is missing: say what is swept, such as {A_SWEEP}"
            )
    if sweep is None:  # of the values only what does not depend on what is swept
        note_values(record, faults, swept_names(record))
    assert sweep is not None
    slice_of(with_values(record, sweep.values(0)), faults)
    return sweep


def _read(sweep: Node, record: Record) -> Sweeping | None:
    """The sweep of a record; None where there is nothing to go on with."""
    parts = sweep.items(most=MAX_MEMBERS) if isinstance(sweep.value, Sequence) else [sweep]
    if not parts:
        sweep.note(sweep.fault(_EXPECTED))
    first: list[str] = []

    def product(part: Node) -> Product:
        entries = part.mapping(expected=_EXPECTED)
        if not entries:
            raise part.fault(_EXPECTED)
        first.extend(entries if not first else ())
        if {*entries} != {*first}:
            raise part.fault(
                f"each mapping of the list sweeps the same parameters: {', '.join(first)}"
            )
        return dict(
            part.gathered(lambda entry: (entry.name, _swept(entry, record)), entries.values())
        )

    products = sweep.gathered(product, parts)
    if len(products) < max(len(parts), 1) or not all(products):
        return None
    found = Sweeping(record, tuple(products))
    if len(found) > MAX_MEMBERS:
        sweep.note(
            sweep.fault(
                f"has {len(found)} members, more than {MAX_MEMBERS}: ask for a part of them"
            )
        )
    return found


def _swept(entry: Node, record: Record) -> Values:
    """The values of a parameter that can be swept."""
    name = entry.name
    check_axis_name(name, entry.place)
    if name in record.axes:
        raise entry.fault(
            f"{name} is an axis and cannot be swept too: remove it here or from the axes"
        )
    if name in record.values:
        raise entry.fault(
            f"{name} has a value under 'parameters' and cannot be swept too: leave one out"
        )
    if name not in record.model.parameters and not record.uses(name):
        hint = did_you_mean(name, record.model.parameters) or ";"
        raise entry.fault(
            f"no parameter is called {name[:40]}{hint} or use it in an expression, {_example(record.model, name)}"
        )
    found = _values(entry)
    if name in record.model.parameters:
        ends = (found[0], found[len(found) - 1]) if isinstance(found, _Spaced) else found
        check_number(name, record.model.kind(name), min(ends), entry.place)
    return found


def _example(model: Model, name: str) -> str:
    parameter = next(iter(model.forces), next(iter(model.parameters), FIRST))
    return f"such as {parameter}: {name[:40]} under 'parameters'"


def _values(entry: Node) -> Values:
    """The values of one parameter: a list, or a range."""
    if entry.is_mapping:
        return _range(entry)
    expected = "expected a list such as [-10, -20], or a range such as {from: -40, to: 0, step: 5}"
    items = entry.items(expected=expected, most=MAX_MEMBERS)
    if not items:
        raise entry.fault("the list is empty: give the values, such as [-10, -20]")
    return tuple(number_of(number_text(item), "a value") for item in items)


def _number(entry: Node) -> Fraction:
    return number_of(number_text(entry), f"'{entry.name}'")


def _step(entry: Node) -> Fraction:
    step = _number(entry)
    if step <= 0:
        raise entry.fault(f"a step is positive, not {step}; a range may go down: from 0 to -40")
    return step


def _steps(entry: Node) -> int:
    steps = _number(entry)
    if steps.denominator != 1 or steps < 2:
        raise entry.fault(
            f"the number of values, both ends among them, is a whole number from 2 on, not {steps}"
        )
    return int(steps)


_ENDS = {"from": "The first value.", "to": "The last value."}
_READ: Codec[dict[str, Any]] = record(
    dict,
    "{from: -40, to: 0, step: 5}",
    **{name: part(reading(_number, **NUMBER), help) for name, help in _ENDS.items()},
    step=part(
        reading(_step, **NUMBER),
        "The distance of two values, positive; it divides that of the ends.",
        None,
        ...,
    ),
    steps=part(
        reading(_steps, type="integer", minimum=2, maximum=MAX_MEMBERS),
        "The number of values.",
        None,
        ...,
    ),
)
_RANGE = _READ.narrowed(
    oneOf=[{"required": ["step"]}, {"required": ["steps"]}],
    description="Values at equal distances, both ends among them.",
)


def _range(entry: Node) -> _Spaced:
    """The values of a range with its ends and the step between two values, or the number of values."""
    said = _RANGE.read(entry)
    low, high, step, steps = said.values()
    if not entry.mapping().keys() <= said.keys():
        raise entry.noted()  # a key that nobody knows may be meant for one of these
    if entry.has("step") == entry.has("steps"):
        raise entry.fault(
            "give either step, the distance of two values, or steps, the number of values"
        )
    if low == high:
        raise entry.fault(f"the range is empty: {low} to {high}; a list gives a single value")
    if step is not None:
        place, signed = entry.at("step"), step if high > low else -step
        if ((high - low) / signed).denominator != 1:
            problem = f"steps of {step} from {low} do not end at {high}: {high - low} is no multiple of {step}"
            raise place.fault(problem)
        found = _Spaced(low, signed, int((high - low) / signed) + 1)
    else:
        place, found = entry.at("steps"), _Spaced(low, (high - low) / (steps - 1), steps)
    if found.number > MAX_MEMBERS:
        raise place.fault(f"has {found.number} values, more than {MAX_MEMBERS}")
    return found


SWEEP = {
    "anyOf": [
        {"$ref": "#/$defs/product"},
        {"type": "array", "items": {"$ref": "#/$defs/product"}, "minItems": 1},
    ]
}
"""The schema of a record's ``sweep``."""
_VALUES = {
    "anyOf": [{"type": "array", "items": NUMBER, "minItems": 1}, {"$ref": "#/$defs/progression"}]
}
DEFINITIONS = {
    "product": {
        "type": "object",
        "minProperties": 1,
        "propertyNames": AXIS_NAME,
        "additionalProperties": _VALUES,
    },
    "progression": _RANGE.schema,
}
"""Schemas of its parts."""
