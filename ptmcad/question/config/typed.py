"""What is typed to ask about a slice or a point: the options ``--set``, ``--range`` and ``--slice``,
and values of parameters, over a record or a model.

Guarantee: whatever is wrong is a `ConfigError` that names the option, or the parameter.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from ptmcad.errors import A_RECORD, A_SLICE, ConfigError, Place
from ptmcad.model import Model, ptm
from ptmcad.question.config.binding import released_names, settled, with_numbers
from ptmcad.question.config.objects import plain, tree_of
from ptmcad.question.config.problemrecord import Record, record_of, unknown_parameter
from ptmcad.question.config.resolution import point_of, without_shorthands
from ptmcad.question.config.scalars import Window, check_axis_name, number_of, number_text
from ptmcad.question.counts import Count
from ptmcad.question.shipped import FIRST, SECOND, RecordSource, record_tree
from ptmcad.question.slice import Slice
from ptmcad.text.entry import Scalar, from_python
from ptmcad.text.expressions import values_at
from ptmcad.text.numerals import Texts
from ptmcad.text.syntax import did_you_mean


class Typed(NamedTuple):
    """What was typed to ask about a slice: a record, and what changes it.

    Attributes
    ----------
    config, slice, sets, ranges, mechanism : as of `ptmcad.question.config.slice_from_options`.
    counting : which count distinguishes two regions.
    free : a text ``NAME=LO:HI``, the free parameter in place of the record's.
    members : values of the free parameter separated by commas, or how many.
    """

    config: str | Path | None = None
    slice: str | None = None
    sets: tuple[str, ...] = ()
    ranges: tuple[str, ...] = ()
    counting: str | Count | None = None
    mechanism: str | None = None
    free: str | None = None
    members: str | None = None


def settings_of(sets: Iterable[str], record: Record) -> dict[str, Scalar]:
    """``NAME=VALUE`` texts, for parameters of a model and what is free or swept in a record."""
    settings: dict[str, Scalar] = {}
    for text in sets:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise ConfigError(f"{text[:80]!r} is not NAME=VALUE, such as {FIRST}=3/2", key="--set")
        place = Place(f"--set {name[:40]}")
        if name not in record.model.parameters and name not in released_names(record):
            raise place.error(unknown_parameter(name, record.model))
        if name in settings:
            raise place.error("is given twice: leave one out")
        settings[name] = Scalar(value, place)
    return settings


def ranges_of(ranges: Iterable[str], option: str = "--range") -> dict[str, Window]:
    """``NAME=LO:HI`` texts of an option."""
    windows: dict[str, Window] = {}
    for text in ranges:
        name, equals, window = (part.strip() for part in text.partition("="))
        low, colon, high = (part.strip() for part in window.partition(":"))
        if not (equals and name and colon and low and high):
            raise ConfigError(f"{text[:80]!r} is not NAME=LO:HI, such as {FIRST}=0:2", key=option)
        place = Place(f"{option} {name[:40]}")
        if name in windows:
            raise place.error("is given twice: leave one out")
        windows[name] = Window(Scalar(low, place), Scalar(high, place), place)
    return windows


def with_axes(
    record: Record, slice: str, sets: Mapping[str, Scalar], ranges: Mapping[str, Window]
) -> Record:
    """The record with the axes of ``--slice X,Y``."""
    place = Place("--slice")
    parameters = record.model.parameters
    names = [name.strip() for name in slice.split(",")]
    if len(names) != 2 or not all(names):
        raise place.error(f"{slice[:80]!r} is not X,Y: name two axes, such as {FIRST},{SECOND}")
    if names[0] == names[1]:
        raise place.error(f"the two axes are both {names[0][:40]}: name two different ones")
    axes = {}
    for name in names:
        check_axis_name(name, place)
        if name in ranges:
            axes[name] = ranges[name]
        elif name in record.axes:
            axes[name] = record.axes[name]
        elif name in parameters:
            window = parameters[name].window
            if window is None:
                raise place.error(f"{name} has no usual range: add --range {name}=LO:HI")
            low, high = window
            axes[name] = Window(Scalar(low, place), Scalar(high, place), place)
        else:
            hint = did_you_mean(name, parameters)
            raise place.error(
                f"unknown axis '{name[:40]}'{hint}; to introduce a new variable add --range {name[:40]}=LO:HI"
            )
    for name in record.axes:
        if (
            name in parameters
            and name not in axes
            and name not in sets
            and name not in record.values
        ):
            raise place.error(
                f"{name} was an axis of {record.place.file} and has no value now: add --set {name}=VALUE"
            )
    return record._replace(
        axes=axes, values={name: v for name, v in record.values.items() if name not in axes}
    )


_EXPECTED = f"{A_SLICE}, {A_RECORD}"


def point_from_mapping(
    values: Mapping[str, object], model: Model | None = None
) -> dict[str, Fraction]:
    """Every parameter of a model, by default the paper's mechanism, at a point: the given ones, and
    the defaults.

    >>> point = point_from_mapping({"rho": "0.7", "L2": "3/2", "F3": -10})
    >>> point["rho"], point["k3"], point["F4"]
    (Fraction(7, 10), Fraction(100, 1), Fraction(0, 1))

    Parameters
    ----------
    values : text (a number, or arithmetic with other parameters), int, Fraction, Decimal, float
        (its shortest decimal) or one of numpy's numbers.

    Raises
    ------
    ConfigError
        For anything wrong, with the parameter's name.
    """
    model = model or ptm()
    given = {}
    for name, value in values.items():
        place = Place(name)
        if name not in model.parameters:
            raise ConfigError(unknown_parameter(name, model))
        given[name] = number_text(from_python(value, place, plain))
    return point_of(Record(model, values=given))


def point_from_options(
    config: str | Path | None = None, at: Texts | None = None, sets: Iterable[str] = ()
) -> tuple[Model, dict[str, Fraction]]:
    """The model and its parameters at the point of the command line's options, with or without a
    record under them.

    Parameters
    ----------
    config : a YAML file, whose axes all need a value in ``at`` or ``sets``.
    at : names of parameters, or of the record's axes, to numbers or expressions.
    sets : texts ``NAME=VALUE``.

    Raises
    ------
    ConfigError
        For anything wrong, with file, line and key, or the option.
    """
    record = record_of(record_tree(config)) if config is not None else Record(ptm())
    given = {name: Scalar(text, Place(f"--at {name[:40]}")) for name, text in (at or {}).items()}
    return _at_point(record, given, sets)


def point_from(
    question: RecordSource | Slice, values: Mapping[str, object]
) -> tuple[Model, dict[str, Fraction]]:
    """The model of a record or slice, and its parameters at a point.

    >>> record = {"axes": {"rho": [0, 2], "L2": [0, 2]}, "parameters": {"F3": -10}}
    >>> point_from(record, {"rho": "0.7", "L2": "3/2"})[1]["F3"]
    Fraction(-10, 1)

    Parameters
    ----------
    values : for all axes; of a record also for what else it leaves open, and for parameters in
        place of its own.

    Raises
    ------
    ConfigError
        For anything wrong, with the name.
    """
    given = {
        name: number_text(from_python(value, Place(name), plain)) for name, value in values.items()
    }
    if not isinstance(question, Slice):
        return _at_point(record_of(tree_of(question, expected=_EXPECTED)), given, (), None)
    names = question.axis_names
    if further := [name for name in given if name not in names]:
        raise ConfigError(
            "is no axis of the slice, which has values for all else: give its record",
            key=further[0],
        )
    if missing := [name for name in names if name not in given]:
        raise ConfigError("is an axis of the slice and has no value", key=missing[0])
    x, y = (number_of(given[name], "the value of this axis") for name in names)
    return question.model, without_shorthands(values_at(question.parameters, x, y), question.model)


def units_of(question: RecordSource | Slice) -> Texts:
    """The units that a record or slice declares, of ``length`` and ``force``.

    Raises
    ------
    ConfigError
        For anything wrong in a record, with file, line and key.
    """
    return (
        question.units
        if isinstance(question, Slice)
        else record_of(tree_of(question, expected=_EXPECTED)).units
    )


def _at_point(
    record: Record, at: Mapping[str, Scalar], sets: Iterable[str], option: str | None = "--at"
) -> tuple[Model, dict[str, Fraction]]:
    given = settings_of(sets, record)
    axes: dict[str, Fraction] = {}
    where = record.place.file or "the record"
    if record.free is not None and (free := record.free[0]) not in {*at, *given}:
        raise ConfigError(
            f"{free} is free in {where} and has no value: add {free}=VALUE", key=option
        )
    for name, scalar in at.items():
        if name in given:
            raise scalar.place.error("is given with --set too: leave one out")
        if name in record.model.parameters or name in released_names(record):
            given[name] = scalar
        elif name in record.axes:
            axes[name] = number_of(scalar, "the value of this axis")
        else:
            raise scalar.place.error(unknown_parameter(name, record.model))
    for name in record.axes:
        if name not in given and name not in axes:
            raise ConfigError(
                f"{name} is an axis of {where} and has no value: add {name}=VALUE", key=option
            )
    return record.model, point_of(with_numbers(settled(record, given), axes, {}))
