"""What no design exceeds, by exact critical values over one parameter.

Guarantee: that of `exact.ranges.width`.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from ptmcad.answer.design import BoundedBox
from ptmcad.answer.intervals import lower, upper
from ptmcad.answer.widths import Maximum
from ptmcad.exact.ranges.anyline import lines_of
from ptmcad.exact.ranges.rangestrips import strips
from ptmcad.exact.ranges.width import widest
from ptmcad.question.config.designed import Aim, Design
from ptmcad.text.flint_numbers import simplest_fraction


class Proof(NamedTuple):
    """What no design exceeds.

    Attributes
    ----------
    bound : None where there is none, for the reason given.
    """

    bound: Fraction | None
    reason: str
    boxes: tuple[BoundedBox, ...] = ()
    maxima: tuple[Maximum, ...] = ()


def exact_maximum(design: Design) -> tuple[Maximum, ...] | None:
    """The widest ranges over one parameter; None for another question.

    Raises
    ------
    HypothesisError
        When the slice is degenerate or leaves the domain of the geometry.
    """
    if design.aim is not Aim.RANGE or len(design.over) != 1 or design.conditions:
        return None
    slice = design.slice({})
    return widest(slice, design.along, strips(slice, design.along, design.working))


def most_on_lines(design: Design) -> Fraction:
    """Of a range over one parameter what there is at most on lines in the variety, of which no
    box's bound speaks.
    """
    if design.aim is not Aim.RANGE or len(design.over) != 1:
        return Fraction(0)
    slice, name = design.slice({}), design.over[0].name
    lines = lines_of(slice, design.along, strips(slice, design.along, design.working))
    held = (
        line.most
        for line in lines
        if design.may_hold({name: (lower(line.value), upper(line.value))})
    )
    return max(held, default=Fraction(0))


def place_of(maximum: Maximum) -> Fraction:
    """A simple rational number where the widest range is, or next to it."""
    low, high = maximum.at.low, maximum.at.high
    if low == high:
        return low
    # of an interval the part before the first value at which the width is not attained
    inside = [upper(v) for v in (*maximum.exceptions, *maximum.doubtful) if low < lower(v)]
    return simplest_fraction(low, min([high, *inside]))
