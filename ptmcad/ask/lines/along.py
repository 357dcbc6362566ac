"""The intervals of constant count along a line of a slice, by the engine that the line needs; and
tables of operation ranges over the other axis, with where they are widest.

Guarantee: that of `ptmcad.exact.ranges.exactline`, or with free lengths that of
`ptmcad.certified.enclosedline`. Widths in rows are enclosed, and a row that has none says why. The
maxima are those of `ptmcad.exact.ranges.width`; with free lengths there are none, and nothing is
claimed between two rows. Then there may be more than two stable equilibria, on small parts of a
window: an operation range is where there are at least two, and of closed loops as many as there are
anywhere in the rows. Two neighbouring intervals are one range only where both are operation ranges;
what could not be decided in a row is said there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from typing import Any

from ptmcad.answer.counts import operation_number
from ptmcad.answer.intervals import CountInterval, CountIntervals
from ptmcad.answer.widths import Maximum, OperationWidths, WidthRow
from ptmcad.ask.quantities import open_chain
from ptmcad.errors import A_SLICE, ConfigError, HypothesisError, expect, quoted
from ptmcad.model import Model
from ptmcad.options import Progress
from ptmcad.process.memory import loading
from ptmcad.question.line import has_free_lengths, on_line, varying_axis
from ptmcad.question.slice import Axis, Slice
from ptmcad.text.enclosure import DIGITS


def intervals(
    slice: Slice,
    along: str,
    at: Mapping[str, Any],
    working: int | None = None,
    digits: int = DIGITS,
) -> CountIntervals:
    """The intervals of constant count on a line of a slice.

    Their ends are exact, or with free lengths on the line enclosed.

    Parameters
    ----------
    along : the axis that varies, over its window.
    at : the other axis with its value: text or a number, of which a float stands for its shortest
        decimal.
    working : the number of stable solutions in an operation range; the greatest one on this line
        when None, and of a mechanism at least two.
    digits : significant digits to which ends are enclosed.

    Raises
    ------
    ConfigError
        When ``along`` is no axis, or ``at`` does not name exactly the other one with an exact
        number.
    DegenerateSliceError
        When at every point of the line some equilibrium is singular.
    InfiniteSolutionsError
        When every point of it has infinitely many equilibria.
    GeometryError
        When a length or a stiffness is not positive on it.
    """
    if has_free_lengths(slice, along, at):
        return certified_intervals(slice, along, at, digits, working)
    from ptmcad.exact.ranges.exactline import intervals as exact_intervals

    return exact_intervals(slice, along, at, working)


def certified_intervals(
    slice: Slice, along: str, at: Mapping[str, Any], digits: int, working: int | None = None
) -> CountIntervals:
    """The intervals on a line by the certified engine, whether springs have free lengths or not.

    The line need not lie in the slice's window, so nothing that is known of the window is used.

    Raises
    ------
    ConfigError
        As `intervals`.
    GeometryError
        When a parameter is not on the whole line what the proofs ask for, or that could not be
        proved.
    """
    with loading("the certified engine"):
        from ptmcad.certified.enclosedline import intervals_and_changes
        from ptmcad.question.domain import proved
    varying, other, value = varying_axis(slice, along, at)
    parameters = on_line(slice, varying, value)
    axes = slice.axes[varying], Axis(other, value, value)
    line = proved(replace(slice, axes=axes, parameters=parameters))
    found, changes = intervals_and_changes(line, 64 + 4 * digits)
    if working is None:
        working = least_number(slice.model, found)
    return CountIntervals(
        slice.name,
        slice.model,
        slice.axes[varying],
        {other: value},
        parameters,
        found,
        changes,
        working,
        enclosed=True,
    )


def least_number(model: Model, found: Iterable[CountInterval]) -> int:
    """The number of stable solutions that there are in an operation range of enclosed intervals at
    least.

    There may be more than two, on small parts of a window. Of closed loops, which are stable
    somewhere nearly everywhere, it is the greatest number.
    """
    least = operation_number(model, ())
    if open_chain(model) is not None:
        return least
    return max((i.working or 0 for i in found), default=least) or least


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
