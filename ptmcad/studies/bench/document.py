"""A study as JSON, read back strictly, and as CSV.

Guarantee: `read_study(write_study(s))` equals s; a file that is not such a document is refused with the place of the
fault. ``docs/bench.schema.json`` is its schema.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Any

from ptmcad.studies.bench.harness import Times
from ptmcad.studies.bench.study import FORMAT, Figures, Measurement, Study
from ptmcad.text.codec import TEXT, TRUTH, Codec, Key, line, listed, named, optional, record
from ptmcad.text.node import Node
from ptmcad.text.textfile import read_as

MAX_BYTES = 10_000_000
_COLUMNS = (
    "slice", "method", "setting", "seconds_median", "seconds_min", "seconds_max", "runs", "computing_median",
    "peak_mib", "count", "wrong_low", "wrong_high", "undetermined", "wrong_centres", "regions", "missed",
    "faintest_low", "faintest_high", "distance_low", "distance_high", "area_width", "reason",
)  # fmt: skip
MAX_COUNTED = 10**12


def write_study(study: Study) -> str:
    """The study as JSON text."""
    return json.dumps(_STUDY.write(study), indent=1, ensure_ascii=False) + "\n"


def write_table(study: Study) -> str:
    """The study as CSV, one row for each measurement and count."""
    text = StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(_COLUMNS)
    for m in study.measurements:
        for row in _rows(study.slice, m):
            table.writerow(["" if value is None else value for value in row])
    return text.getvalue()


def _rows(slice: str, m: Measurement) -> Iterator[tuple[Any, ...]]:
    s, none = m.seconds, (None,)
    start = (slice, m.method, m.setting, *((s.median, s.minimum, s.maximum, s.runs) if s else none * 4),
             m.computing.median if m.computing else None, m.peak)  # fmt: skip
    if not m.figures:
        yield (*start, *(none * 11), m.area_width, m.reason)
    for count, f in (m.figures or {}).items():
        yield (*start, count, *f.wrong, f.undetermined, f.wrong_centres, f.regions, f.missed,
               *(f.faintest or none * 2), *(f.distance or none * 2), m.area_width, m.reason)  # fmt: skip


def read_study(path: Path) -> Study:
    """Read a study's JSON file.

    Raises
    ------
    ConfigError
        When the file is missing or is no such document.
    """
    return read_as(path, MAX_BYTES, FORMAT, study_of)


def study_of(text: str) -> Study:
    """The study that `write_study` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document; the message names the place.
    """
    node = Node(json.loads(text), "")
    if (found := node.mapping().get("format")) is not None and found.text() != FORMAT:
        raise found.fault(f"is not {FORMAT!r}")
    return _STUDY.read(node)


def _whole(node: Node) -> int:
    """Of pixels or regions, a seed: what nobody can count is not one."""
    if type(node.value) is not int:
        raise node.fault("is not a whole number")
    if node.value > MAX_COUNTED:
        raise node.fault(f"is more than {MAX_COUNTED}")
    return node.value


def _positive(node: Node) -> float:
    seconds = node.number()
    if not seconds > 0:
        raise node.fault("is not a positive number of seconds")
    return seconds


_WHOLE: Codec[int] = Codec(lambda value: value, _whole)
_NUMBER: Codec[float] = Codec(lambda value: value, Node.number)
_SECONDS: Codec[float] = Codec(lambda value: value, _positive)
_PAIR = listed(_NUMBER, 2)
_TIMES = record(Times, runs=_WHOLE, median=_SECONDS, minimum=_SECONDS, maximum=_SECONDS)
_FIGURES = record(
    Figures, wrong=_PAIR, undetermined=_NUMBER, wrong_centres=optional(_WHOLE), regions=optional(_WHOLE),
    missed=optional(_WHOLE), faintest=optional(_PAIR), distance=optional(_PAIR),
)  # fmt: skip
_MEASUREMENT = record(
    Measurement, method=line(60), setting=line(60), seconds=optional(_TIMES), computing=optional(_TIMES),
    peak=optional(_NUMBER), reason=line(1000), note=line(1000), figures=optional(named(_FIGURES)),
    area_width=optional(_NUMBER),
)  # fmt: skip
_STUDY = record(
    lambda format, **values: Study(**values), format=Key(TEXT, lambda _: FORMAT), slice=line(200), heading=line(1000),
    machine=named(line(300)), versions=named(line(300)), seed=_WHOLE, rounds=_WHOLE, time_limit=_NUMBER, quick=TRUTH,
    verified=optional(TRUTH), floor=_TIMES, measurements=listed(_MEASUREMENT),
)  # fmt: skip
