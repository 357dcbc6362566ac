"""The intervals of constant count along a line of a slice, by the engine that the line needs.

Guarantee: that of `ptmcad.exact.ranges.line`, or with free lengths that of `ptmcad.certified.line`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.answer.intervals import CertifiedIntervals, CountIntervals
from ptmcad.question.line import has_free_lengths
from ptmcad.question.slice import Slice


def intervals_along(
    slice: Slice, along: str, at: Mapping[str, Any], digits: int
) -> CountIntervals | CertifiedIntervals:
    """The intervals on a line, exact, or with free lengths enclosed to so many digits.

    Raises
    ------
    ConfigError, HypothesisError
        As `ptmcad.intervals` and `ptmcad.certified.intervals.certified_intervals`.
    """
    if has_free_lengths(slice, along, at):
        from ptmcad.certified.intervals import certified_intervals

        return certified_intervals(slice, along, at, digits)
    from ptmcad.exact.ranges.line import intervals

    return intervals(slice, along, at)
