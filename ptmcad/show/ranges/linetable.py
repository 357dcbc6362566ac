"""Intervals along a line, and operation ranges over the other axis, as text for the terminal.

Guarantee: every digit that is shown is right; what was not decided is called undecided and has no
counts.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ptmcad.answer.counts import MorseIndex
from ptmcad.answer.intervals import AnyEnd, Change, CountIntervals, Span
from ptmcad.answer.widths import Attainment, Maximum, OperationWidths, WidthRow
from ptmcad.answer.words import sought
from ptmcad.model import Model
from ptmcad.show.ranges.endtext import end_text, width_text
from ptmcad.show.table import aligned
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.numerals import between, equalities, rounded, shortest_text
from ptmcad.text.plane import PlanePolynomial

MAX_POLYNOMIAL = 60
"""Characters of a polynomial; of longer ones the degree is reported."""
UNDECIDED_PART = ", a part of the window undecided"


def table(found: CountIntervals, digits: int = 10) -> str:
    """One row for each interval, then what happens at their ends, then the operation range."""
    name, low, high = found.along.name, found.along.low, found.along.high
    heads = _heads(found)
    rows = [["from", "to", *heads.values(), "sample"]]
    for each in found.intervals:
        ends = (_side_text(each.low, digits, up=True), _side_text(each.high, digits))
        counts = (_counted(column, getattr(each, column)) for column in heads)
        rows.append([*ends, *counts, shortest_text(each.sample)])
    window = f"({shortest_text(low)}, {shortest_text(high)})"
    at = equalities(found.at, shortest_text)
    lines = [f"{name} in {window} at {at}", "", *aligned(rows)]
    if found.changes:
        columns = ["what is met"] if found.enclosed else [f"as {name} increases", "root of"]
        changes = [["at", *columns], *(_change_row(c, name, digits) for c in found.changes)]
        lines += ["", *aligned(changes)]
    if "peaks" in heads:
        lines += [
            "",
            "peaks: configurations without length of spring A3A4 in which the energy has a peak",
        ]
    lines.append("")
    range_name = operation_name(found.model, found.working)
    if not found.operation:
        none = f"none, {nowhere(found.model, found.working)}"
        lines.append(f"{range_name}: {none if found.decided else 'undecided'}")
    note = "" if found.decided else UNDECIDED_PART
    lines += [f"{range_name}: {_range_text(i, digits)}{note}" for i in found.operation]
    return "\n".join(lines)


def _heads(found: CountIntervals) -> dict[str, str]:
    """The columns of counts, by the names of these; where nothing is decided, all there may be."""

    def known(count: str) -> bool:
        return any(getattr(interval, count) is not None for interval in found.intervals)

    heads = {"total": "total"}
    if known("stable") or not known("total"):
        heads["stable"] = "stable"
    if known("index") or not known("total"):
        sizes = {len(i.index) for i in found.intervals if i.index is not None}
        heads["index"] = _INDEX_HEADS.get(min(sizes, default=0), "index")
    if known("peaks"):
        heads["peaks"] = "peaks"
    return heads


def _change_row(change: Change, name: str, digits: int) -> list[str]:
    """Where a change is, what happens there, and of an exact one its polynomial."""
    at = change.at
    if isinstance(at, AlgebraicNumber):
        return [end_text(at, digits), change.text, formula(at, name)]
    return [place_text(at, digits), change.text]


def place_text(at: AlgebraicNumber | Enclosure, digits: int) -> str:
    """Where a change is: a number, or two ends where its digits are not settled."""
    text = _side_text(at, digits)
    if isinstance(at, AlgebraicNumber) or at.settles(digits):
        return text
    return f"{text} to {_side_text(at, digits, up=True)}"


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
        side for side, end in (("lower", interval.low), ("upper", interval.high)) if _is_edge(end)
    ]
    notes = ("", " (its {} end is the window's edge)", " (the whole window)")
    note = notes[len(edges)].format(*edges)
    low, high = _side_text(interval.low, digits, up=True), _side_text(interval.high, digits)
    return f"{low} to {high}, width {width_text(interval, digits)}{note}"


def _is_edge(end: AnyEnd) -> bool:
    """Whether an end is the window's edge."""
    return isinstance(end, Fraction) or (isinstance(end, Enclosure) and end.exact is not None)


def formula(end: AlgebraicNumber, name: str) -> str:
    """The polynomial of which a number is a root, or its degree when it is long."""
    text = PlanePolynomial.of((k, 0, c) for k, c in enumerate(end.polynomial)).text((name, "_"))
    return (
        text if len(text) <= MAX_POLYNOMIAL else f"a polynomial of degree {end.degree}, in the JSON"
    )


def width_table(found: OperationWidths, digits: int = 10) -> str:
    """The operation ranges at the tabulated values, and where they are widest."""
    model, working = found.model, found.working
    range_name = "operation range" if found.enclosed else operation_name(model, working)
    rows = [[found.over.name, f"{range_name} from", "to", "width"]]
    for row in found.rows:
        value = shortest_text(row.value)
        cells = [[value, *_width_cells(row, one, digits)] for one in row.operation]
        note = "degenerate" if row.remark else "undecided" if row.undecided else "none"
        rows += cells or [[value, note, "", ""]]
    marked = any("*" in cell for cells in rows for cell in cells)
    lines = [*aligned(rows), *[f"* the edge of the window of {found.along.name}"] * marked, ""]
    if found.enclosed:
        least = f"{range_name}: where there are at least {working_text(model, working)}"
        return "\n".join([least, "", *lines, widest_text(found)])
    if not found.maxima:
        lines.append(f"widest {range_name}: none, {nowhere(model, working)}")
    for m in found.maxima:
        lines.append(f"widest {range_name}: {maximum_text(m, found.over.name, digits)}")
    return "\n".join(lines)


def _width_cells(row: WidthRow, span: Span, digits: int) -> Iterator[str]:
    """The ends, with a mark at the window's edge, and the width."""
    for end, up in ((span.low, True), (span.high, False)):
        yield _side_text(end, digits, up) + " *" * _is_edge(end)
    yield width_text(span, digits) + UNDECIDED_PART * row.undecided


def maximum_text(found: Maximum, over: str, digits: int) -> str:
    """A maximum in words."""
    width = found.width
    known = width.settled_text(digits) or f"from {between(width.low, width.high, 4)}"
    return f"width {known}, {found.words(over, digits)}"


def widest_text(found: OperationWidths) -> str:
    """The widest range of the table."""
    if found.widest is None:
        return f"widest operation range: none, {nowhere(found.model, found.working)} in these rows"
    row, one = found.widest
    at = f"{found.over.name} = {shortest_text(row.value)}"
    return (
        f"widest of these rows: width {width_text(one, 6)} at {at}; nothing is proved of the values between them: "
        f"{Attainment.UNDECIDED.value}"
    )


def _side_text(end: AnyEnd, digits: int, up: bool = False) -> str:
    """The end rounded; of an enclosure whose digits are not settled its lower or its upper side,
    rounded outwards.
    """
    if not isinstance(end, Enclosure) or end.settles(digits):
        return end_text(end, digits)
    outer = rounded(end.high if up else end.low, Fraction(1, 10**digits), up)
    return Enclosure(outer, outer).text(digits + 20)
