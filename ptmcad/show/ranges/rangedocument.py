"""Ranges, widths, paths and branches as a JSON document, docs/range.schema.json.

Guarantee: parameters, ends and samples are written exactly; every digit of a decimal is right; the
same answer gives the same text.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import partial
from operator import attrgetter
from typing import Any

from ptmcad.answer.counts import Counts, MorseIndex
from ptmcad.answer.intervals import (
    AnyEnd,
    Change,
    CountInterval,
    CountIntervals,
    Event,
    OperationSpan,
    Span,
)
from ptmcad.answer.paths import Branches, Fate, PathEnd, PathPoint, PosePath, PosePaths, Target
from ptmcad.answer.regionmap import Kind
from ptmcad.answer.widths import Attainment, OperationWidths, WidthRow
from ptmcad.question.slice import Axis
from ptmcad.show.document.designdocument import maximum
from ptmcad.show.document.exactnumbers import INDEX, with_decimal
from ptmcad.show.document.slicedocument import VERSIONS
from ptmcad.show.ranges.endtext import end_text, known, narrowly_known, width_text
from ptmcad.text.codec import (
    COUNT,
    DATA,
    NATURAL,
    POSITIVE,
    RATIONAL,
    TEXT,
    TRUTH,
    Codec,
    Key,
    Known,
    by_name,
    choice,
    derived,
    in_words,
    listed,
    named,
    optional,
    record,
    record_of,
    unless_default,
)
from ptmcad.text.documents import CLASS
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.version import __version__

FORMAT = "ptmcad-range/1"
PATH_DIGITS = 12
BRANCH_DIGITS = 6
_UNDECIDED = choice(Attainment).narrowed(enum=[Attainment.UNDECIDED.value])
_AXIS = record_of(
    Axis, {}, lambda name, window: Axis(name, *window), low=None, high=None,
    window=Key(listed(RATIONAL, 2), attrgetter("low", "high")),
)  # fmt: skip


def _exact(digits: int) -> Codec[Any]:
    """The codec of an exact end, with a decimal of so many digits."""
    return with_decimal(partial(end_text, digits=digits))


def _enclosed(digits: int) -> Codec[Enclosure]:
    """The codec of an enclosed end, with a decimal of as many digits as are known."""
    return record_of(
        Enclosure, decimal=derived(lambda end: end.settled_text(digits), optional(TEXT))
    )


def _exact_places(digits: int) -> dict[Any, Codec[Any]]:
    """The codecs of exact ends and of intervals between them."""
    places = {Axis: _AXIS, AnyEnd: _exact(digits)}
    interval = record_of(
        CountInterval, places, counts=None, peaks=None, total=NATURAL, stable=COUNT, index=INDEX,
        width=derived(partial(width_text, digits=digits)),
    )  # fmt: skip
    return {**places, CountInterval: interval}


def _enclosed_places(digits: int) -> dict[Any, Codec[Any]]:
    """The codecs of enclosed ends, and of intervals and changes between them."""
    places = dict.fromkeys((AnyEnd, AlgebraicNumber | Enclosure), _enclosed(digits))
    interval = record_of(
        CountInterval, places, _interval, counts=None, total=COUNT, stable=COUNT, index=INDEX
    )
    change = record_of(
        Change, places, partial(Change, before=None, after=None),
        before=None, after=None, kind=None, continuum=None, names=None, met=Key(field="names"),
    )  # fmt: skip
    return {
        **places,
        Axis: _AXIS,
        CountInterval: interval.narrowed(**{CLASS: "EnclosedInterval"}),
        Change: change,
        OperationSpan: record_of(Span, places),
    }


def _interval(
    total: int | None, stable: int | None, index: MorseIndex | None, **other: Any
) -> CountInterval:
    """An enclosed interval as it is read."""
    return CountInterval(counts=None if total is None else Counts(total, stable, index), **other)


def _counts(counts: Counts) -> list[int] | dict[str, int | None]:
    """Numbers by index, or without an index in all and of stable ones."""
    return (
        {"total": counts.total, "stable": counts.stable}
        if counts.index is None
        else list(counts.index)
    )


_COUNTS: Codec[Any] = Codec(
    _counts,
    lambda node: node.value,
    {"anyOf": [INDEX.schema["anyOf"][1], record(Counts, total=NATURAL, stable=COUNT).schema]},
)


def line_codec(digits: int) -> Codec[CountIntervals]:
    """The codec of the intervals of a line."""
    known = _exact_places(digits)
    known[Change] = record_of(
        Change,
        {AlgebraicNumber | Enclosure: known[AnyEnd], Counts | None: _COUNTS, Kind | None: choice(Kind)},
        **unless_default(Change, "continuum"), names=None, proved=None,
        event=derived(attrgetter("event"), choice(Event, by_name)), text=derived(attrgetter("text")),
    )  # fmt: skip
    return record_of(
        CountIntervals, known, name=None, model=None, working=None, enclosed=None,
        parameters=Key(
            named(TEXT), lambda found: {n: e.to_text((found.along.name, "_")) for n, e in found.parameters.items()}
        ),
        operation=derived(
            lambda found: [n for n, i in enumerate(found.intervals) if i.working == found.working],
            listed(NATURAL),
        ),
    )  # fmt: skip


def enclosed_codec(digits: int) -> Codec[Any]:
    """The codec of the intervals of a line on which springs have free lengths; what is read has no
    model.
    """
    return record_of(
        CountIntervals, _enclosed_places(digits), dict,
        name=None, model=None, parameters=None, working=None, enclosed=None,
    )  # fmt: skip


def over_codec(over: str, digits: int) -> Codec[OperationWidths]:
    """The codec of the widths over the other axis, which has this name."""
    known = _exact_places(digits)
    parts = listed(known[CountInterval])
    row = record_of(
        WidthRow, known, undecided=None,
        operation=Key(parts, lambda row: [i for span in row.operation for i in span.parts]),
    )  # fmt: skip
    return record_of(
        OperationWidths, {**known, WidthRow: row}, name=None, model=None, enclosed=None,
        stable=Key(NATURAL, default=2, field="working", always=True),
        maxima=listed(maximum(over, digits)),
    )  # fmt: skip


def bands_codec(digits: int) -> Codec[Any]:
    """The codec of the operation ranges over the other axis with free lengths; what is read has no
    model.
    """
    return record_of(
        OperationWidths, _enclosed_places(digits), dict, name=None, model=None, maxima=None, enclosed=None,
        stable=Key(NATURAL, field="working"),
        attainment=derived(lambda _: Attainment.UNDECIDED, _UNDECIDED, default=Attainment.UNDECIDED),
    )  # fmt: skip


_NARROW: Codec[Enclosure] = in_words(partial(narrowly_known, digits=PATH_DIGITS), optional(TEXT))
_POINTS: Known = {
    kind: record_of(
        kind,
        {Enclosure: _NARROW},
        sides=None,
        **unless_default(kind, "reals", known={Enclosure: _NARROW}),
    )
    for kind in (PathPoint, Target)
}
_ENERGY: Codec[Any] = in_words(
    lambda energy: energy and energy.settled_text(PATH_DIGITS), optional(TEXT)
)
_EXACT, _ENCLOSED = _exact(PATH_DIGITS), _enclosed(PATH_DIGITS)
_ANY_END: Codec[Any] = Codec(
    lambda end: (_ENCLOSED if isinstance(end, Enclosure) else _EXACT).write(end),
    lambda node: (
        _ENCLOSED if node.mapping().keys() == {"low", "high", "decimal"} else _EXACT
    ).read(node),
    {"anyOf": [_EXACT.schema, _ENCLOSED.schema]},
)
_PATH_END = record_of(
    PathEnd, {**_POINTS, AnyEnd: _ANY_END}, fate=choice(Fate, by_name), text=derived(attrgetter("fate.value")),
    energy=_ENERGY, target_energy=_ENERGY, **unless_default(PathEnd, "among", "fallen"),
)  # fmt: skip
PATHS = record_of(
    PosePaths,
    {Axis: _AXIS, PosePath: record_of(PosePath, {**_POINTS, PathEnd: _PATH_END}, start=None, number=POSITIVE)},
    name=None, model=None, moved=None, joined=Key(TRUTH, lambda _: False, default=False, made=False),
)  # fmt: skip
"""The codec of the paths of stable poses. Earlier versions joined points in floating point
(``joined``) where springs have free lengths.
"""
BRANCHES = record_of(
    Branches,
    {Axis: TEXT, Enclosure: in_words(partial(known, digits=BRANCH_DIGITS))},
    name=None, model=None, along=Key(TEXT, attrgetter("along.name")),
)  # fmt: skip
"""The codec of branches of solutions."""


def part(found: Any, digits: int) -> dict[str, Any]:
    """An answer as a part of a document, under its key."""
    codec: Codec[Any]
    match found:
        case CountIntervals():
            key, codec = (
                ("enclosed", enclosed_codec(digits))
                if found.enclosed
                else ("line", line_codec(digits))
            )
        case OperationWidths():
            key, codec = (
                ("bands", bands_codec(digits))
                if found.enclosed
                else ("over", over_codec(found.over.name, digits))
            )
        case PosePaths():
            key, codec = "path", PATHS
        case _:
            key, codec = "branches", BRANCHES
    return {key: codec.write(found)}


def schema() -> Mapping[str, Any]:
    """The schema of a document with any parts."""
    parts: dict[str, Codec[Any]] = {
        "line": line_codec(1), "enclosed": enclosed_codec(1), "over": over_codec("x", 1),
        "path": PATHS, "branches": BRANCHES, "bands": bands_codec(1), "slice": DATA, "request": DATA,
    }  # fmt: skip
    keys = {key: Key(codec, default=None) for key, codec in parts.items()}
    return record(dict, name=TEXT, mechanism=TEXT, versions=VERSIONS, **keys).schema


def document(name: str, mechanism: str, parts: Mapping[str, Any]) -> str:
    """The JSON text of an answer; ``parts`` has some of the entries line, enclosed, over and path."""
    data = {
        "format": FORMAT,
        "name": name,
        "mechanism": mechanism,
        **parts,
        "versions": {"ptmcad": __version__},
    }
    return json.dumps(data, ensure_ascii=False, indent=1) + "\n"
