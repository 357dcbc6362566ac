"""The ranges of a count on any line of a slice: one at an algebraic value, or in the discriminant variety, too.

Guarantee: exact. In the ranges that are certain the count is the wanted one at all but finitely many points; elsewhere,
off those that are possible, it is another one. At an irrational value, and on a line in the variety, nothing is
decided: none is certain and any is possible.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from ptmcad.answer.intervals import End, Span
from ptmcad.errors import ConfigError, DegenerateSliceError, HypothesisError, InfiniteSolutionsError
from ptmcad.exact.models import system_from
from ptmcad.exact.ranges.line import intervals
from ptmcad.question.line import line_of
from ptmcad.question.slice import Slice


class LineRanges(NamedTuple):
    """The ranges of a count on a line: those that are certain, and all that are possible."""

    certain: tuple[Span, ...]
    possible: tuple[Span, ...]


def ranges_on(slice: Slice, along: str, value: End, working: int) -> LineRanges:
    """The ranges of a count on the line at a value of the other axis.

    Where the slice has no meaning on the line, as a length is zero there, there are none.

    Parameters
    ----------
    working : the number of stable solutions, or of all where nothing says what is stable.
    """
    number = slice.axis_names.index(along)
    axis = slice.axes[number]
    if isinstance(value, Fraction):
        at = {slice.axis_names[1 - number]: value}
        try:
            found = intervals(slice, along, at, working).operation
            return LineRanges(found, found)
        except (DegenerateSliceError, InfiniteSolutionsError):
            on_line = line_of(slice, along, at).parameters
            if not all(on_line[name].numerator for name in system_from(slice.model).positive):
                return LineRanges((), ())
        except (ConfigError, HypothesisError):
            return LineRanges((), ())
    return LineRanges((), (Span(axis.low, axis.high),))
