"""The energy of a mechanism from its record's numbers alone, with mpmath: springs, torsion is left
out, and loads.

It shares nothing with the engines: a record's expressions are Python's own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mpmath import mp, mpf


def energy(record: Mapping[str, Any], values: Mapping[str, mpf], unknowns: Sequence[mpf]) -> mpf:
    """At values of all parameters and of the unknowns in the record's order."""
    scope = {
        "cos": mp.cos,
        "sin": mp.sin,
        **values,
        **dict(zip(record["unknowns"], unknowns, strict=True)),
    }

    def value(expression: object) -> mpf:
        return eval(str(expression).replace("^", "**"), {}, scope)

    points = {name: [value(x) for x in pair] for name, pair in record["points"].items()}
    total = mpf(0)
    for spring in record["springs"]:
        start, end = (points[name] for name in spring["between"])
        length = mp.sqrt(sum((b - a) ** 2 for a, b in zip(start, end, strict=True)))
        total += value(spring["k"]) * (length - value(spring.get("free", 0))) ** 2 / 2
    for point, force in record.get("loads", {}).items():
        total -= sum(value(f) * x for f, x in zip(force, points[point], strict=True))
    return total
