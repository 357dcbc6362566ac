"""The certified engine's intervals along a line, and operation ranges over the other axis, as
tables.

Guarantee: every digit is right; what was not decided is called undecided and has no counts.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ptmcad.answer.intervals import CertifiedChange, CertifiedIntervals
from ptmcad.answer.widths import Attainment, CertifiedRange, CertifiedRow, CertifiedWidths
from ptmcad.show.columns import aligned
from ptmcad.show.ranges.numbers import known
from ptmcad.show.ranges.table import interval_rows, nowhere, width_rows, working_text
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import rounded, shortest_text


def table(found: CertifiedIntervals, digits: int) -> str:
    """One row for each interval, then what lies between them."""
    peaks = any(i.cones is not None for i in found.intervals)  # of the paper's mechanism only
    only_totals = all(i.index is None for i in found.intervals) and any(
        i.total is not None for i in found.intervals
    )
    heads = {"total": "total", "stable": "stable"}
    if not only_totals:
        heads["index"] = "min-saddle-max" if peaks else "index"
    elif all(i.stable is None for i in found.intervals):
        del heads["stable"]
    if peaks:
        heads["cones"] = "peaks"
    lines = interval_rows(
        found, heads, lambda i: (_text(i.low, digits, up=True), _text(i.high, digits))
    )
    if found.changes:
        changes = [["at", "what is met"]]
        for change in found.changes:
            place = _text(change.at, digits)
            if not change.at.settles(digits):
                place = f"{place} to {_text(change.at, digits, up=True)}"
            changes.append([place, met(change)])
        lines += ["", *aligned(changes)]
    if peaks:
        lines += [
            "",
            "peaks: configurations without length of spring A3A4 in which the energy has a peak",
        ]
    return "\n".join(lines)


def met(change: CertifiedChange) -> str:
    """What is met, in words, without how it was looked for: folds with and without a short spring
    may be the same.
    """
    kinds = dict.fromkeys(name.partition(" with ")[0] for name in change.names)
    return (
        " and ".join(kinds)
        if change.proved
        else f"undecided whether there is a {' or a '.join(kinds)}"
    )


def width_table(found: CertifiedWidths, digits: int) -> str:
    """The operation ranges at the tabulated values, and the widest of them."""

    def note(row: CertifiedRow) -> str:
        return "degenerate" if row.remark else "undecided" if row.undecided else "none"

    def cells(row: CertifiedRow, one: CertifiedRange) -> Iterator[str]:
        for end, up in ((one.low, True), (one.high, False)):
            yield _text(end, digits, up) + " *" * (end.low == end.high)
        yield known(one.width, min(digits, 6)) + ", a part of the window undecided" * row.undecided

    ranges = f"operation range: where there are at least {working_text(found.model, found.working)}"
    return "\n".join(
        [ranges, "", *width_rows(found, "operation range", note, cells), "", widest_text(found)]
    )


def widest_text(found: CertifiedWidths) -> str:
    """The widest range of the table."""
    if found.widest is None:
        return f"widest operation range: none, {nowhere(found.model, found.working)} in these rows"
    row, one = found.widest
    at = f"{found.over.name} = {shortest_text(row.value)}"
    return (
        f"widest of these rows: width {known(one.width, 6)} at {at}; nothing is proved of the values between them: "
        f"{Attainment.UNDECIDED.value}"
    )


def _text(end: Enclosure, digits: int, up: bool = False) -> str:
    """The end rounded; where its digits are not settled, its outer side, rounded outwards."""
    if end.settles(digits):
        return end.text(digits)
    outer = rounded(end.high if up else end.low, Fraction(1, 10**digits), up)
    return Enclosure(outer, outer).text(digits + 20)
