"""What is typed to ask about a slice, and the options ``--set``, ``--range`` and ``--slice``.

Guarantee: whatever is wrong is a `ConfigError` that names the option.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from ptmcad.errors import ConfigError, Place
from ptmcad.question.config.binding import released_names
from ptmcad.question.config.record import Record, unknown_parameter
from ptmcad.question.config.windows import Window, check_axis_name
from ptmcad.question.counts import Count
from ptmcad.question.examples import FIRST, SECOND
from ptmcad.text.entry import Scalar
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
