"""The certified engine: from a slice to a region map of which the undecided part is known and small.

Guarantee: the counts of each cell hold at every one of its points. What is not decided is in the map's cover, or in a
component of the cover's complement that has no cell; `RegionMap.undetermined` is its exact share of the window.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import inf
from time import perf_counter

import flint
import numba
import numpy as np

from ptmcad.cover import MOST_STEPS, Cover, Rectangle, from_boxes, union_area
from ptmcad.cover.filling import simplified
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.interval.assembly import Assembler
from ptmcad.interval.curves import curves
from ptmcad.interval.points import point_counter
from ptmcad.interval.refinement import Enclosure, begin, refine
from ptmcad.interval.search import Boxes
from ptmcad.interval.statement import plan_of
from ptmcad.interval.tape import enclosing_floats
from ptmcad.regionmap import RegionMap, Status
from ptmcad.slice import Slice
from ptmcad.version import __version__

TOLERANCE = Fraction(1, 1000)
"""Of the window's area, left undetermined unless another number is asked for."""
TILES = 8
"""Rectangles along each axis that the search begins with."""
FIRST_LEVEL, LAST_LEVEL = 4, 40
"""At level n, boxes are bisected until their projection has at most 4^-n of the window's area."""
LARGEST = Fraction(10**100)
"""Ends of axes; areas and squares of such numbers are floats still."""
MOST_BOXES = 6_000_000
MANY = 40_000
"""Rectangles from which on it pays to look for fewer that cover the same."""
STEPS = 2**24
"""Lattice steps of a cover along each axis; more for a tolerance below 1e-5."""

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class Options:
    """What is asked of `certified_map` beside the slice; see there."""

    tolerance: Fraction = TOLERANCE
    deadline: float | None = None
    jobs: int = 1
    progress: Progress | None = None
    partial: Callable[[RegionMap], None] | None = None
    reached: Callable[[Fraction], None] | None = None
    keep: frozenset[str] = frozenset()


def certified_map(
    slice: Slice,
    *,
    tolerance: Fraction | None = None,
    deadline: float | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
    partial: Callable[[RegionMap], None] | None = None,
    resume: Cover | None = None,
    reached: Callable[[Fraction], None] | None = None,
    keep: frozenset[str] = frozenset(),
) -> RegionMap:
    """The region map of a slice by interval methods.

    Parameters
    ----------
    tolerance : largest undetermined share of the window's area at which to stop; `TOLERANCE` when None.
    deadline : reading of `time.perf_counter` at which to stop.
    jobs : number of threads, all processors when None. The map does not depend on it.
    progress : called as progress(what, done, total).
    partial : called with maps on the way, each complete but for a larger undetermined area.
    reached : called after each level with the share of the window that the boxes still cover.
    resume : cover of an earlier map of the same slice and count: what was outside it stays decided.
    keep : names of savings to switch off, of `ptmcad.savings`.

    Raises
    ------
    LimitReached
        At the deadline, or when doubles are exhausted, with the map so far as ``partial``.
    """
    if any(max(abs(axis.low), abs(axis.high)) > LARGEST for axis in slice.axes):
        raise ConfigError(f"the certified engine computes in floats: an axis may reach {float(LARGEST):g}, no more")
    options = Options(tolerance or TOLERANCE, deadline, jobs or os.cpu_count() or 1, progress, partial, reached, keep)
    return _Run(slice, options, resume).run()


class _Run:
    """One computation of a map: the enclosures, which shrink, and the time each part took."""

    def __init__(self, slice: Slice, options: Options, resume: Cover | None):
        self.started = perf_counter()
        self.slice, self.options = slice, options
        self.seconds = {"plan": 0.0, "curves": 0.0, "regions": 0.0}
        self.area = float((slice.axes[0].high - slice.axes[0].low) * (slice.axes[1].high - slice.axes[1].low))
        self.steps = STEPS
        while self.steps * options.tolerance < 64 and self.steps < MOST_STEPS:
            self.steps *= 2
        if resume is not None and len(resume.rectangles) > TILES**2:
            resume = simplified(resume)  # disjoint rectangles: nothing is searched twice
        wanted = curves(slice, slice.count, options.keep)
        self.enclosures: list[Enclosure] = begin(wanted, _rectangles(slice, resume))
        self.assembler = Assembler(slice, point_counter(slice), plan_of(slice, wanted, options.keep), _versions())
        self.handed_over = perf_counter()
        self.slowest = 0.0
        self.seconds["plan"] = perf_counter() - self.started

    def run(self) -> RegionMap:
        undetermined = Fraction(1)
        for level in range(FIRST_LEVEL, LAST_LEVEL):
            start = perf_counter()
            in_time = refine(
                self.enclosures,
                self.area * 4.0**-level,
                self.options.jobs,
                self._search_until(),
                self._report(level, undetermined),
            )
            self.seconds["curves"] += perf_counter() - start
            cover = self.cover()
            undetermined = Fraction(union_area(cover), cover.steps**2)
            if self.options.reached is not None:
                self.options.reached(undetermined)
            if not in_time:
                so_far = self.map(cover, Status.PARTIAL)
                raise LimitReached(
                    f"the time limit was reached with {_percent(so_far.undetermined)} undetermined, "
                    f"more than the tolerance of {_percent(self.options.tolerance)}",
                    partial=so_far,
                )
            if undetermined <= self.options.tolerance:
                result = self.map(cover, Status.CERTIFIED)
                undetermined = result.undetermined
                if undetermined <= self.options.tolerance:
                    return result
            self._hand_over(cover)
            if sum(len(e.boxes()) for e in self.enclosures) > MOST_BOXES:
                break
        so_far = self.map(self.cover(), Status.PARTIAL)
        raise LimitReached(
            f"the search ended with {_percent(so_far.undetermined)} undetermined, more than the tolerance of "
            f"{_percent(self.options.tolerance)}: smaller boxes did not help",
            partial=so_far,
        )

    def cover(self) -> Cover:
        boxes = [enclosure.boxes() for enclosure in self.enclosures]
        low = np.concatenate([b[:, :2] for b in boxes])
        high = np.concatenate([b[:, b.shape[1] // 2 :][:, :2] for b in boxes])
        horizontal, vertical = self.slice.axes
        window = ((horizontal.low, horizontal.high), (vertical.low, vertical.high))
        return from_boxes(window, low, high, self.steps)

    def map(self, cover: Cover, status: Status) -> RegionMap:
        start = perf_counter()
        if len(cover.rectangles) > MANY:
            fewer = simplified(cover)
            cover = fewer if len(fewer.rectangles) < len(cover.rectangles) else cover
        times = self.seconds | {"total": start - self.started}
        result = self.assembler.map(cover, status, times)
        self.seconds["regions"] += perf_counter() - start
        self.slowest = max(self.slowest, perf_counter() - start)
        return result

    def _search_until(self) -> float | None:
        """The deadline, less the time that it takes to make a map of what there is by then."""
        deadline = self.options.deadline
        if deadline is None:
            return None
        boxes = sum(len(e.boxes()) for e in self.enclosures)
        return deadline - max(1.0, 0.08 * (deadline - self.started), 2 * self.slowest, 2e-5 * boxes)

    def _report(self, level: int, undetermined: Fraction) -> Callable[[int, int], None] | None:
        progress = self.options.progress
        if progress is None:
            return None
        what = f"undetermined {_percent(undetermined)}"
        return lambda treated, waiting: progress(what, treated, treated + 8 * waiting)

    def _hand_over(self, cover: Cover) -> None:
        """Give the map so far to whoever asked for it, but not so often that it would cost much."""
        partial = self.options.partial
        if partial is not None and perf_counter() - self.handed_over > 10 * self.seconds["regions"] + 2:
            partial(self.map(cover, Status.PARTIAL))
            self.handed_over = perf_counter()


def _rectangles(slice: Slice, resume: Cover | None) -> Boxes:
    """The rectangles (low x, low y, high x, high y) with which the search begins, rounded outwards."""
    steps, rectangles = (resume.steps, resume.rectangles) if resume is not None else (TILES, ())
    if resume is None:
        rectangles = tuple(sorted(_tiles(), key=lambda tile: _ease(slice, tile), reverse=True))
    horizontal, vertical = slice.axes

    def value(axis_low: Fraction, axis_high: Fraction, step: int, towards: float) -> float:
        low, high = enclosing_floats(axis_low + (axis_high - axis_low) * Fraction(step, steps))
        return low if towards < 0 else high

    result = np.empty((len(rectangles), 4))
    for k, (left, right, bottom, top) in enumerate(rectangles):
        result[k] = (
            value(horizontal.low, horizontal.high, left, -inf),
            value(vertical.low, vertical.high, bottom, -inf),
            value(horizontal.low, horizontal.high, right, inf),
            value(vertical.low, vertical.high, top, inf),
        )
    return result


def _tiles() -> Iterator[Rectangle]:
    return ((i, i + 1, j, j + 1) for i in range(TILES) for j in range(TILES))


def _ease(slice: Slice, tile: Rectangle) -> Fraction:
    """Small where the search takes long, which is best begun first: for small rho and bars of equal length."""
    left, _, bottom, _ = tile
    x, y = (
        axis.low + (axis.high - axis.low) * Fraction(2 * step + 1, 2 * TILES)
        for axis, step in zip(slice.axes, (left, bottom), strict=True)
    )
    rho, bar1, bar2 = (slice.parameters[name].evaluate(x, y) for name in ("rho", "L1", "L2"))
    return rho + abs(bar1 - bar2)


def _percent(share: Fraction) -> str:
    percent = 100 * float(share)
    return f"{percent:.0f} %" if percent >= 10 else f"{percent:.2g} %"


def _versions() -> dict[str, str]:
    return {
        "ptmcad": __version__,
        "python": sys.version.split()[0],
        "python-flint": flint.__version__,
        "FLINT": flint.__FLINT_VERSION__,
        "numba": numba.__version__,
        "numpy": np.__version__,
    }
