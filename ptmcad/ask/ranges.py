"""Ranges: where along a line the counts are constant, how wide the operation range gets, where stable poses snap.

Guarantee: ends are exact algebraic numbers, widths are enclosed, paths are proved; see `line`, `width` and `path`.
Where springs have free lengths paths are what `ptmcad.ask.paths` says.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.answer.intervals import Change, CountInterval, CountIntervals, Event
from ptmcad.answer.paths import Fate, PosePath, PosePaths
from ptmcad.answer.widths import Maximum, OperationWidths, Place
from ptmcad.exact.ranges import path as exact_paths
from ptmcad.exact.ranges.line import intervals
from ptmcad.exact.ranges.rows import operation_widths
from ptmcad.options import Progress
from ptmcad.question.line import has_free_lengths
from ptmcad.question.slice import Slice

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


def pose_paths(
    slice: Slice,
    along: str,
    at: Mapping[str, Any],
    start: object,
    number: int | None = None,
    progress: Progress | None = None,
) -> PosePaths:
    """Follow stable poses along a line, from their places at one value of the axis.

    Parameters
    ----------
    start : the value, inside the window and not critical.
    number : which pose, counted from 1 as ``ptmcad solve`` lists them; None for every stable one.
    progress : with free lengths called as progress("paths: pose", done, total).

    Raises
    ------
    ConfigError
        When the start is outside the window or critical, or there is no such stable pose.
    HypothesisError
        As for `intervals`.

    Of a system that does not say what a stable solution is, all solutions are followed.
    """
    if has_free_lengths(slice, along, at):
        from ptmcad.ask.paths import joined_paths

        return joined_paths(slice, along, at, start, number, progress)
    return exact_paths.pose_paths(slice, along, at, start, number)
