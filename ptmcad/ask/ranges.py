"""Ranges: where along a line the counts are constant, how wide the operation range gets, where
stable poses snap.

Guarantee: ends are exact algebraic numbers, widths are enclosed, paths are proved; see `line`,
`width` and `path`. Where springs have free lengths paths are what `ptmcad.ask.paths` says.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ptmcad.answer.intervals import Change, CountInterval, CountIntervals, Event
from ptmcad.answer.paths import Fate, PosePath, PosePaths
from ptmcad.answer.widths import Maximum, OperationWidths, Place
from ptmcad.errors import ConfigError
from ptmcad.exact.ranges.line import intervals
from ptmcad.exact.ranges.rows import operation_widths
from ptmcad.options import Progress
from ptmcad.question.line import has_free_lengths, on_line, varying_axis
from ptmcad.question.slice import Slice, moved
from ptmcad.text.parsing import number_for

if TYPE_CHECKING:
    from ptmcad.ask.paths import JoinedFollower
    from ptmcad.exact.ranges.path import ExactFollower

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
    varying, other, value = varying_axis(slice, along, at)
    axis, begin, model = slice.axes[varying], number_for("--path", start), slice.model
    if not axis.holds(begin):
        raise ConfigError(
            f"{begin} is not inside the window of {along}, {axis.low} to {axis.high}", key="--path"
        )
    joined = has_free_lengths(slice, along, at)
    follower: ExactFollower | JoinedFollower
    # both bring numpy, which intervals and widths do without
    if joined:
        from ptmcad.ask import paths

        follower = paths.follower(slice, along, at, begin)
    else:
        from ptmcad.exact.ranges import path

        follower = path.follower(slice, along, at, begin)
    stable = [k for k, pose in enumerate(follower.poses, 1) if model.criterion.works(pose.stable)]
    if number is not None and number not in stable:
        what = f"{len(stable)} {model.criterion.poses}"
        raise ConfigError(
            f"{number} is none of the {what} at {along} = {begin}, counted from 1", key="--pose"
        )
    found = []
    chosen = stable if number is None else [number]
    for done, k in enumerate(chosen):
        if joined and progress is not None:
            progress("paths: pose", done, len(chosen))
        found.append(follower.path(k))
    forces = moved(model, on_line(slice, varying, value))
    return PosePaths(slice.name, model, axis, {other: value}, begin, tuple(found), forces, joined)
