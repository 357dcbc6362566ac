"""A study as JSON, read back strictly, and as CSV.

Guarantee: `read_study(write_study(s))` equals s; a file that is not such a document is refused with the place of the
fault. ``docs/bench.schema.json`` is its schema.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from io import StringIO
from pathlib import Path
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.show.document.node import Node
from ptmcad.studies.bench.rounds import Times
from ptmcad.studies.bench.study import FORMAT, Figures, Measurement, Study
from ptmcad.text.textfile import read_text

MAX_BYTES = 10_000_000
_COLUMNS = (
    "slice", "method", "setting", "seconds_median", "seconds_min", "seconds_max", "runs", "computing_median",
    "peak_mib", "count", "wrong_low", "wrong_high", "undetermined", "wrong_centres", "regions", "missed",
    "faintest_low", "faintest_high", "distance_low", "distance_high", "area_width", "reason",
)  # fmt: skip
MAX_COUNTED = 10**12


def write_study(study: Study) -> str:
    """The study as JSON text."""
    return json.dumps({"format": FORMAT, **asdict(study)}, indent=1, ensure_ascii=False) + "\n"


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
    text = read_text(path, MAX_BYTES, f"a {FORMAT} file")
    try:
        return study_of(text)
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"is not a {FORMAT} file: {error}", file=str(path)) from error


def study_of(text: str) -> Study:
    """The study that `write_study` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document; the message names the place.
    """
    d = Node(json.loads(text), "").record(
        "format", "slice", "heading", "machine", "versions", "seed", "rounds", "time_limit", "quick", "verified",
        "floor", "measurements",
    )  # fmt: skip
    if d["format"].text() != FORMAT:
        raise d["format"].fault(f"is not {FORMAT!r}")
    return Study(
        slice=d["slice"].line(200),
        heading=d["heading"].line(1000),
        machine=_texts(d["machine"]),
        versions=_texts(d["versions"]),
        seed=_whole(d["seed"]),
        rounds=_whole(d["rounds"]),
        time_limit=d["time_limit"].number(),
        quick=_flag(d["quick"]),
        verified=None if d["verified"].value is None else _flag(d["verified"]),
        floor=_times(d["floor"]),
        measurements=d["measurements"].each(_measurement),
    )


def _measurement(node: Node) -> Measurement:
    m = node.record("method", "setting", "seconds", "computing", "peak", "reason", "note", "figures", "area_width")
    return Measurement(
        method=m["method"].line(60),
        setting=m["setting"].line(60),
        seconds=_optional(m["seconds"], _times),
        computing=_optional(m["computing"], _times),
        peak=_optional(m["peak"], Node.number),
        reason=m["reason"].line(1000),
        note=m["note"].line(1000),
        figures=_optional(m["figures"], lambda n: {count: _figures(f) for count, f in n.mapping().items()}),
        area_width=_optional(m["area_width"], Node.number),
    )


def _figures(node: Node) -> Figures:
    f = node.record("wrong", "undetermined", "wrong_centres", "regions", "missed", "faintest", "distance")
    return Figures(
        wrong=_pair(f["wrong"]),
        undetermined=f["undetermined"].number(),
        wrong_centres=_optional(f["wrong_centres"], _number),
        regions=_optional(f["regions"], _number),
        missed=_optional(f["missed"], _number),
        faintest=_optional(f["faintest"], _pair),
        distance=_optional(f["distance"], _pair),
    )


def _number(node: Node) -> int:
    """Of pixels or regions: what nobody can count is not one."""
    found = _whole(node)
    if found > MAX_COUNTED:
        raise node.fault(f"is more than {MAX_COUNTED}")
    return found


def _times(node: Node) -> Times:
    t = node.record("runs", "median", "minimum", "maximum")
    seconds = [t[key].number() for key in ("median", "minimum", "maximum")]
    for key, value in zip(("median", "minimum", "maximum"), seconds, strict=True):
        if not value > 0:
            raise t[key].fault("is not a positive number of seconds")
    return Times(_whole(t["runs"]), *seconds)


def _optional(node: Node, read: Any) -> Any:
    return None if node.value is None else read(node)


def _pair(node: Node) -> tuple[float, float]:
    low, high = node.each(Node.number, 2)
    return low, high


def _whole(node: Node) -> int:
    if type(node.value) is not int:
        raise node.fault("is not a whole number")
    return node.value


def _flag(node: Node) -> bool:
    if not isinstance(node.value, bool):
        raise node.fault("is neither true nor false")
    return node.value


def _texts(node: Node) -> Mapping[str, str]:
    return {key: value.line(300) for key, value in node.mapping().items()}
