"""A stored study: its JSON document, its CSV file, its measurements as a data frame, and two of one
slice compared.

Guarantee: `study_of(write_study(s))` equals s; a file that is not such a document is refused with
the place of the fault. ``docs/bench.schema.json`` is its schema, and says what each key means. Of
two studies an error is worse only if its bounds do not overlap the earlier ones. Times are compared
as multiples of each study's own floor, so that machines of different speed compare; one is slower
only if its fastest run is slower than the slowest run of the other by `MARGIN`, with the spread of
both floors allowed for. That a small change is found is not guaranteed.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import pandas as pd

from ptmcad.errors import ConfigError
from ptmcad.question.counts import Count
from ptmcad.show.table import aligned
from ptmcad.studies.bench.error import FIGURES
from ptmcad.studies.bench.harness import FORMAT, Row, measurement
from ptmcad.studies.bench.study import RIVALS
from ptmcad.text import codec
from ptmcad.text.codec import POSITIVE, SECONDS, Codec, line, listed, named, optional, record
from ptmcad.text.documents import document_schema
from ptmcad.text.node import Node, opened
from ptmcad.text.textfile import read_as

MAX_BYTES = 10_000_000
MARGIN = 1.1
SINGLE_RUN_MARGIN = 1.5
"""The same where one of the two was run once only, so that its spread is not known."""
BAD = ("slower", "worse", "lost")
"""Verdicts that are no good news; the others are faster, better, gained and same."""
_COMPARED = ("wrong", "undetermined", "wrong_centres", "missed", "distance")
"""Figures, numbers or bounds, larger being worse."""
_CSV = {
    "seconds_minimum": "seconds_min",
    "seconds_maximum": "seconds_max",
    "seconds_runs": "runs",
    "peak": "peak_mib",
}
"""Keys that have other names in the CSV file."""
_PAIRS = ("wrong", "faintest", "distance")
"""Figures that are bounds: of each are two columns."""
_COLUMNS = (
    "slice", "method", "setting", "seconds_median", "seconds_min", "seconds_max", "runs", "computing_median",
    "peak_mib", "count",
    *chain.from_iterable((f"{name}_low", f"{name}_high") if name in _PAIRS else (name,) for name in FIGURES),
    "area_width", "reason", "note",
)  # fmt: skip
_WHOLE = ("runs", "wrong_centres", "regions", "missed")


def frame(study: Row) -> pd.DataFrame:
    """A row for each measurement and count, with the columns of the CSV file and the notes."""
    rows = []
    for m in study["measurements"]:
        for count, figures in (m["figures"] or {None: {}}).items():
            parts = {
                name: dict(zip(("low", "high"), x, strict=True)) if isinstance(x, tuple) else x
                for name, x in figures.items()
            }
            rows.append({"slice": study["slice"], "count": count, **m, **parts, "figures": None})
    table = pd.json_normalize(rows, sep="_").rename(columns=_CSV).reindex(columns=list(_COLUMNS))
    return table.astype(dict.fromkeys(_WHOLE, "Int64"))


def finest(study: Row) -> pd.DataFrame:
    """A row for each measurement, with the figures for the finest count that the method gives."""
    table = frame(study)
    ranks = table["count"].map({count.value: count.kind.rank for count in Count})
    return (
        table.loc[ranks.sort_values(kind="stable").index]
        .drop_duplicates(["method", "setting"])
        .sort_index()
    )


def write_study(study: Row) -> str:
    """The study as JSON text."""
    return json.dumps(study, indent=1, ensure_ascii=False) + "\n"


def write_table(study: Row) -> str:
    """The study as CSV, one row for each measurement and count."""
    text = frame(study).drop(columns="note").to_csv(index=False, lineterminator="\n")
    return text


def read_study(path: Path) -> Row:
    """Read a study's JSON file.

    Raises
    ------
    ConfigError
        When the file is missing or is no such document.
    """
    return read_as(path, MAX_BYTES, FORMAT, study_of)


def study_of(text: str) -> Row:
    """The study that `write_study` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document; the message names the place.
    """
    return _STUDY.read(opened(text, FORMAT, MAX_BYTES, "ptmcad bench"))


def study_schema() -> dict[str, Any]:
    """The schema of a study's JSON, without prose."""
    return document_schema(FORMAT, _STUDY.schema)


def _positive(node: Node) -> float:
    seconds = node.number()
    if not seconds > 0:
        raise node.fault("is not a positive number of seconds")
    return seconds


_TIME: Codec[float] = codec.reading(_positive, type="number", exclusiveMinimum=0)
_PAIR = listed(SECONDS, 2)
_TIMES: Codec[Row] = record(dict, runs=POSITIVE, median=_TIME, minimum=_TIME, maximum=_TIME)
_NUMBER: Codec[Any] = optional(codec.NATURAL)
_BOUNDS: Codec[Any] = optional(_PAIR)
_KINDS: tuple[Codec[Any], ...] = (
    _PAIR,
    SECONDS,
    _NUMBER,
    optional(POSITIVE),
    _NUMBER,
    _BOUNDS,
    _BOUNDS,
)
_FIGURES: Codec[Row] = record(dict, **dict(zip(FIGURES, _KINDS, strict=True)))
_MEASUREMENT: Codec[Row] = record(
    dict,
    method=line(60).narrowed(enum=[*RIVALS]),
    setting=line(60),
    seconds=optional(_TIMES),
    computing=optional(_TIMES),
    peak=optional(SECONDS),
    reason=line(1000),
    note=line(1000),
    figures=optional(
        named(_FIGURES).narrowed(propertyNames={"enum": [count.value for count in Count]})
    ),
    area_width=optional(SECONDS),
)
_STUDY: Codec[Row] = record(
    lambda **keys: {"format": FORMAT, **keys},
    slice=line(200),
    heading=line(1000),
    machine=named(line(300)),
    versions=named(line(300)),
    seed=codec.WHOLE,
    rounds=POSITIVE,
    time_limit=_TIME,
    quick=codec.TRUTH,
    verified=optional(codec.TRUTH),
    floor=_TIMES,
    measurements=listed(_MEASUREMENT),
)


# ------------------------------------------------------------------------------------------------------ two compared


def compare(old: Row, new: Row) -> tuple[Row, ...]:
    """What changed from the old study to the new one, in the old one's order: method, setting,
    verdict and detail.

    Raises
    ------
    ConfigError
        When they are of different slices, or were made with different settings that figures depend
        on.
    """
    for key in ("slice", "seed"):
        if old[key] != new[key]:
            raise ConfigError(
                f"the two studies differ in {key}: {old[key]} and {new[key]}", key=key
            )
    before, after = (
        {(m["method"], m["setting"]): m for m in study["measurements"]} for study in (old, new)
    )
    absent = measurement("", "", reason="not in that study")
    return tuple(
        {"method": place[0], "setting": place[1], "verdict": verdict, "detail": detail}
        for place in dict.fromkeys([*before, *after])
        for verdict, detail in _changes(
            before.get(place, absent), old["floor"], after.get(place, absent), new["floor"]
        )
    )


def _changes(before: Row, old_floor: Row, after: Row, new_floor: Row) -> Iterator[tuple[str, str]]:
    old, new = before["seconds"], after["seconds"]
    if old is None or new is None:
        if old is not None:
            yield "lost", f"now: {after['reason']}"
        elif new is not None:
            yield "gained", f"{new['median']:g} s; before: {before['reason']}"
        return
    one, two = _bounds(before, old_floor), _bounds(after, new_floor)
    gone = (before["figures"] or {}).keys() - (after["figures"] or {}).keys()
    verdicts = [("lost", f"{count}: no error is reported any more") for count in sorted(gone)]
    ratio = (new["median"] / new_floor["median"]) / (old["median"] / old_floor["median"])
    times = (
        f"{ratio:.2f} times the time, machine allowed for ({old['median']:g} s at a floor of "
        f"{old_floor['median']:g} s, now {new['median']:g} at {new_floor['median']:g})"
    )
    for name in (name for name in one if name in two):
        (low, high), (least, most) = one[name], two[name]
        margin, words, detail = 1.0, ("worse", "better"), f"{name}: {high:g}, now {most:g}"
        if name == "time":
            margin = MARGIN if old["runs"] > 1 and new["runs"] > 1 else SINGLE_RUN_MARGIN
            words, detail = ("slower", "faster"), times
        if least > margin * high:
            verdicts.append((words[0], detail))
        elif low > margin * most:
            verdicts.append((words[1], detail))
    yield from verdicts or [("same", times)]


def _bounds(m: Row, floor: Row) -> dict[str, tuple[float, float]]:
    """What is compared of a measurement: bounds of the time in floors, and of figures of error."""
    found = {
        "time": (
            m["seconds"]["minimum"] / floor["maximum"],
            m["seconds"]["maximum"] / floor["minimum"],
        )
    }
    figures = {
        f"{count}, {name.replace('_', ' ')}": f[name]
        for count, f in (m["figures"] or {}).items()
        for name in _COMPARED
    }
    for name, x in ({"width of area bounds": m["area_width"]} | figures).items():
        if x is not None:
            found[name] = x if isinstance(x, tuple) else (x, x)
    return found


def comparison_table(changes: Sequence[Row]) -> str:
    """A line for each change, the bad ones first, and a line that sums up."""
    ordered = sorted(changes, key=lambda c: (c["verdict"] not in BAD, c["verdict"] == "same"))
    lines = aligned([(c["verdict"], c["method"], c["setting"], c["detail"]) for c in ordered])
    tally = {verdict: sum(c["verdict"] == verdict for c in changes) for verdict in BAD}
    summary = ", ".join(f"{number} {verdict}" for verdict, number in tally.items() if number)
    return "\n".join([*lines, summary or "nothing became slower or worse beyond noise"])
