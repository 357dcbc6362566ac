"""Ranges: where along a line the counts are constant, how wide the operation range gets, where stable poses snap.

Guarantee: ends are exact algebraic numbers, widths are enclosed, paths are proved; see `line`, `width` and `path`.
"""

from __future__ import annotations

from ptmcad.ranges.line import Change, CountInterval, CountIntervals, Event, intervals
from ptmcad.ranges.path import Fate, PosePath, PosePaths, pose_paths
from ptmcad.ranges.width import Maximum, OperationWidths, Place, operation_widths

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
    "pose_paths",
]
