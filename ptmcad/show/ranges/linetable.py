"""Intervals along a line, and operation ranges over the other axis, as text for the terminal.

Guarantee: every digit that is shown is right; what was not decided is called undecided and has no
counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any

from ptmcad.answer.counts import MorseIndex
from ptmcad.answer.intervals import (
    CertifiedChange,
    CertifiedIntervals,
    CountIntervals,
    End,
    OperationSpan,
    Span,
)
from ptmcad.answer.widths import (
    Attainment,
    CertifiedRange,
    CertifiedRow,
    CertifiedWidths,
    Maximum,
    OperationWidths,
    WidthRow,
)
from ptmcad.answer.words import sought
from ptmcad.model import Model
from ptmcad.show.columns import aligned
from ptmcad.show.ranges.endtext import end_text, known, line_head, settled, width_text
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import decimal, rounded, shortest_text
from ptmcad.text.plane import PlanePolynomial

MAX_POLYNOMIAL = 60
"""Characters of a polynomial; of longer ones the degree is reported."""


def table(found: CountIntervals | CertifiedIntervals, digits: int = 10) -> str:
    """One row for each interval, then what happens at their ends, then, of exact ones, the
    operation range.
    """
    if isinstance(found, CertifiedIntervals):
        return _enclosed_table(found, digits)
    name = found.along.name
    first = found.intervals[0]
    heads = {"total": "total"}
    if first.stable is not None:
        heads["stable"] = "stable"
    if first.index is not None:
        heads["index"] = _INDEX_HEADS.get(len(first.index), "index")
    lines = interval_rows(
        found, heads, lambda i: (end_text(i.low, digits), end_text(i.high, digits))
    )
    if found.changes:
        lines.append("")
        changes = [["at", f"as {name} increases", "root of"]]
        changes += [[end_text(c.at, digits), c.text, formula(c.at, name)] for c in found.changes]
        lines += aligned(changes)
    lines.append("")
    range_name = operation_name(found.model, found.working)
    if not found.operation:
        lines.append(f"{range_name}: none, {nowhere(found.model, found.working)}")
    lines += [f"{range_name}: {_range_text(i, digits)}" for i in found.operation]
    return "\n".join(lines)


def interval_rows(
    found: CountIntervals | CertifiedIntervals,
    heads: Mapping[str, str],
    ends: Callable[[Any], Iterable[str]],
) -> list[str]:
    """A line for each interval, below what is fixed.

    Parameters
    ----------
    heads : of the columns of counts, by the names of these.
    """
    rows = [["from", "to", *heads.values(), "sample"]]
    for each in found.intervals:
        counts = (_counted(name, getattr(each, name)) for name in heads)
        rows.append([*ends(each), *counts, shortest_text(each.sample)])
    return [line_head(found.along, found.at), "", *aligned(rows)]


def _counted(name: str, count: int | MorseIndex | None) -> str:
    if count is None:
        return "undecided" if name == "total" else ""
    return "-".join(map(str, count)) if isinstance(count, tuple) else str(count)


_INDEX_HEADS = {2: "min-max", 3: "min-saddle-max"}
_WORDS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


def operation_name(model: Model, number: int) -> str:
    """What the range of so many stable solutions is called: only a mechanism operates."""
    nouns = model.nouns
    return (
        nouns.range
        if number == nouns.usual
        else nouns.range_with.format(working_text(model, number))
    )


def working_text(model: Model, number: int) -> str:
    """What there is in an operation range, such as two stable equilibria."""
    many = _WORDS[number] if number < len(_WORDS) else str(number)
    return f"{many} {sought(model, number)}"


def nowhere(model: Model, number: int) -> str:
    """Why there is no operation range."""
    return f"there {'is' if number == 1 else 'are'} nowhere {working_text(model, number)}"


def _range_text(interval: Span, digits: int) -> str:
    edges = [
        side
        for side, end in (("lower", interval.low), ("upper", interval.high))
        if isinstance(end, Fraction)
    ]
    note = ""
    if edges:
        note = (
            f" (its {edges[0]} end is the window's edge)"
            if len(edges) == 1
            else " (the whole window)"
        )
    low, high = end_text(interval.low, digits), end_text(interval.high, digits)
    return f"{low} to {high}, width {width_text(interval, digits)}{note}"


def formula(end: End, name: str) -> str:
    """The polynomial of which an end is a root, or its degree when it is long."""
    if isinstance(end, Fraction):
        return ""
    text = PlanePolynomial.of((k, 0, c) for k, c in enumerate(end.polynomial)).text((name, "_"))
    return (
        text if len(text) <= MAX_POLYNOMIAL else f"a polynomial of degree {end.degree}, in the JSON"
    )


def width_rows(
    found: OperationWidths | CertifiedWidths,
    range_name: str,
    note: Callable[[Any], str],
    cells: Callable[[Any, Any], Iterable[str]],
) -> list[str]:
    """A line for each range of each row, and what a mark at an end means, where there is one.

    Parameters
    ----------
    note : what is said of a row without a range.
    cells : of a row and one of its ranges the ends and the width.
    """
    rows = [[found.over.name, f"{range_name} from", "to", "width"]]
    for row in found.rows:
        value = shortest_text(row.value)
        rows += [[value, *cells(row, one)] for one in row.operation] or [[value, note(row), "", ""]]
    marked = any("*" in cell for cells in rows for cell in cells)
    return [*aligned(rows), *[f"* the edge of the window of {found.along.name}"] * marked]


def width_table(found: OperationWidths | CertifiedWidths, digits: int = 10) -> str:
    """The operation ranges at the tabulated values, and where they are widest."""
    if isinstance(found, CertifiedWidths):
        return _enclosed_width_table(found, digits)
    range_name = operation_name(found.model, found.working)

    def cells(_: WidthRow, span: OperationSpan) -> Iterator[str]:
        for end in (span.low, span.high):
            yield end_text(end, digits) + " *" * isinstance(end, Fraction)
        yield width_text(span, digits)

    lines = [
        *width_rows(found, range_name, lambda row: "degenerate" if row.remark else "none", cells),
        "",
    ]
    if not found.maxima:
        lines.append(f"widest {range_name}: none, {nowhere(found.model, found.working)}")
    for m in found.maxima:
        lines.append(f"widest {range_name}: {maximum_text(m, found.over.name, digits)}")
    return "\n".join(lines)


def maximum_text(found: Maximum, over: str, digits: int) -> str:
    """A maximum in words."""
    low, high = (
        decimal(end, up, 4) for end, up in ((found.width.low, False), (found.width.high, True))
    )
    return f"width {settled(found.width, digits) or f'from {low} to {high}'}, {found.words(over, digits)}"


def _enclosed_table(found: CertifiedIntervals, digits: int) -> str:
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
        found, heads, lambda i: (_outer_text(i.low, digits, up=True), _outer_text(i.high, digits))
    )
    if found.changes:
        changes = [["at", "what is met"]]
        for change in found.changes:
            place = _outer_text(change.at, digits)
            if not change.at.settles(digits):
                place = f"{place} to {_outer_text(change.at, digits, up=True)}"
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


def _enclosed_width_table(found: CertifiedWidths, digits: int) -> str:
    """The operation ranges at the tabulated values, and the widest of them."""

    def note(row: CertifiedRow) -> str:
        return "degenerate" if row.remark else "undecided" if row.undecided else "none"

    def cells(row: CertifiedRow, one: CertifiedRange) -> Iterator[str]:
        for end, up in ((one.low, True), (one.high, False)):
            yield _outer_text(end, digits, up) + " *" * (end.low == end.high)
        yield known(one.width, min(digits, 6)) + ", a part of the window undecided" * row.undecided

    ranges = f"operation range: where there are at least {working_text(found.model, found.working)}"
    return "\n".join(
        [
            ranges,
            "",
            *width_rows(found, "operation range", note, cells),
            "",
            widest_text(found),
        ]
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


def _outer_text(end: Enclosure, digits: int, up: bool = False) -> str:
    """The end rounded; where its digits are not settled, its outer side, rounded outwards."""
    if end.settles(digits):
        return end.text(digits)
    outer = rounded(end.high if up else end.low, Fraction(1, 10**digits), up)
    return Enclosure(outer, outer).text(digits + 20)
