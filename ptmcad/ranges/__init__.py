"""Ranges: where along a line of the parameter space the counts are constant, and how far the operation range reaches.

Guarantee: exact, see the modules: `line` has the intervals.
"""

from __future__ import annotations

from ptmcad.ranges.line import Change, CountInterval, CountIntervals, Event, intervals

__all__ = ["Change", "CountInterval", "CountIntervals", "Event", "intervals"]
