"""A table of the operation range's width against the other axis of a slice, and where it is
largest.

Guarantee: widths in rows are enclosed, and a row that has none says why; the maxima are those of
`width`.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.answer.widths import OperationWidths, WidthRow
from ptmcad.errors import A_SLICE, ConfigError, HypothesisError, expect, quoted
from ptmcad.exact.ranges.line import intervals
from ptmcad.exact.ranges.strips import strips
from ptmcad.exact.ranges.width import widest
from ptmcad.question.slice import Slice

ROWS = 41


def operation_widths(slice: Slice, along: str, rows: int = ROWS) -> OperationWidths:
    """Tabulate the operation range's width over the other axis and find where it is largest.

    Raises
    ------
    HypothesisError
        When the slice is degenerate or leaves the domain of the geometry.
    """
    expect(slice, Slice, "slice", A_SLICE)
    names = slice.axis_names
    if along not in names:
        raise ConfigError(
            f"{quoted(along)} is not an axis of the slice: choose {names[0]} or {names[1]}",
            key="along",
        )
    if isinstance(rows, bool) or not isinstance(rows, int) or rows < 1:
        raise ConfigError(f"{rows!r:.60} is not a number of rows", key="rows")
    over = slice.axes[1 - names.index(along)]
    found = strips(slice, along)
    table = []
    for k in range(1, rows + 1):
        value = over.at(Fraction(k, rows + 1))
        table.append(_row(slice, along, {over.name: value}, found.working))
    maxima = widest(slice, along, found)
    return OperationWidths(
        slice.name,
        slice.axes[names.index(along)],
        over,
        tuple(table),
        maxima,
        slice.model,
        found.working,
    )


def _row(slice: Slice, along: str, at: Mapping[str, Fraction], working: int) -> WidthRow:
    (value,) = at.values()
    try:
        return WidthRow(value, intervals(slice, along, at, working).operation)
    except HypothesisError as error:
        return WidthRow(value, (), str(error))
