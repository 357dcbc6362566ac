"""What no design exceeds, by exact critical values over one parameter, or by branch and bound over
boxes of designs; and how near the best known one comes to it.

Guarantee: over one parameter that of `exact.ranges.width`. The bounds of the boxes are upper bounds
for all designs in them off a set without interior, for those that satisfy the conditions, whatever
the order in which they were cut. For areas the window is cut into strips; over a strip and an
interval of designs `designlines` bounds the length of what may have the wanted count on any line of
the strip, and so what it adds to the area.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from heapq import heappop, heappush
from math import prod
from typing import Any, NamedTuple

from flint import fmpq

from ptmcad.algebra.real_roots import Interval
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
from ptmcad.text.flint_numbers import from_fraction, interval_of, simplest_fraction, to_fraction
from ptmcad.workbench.designs.designlines import (
    Run,
    Space,
    certain,
    longest,
    measure,
    refined,
    space_of_family,
    space_of_slice,
)


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


Place = tuple[Interval, ...]
"""A box of one or two design parameters."""


Bounded = tuple[fmpq, fmpq, Any]
"""What is known over a box: a bound of every design's value from above, one from below, and what a
box inside of it starts from."""


def bounded(
    design: Design,
    bounder: Bounder,
    look: Callable[[tuple[Fraction, ...] | None], Fraction],
    tolerance: Fraction,
    most: int,
    go_on: Callable[[int, float, float], bool],
) -> Proof:
    """A bound by branch and bound: boxes are cut, always the one with the largest bound, until that
    is near enough to the best value.

    Parameters
    ----------
    look : from a design, if one is given, to a lower bound of the best value that is known after it
        was evaluated.
    most : boxes.
    go_on : called with the number of boxes, the bound and the best value.
    """
    whole = tuple(interval_of(axis) for axis in design.over)
    size = prod((axis.width for axis in design.axes), start=Fraction(1))  # of the window
    share, least = from_fraction(tolerance), from_fraction(tolerance * size)
    best = from_fraction(look(None))

    def enough() -> fmpq:
        return best * (1 + share) if best > 0 else max(best * (1 + share), least)

    settled: list[tuple[Place, fmpq]] = []
    boxes = 1
    try:
        bound, _, state = bounder.over(whole, bounder.whole(), fmpq(1), enough())
        heap = [(-bound, 0, whole, state)]
        while heap and -heap[0][0] > enough() and boxes < most:
            if not go_on(boxes, *(float(to_fraction(x)) for x in (-heap[0][0], best))):
                break
            negative, _, place, state = heappop(heap)
            for half in _cut(place, whole):
                ranges = zip(design.over, _fractions(half), strict=True)
                if not design.may_hold({axis.name: ends for axis, ends in ranges}):
                    continue
                boxes += 1
                largest = max(_shares(half, whole))
                above, certainly, within = bounder.over(half, state, largest, enough())
                bound = min(above, -negative)
                if bound > enough() and bound + certainly > 2 * best:
                    middle = tuple(to_fraction((low + high) / 2) for low, high in half)
                    best = from_fraction(look(middle))
                if bound > enough():
                    heappush(heap, (-bound, boxes, half, within))
                else:
                    settled.append((half, bound))
    except HypothesisError as error:
        return Proof(None, f"a bound fails: {error}")
    settled += [(place, -negative) for negative, _, place, _ in heap]
    found = tuple(BoundedBox(_fractions(place), to_fraction(bound)) for place, bound in settled)
    number = f"{len(found)} boxes of designs" if len(found) != 1 else "one box of designs"
    complete = all(bound <= enough() for _, bound in settled)
    how = f"over {number}" if complete else f"which was stopped at {number}"
    highest = max((box.bound for box in found), default=Fraction(0))
    return Proof(highest, f"by branch and bound, {how}", found)


def _fractions(place: Place) -> tuple[tuple[Fraction, Fraction], ...]:
    return tuple((to_fraction(low), to_fraction(high)) for low, high in place)


def _shares(place: Place, whole: Place) -> list[fmpq]:
    return [(b - a) / (d - c) for (a, b), (c, d) in zip(place, whole, strict=True)]


def _cut(place: Place, whole: Place) -> Sequence[Place]:
    """The halves of a box across its longest side, as a share of the bounds'."""
    shares = _shares(place, whole)
    axis = shares.index(max(shares))
    low, high = place[axis]
    middle = (low + high) / 2
    return [(*place[:axis], part, *place[axis + 1 :]) for part in ((low, middle), (middle, high))]


class Lengths(NamedTuple):
    """The length of the longest interval with the wanted count on a line."""

    space: Space
    tolerance: fmpq

    def whole(self) -> Any:
        """The state of which nothing is known."""
        return self.space.whole()

    def over(self, place: Place, state: Any, share: fmpq, enough: fmpq) -> Bounded:
        """Bounds over a box.

        Runs that are short enough are no longer looked at; they count with their lengths.

        Parameters
        ----------
        state : of a box that this one is in.
        share : the box's longest side as a share of the bounds'.
        enough : a bound that is not above it needs no improvement.
        """
        space = self.space
        size = space.window[1] - space.window[0]
        resolution = max(size * share / _FINENESS, enough * self.tolerance / (2 * _FINENESS))
        short = [run for run in state if space.length(*run.ends) <= enough]
        box = (place[0], place[1] if len(place) > 1 else _ANY)
        runs = refined(space, box, [run for run in state if run not in short], resolution)
        bound = max(longest(space, runs), longest(space, short))
        return bound, certain(space, runs), (*runs, *short)


_FINENESS = 16
"""Parts of a line are as many times finer than the box, in shares of their windows."""
_ANY = (fmpq(0), fmpq(1))


class _AreaStrip(NamedTuple):
    """A part of the window between two values of the axis that is not the line's, with its runs.

    Attributes
    ----------
    most, least : bounds of the area in it.
    """

    base: Interval
    runs: tuple[Run, ...]
    most: fmpq
    least: fmpq


class _AreaBounder(NamedTuple):
    """The area where the count is the wanted one.

    Attributes
    ----------
    space : of lines in the window; the first design parameter of its boxes is the window's other
        axis.
    base : the range of that axis.
    """

    space: Space
    base: Interval

    def whole(self) -> tuple[_AreaStrip, ...]:
        size = self.space.window[1] - self.space.window[0]
        return (
            _AreaStrip(
                self.base, self.space.whole(), size * (self.base[1] - self.base[0]), fmpq(0)
            ),
        )

    def over(self, place: Place, state: Sequence[_AreaStrip], share: fmpq, enough: fmpq) -> Bounded:
        """Strips are cut until they are about as narrow as the designs' interval, in shares of
        their ranges.
        """
        narrowest = (self.base[1] - self.base[0]) * share / _STRIP_FINENESS
        done: list[_AreaStrip] = []
        waiting = [self._strip(strip.base, strip.runs, place[0], share) for strip in state]
        while waiting:
            strips = [*done, *waiting]
            bound = sum((s.most for s in strips), fmpq(0))
            doubt = bound - sum((s.least for s in strips), fmpq(0))
            if bound <= enough:
                break
            cut: list[_AreaStrip] = []
            for strip in waiting:
                low, high = strip.base
                if high - low <= narrowest or (strip.most - strip.least) * 2 * len(strips) < doubt:
                    done.append(strip)
                    continue
                middle = (low + high) / 2
                cut += [
                    self._strip(base, strip.runs, place[0], share)
                    for base in ((low, middle), (middle, high))
                ]
            waiting = cut
        strips = sorted((*done, *waiting))
        most, least = (sum((getattr(s, end) for s in strips), fmpq(0)) for end in ("most", "least"))
        return most, least, tuple(strips)

    def _strip(
        self, base: Interval, runs: Sequence[Run], designs: Interval, share: fmpq
    ) -> _AreaStrip:
        space, width = self.space, base[1] - base[0]
        size = space.window[1] - space.window[0]
        fine = (
            max(share / _STRIP_FINENESS, width / (self.base[1] - self.base[0]))
            * size
            / _STRIP_FINENESS
        )
        found = refined(space, (base, designs), runs, fine)
        least = sum(
            (space.least(p.low, p.high) for run in found for p in run.parts if p.here), fmpq(0)
        )
        return _AreaStrip(base, found, width * measure(space, found), width * least)


_STRIP_FINENESS = 4


Bounder = Lengths | _AreaBounder
"""An objective that can be bounded over boxes."""


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
    return _AreaBounder(found, ranges[0]) if design.aim is Aim.AREA else Lengths(found, tolerance)
