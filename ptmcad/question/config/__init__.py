"""From a problem record (YAML), a mapping or command-line options to a `Slice`.

Guarantee: a `Slice` that leaves here is complete and exact: every parameter of the mechanism is a
rational function of the two axes, its window is a nonempty rectangle, and no length or stiffness is
known to be out of the range that the geometry needs. Whatever is wrong with the input is a
`ConfigError` that names file, line and key, and the remedy; nothing unknown is ignored.

Not guaranteed: that a length given by an expression is positive in the whole window, where that was
not decided at once. The slice carries what is known, and an engine decides the rest or refuses
(`ptmcad.question.domain.proved`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ptmcad.errors import A_RECORD, A_SLICE, ConfigError, Faults, Place, expect
from ptmcad.model import Kind, Parameter, ptm
from ptmcad.question.config.binding import released_names, settled
from ptmcad.question.config.familyquestion import (
    Family,
    checked_family,
    family_of,
    fault_of_member,
    member_like,
)
from ptmcad.question.config.modelkeys import named_model
from ptmcad.question.config.objects import make_mechanism, make_system, tree_of
from ptmcad.question.config.problemrecord import COUNT, Record, record_of, with_place
from ptmcad.question.config.resolution import checked_slice, slice_of
from ptmcad.question.config.scalars import check_axis_name, file_name, portable_file
from ptmcad.question.config.typed import (
    Typed,
    point_from,
    point_from_mapping,
    point_from_options,
    ranges_of,
    settings_of,
    units_of,
    with_axes,
)
from ptmcad.question.counts import Count
from ptmcad.question.domain import MAX_DEGREE
from ptmcad.question.shipped import FIRST, SECOND, RecordSource, record_tree
from ptmcad.question.slice import Slice
from ptmcad.text.entry import Scalar, Sequence, Written
from ptmcad.text.node import Node
from ptmcad.text.syntax import did_you_mean

__all__ = [
    "MAX_DEGREE",
    "Family",
    "Kind",
    "Parameter",
    "family_from",
    "fault_of_member",
    "file_name",
    "load",
    "make_mechanism",
    "make_system",
    "member_like",
    "names_in_record",
    "point_from",
    "point_from_mapping",
    "point_from_options",
    "portable_file",
    "question_from_options",
    "record_from_options",
    "slice_from",
    "slice_from_mapping",
    "slice_from_options",
    "slice_from_typed",
    "units_of",
    "with_place",
]


def load(path: str | Path) -> Slice:
    """Read a problem record: a YAML file, or one that is shipped, by its name.

    Raises
    ------
    ConfigError
        For anything wrong in it, with file, line and key; its ``faults`` are all there are.
    """
    expect(path, (str, Path), "path", "the file of a record")
    return checked_slice(record_tree(path))


def slice_from_mapping(mapping: Mapping[str, Any]) -> Slice:
    """The slice of a record given as Python data: numbers as text, int, Fraction, float (its
    shortest decimal) or one of numpy's.

    Expressions may be SymPy's; ``mechanism`` and ``system`` may be objects that `ptmcad.Mechanism`
    and `ptmcad.System` have made.

    >>> slice_from_mapping({"axes": {"rho": [0, 2], "L2": ["0", "2"]}, "parameters": {"F3": "-0.1"}}).axis_names
    ('rho', 'L2')
    """
    expect(mapping, Mapping, "mapping", "a mapping like a record")
    return checked_slice(tree_of(mapping))


def slice_from(question: RecordSource | Slice) -> Slice:
    """The slice that is meant by a record's file, by a mapping like a record, or by itself."""
    if isinstance(question, Slice):
        return question
    return checked_slice(tree_of(question, "slice", f"{A_SLICE}, {A_RECORD}"))


def family_from(question: RecordSource | Family) -> Family:
    """The family that is meant by a record's file, by a mapping like a record, or by itself.

    >>> record = {"axes": {"rho": [0, 2], "L2": [0, 2]}, "parameters": {"F3": "F", "F4": "F"},
    ...           "free": {"F": [-40, 0]}, "members": 5}
    >>> [str(value) for value in family_from(record).values]
    ['-40', '-30', '-20', '-10', '0']
    """
    if isinstance(question, Family):
        return question
    return checked_family(tree_of(question))


def slice_from_options(
    config: str | Path | None = None,
    slice: str | None = None,
    sets: Iterable[str] = (),
    ranges: Iterable[str] = (),
    count: str | Count | None = None,
    mechanism: str | None = None,
) -> Slice:
    """The slice of the command line's options, with or without a record under them.

    Options override the record. `slice` replaces the record's axes: a parameter the record fixed
    becomes free when it is named there, and keeps the record's range when it was an axis there.
    Answers and title of a record are dropped when another slice than the recorded one is asked for.

    Parameters
    ----------
    config : a YAML file.
    slice : ``"X,Y"``, the two axes, the horizontal one first.
    sets : texts ``NAME=VALUE``; one of them has the value of the parameter that is free in the
        record, if one is.
    ranges : texts ``NAME=LO:HI``, for axes.
    count : which count distinguishes two regions.
    mechanism : the name of a built-in mechanism, or a YAML file that describes one, in place of a
        record.

    Raises
    ------
    ConfigError
        For anything wrong, with file, line and key, or the option.
    """
    return slice_from_typed(Typed(config, slice, tuple(sets), tuple(ranges), count, mechanism))


def slice_from_typed(typed: Typed) -> Slice:
    """The slice of what was typed, as `slice_from_options` gives it."""
    if typed.config is not None and typed == Typed(typed.config):
        return load(typed.config)
    return slice_of(record_from_options(typed))


def question_from_options(typed: Typed) -> Slice | Family:
    """The slice of the command line's options, or the family where a parameter stays free.

    Raises
    ------
    ConfigError
        For anything wrong, with file, line and key, or the option.
    """
    if typed.config is not None and typed == Typed(typed.config):
        tree = record_tree(typed.config)
        return checked_family(tree) if "free" in tree.entries else checked_slice(tree)
    record = record_from_options(typed)
    if typed.members is not None:
        if record.free is None:
            raise ConfigError(
                "there are members where a parameter is free: add --free NAME=LO:HI",
                key="--members",
            )
        record = record._replace(members=_members(typed.members))
    return slice_of(record) if record.free is None else family_of(record)


def _members(text: str) -> Written:
    place = Place("--members")
    items = tuple(Scalar(item.strip(), place) for item in text.split(","))
    return items[0] if len(items) == 1 else Sequence(items, place)


def record_from_options(typed: Typed) -> Record:
    """The record with what the options change in it, but for the members.

    Raises
    ------
    ConfigError
        For a key or an option that is wrong; what the values are worth is not looked at.
    """
    config, slice, sets, ranges, count, mechanism, free, _ = typed
    if config is not None and mechanism is not None:
        raise ConfigError(
            "the record says which mechanism is meant: leave one out", key="--mechanism"
        )
    record = record_of(record_tree(config)) if config is not None else Record(ptm())
    if mechanism is not None:
        record = Record(named_model(Scalar(mechanism, Place("--mechanism"))))
    if free is not None:
        ((name, window),) = ranges_of([free], "--free").items()
        check_axis_name(name, window.place)
        values = {n: value for n, value in record.values.items() if n != name}
        record = record._replace(
            free=(name, window), members=None, values=values, title="", reference={}
        )
    given_sets, given_ranges = settings_of(sets, record), ranges_of(ranges)
    names = [] if slice is None else [name.strip() for name in slice.split(",")]
    if record.free is not None and record.free[0] in names and record.free[0] not in given_sets:
        given_ranges = dict([record.free]) | given_ranges  # an axis is free, too
        record = record._replace(free=None, members=None)
    if slice is not None:
        record = with_axes(record, slice, given_sets, given_ranges)
    elif config is None:
        raise ConfigError(
            f"give a problem record (a YAML file), or two axes such as --slice {FIRST},{SECOND}"
        )
    for name, value in given_sets.items():
        if name in record.axes:
            raise value.place.error(
                f"{name} is an axis and cannot be fixed too: choose other axes with --slice"
            )
    record = settled(record, given_sets)
    for name, window in given_ranges.items():
        if name not in record.axes:
            axes = " and ".join(record.axes)
            raise window.place.error(
                f"{name} is not an axis; the axes are {axes}{did_you_mean(name, record.axes)}"
            )
        record = record._replace(axes={**record.axes, name: window})
    if slice is not None or sets or given_ranges:
        record = record._replace(title="", reference={})
    if count is not None:
        text = count.value if isinstance(count, Count) else count
        place = Place("--count")
        record = record._replace(
            counting=COUNT.read(Node(Scalar(text, place), place, Faults())), count_place=place
        )
    return record


def names_in_record(config: str | Path) -> tuple[tuple[str, ...], frozenset[str]]:
    """The names of a record's axes, and of all that a value can be given to: parameters, and what
    is free or swept.

    Raises
    ------
    ConfigError
        For keys and shapes that are wrong; values are not looked at.
    """
    record = record_of(record_tree(config))
    return tuple(record.axes), frozenset((*record.model.parameters, *released_names(record)))
