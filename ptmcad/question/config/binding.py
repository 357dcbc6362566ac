"""What the names in a record's values stand for: numbers in place of a family's free parameter or of
what a sweep goes through, and each parameter as a function of the axes and as it is written.

Guarantee: exact; the record with numbers is the one that a person would get who typed them. What is
wrong is a `ConfigError` with file, line and key, said once where it stands.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from fractions import Fraction

from ptmcad.errors import ExpressionError, Faults, Place
from ptmcad.model import Kind
from ptmcad.question.config.problemrecord import Record, swept_names
from ptmcad.question.config.scalars import names_in_scalar, number_of, parsed
from ptmcad.question.slice import Slice
from ptmcad.text.entry import Scalar
from ptmcad.text.expressions import Expression, Expressions, constant
from ptmcad.text.numerals import Numbers, text_of
from ptmcad.text.parsing import rational
from ptmcad.text.syntax import NOT_NUMBERS, did_you_mean, names_in, parse
from ptmcad.text.tree import Number, names_of, replaced, to_text


def with_numbers(record: Record, numbers: Numbers, places: Mapping[str, Place]) -> Record:
    """The record with numbers as the values of parameters, and in place of other names in what it
    writes.

    Parameters
    ----------
    places : where the numbers are said, for messages about parameters.
    """
    known = record.model.parameters
    others = {name: number for name, number in numbers.items() if name not in known}
    values = (
        {name: _with_numbers(scalar, others) for name, scalar in record.values.items()}
        if others
        else {}
    )
    fixed = {
        name: Scalar(to_text(Number(number)), places.get(name, Place(name)))
        for name, number in numbers.items()
        if name in known
    }
    return record._replace(
        values={**record.values, **values, **fixed}, unread=record.unread - numbers.keys()
    )


def released_names(record: Record) -> set[str]:
    """What has no value in a record and may be given one: what is free, and what is swept."""
    return {*swept_names(record), *(record.free or ())[:1]}


def bound(record: Record, name: str, value: Fraction) -> Record:
    """The record with a number in place of its free parameter, and without answers, which are of
    another slice.
    """
    assert record.free is not None
    found = with_numbers(record, {name: value}, {name: record.free[1].place})
    title = f"{record.title}, {name} = {text_of(value)}" if record.title else ""
    return found._replace(free=None, members=None, title=title, reference={})


def member_name(record: Record, name: str, value: Fraction) -> str:
    """The name of a member, and of its files: the record's, the parameter's, and its value."""
    start = f"{record.name or 'family-' + '-'.join((*record.axes, name))}-{name}"
    return f"{start}{text_of(value).replace('/', '_')}"


def settled(record: Record, given: Mapping[str, Scalar]) -> Record:
    """The record with values of parameters, and with numbers in place of what is free or swept in
    it.

    Raises
    ------
    ConfigError
        When there is a sweep, and other parameters are still swept.
    """
    left = dict(given)
    if record.free is not None and (name := record.free[0]) in left:
        number = number_of(left.pop(name), f"the value of {name}")
        record = bound(record, name, number)._replace(name=member_name(record, name, number))
    if record.sweep is not None:
        for name, place in swept_names(record).items():
            if name not in left and name not in record.axes:
                raise place.error(
                    f"{name} is swept too: add --set {name}=VALUE, or ask `ptmcad sweep` for all of its values"
                )
        new = {
            name: number_of(left.pop(name), "a value")
            for name in given
            if name not in record.model.parameters
        }
        record = with_numbers(record, new, {})._replace(sweep=None)
    return record._replace(values={**record.values, **left})


def _with_numbers(scalar: Scalar, numbers: Numbers) -> Scalar:
    """A text with numbers in it; what cannot be read or has no value stays as it is, to be refused
    with its place.

    A number is one number, so that slices that are the same say the same.
    """
    try:
        tree = parse(scalar.text)
    except ExpressionError:
        return scalar
    other = replaced(tree, {name: Number(number) for name, number in numbers.items()})
    if other is tree:
        return scalar
    text = to_text(other)
    if not names_of(other):
        with suppress(ExpressionError):
            text = to_text(Number(rational(text)))
    return Scalar(text, scalar.place)


def resolved(
    record: Record, free: Expressions, faults: Faults
) -> tuple[dict[str, Expression], set[str]]:
    """What the parameters stand for, depth first, and the names of those that are faulty or depend
    on such a one.

    Parameters
    ----------
    free : names to what they stand for already.
    faults : where it is noted that a parameter cannot be resolved, which then is 1; a cycle is
        refused.
    """
    parameters = record.model.parameters
    faulty = set(record.doubtful - free.keys())
    done = {**dict.fromkeys(faulty, constant(1)), **free}
    known = tuple(dict.fromkeys((*free, *parameters, *sorted(record.unread))))

    def value(name: str, chain: tuple[str, ...]) -> Expression:
        if name not in done:
            with faults:
                done[name] = found(name, chain)
                return done[name]
            faulty.add(name)
            done[name] = constant(1)
        return done[name]

    def found(name: str, chain: tuple[str, ...]) -> Expression:
        scalar = record.values.get(name)
        if scalar is None:
            scalar = Scalar(parameters[name].default, record.place_of(name))
            if not scalar.text:
                raise scalar.place.error(
                    f"{name} has no value: give it one under 'parameters', or make it an axis"
                )
        if name in chain:
            cycle = " -> ".join((*chain[chain.index(name) :], name))
            raise scalar.place.error(f"the definition goes round in a circle: {cycle}")
        names = names_in_scalar(scalar)
        misnamed = [
            other for other in names if other not in known and other.lower() not in NOT_NUMBERS
        ]
        for other in misnamed[:1]:
            with faults:
                hint = did_you_mean(
                    other, known, "; the names are " if known else "; no name is known here"
                )
                raise scalar.place.error(f"unknown name '{other[:40]}'{hint}")
        values = {other: value(other, (*chain, name)) for other in names if other in known}
        if misnamed or values.keys() & faulty:
            faulty.add(name)
        return constant(1) if misnamed else parsed(scalar, values)

    return {name: value(name, ()) for name in parameters}, faulty


def texts_of(names: Iterable[str], record: Record) -> dict[str, str]:
    """Parameters that are no axes as they are written, and every parameter that such a text names."""
    texts: dict[str, str] = {}
    waiting = [*names]
    while waiting:
        name = waiting.pop()
        if name not in texts and name in record.model.parameters and name not in record.axes:
            texts[name] = _written(name, record)
            waiting += names_in(texts[name])
    return texts


def written_in(record: Record, member: Slice) -> dict[str, str]:
    """Each parameter of a family's members as the record writes it, and every parameter that such a
    text names.
    """
    texts = {} if record.free is None else {record.free[0]: Scalar(record.free[0], Place())}
    return texts_of(member.parameters, record._replace(values={**record.values, **texts}))


def _written(name: str, record: Record) -> str:
    if name in record.axes:
        return name
    if name in record.values:
        return record.values[name].text
    parameter = record.model.parameters[name]
    if parameter.alias_of and parameter.kind is Kind.FREE_LENGTH:
        return _written(parameter.alias_of, record)  # which the slice need not name
    return parameter.default
