"""A family of slices: a record with one more parameter that is free, and its members at values of
that parameter.

Guarantee: a member is the slice of the record in whose texts the free parameter's name is replaced
by its value, and so the slice that a person would get who typed that value. Every member at a
stated value has been read, and is as exact and complete as any slice.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from ptmcad.errors import ConfigError, ExpressionError, Faults
from ptmcad.model import Model
from ptmcad.question.config.binding import bound, member_name, written_in
from ptmcad.question.config.problemrecord import Record
from ptmcad.question.config.resolution import (
    axis_of,
    described_record,
    note_values,
    slice_of,
)
from ptmcad.question.config.scalars import MAX_MEMBERS, Window, check_members, number_of
from ptmcad.question.slice import Axes, Axis, Slice
from ptmcad.text.entry import Scalar, Sequence, Tree, Written
from ptmcad.text.expressions import Expression, Expressions, axis, constant
from ptmcad.text.node import Node
from ptmcad.text.numerals import Texts, text_of
from ptmcad.text.parsing import parse
from ptmcad.text.syntax import names_in

MEMBERS = 9
"""Where nothing is stated: so many values, evenly spaced."""


class Family(NamedTuple):
    """The question that is put to `ptmcad.family`.

    Attributes
    ----------
    record : of which the members are made.
    free : the free parameter with its range.
    values : at which members are wanted, in increasing order.
    axes : of every member.
    text : every parameter on which a member depends, as it is written in the record.
    """

    record: Record
    free: Axis
    values: tuple[Fraction, ...]
    axes: Axes
    text: Texts

    @property
    def name(self) -> str:
        return self.record.name or "family-" + "-".join((*self.record.axes, self.free.name))

    @property
    def model(self) -> Model:
        return self.record.model

    def __repr__(self) -> str:
        window = ", ".join(map(str, (*self.axes, self.free)))
        return f"<Family {self.name} of {self.model.name}: {window}, {len(self.values)} members>"

    def member(self, value: Fraction) -> Slice:
        """The slice at a value of the free parameter.

        Raises
        ------
        ConfigError
            When the value is outside of the range, or the slice is none that can be answered.
        """
        if not self.free.low <= value <= self.free.high:
            raise ConfigError(
                f"{text_of(value)} is outside of the range of {self.free.name}, {text_of(self.free.low)} to "
                f"{text_of(self.free.high)}"
            )
        return _member(self.record, self.free.name, value)


def family_of(record: Record, faults: Faults | None = None) -> Family:
    """The family of a record with a free parameter.

    Parameters
    ----------
    faults : what was found in the record before, and is raised with the rest.
    """
    faults = faults or Faults()
    assert record.free is not None
    name, window = record.free
    free: Axis | None = None
    values: tuple[Fraction, ...] = ()
    with faults:
        _check_name(record, name, window)
        free = axis_of(name, window, record.model)
        values = _values(free, record.members, faults)
    if (
        free is None or faults.found
    ):  # of the values only what does not depend on the free parameter
        note_values(record, faults, {name})
    assert free is not None
    slices = [_located(record, name, value, faults) for value in values]
    faults.check()
    first = slices[0]
    assert first is not None
    text = written_in(record, first)
    if name not in record.model.parameters and not record.uses(name):
        example = next((n for n in record.model.parameters if n not in record.axes), "")
        use = f": use it in an expression, such as {example}: {name}" if example else ""
        raise window.place.error(
            f"the free parameter {name} is not used: no parameter depends on it{use}"
        )
    return Family(record, free, values, first.axes, text)


def checked_family(tree: Tree) -> Family:
    """The family of a record as read.

    Raises
    ------
    ConfigError
        For anything wrong in it, with file, line and key; its ``faults`` are all there are.
    """
    record, faults = described_record(tree)
    if record.free is None:
        with faults:
            if "free" not in tree.entries:
                missing = tree.place.below("free")
                raise missing.error(
                    "is missing: a family has a third parameter, such as free: {F: [-20, 0]}"
                )
        note_values(record, faults)
    return family_of(record, faults)


def fault_of_member(slice: Slice, text: Texts, free: str, value: Fraction) -> str:
    """What shows that a slice is not a family's member at a value, in words; empty where it is.

    Parameters
    ----------
    text : of the family's parameters, as `Family.text`.
    """
    try:
        wanted = member_like(slice, text, free, value).parameters
    except ExpressionError as error:
        return error.message
    for name, found in slice.parameters.items():
        if wanted[name] != found:
            return "{} is {}, not {}".format(
                name, *(e.to_text(slice.axis_names) for e in (found, wanted[name]))
            )
    return ""


def member_like(
    slice: Slice, text: Texts, free: str, value: Fraction, turned: bool = False
) -> Slice:
    """Another member of the family of which a slice is one.

    Parameters
    ----------
    text : of the family's parameters, as `Family.text`.
    turned : whether the axes are exchanged.

    Raises
    ------
    ExpressionError
        When the texts say nothing of a parameter, or divide by zero at this value.
    """
    axes = (slice.axes[1], slice.axes[0]) if turned else slice.axes
    known = {own.name: axis(k) for k, own in enumerate(axes)} | {free: constant(value)}
    parameters = {name: _resolved(name, text, known) for name in slice.parameters}
    return replace(slice, axes=axes, parameters=parameters, reference={}, text={})


def _resolved(
    name: str, text: Texts, known: Expressions, chain: tuple[str, ...] = ()
) -> Expression:
    """A parameter in the axes, from the texts of those that it depends on."""
    if name in known:
        return known[name]
    if name not in text or name in chain:
        raise ExpressionError(f"the family says nothing of {name}")
    named = {other: _resolved(other, text, known, (*chain, name)) for other in names_in(text[name])}
    return parse(text[name], named)


def _member(record: Record, name: str, value: Fraction) -> Slice:
    return slice_of(bound(record, name, value)._replace(name=member_name(record, name, value)))


def _located(record: Record, name: str, value: Fraction, faults: Faults) -> Slice | None:
    """The member at a stated value; what is wrong with it is said with the value, once for all
    members.
    """
    known = {(fault.key, fault.line) for fault in faults.found}
    try:
        return _member(record, name, value)
    except ConfigError as error:
        with faults:
            for fault in error.faults:
                if (fault.key, fault.line) not in known:
                    raise fault.place.error(
                        f"{fault.message} (at {name} = {text_of(value)})"
                    ) from error
        return None


def _check_name(record: Record, name: str, window: Window) -> None:
    if name in record.axes:
        raise window.place.error(f"{name} is an axis too: a family has three different parameters")
    if name in record.values:
        raise record.values[name].place.error(
            f"{name} is free and cannot be fixed too: remove it here or from free"
        )


def _values(free: Axis, members: Written | None, faults: Faults) -> tuple[Fraction, ...]:
    """Where members are wanted: at the values of a list, or at as many as a number says, evenly
    spaced.
    """
    if members is None:
        return _spaced(free, MEMBERS)
    check_members(members)
    if isinstance(members, Scalar):
        number = number_of(members, "the number of members")
        if number.denominator != 1 or not 2 <= number <= MAX_MEMBERS:
            raise members.place.error(
                f"write how many members there are, 2 to {MAX_MEMBERS}, or a list of values"
            )
        return _spaced(free, int(number))
    entry = Node.of(members, faults)
    assert isinstance(members, Sequence)
    if not 1 <= len(members.items) <= MAX_MEMBERS:
        raise entry.fault(
            f"{len(members.items)} values are given: a family has 1 to {MAX_MEMBERS} members"
        )
    values: set[Fraction] = set()

    def read(item: Node) -> None:
        if not isinstance(item.value, Scalar):
            raise item.fault("expected a number")
        value = number_of(item.value, "the value of a member")
        if not free.low <= value <= free.high:
            raise item.fault(f"{text_of(value)} is outside of the range of {free.name}")
        if value in values:
            raise item.fault(f"{text_of(value)} is given twice: leave one out")
        values.add(value)

    entry.each(read)
    return tuple(sorted(values))


def _spaced(free: Axis, number: int) -> tuple[Fraction, ...]:
    return tuple(free.at(Fraction(k, number - 1)) for k in range(number))
