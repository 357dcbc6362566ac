"""Bounds of the area with the wanted count, over an interval of one design parameter.

Guarantee: as of `search`. The window is cut into strips; over a strip and an interval of designs
`cover` bounds the length of what may have the wanted count on any line of the strip, and so what it
adds to the area.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.real_roots import Interval
from ptmcad.workbench.designs.branchandbound import Bounded, Place
from ptmcad.workbench.designs.subdivision import Run, Space, measure, refined


class AreaStrip(NamedTuple):
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

    def whole(self) -> tuple[AreaStrip, ...]:
        size = self.space.window[1] - self.space.window[0]
        return (
            AreaStrip(self.base, self.space.whole(), size * (self.base[1] - self.base[0]), fmpq(0)),
        )

    def over(self, place: Place, state: Sequence[AreaStrip], share: fmpq, enough: fmpq) -> Bounded:
        """Strips are cut until they are about as narrow as the designs' interval, in shares of
        their ranges.
        """
        narrowest = (self.base[1] - self.base[0]) * share / _FINENESS
        done: list[AreaStrip] = []
        waiting = [self._strip(strip.base, strip.runs, place[0], share) for strip in state]
        while waiting:
            strips = [*done, *waiting]
            bound = sum((s.most for s in strips), fmpq(0))
            doubt = bound - sum((s.least for s in strips), fmpq(0))
            if bound <= enough:
                break
            cut: list[AreaStrip] = []
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
    ) -> AreaStrip:
        space, width = self.space, base[1] - base[0]
        size = space.window[1] - space.window[0]
        fine = max(share / _FINENESS, width / (self.base[1] - self.base[0])) * size / _FINENESS
        found = refined(space, (base, designs), runs, fine)
        least = sum(
            (space.least(p.low, p.high) for run in found for p in run.parts if p.here), fmpq(0)
        )
        return AreaStrip(base, found, width * measure(space, found), width * least)


_FINENESS = 4
