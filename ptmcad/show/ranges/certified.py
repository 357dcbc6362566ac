"""The certified engine's intervals along a line as a table.

Guarantee: every digit is right; what was not decided is called undecided and has no counts.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.answer.intervals import CertifiedIntervals
from ptmcad.show.ranges.table import aligned
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import shortest_text


def table(found: CertifiedIntervals, digits: int) -> str:
    """One row for each interval, then what lies between them."""
    fixed = ", ".join(f"{n} = {shortest_text(v)}" for n, v in found.at.items())
    known = any(i.cones is not None for i in found.intervals)  # of the paper's mechanism only
    rows = [["from", "to", "total", "stable", "min-saddle-max" if known else "index", *["peaks"] * known, "sample"]]
    for i in found.intervals:
        counts = ["undecided", "", "", *[""] * known]
        if i.index is not None:
            counts = [str(sum(i.index)), str(i.index[0]), "-".join(map(str, i.index)), *[str(i.cones)] * known]
        rows.append([_text(i.low, digits, up=True), _text(i.high, digits), *counts, shortest_text(i.sample)])
    lines = [f"{found.along.name} in ({shortest_text(found.along.low)}, {shortest_text(found.along.high)}) at {fixed}"]
    lines += ["", *aligned(rows)]
    if found.changes:
        changes = [["at", "what is met"]]
        for change in found.changes:
            place = _text(change.at, digits)
            if not change.at.settles(digits):
                place = f"{place} to {_text(change.at, digits, up=True)}"
            note = "" if change.proved else "undecided whether there is a "
            changes.append([place, note + " and a ".join(change.names)])
        lines += ["", *aligned(changes)]
    if known:
        lines += ["", "peaks: configurations without length of spring A3A4 in which the energy has a peak"]
    return "\n".join(lines)


def _text(end: Enclosure, digits: int, up: bool = False) -> str:
    """The end rounded; where its digits are not settled, its outer side, rounded outwards."""
    if end.settles(digits):
        return end.text(digits)
    value = end.high if up else end.low
    scale = Fraction(10) ** digits
    rounded = (-((-value * scale) // 1) if up else (value * scale) // 1) / scale
    return Enclosure(rounded, rounded).text(digits + 20)
