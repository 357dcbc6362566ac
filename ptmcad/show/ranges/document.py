"""Ranges, widths and paths as a JSON document, docs/range.schema.json.

Guarantee: parameters, ends and samples are written exactly; every digit of a decimal is right; the same answer gives
the same text.
"""

from __future__ import annotations

import json
from typing import Any

from ptmcad.answer.counts import Counts
from ptmcad.answer.intervals import CertifiedIntervals, CountInterval, CountIntervals
from ptmcad.answer.paths import PathEnd, PathPoint, PosePaths, Target
from ptmcad.answer.widths import Attainment, CertifiedWidths, OperationWidths
from ptmcad.question.slice import Axis
from ptmcad.show.document.extremes import maximum_data
from ptmcad.show.ranges.numbers import (
    end_data,
    narrowly_known,
    place_data,
    settled,
    width_text,
)
from ptmcad.text.numerals import text_of
from ptmcad.version import __version__

FORMAT = "ptmcad-range/1"


def line_data(found: CountIntervals, digits: int) -> dict[str, Any]:
    """The intervals of a line as JSON data."""
    return {
        "along": _axis(found.along),
        "at": {name: text_of(value) for name, value in found.at.items()},
        "parameters": {n: e.to_text((found.along.name, "_")) for n, e in found.parameters.items()},
        "intervals": [_interval(i, digits) for i in found.intervals],
        "changes": [
            {
                "at": end_data(c.at, digits),
                "kind": c.kind.value,
                "before": _counts(c.before),
                "after": _counts(c.after),
                "event": c.event.name.lower(),
                **({} if c.continuum is None else {"continuum": c.continuum.value}),
                "text": c.text,
            }
            for c in found.changes
        ],
        "operation": [n for n, i in enumerate(found.intervals) if i.counts.working == found.working],
    }


def enclosed_data(found: CertifiedIntervals, digits: int) -> dict[str, Any]:
    """The intervals of a line on which springs have free lengths as JSON data."""
    return {
        "along": _axis(found.along),
        "at": {name: text_of(value) for name, value in found.at.items()},
        "intervals": [
            {
                "low": place_data(i.low, digits),
                "high": place_data(i.high, digits),
                "total": i.total,
                "stable": i.stable,
                "index": None if i.index is None else list(i.index),
                "peaks": i.cones,
                "sample": text_of(i.sample),
            }
            for i in found.intervals
        ],
        "changes": [{"at": place_data(c.at, digits), "met": list(c.names), "proved": c.proved} for c in found.changes],
    }


def _axis(axis: Axis) -> dict[str, Any]:
    return {"name": axis.name, "window": [text_of(axis.low), text_of(axis.high)]}


def _interval(interval: CountInterval, digits: int) -> dict[str, Any]:
    return {
        "low": end_data(interval.low, digits),
        "high": end_data(interval.high, digits),
        "total": interval.total,
        "stable": interval.stable,
        "index": None if interval.index is None else list(interval.index),
        "sample": text_of(interval.sample),
        "width": width_text(interval, digits),
    }


def _counts(counts: Counts) -> list[int] | dict[str, int | None]:
    """Numbers by index, or without an index in all and of stable ones."""
    if counts.index is not None:
        return list(counts.index)
    return {"total": counts.total, "stable": counts.stable}


def over_data(found: OperationWidths, digits: int) -> dict[str, Any]:
    """The widths over the other axis as JSON data."""
    return {
        "along": _axis(found.along),
        "over": _axis(found.over),
        "stable": found.working,
        "rows": [
            {
                "value": text_of(row.value),
                "operation": [_interval(i, digits) for span in row.operation for i in span.parts],
                "remark": row.remark,
            }
            for row in found.rows
        ],
        "maxima": [maximum_data(m, found.over.name, digits) for m in found.maxima],
    }


def bands_data(found: CertifiedWidths, digits: int) -> dict[str, Any]:
    """The operation ranges over the other axis with free lengths as JSON data."""
    return {
        "along": _axis(found.along),
        "over": _axis(found.over),
        "stable": found.working,
        "attainment": Attainment.UNDECIDED.value,
        "rows": [
            {
                "value": text_of(row.value),
                "operation": [
                    {"low": place_data(i.low, digits), "high": place_data(i.high, digits)} for i in row.operation
                ],
                "undecided": row.undecided,
                "remark": row.remark,
            }
            for row in found.rows
        ],
    }


def path_data(found: PosePaths) -> dict[str, Any]:
    """The paths of stable poses as JSON data."""
    return {
        "along": _axis(found.along),
        "at": {name: text_of(value) for name, value in found.at.items()},
        "start": text_of(found.start),
        **({"joined": True} if found.joined else {}),
        "paths": [
            {
                "number": path.number,
                "upright": path.upright,
                "reverse": path.reverse,
                "low": _path_end(path.low),
                "high": _path_end(path.high),
                "points": [_point(p) for p in path.points],
            }
            for path in found.paths
        ],
    }


def _path_end(end: PathEnd) -> dict[str, Any]:
    return {
        "fate": end.fate.name.lower(),
        "text": end.fate.value,
        "at": end_data(end.at, DIGITS),
        "last": _point(end.last),
        "meeting": list(end.meeting),
        "leaving": list(end.leaving),
        **({"among": True} if end.among else {}),
        "energy": None if end.energy is None else settled(end.energy, DIGITS),
        "target": None if end.target is None else _place(end.target),
        "target_energy": None if end.target_energy is None else settled(end.target_energy, DIGITS),
    }


DIGITS = 12


def _point(point: PathPoint) -> dict[str, Any]:
    return {"value": text_of(point.value), **_place(point)}


def _place(point: PathPoint | Target) -> dict[str, Any]:
    return {"angles": [narrowly_known(a, DIGITS) for a in point.angles]} | (
        {"reals": [narrowly_known(x, DIGITS) for x in point.reals]} if point.reals else {}
    )


def document(name: str, mechanism: str, parts: dict[str, Any]) -> str:
    """The JSON text of an answer; ``parts`` has some of the entries line, enclosed, over and path."""
    data = {
        "format": FORMAT,
        "name": name,
        "mechanism": mechanism,
        **parts,
        "versions": {"ptmcad": __version__},
    }
    return json.dumps(data, ensure_ascii=False, indent=1) + "\n"
