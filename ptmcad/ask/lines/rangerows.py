"""Tables of operation ranges along one axis of a slice against values of the other one, and where
they are widest.

Guarantee: widths in rows are enclosed, and a row that has none says why. The maxima are those of
`ptmcad.exact.ranges.width`; with free lengths there are none, and nothing is claimed between two
rows. Then there may be more than two stable equilibria, on small parts of a window: an operation
range is where there are at least two, and of closed loops as many as there are anywhere in the
rows. Two neighbouring intervals are one range only where both are operation ranges; what could not
be decided in a row is said there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import groupby
from typing import TypeVar

from ptmcad.answer.counts import operation_number
from ptmcad.answer.intervals import CertifiedInterval
from ptmcad.answer.widths import (
    CertifiedRange,
    CertifiedRow,
    CertifiedWidths,
    OperationWidths,
    WidthRow,
)
from ptmcad.ask.quantities import open_chain
from ptmcad.errors import A_SLICE, ConfigError, HypothesisError, expect, quoted
from ptmcad.options import Progress
from ptmcad.question.slice import Axis, Slice

ROWS = 41
T = TypeVar("T")


def operation_widths(slice: Slice, along: str, rows: int = ROWS) -> OperationWidths:
    """Tabulate the operation range's width over the other axis and find where it is largest.

    Raises
    ------
    ConfigError
        When springs have a free length.
    HypothesisError
        When the slice is degenerate or leaves the domain of the geometry.
    """
    from ptmcad.exact.ranges.exactline import intervals
    from ptmcad.exact.ranges.rangestrips import strips
    from ptmcad.exact.ranges.width import widest

    axis, over = _axes(slice, along, rows)
    found = strips(slice, along)
    table = tuple(
        WidthRow(value, () if line is None else line.operation, remark)
        for value, line, remark in _rows(
            over, rows, lambda value: intervals(slice, along, {over.name: value}, found.working)
        )
    )
    maxima = widest(slice, along, found)
    return OperationWidths(slice.name, axis, over, table, maxima, slice.model, found.working)


def enclosed_widths(
    slice: Slice, along: str, rows: int, digits: int, progress: Progress
) -> CertifiedWidths:
    """Tabulate the operation ranges of a slice whose springs have free lengths.

    Parameters
    ----------
    digits : to which ends are enclosed.
    progress : called as progress("rows", done, rows).
    """
    from ptmcad.ask.lines.along import certified_intervals

    axis, over = _axes(slice, along, rows)
    found: list[tuple[Fraction, tuple[CertifiedInterval, ...], str]] = []
    for value, line, remark in _rows(
        over, rows, lambda value: certified_intervals(slice, along, {over.name: value}, digits)
    ):
        found.append((value, () if line is None else line.intervals, remark))
        progress("rows", len(found), rows)
    working = operation_number(slice.model, ())
    if open_chain(slice.model) is None:
        # as without free lengths: a loop is stable somewhere nearly everywhere
        known = (i.working or 0 for _, row, _ in found for i in row)
        working = max(known, default=working) or working
    table = tuple(
        CertifiedRow(value, _ranges(row, working), any(i.working is None for i in row), remark)
        for value, row, remark in found
    )
    return CertifiedWidths(axis, over, table, working, slice.name, slice.model)


def _axes(slice: Slice, along: str, rows: int) -> tuple[Axis, Axis]:
    """The axis along which ranges lie, and the other one."""
    expect(slice, Slice, "slice", A_SLICE)
    names = slice.axis_names
    if along not in names:
        raise ConfigError(
            f"{quoted(along)} is not an axis of the slice: choose {names[0]} or {names[1]}",
            key="along",
        )
    if isinstance(rows, bool) or not isinstance(rows, int) or rows < 1:
        raise ConfigError(f"{rows!r:.60} is not a number of rows", key="rows")
    number = names.index(along)
    return slice.axes[number], slice.axes[1 - number]


def _rows(
    over: Axis, rows: int, line: Callable[[Fraction], T]
) -> Iterator[tuple[Fraction, T | None, str]]:
    """Values of an axis at equal distances, the line at each, or why it has no answer."""
    for k in range(1, rows + 1):
        value = over.at(Fraction(k, rows + 1))
        try:
            yield value, line(value), ""
        except HypothesisError as error:
            yield value, None, str(error)


def _ranges(row: tuple[CertifiedInterval, ...], working: int) -> tuple[CertifiedRange, ...]:
    """The operation ranges of a row; one goes on through a value at which only other solutions
    meet.
    """
    groups = groupby(
        row, lambda interval: interval.working is not None and interval.working >= working
    )
    runs = [list(group) for inside, group in groups if inside]
    return tuple(CertifiedRange(run[0].low, run[-1].high) for run in runs)
