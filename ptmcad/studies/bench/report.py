"""A benchmark's report as JSON and as a Markdown table."""

from __future__ import annotations

import json
from dataclasses import asdict

from ptmcad.studies.bench.suite import Report, Row, Summary
from ptmcad.studies.tables import markdown, measured_with

_HEADER = (
    "slice",
    "JSON: median (min-max) s",
    "over floor",
    "with PNG and SVG, s",
    "peak MiB, JSON / pictures",
)


def to_json(report: Report) -> str:
    """The whole report; floats rounded to 0.1 ms and 0.1 %, keys in a fixed order."""
    return json.dumps(_rounded(asdict(report)), indent=2, ensure_ascii=False) + "\n"


def to_markdown(report: Report) -> str:
    """The report as a page: the table, and what it was measured with."""
    lines = [
        "# Benchmark",
        "",
        "Wall seconds of whole processes, start-up included; every round runs each job once, in shuffled order. Ratios",
        "are medians of the ratios within a round. The floor is the time in which the machine's Python imports flint,",
        "numpy, click and yaml and does nothing else. Written by `make bench`. Other programs, and the error of each,",
        "are on [their own page](error-time.md).",
        "",
        f"Floor: {_times(report.floor)} s. Rounds: {report.rounds}, seed {report.seed}{_date(report)}.",
        "",
        *markdown(_HEADER, map(_cells, report.rows)),
        "",
        *measured_with({"machine": report.machine, "versions": report.versions}),
    ]
    return "\n".join(lines) + "\n"


def _date(report: Report) -> str:
    return f", {report.date}" if report.date else ""


def _cells(row: Row) -> tuple[str, ...]:
    peaks = " / ".join(f"{part.peak:.0f}" if isinstance(part, Summary) else "-" for part in (row.text, row.pictures))
    over = f"{row.over_floor:.2f}" if row.over_floor else "-"
    pictures = f"{row.pictures.median:.2f}" if isinstance(row.pictures, Summary) else row.pictures
    return (row.name, _times(row.text), over, pictures, peaks)


def _times(found: Summary | str) -> str:
    if isinstance(found, str):
        return found
    return f"{found.median:.3f} ({found.minimum:.3f}-{found.maximum:.3f})"


def _rounded(value: object) -> object:
    if isinstance(value, float):
        return round(value, 4)
    if isinstance(value, dict):
        return {key: _rounded(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(part) for part in value]
    return value
