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

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import chain

from ptmcad.answer.intervals import CountIntervals
from ptmcad.answer.widths import Maximum, OperationWidths, WidthRow
from ptmcad.errors import A_SLICE, ConfigError, HypothesisError, expect, quoted
from ptmcad.options import Progress
from ptmcad.question.slice import Axis, Slice
from ptmcad.text.enclosure import DIGITS

ROWS = 41


def operation_widths(
    slice: Slice,
    along: str,
    rows: int = ROWS,
    digits: int = DIGITS,
    progress: Progress | None = None,
) -> OperationWidths:
    """Tabulate the operation range's width over the other axis.

    Where no spring has a free length, all numbers are exact, and it is proved where the range is
    widest. With free lengths ends are enclosed in each row, and nothing is proved of the values
    between two rows.

    Parameters
    ----------
    rows : values of the other axis, at equal distances within its window.
    digits : to which ends are enclosed, with free lengths.
    progress : with free lengths called as progress("rows", done, rows).

    Raises
    ------
    ConfigError
        When ``along`` is no axis of the slice, or ``rows`` no number of them.
    HypothesisError
        When the slice is degenerate or leaves the domain of the geometry.
    """
    axis, over = _axes(slice, along, rows)
    maxima: tuple[Maximum, ...] = ()
    if slice.has_free_lengths:
        from ptmcad.ask.lines.along import certified_intervals, least_number

        found = _rows(
            over,
            rows,
            progress,
            lambda v: certified_intervals(slice, along, {over.name: v}, digits),
        )
        lines = (line.intervals for _, line, _ in found if line is not None)
        working = least_number(slice.model, chain.from_iterable(lines))
    else:
        from ptmcad.exact.ranges.exactline import intervals
        from ptmcad.exact.ranges.rangestrips import strips
        from ptmcad.exact.ranges.width import widest

        known = strips(slice, along)
        working = known.working
        found = _rows(over, rows, None, lambda v: intervals(slice, along, {over.name: v}, working))
        maxima = widest(slice, along, known)
    table = []
    for value, line, remark in found:
        operation = () if line is None else replace(line, working=working).operation
        undecided = line is not None and any(i.working is None for i in line.intervals)
        table.append(WidthRow(value, operation, undecided, remark))
    return OperationWidths(
        slice.name, axis, over, tuple(table), maxima, slice.model, working, slice.has_free_lengths
    )


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
    over: Axis, rows: int, progress: Progress | None, line: Callable[[Fraction], CountIntervals]
) -> list[tuple[Fraction, CountIntervals | None, str]]:
    """Values of an axis at equal distances, the line at each, or why it has no answer."""
    found: list[tuple[Fraction, CountIntervals | None, str]] = []
    for k in range(1, rows + 1):
        value = over.at(Fraction(k, rows + 1))
        try:
            found.append((value, line(value), ""))
        except HypothesisError as error:
            found.append((value, None, str(error)))
        if progress is not None:
            progress("rows", k, rows)
    return found
