"""Operation ranges over the other axis of a slice whose springs have free lengths, by the certified
engine.

With free lengths there may be more than two stable equilibria, on small parts of a window: an
operation range is where there are at least two, and of closed loops as many as there are anywhere
in the rows.

Guarantee: of each row the ends are enclosed, and two neighbouring intervals are one range only
where both are operation ranges. What could not be decided in a row is said there. Nothing is
claimed between two rows.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import groupby

from ptmcad.answer.counts import operation_number
from ptmcad.answer.intervals import CertifiedInterval
from ptmcad.answer.widths import CertifiedRange, CertifiedRow, CertifiedWidths
from ptmcad.ask.quantities import open_chain
from ptmcad.certified.intervals import certified_intervals
from ptmcad.errors import HypothesisError
from ptmcad.options import Progress
from ptmcad.question.slice import Slice


def certified_widths(
    slice: Slice, along: str, rows: int, digits: int, progress: Progress | None = None
) -> CertifiedWidths:
    """Tabulate the operation ranges along one axis over the other one.

    Parameters
    ----------
    rows : how many values of the other axis, at equal distances.
    digits : to which ends are enclosed.
    progress : called as progress("rows", done, rows).
    """
    number = slice.axis_names.index(along)
    over = slice.axes[1 - number]
    found: list[tuple[Fraction, tuple[CertifiedInterval, ...], str]] = []
    for k in range(1, rows + 1):
        value = over.at(Fraction(k, rows + 1))
        try:
            found.append(
                (value, certified_intervals(slice, along, {over.name: value}, digits).intervals, "")
            )
        except HypothesisError as error:
            found.append((value, (), str(error)))
        if progress is not None:
            progress("rows", k, rows)
    working = operation_number(slice.model, ())
    if open_chain(slice.model) is None:
        # as without free lengths: a loop is stable somewhere nearly everywhere
        working = (
            max((i.working or 0 for _, row, _ in found for i in row), default=working) or working
        )
    table = tuple(
        CertifiedRow(value, _ranges(row, working), any(i.working is None for i in row), remark)
        for value, row, remark in found
    )
    return CertifiedWidths(slice.name, slice.axes[number], over, table, slice.model, working)


def _ranges(row: tuple[CertifiedInterval, ...], working: int) -> tuple[CertifiedRange, ...]:
    """The operation ranges of a row; one goes on through a value at which only other solutions
    meet.
    """
    groups = groupby(
        row, lambda interval: interval.working is not None and interval.working >= working
    )
    runs = [list(group) for inside, group in groups if inside]
    return tuple(CertifiedRange(run[0].low, run[-1].high) for run in runs)
