"""What no design exceeds: by exact critical values over one parameter, or by branch and bound over
one or two.

Guarantee: that of `exact.ranges.width` and `workbench.designs.designbounds`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import prod
from typing import NamedTuple

from flint import fmpq

from ptmcad.answer.design import BoundedBox
from ptmcad.answer.intervals import lower, upper
from ptmcad.answer.widths import Maximum
from ptmcad.ask.members import in_space
from ptmcad.errors import (
    DegenerateSliceError,
    ExpressionError,
    HypothesisError,
    InfiniteSolutionsError,
)
from ptmcad.exact.ranges.anyline import lines_of
from ptmcad.exact.ranges.rangestrips import strips
from ptmcad.exact.ranges.width import widest
from ptmcad.exact.stages import problem_of
from ptmcad.question.config.designed import Aim, Design
from ptmcad.text.flint_numbers import from_fraction, interval_of, simplest_between, to_fraction
from ptmcad.workbench.designs.designbounds import (
    AreaBounder,
    Bounder,
    Lengths,
    Place,
    Point,
    search,
)
from ptmcad.workbench.designs.designlines import space_of_family, space_of_slice

Look = Callable[[Mapping[str, Fraction]], Fraction]
"""From a design to a lower bound of the best value that is known after it was evaluated."""


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
    return to_fraction(simplest_between(from_fraction(low), from_fraction(min([high, *inside]))))


def bounder_of(design: Design, tolerance: Fraction) -> Bounder | str:
    """What bounds the objective over boxes of designs, or why there is nothing that does."""
    count = len(design.over)
    if design.aim not in (Aim.RANGE, Aim.AREA):
        return f"no bound is offered of {design.maximise}: nothing is proved of what is better elsewhere"
    most = 2 if design.aim is Aim.RANGE else 1
    if count > most:
        return (
            f"with {count} design parameters no bound is offered (for {design.aim.value} with {most} at most): nothing "
            "is proved of what is better elsewhere"
        )
    try:
        found = _bounder(design, from_fraction(tolerance))
    except (ExpressionError, DegenerateSliceError, InfiniteSolutionsError) as error:
        return f"there is no discriminant variety of all designs at once: {error}"
    return (
        found
        or "there is no discriminant variety of all designs at once: solutions have to be left out"
    )


def _bounder(design: Design, tolerance: fmpq) -> Bounder | None:
    family = design.family
    if family is None:  # a range over one parameter: a slice
        slice = design.slice({})
        space = space_of_slice(
            problem_of(slice), slice.axis_names.index(design.along), design.working
        )
        return Lengths(space, tolerance)
    axes = (*family.axes, family.free)
    ranges = tuple(interval_of(axis) for axis in axes)
    along = 1 if design.aim is Aim.AREA else 0
    names = tuple(a.name for a in axes)
    found = space_of_family(in_space(family), names, ranges, along, design.working)
    if found is None:
        return None
    return AreaBounder(found, ranges[0]) if design.aim is Aim.AREA else Lengths(found, tolerance)


def bounded(
    design: Design,
    bounder: Bounder,
    look: Look,
    tolerance: Fraction,
    most: int,
    go_on: Callable[[int, float, float], bool],
) -> Proof:
    """A bound by branch and bound.

    Parameters
    ----------
    most : boxes.
    go_on : called with the number of boxes, the bound and the best value.
    """
    names = [axis.name for axis in design.over]

    def feasible(place: Place) -> bool:
        box = {
            n: (to_fraction(low), to_fraction(high))
            for n, (low, high) in zip(names, place, strict=True)
        }
        return design.may_hold(box)

    def improved(point: Point | None) -> fmpq:
        values = (
            {} if point is None else {n: to_fraction(v) for n, v in zip(names, point, strict=True)}
        )
        return from_fraction(look(values))

    size = prod((axis.width for axis in design.axes), start=Fraction(1))  # of the window
    share, least = from_fraction(tolerance), from_fraction(tolerance * size)

    def enough(best: fmpq) -> fmpq:
        return best * (1 + share) if best > 0 else max(best * (1 + share), least)

    def more(boxes: int, bound: fmpq, best: fmpq) -> bool:
        return boxes < most and go_on(boxes, float(to_fraction(bound)), float(to_fraction(best)))

    whole = tuple(interval_of(axis) for axis in design.over)
    try:
        found, complete = search(bounder, whole, feasible, improved, enough, more)
    except HypothesisError as error:
        return Proof(None, f"a bound fails: {error}")
    boxes = tuple(
        BoundedBox(tuple((to_fraction(a), to_fraction(b)) for a, b in place), to_fraction(bound))
        for place, bound in found
    )
    number = f"{len(boxes)} boxes of designs" if len(boxes) != 1 else "one box of designs"
    how = f"over {number}" if complete else f"which was stopped at {number}"
    bound = max((box.bound for box in boxes), default=Fraction(0))
    return Proof(bound, f"by branch and bound, {how}", boxes)
