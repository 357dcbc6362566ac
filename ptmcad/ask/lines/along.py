"""The intervals of constant count along a line of a slice, by the engine that the line needs.

Guarantee: that of `ptmcad.exact.ranges.exactline`, or with free lengths that of
`ptmcad.certified.enclosedline`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ptmcad.answer.counts import operation_number
from ptmcad.answer.intervals import CountIntervals
from ptmcad.process.memory import loading
from ptmcad.question.line import has_free_lengths, on_line, varying_axis
from ptmcad.question.slice import Axis, Slice


def intervals_along(slice: Slice, along: str, at: Mapping[str, Any], digits: int) -> CountIntervals:
    """The intervals on a line, exact, or with free lengths enclosed to so many digits.

    Raises
    ------
    ConfigError, HypothesisError
        As `ptmcad.intervals` and `certified_intervals`.
    """
    if has_free_lengths(slice, along, at):
        return certified_intervals(slice, along, at, digits)
    from ptmcad.exact.ranges.exactline import intervals

    return intervals(slice, along, at)


def certified_intervals(
    slice: Slice, along: str, at: Mapping[str, Any], digits: int
) -> CountIntervals:
    """The intervals of constant count on a line of a slice whose springs have free lengths.

    Parameters
    ----------
    along : the axis that varies, over its window.
    at : the other axis with its value: text, int or Fraction.
    digits : significant digits to which critical values are enclosed.

    Raises
    ------
    ConfigError When ``along`` is no axis, or ``at`` does not name exactly the other one with an
        exact number.
    GeometryError When a parameter is not on the whole line what the proofs ask for, or that could
        not be proved. The line need not lie in the slice's window, so nothing that is known of the
        window is used.
    """
    with loading("the certified engine"):
        from ptmcad.certified.enclosedline import intervals_and_changes
        from ptmcad.question.domain import proved
    varying, other, value = varying_axis(slice, along, at)
    parameters = on_line(slice, varying, value)
    axes = slice.axes[varying], Axis(other, value, value)
    line = proved(replace(slice, axes=axes, parameters=parameters))
    found, changes = intervals_and_changes(line, 64 + 4 * digits)
    working = operation_number(slice.model, (i.counts for i in found if i.counts is not None))
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
