"""The intervals of a line as a JSON document, docs/range.schema.json.

Guarantee: parameters, ends and samples are written exactly; every digit of a decimal is right; the same intervals give
the same text.
"""

from __future__ import annotations

import json
from typing import Any

from ptmcad.numerals import text_of
from ptmcad.ranges.line import CountIntervals
from ptmcad.ranges.numbers import enclosure_data, end_data, width_text
from ptmcad.version import __version__

FORMAT = "ptmcad-range/1"


def line_data(found: CountIntervals, digits: int) -> dict[str, Any]:
    """The intervals of a line as JSON data."""
    return {
        "along": {"name": found.along.name, "window": [text_of(found.along.low), text_of(found.along.high)]},
        "at": {name: text_of(value) for name, value in found.at.items()},
        "parameters": {n: e.to_text((found.along.name, "_")) for n, e in found.parameters.items()},
        "intervals": [
            {
                "low": end_data(i.low, digits),
                "high": end_data(i.high, digits),
                "total": i.total,
                "stable": i.stable,
                "index": list(i.index),
                "sample": text_of(i.sample),
                "width": width_text(i, digits),
                "width_enclosure": enclosure_data(i.width),
            }
            for i in found.intervals
        ],
        "changes": [
            {
                "at": end_data(c.at, digits),
                "kind": c.kind.value,
                "before": list(c.before),
                "after": list(c.after),
                "event": c.event.name.lower(),
                "text": c.text,
            }
            for c in found.changes
        ],
        "operation": [n for n, i in enumerate(found.intervals) if i.stable == 2],
    }


def document(name: str, mechanism: str, parts: dict[str, Any]) -> str:
    """The JSON text of an answer; ``parts`` has some of the entries line, over, path."""
    data = {
        "format": FORMAT,
        "name": name,
        "mechanism": mechanism,
        **parts,
        "versions": {"ptmcad": __version__},
    }
    return json.dumps(data, ensure_ascii=False, indent=1) + "\n"
