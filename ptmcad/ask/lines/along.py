"""The intervals of constant count along a line of a slice, by the engine that the line needs.

Guarantee: that of `ptmcad.exact.ranges.exactline`, or with free lengths that of
`ptmcad.certified.enclosedline`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from ptmcad.answer.counts import operation_number
from ptmcad.answer.intervals import CountInterval, CountIntervals
from ptmcad.ask.quantities import open_chain
from ptmcad.model import Model
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
