"""A stored study: its JSON document, its CSV file, and its measurements as a data frame.

Guarantee: `study_of(write_study(s))` equals s; a file that is not such a document is refused with the place of the
fault. ``docs/bench.schema.json`` is its schema, and says what each key means.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd

from ptmcad.question.slice import Count
from ptmcad.studies.bench.error import FIGURES
from ptmcad.studies.bench.harness import Row
from ptmcad.studies.bench.methods import RIVALS
from ptmcad.text import codec
from ptmcad.text.codec import POSITIVE, SECONDS, Codec, line, listed, named, optional, record
from ptmcad.text.node import Node, opened
from ptmcad.text.textfile import read_as

FORMAT = "ptmcad-bench/1"
MAX_BYTES = 10_000_000
_FINEST = ("index", "total", "stable", "admissible")
_SHORT = {
    "seconds_minimum": "seconds_min",
    "seconds_maximum": "seconds_max",
    "seconds_runs": "runs",
    "peak": "peak_mib",
}
_TAKEN = ("seconds_median", "seconds_min", "seconds_max", "runs", "computing_median", "peak_mib")
_PAIRS = ("wrong", "faintest", "distance")
"""Figures that are bounds: of each are two columns."""
_FIGURE_COLUMNS = [
    column for name in FIGURES for column in ([f"{name}_low", f"{name}_high"] if name in _PAIRS else [name])
]
_COLUMNS = ["slice", "method", "setting", *_TAKEN, "count", *_FIGURE_COLUMNS, "area_width", "reason", "note"]
_WHOLE = ("runs", "wrong_centres", "regions", "missed")


_KEYS = ("method", "setting", "seconds", "computing", "peak", "reason", "note", "figures", "area_width")


def measurement(method: str, setting: str, **more: Any) -> Row:
    """What is known of one method at one setting; ``docs/bench.schema.json`` says what each key means."""
    return dict.fromkeys(_KEYS) | {"method": method, "setting": setting, "reason": "", "note": "", **more}


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
    table = pd.json_normalize(rows, sep="_").rename(columns=_SHORT).reindex(columns=_COLUMNS)
    return table.astype(dict.fromkeys(_WHOLE, "Int64"))


def finest(study: Row) -> pd.DataFrame:
    """A row for each measurement, with the figures for the finest count that the method gives."""
    table = frame(study)
    ranks = table["count"].map({count: rank for rank, count in enumerate(_FINEST)})
    return table.loc[ranks.sort_values(kind="stable").index].drop_duplicates(["method", "setting"]).sort_index()


def records(table: pd.DataFrame) -> list[Row]:
    """The rows of a table."""
    return [{str(name): x for name, x in row.items()} for row in table.to_dict("records")]


def write_study(study: Row) -> str:
    """The study as JSON text."""
    return json.dumps(study, indent=1, ensure_ascii=False) + "\n"


def write_table(study: Row) -> str:
    """The study as CSV, one row for each measurement and count."""
    text: str = frame(study).drop(columns="note").to_csv(index=False, lineterminator="\n")
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
    return codec.document_schema(FORMAT, _STUDY.schema)


def _positive(node: Node) -> float:
    seconds = node.number()
    if not seconds > 0:
        raise node.fault("is not a positive number of seconds")
    return seconds


_TIME: Codec[float] = Codec(SECONDS.write, _positive, {"type": "number", "exclusiveMinimum": 0})
_PAIR = listed(SECONDS, 2)
_TIMES: Codec[Row] = record(dict, runs=POSITIVE, median=_TIME, minimum=_TIME, maximum=_TIME)
_FIGURES: Codec[Row] = record(
    dict,
    wrong=_PAIR,
    undetermined=SECONDS,
    wrong_centres=optional(codec.NATURAL),
    regions=optional(POSITIVE),
    missed=optional(codec.NATURAL),
    faintest=optional(_PAIR),
    distance=optional(_PAIR),
)
_MEASUREMENT: Codec[Row] = record(
    dict,
    method=line(60).narrowed(enum=[*RIVALS]),
    setting=line(60),
    seconds=optional(_TIMES),
    computing=optional(_TIMES),
    peak=optional(SECONDS),
    reason=line(1000),
    note=line(1000),
    figures=optional(named(_FIGURES).narrowed(propertyNames={"enum": [count.value for count in Count]})),
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
