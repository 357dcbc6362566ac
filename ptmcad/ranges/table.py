"""The intervals of a line as a table for the terminal.

Guarantee: every digit that is shown is right.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.numerals import shortest_text
from ptmcad.plane import PlanePolynomial
from ptmcad.ranges.line import CountIntervals, End
from ptmcad.ranges.numbers import end_text, width_text

LONGEST = 60
"""Characters of a polynomial; of longer ones the degree is told."""


def table(found: CountIntervals, digits: int = 10) -> str:
    """One row for each interval, then what happens at their ends, then the operation range."""
    name = found.along.name
    fixed = ", ".join(f"{n} = {shortest_text(v)}" for n, v in found.at.items())
    rows = [["from", "to", "total", "stable", "min-saddle-max", "sample"]]
    for i in found.intervals:
        index = "-".join(map(str, i.index))
        ends = [end_text(i.low, digits), end_text(i.high, digits)]
        rows.append([*ends, str(i.total), str(i.stable), index, shortest_text(i.sample)])
    lines = [f"{name} in ({shortest_text(found.along.low)}, {shortest_text(found.along.high)}) at {fixed}", ""]
    lines += aligned(rows)
    if found.changes:
        lines.append("")
        changes = [["at", "what happens as it grows", "root of"]]
        changes += [[end_text(c.at, digits), c.text, formula(c.at, name)] for c in found.changes]
        lines += aligned(changes)
    lines.append("")
    if not found.operation:
        lines.append("operation range: none, there are nowhere two stable equilibria")
    for i in found.operation:
        edges = [side for side, end in (("lower", i.low), ("upper", i.high)) if isinstance(end, Fraction)]
        note = f" (its {' and '.join(edges)} end is the window's edge)" if edges else ""
        low, high = end_text(i.low, digits), end_text(i.high, digits)
        lines.append(f"operation range: {low} to {high}, width {width_text(i, digits)}{note}")
    return "\n".join(lines)


def formula(end: End, name: str) -> str:
    """The polynomial of which an end is a root, or its degree when it is long."""
    if isinstance(end, Fraction):
        return ""
    text = PlanePolynomial.of((k, 0, c) for k, c in enumerate(end.polynomial)).text((name, "_"))
    return text if len(text) <= LONGEST else f"a polynomial of degree {end.degree}, in the JSON"


def aligned(rows: list[list[str]]) -> list[str]:
    """Rows as lines with columns of equal width."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in rows]
