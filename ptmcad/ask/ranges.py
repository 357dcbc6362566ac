"""Ranges: where along a line the counts are constant, how wide the operation range gets, where
stable poses snap.

Guarantee: ends are exact algebraic numbers, widths are enclosed, paths are proved; see `line`,
`width` and `path`. Where springs have free lengths paths are what `ptmcad.ask.lines.follower` says.
"""

from __future__ import annotations

from ptmcad.answer.intervals import Change, CountInterval, CountIntervals, Event
from ptmcad.answer.paths import Fate, PosePath, PosePaths
from ptmcad.answer.widths import Maximum, OperationWidths, Place
from ptmcad.exact.ranges.line import intervals
from ptmcad.exact.ranges.rows import operation_widths

__all__ = [
    "Change",
    "CountInterval",
    "CountIntervals",
    "Event",
    "Fate",
    "Maximum",
    "OperationWidths",
    "Place",
    "PosePath",
    "PosePaths",
    "intervals",
    "operation_widths",
]
