"""Bounds over boxes of designs, and branch and bound by them: what no design exceeds, and how near the
best known one comes to it.

Guarantee: the bounds of the boxes are upper bounds for all designs in them off a set without
interior, for those that satisfy the conditions, whatever the order in which they were cut. For
areas the window is cut into strips; over a strip and an interval of designs `designlines` bounds the
length of what may have the wanted count on any line of the strip, and so what it adds to the area.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from heapq import heappop, heappush
from typing import Any, NamedTuple

from flint import fmpq

from ptmcad.algebra.real_roots import Interval
from ptmcad.workbench.designs.designlines import Run, Space, certain, longest, measure, refined

Place = tuple[Interval, ...]
"""A box of one or two design parameters."""
Point = tuple[fmpq, ...]


Bounded = tuple[fmpq, fmpq, Any]
"""What is known over a box: a bound of every design's value from above, one from below, and what a
box inside of it starts from."""


def search(
    bounder: Bounder,
    whole: Place,
    feasible: Callable[[Place], bool],
    improved: Callable[[Point | None], fmpq],
    enough: Callable[[fmpq], fmpq],
    go_on: Callable[[int, fmpq, fmpq], bool],
) -> tuple[Sequence[tuple[Place, fmpq]], bool]:
    """Cut boxes, always the one with the largest bound, until the largest bound is near enough to
    the best value.

    Returns a partition of the bounds, each box with its bound, but for boxes on which the
    conditions fail; and whether all bounds are near enough.

    Parameters
    ----------
    whole : the bounds.
    feasible : whether some design of a box may satisfy the conditions.
    improved : gives a lower bound of the best value that is known, after a look at a design if one
        is given.
    enough : by the best value, the bound that is near enough to it.
    go_on : called with the number of boxes, the bound and the best value.
    """
    best = improved(None)
    bound, _, state = bounder.over(whole, bounder.whole(), fmpq(1), enough(best))
    heap = [(-bound, 0, whole, state)]
    settled: list[tuple[Place, fmpq]] = []
    boxes = 1
    while heap and -heap[0][0] > enough(best) and go_on(boxes, -heap[0][0], best):
        negative, _, place, state = heappop(heap)
        for half in _cut(place, whole):
            if not feasible(half):
                continue
            boxes += 1
            above, certainly, within = bounder.over(
                half, state, max(_shares(half, whole)), enough(best)
            )
            bound = min(above, -negative)
            if bound > enough(best) and bound + certainly > 2 * best:
                best = improved(tuple((low + high) / 2 for low, high in half))
            if bound > enough(best):
                heappush(heap, (-bound, boxes, half, within))
            else:
                settled.append((half, bound))
    settled += [(place, -negative) for negative, _, place, _ in heap]
    return settled, all(bound <= enough(best) for _, bound in settled)


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


class AreaBounder(NamedTuple):
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


Bounder = Lengths | AreaBounder
"""An objective that can be bounded over boxes."""
