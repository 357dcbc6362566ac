"""The certified engine: from a slice to a region map of which the undecided part is known and
small.

Guarantee: the counts of each cell hold at every one of its points. What is not decided is in the
map's cover, or in a component of the cover's complement that has no cell; `RegionMap.undetermined`
is its exact share of the window.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import flint
import numba
import numpy as np

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.certified.coverassembly import assembled
from ptmcad.certified.covering import (
    Lattice,
    Thinning,
    box_rectangles,
    first_rectangles,
    share_of,
    thinning,
    without_specks,
)
from ptmcad.certified.loading import load
from ptmcad.certified.pace import PARTS, SAFETY, Pace, parts_done
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.mirrors import halving
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.refinement import CurveEnclosure, begin, refine
from ptmcad.certified.statement import plan_of
from ptmcad.cover import components
from ptmcad.cover.lattice import combined
from ptmcad.cover.rectangles import MAX_STEPS, Cover
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.options import DEFAULTS, Options
from ptmcad.process.handover import LAST_SECONDS, leave_if_asked
from ptmcad.question.domain import proved
from ptmcad.question.slice import Slice
from ptmcad.text.numerals import percent
from ptmcad.version import __version__

TOLERANCE = Fraction(1, 1000)
"""Of the window's area, left undetermined unless another number is asked for."""
FIRST_LEVEL, LAST_LEVEL = 4, 40
"""At level n, boxes are bisected until their projection has at most 4^-n of the window's area."""
MAX_AXIS_END = Fraction(10**100)
"""Ends of axes; areas and squares of such numbers are floats still."""
MAX_BOXES = 6_000_000
"""After a level that leaves more of them, the search ends, as at its deadline."""
MAX_RECTANGLES = 3_000_000
"""In a cover made of strips: its JSON has some 40 bytes for each, and Python some 200."""
STRIP_TRIAL_RATIO = 0.1
"""Strips are tried as soon as the square of the boxes' share is at most so many times the
tolerance: the strips' share is about that square at best."""
STRIP_TARGET_SHARE = 0.5
"""Strips are used as soon as the finest ones would leave less than this part of the tolerance."""
COARSE_SHARE = Fraction(1, 4)
"""While the boxes have more of the window, maps on the way do without strips, which would gain
little.
"""
SECONDS_PER_RECTANGLE = 3e-5
"""That a map takes for each rectangle, with its JSON: less, on most machines."""
MAP_SHRINK_RATIO = Fraction(9, 10)
"""A map on the way is worth making when the boxes' share is at most this part of what it was at the
last one.
"""
FIRST_MAP_SHARE = Fraction(97, 100)
"""The first map on the way is made when the boxes have at most this share of the window; at the end
of the first level there is one in any case.
"""
LAST_SHARE = 0.7
"""Of the time that a process has when it is asked to leave: the rest is for tasks to end and for
the map's text.
"""
EARLY = 1.5
"""Seconds before the time limit: a search that ends earlier says so."""
LATTICE_STEPS = 2**24
"""Lattice steps of a cover along each axis; more for a tolerance below 64 / 2^24, or 3.8e-6."""


def certified_map(slice: Slice, options: Options = DEFAULTS) -> RegionMap:
    """The region map of a slice by interval methods.

    Parameters
    ----------
    options : of which ``deadline`` counts, not ``timeout``; `ptmcad.certified.loading.load`, which
        compiles, comes before it is set. Maps on the way are complete but for a larger undetermined
        area.

    Raises
    ------
    GeometryError
        When a parameter is not in the whole window what the proofs ask for, or that could not be
        proved.
    LimitReached
        At the deadline, or when doubles are exhausted, with the map so far as ``partial``.
    """
    if any(max(abs(axis.low), abs(axis.high)) > MAX_AXIS_END for axis in slice.axes):
        raise ConfigError(
            f"the certified engine computes in floats: an axis may reach {float(MAX_AXIS_END):g}, no more"
        )
    return _MapSearch(proved(slice), options).run()


class _MapSearch:
    """One computation of a map: the enclosures, which shrink, and the time each part took."""

    def __init__(self, slice: Slice, options: Options):
        load(options.progress)
        self.pace = Pace(options.deadline)
        self.clock = self.pace.clock
        self.reached = 0
        """Of `PARTS`, by the progress that was reported."""
        self.slice, self.options = slice, options
        self.tolerance = options.tolerance or TOLERANCE
        self.jobs = options.jobs or os.cpu_count() or 1
        self.seconds = {"plan": 0.0, "curves": 0.0, "regions": 0.0}
        self.area = float(slice.area)
        steps = LATTICE_STEPS
        while steps * self.tolerance < 64 and steps < MAX_STEPS:
            steps *= 2
        horizontal, vertical = slice.axes
        self.earlier = None if options.resume is None else options.resume.cover
        whole = self.earlier is not None or "mirror-images" in options.without
        window = (horizontal.low, horizontal.high), (vertical.low, vertical.high)
        self.lattice = Lattice(window, steps, None if whole else halving(slice))
        wanted = curves(slice, slice.count, options.without)
        self.enclosures: list[CurveEnclosure] = begin(
            wanted, first_rectangles(self.lattice, self.earlier)
        )
        self.counter = plain_counter(slice)
        self.plan = plan_of(slice, wanted, options.without, self.lattice.change)
        self.best: RegionMap | None = None
        """The map with the least undetermined area of those that were handed over."""
        self._thinned: Thinning | None = None
        """The strips of the boxes as they are, when they are known."""
        self.tried_at = Fraction(1)
        """The least share of the window that the boxes had when a map on the way was made, whether
        it was the best one or not."""
        self.uncounted = Fraction(0)
        """The share that the best map leaves outside of its cover."""
        self.seconds["plan"] = self.clock() - self.pace.started

    def run(self) -> RegionMap:
        """The map; where a signal ends this process, what is known by then is handed over first."""
        try:
            return self._search()
        except SystemExit:
            if self.options.partial is not None:
                until = self.clock() + LAST_SHARE * LAST_SECONDS
                self.pace.deadline = (
                    until if self.pace.deadline is None else min(until, self.pace.deadline)
                )
                self._hand_over()
            raise

    def _search(self) -> RegionMap:
        undetermined = Fraction(1)
        tolerance = self.tolerance
        if self.earlier is not None and share_of(self.earlier) <= tolerance:
            result = self.map(self.earlier, Status.CERTIFIED)
            if result.undetermined <= tolerance:
                return result
        for level in range(FIRST_LEVEL, LAST_LEVEL):
            start, regions = self.clock(), self.seconds["regions"]
            report = self._report(undetermined)
            self._thinned = None
            in_time = refine(
                self.enclosures, self.area * 4.0**-level, self.jobs, report, self._late
            )
            self.seconds["curves"] += self.clock() - start - (self.seconds["regions"] - regions)
            if not in_time:
                return self._stopped(self._at_limit())
            cover = self._box_cover()
            enclosed = undetermined = share_of(cover)
            thin = None if undetermined <= tolerance else self.thin_cover(enclosed)
            if thin is not None:
                cover = thin
            if (thin is not None or undetermined <= tolerance) and self._affordable(cover):
                result = self.map(cover, Status.CERTIFIED, self.area * 4.0**-level)
                undetermined = result.undetermined
                if undetermined <= tolerance:
                    return result
            strips_wanted = self._thinned is None and enclosed <= COARSE_SHARE
            if self.options.partial is not None and (
                self.best is None or self.pace.due(self.boxes(), thinned=strips_wanted)
            ):
                self._hand_over(enclosed)
            if self.boxes() > MAX_BOXES:
                break
        return self._stopped(f"the search ended at {self.boxes():,} boxes")

    def _at_limit(self) -> str:
        """Why a search ended for its deadline, in words: before it, where much was kept for the
        last map.
        """
        kept = self.pace.left()
        if kept < EARLY:
            return "the time limit was reached"
        return f"the search ended {kept:.1f} s before the time limit, which the last map may take,"

    def boxes(self) -> int:
        """The number of boxes there are by now."""
        return sum(enclosure.number() for enclosure in self.enclosures)

    def thin_cover(self, enclosed: Fraction) -> Cover | None:
        """A cover of strips that are thin enough for the tolerance, if they can be, in the time
        that there is.

        Parameters
        ----------
        enclosed : the boxes' share of the window.
        """
        allowed = self.tolerance
        if enclosed**2 > STRIP_TRIAL_RATIO * allowed or self.pace.left() < SAFETY * self.pace.cost(
            self.boxes(), "strips"
        ):
            return None
        start = self.clock()
        strips = self._strips()
        target = float(allowed) * self.area
        enough = (
            strips.least() <= STRIP_TARGET_SHARE * target
            and strips.number(target) <= MAX_RECTANGLES
        )
        cover = strips.cover(target) if enough else None
        self.seconds["curves"] += self.clock() - start
        return cover

    def map_so_far(self) -> RegionMap:
        """The map so far, with strips as thin as they can be for not many more rectangles than
        boxes.

        Where there is no time for it, or another one has a smaller undetermined area, it is the
        best that was made.
        """
        boxes = self.boxes()
        if self.best is not None and self.pace.cost(boxes) > self.pace.left():
            return self.best
        strips = self._strips()
        most = min(4 * len(strips.thin), MAX_RECTANGLES)
        if self.pace.deadline is not None:
            most = min(most, max(0, int(self.pace.left() / (SAFETY * SECONDS_PER_RECTANGLE))))
        cover, known = strips.cover(1.5 * strips.least(), most), self.earlier
        if known is not None and share_of(known) < share_of(cover):
            cover = known
        found = self.map(cover, Status.PARTIAL)
        return (
            found if self.best is None or found.undetermined < self.best.undetermined else self.best
        )

    def map(self, cover: Cover, status: Status, area: float | None = None) -> RegionMap:
        """The map of a cover; what is not counted when the time is over is undetermined.

        Parameters
        ----------
        area : of a box's projection, below which the search has left it alone; without it specks
            stay.
        """
        start, boxes = self.clock(), self.boxes()
        times = self.seconds | {"total": start - self.pace.started}
        complement = components(cover)
        if area is not None:
            complement = without_specks(complement, self.enclosures, self.lattice, area)
        result = replace(
            assembled(complement, self.slice, self.counter, status, self._must_hand_over),
            plan=self.plan,
            versions=_versions(),
            timings=times,
        )
        self.seconds["regions"] += self.clock() - start
        self.pace.record("map", boxes, self.clock() - start)
        return result

    def _must_hand_over(self) -> bool:
        """Whether there is only time left to put a map into other hands."""
        return self.pace.left() < SAFETY * self.pace.cost(self.boxes(), "text")

    def _box_cover(self) -> Cover:
        return combined(self.lattice.cover(box_rectangles(self.enclosures)))

    def _strips(self) -> Thinning:
        if self._thinned is None:
            start, boxes = self.clock(), self.boxes()
            self._thinned = thinning(self.enclosures, self.lattice, self.jobs)
            self.pace.record("strips", boxes, self.clock() - start)
        return self._thinned

    def _affordable(self, cover: Cover) -> bool:
        """Whether there is the time to make a map of the cover, as far as one can foresee."""
        pieces = max(self.boxes(), len(cover.rectangles))
        return SAFETY * self.pace.cost(pieces, "map", "text") < self.pace.left()

    def _late(self) -> bool:
        """Whether the search has to end for the last map; between its tasks maps are handed over. A
        process that is to leave ends here.
        """
        boxes = self.boxes()
        leave_if_asked()
        if self.pace.late(boxes):
            self._thinned = None
            return True
        if self.options.partial is not None and self.pace.due(boxes):
            start = self.clock()
            self._thinned = None
            enclosed = share_of(self._box_cover())
            self.pace.looked(self.clock() - start)
            if enclosed <= (
                FIRST_MAP_SHARE if self.best is None else MAP_SHRINK_RATIO * self.tried_at
            ):
                self._hand_over(enclosed)
            self.pace.resumed()
        return False

    def _hand_over(self, enclosed: Fraction | None = None) -> None:
        """Give the map so far to whoever asked for it.

        Parameters
        ----------
        enclosed : the boxes' share of the window; without it the map is one without strips.
        """
        start = self.clock()
        found = (
            self.map_so_far()
            if enclosed is not None and enclosed <= COARSE_SHARE
            else self.map(self._box_cover(), Status.PARTIAL)
        )
        if enclosed is not None:
            self.tried_at = min(enclosed, self.tried_at)
        if found.undetermined < self._least() and self.options.partial is not None:
            made = self.clock()
            self.options.partial(found)
            self.best = found
            self.pace.record("text", self.boxes(), self.clock() - made)
            if found.cover is not None:
                self.uncounted = found.undetermined - share_of(found.cover)
        self.pace.spent += self.clock() - start

    def _stopped(self, why: str) -> RegionMap:
        """The map so far if it will do after all.

        Raises
        ------
        LimitReached
            Otherwise, with that map; without one where nothing is decided yet.
        """
        tolerance = self.tolerance
        if self.best is None and self.options.partial is not None:
            self._hand_over()  # a cheap one first: what strips take is not known yet
        so_far = self.map_so_far()
        if so_far.undetermined <= tolerance:  # strips of what the level had reached were enough
            return replace(so_far, status=Status.CERTIFIED)
        if so_far.undetermined == 1:
            raise LimitReached(f"{why} before anything was decided: there is no map to save yet")
        raise LimitReached(
            f"{why} with {percent(so_far.undetermined)} undetermined, more than the tolerance of {percent(tolerance)}",
            partial=so_far,
        )

    def _report(self, undetermined: Fraction) -> Callable[[int, int], None] | None:
        progress = self.options.progress
        if progress is None:
            return None

        def report(treated: int, waiting: int) -> None:
            level = treated / max(treated + 8 * waiting, 1)  # most of those that wait are cut again
            share = self._kept(undetermined)
            done = parts_done(float(share), level, float(self.tolerance))
            self.reached = max(self.reached, done)
            progress(f"undetermined {percent(share)}", self.reached, PARTS)

        return report

    def _least(self) -> Fraction:
        """What the best map leaves undetermined of those that were handed over, and the one to go
        on from.
        """
        return min(
            (found.undetermined for found in (self.best, self.options.resume) if found),
            default=Fraction(1),
        )

    def _kept(self, undetermined: Fraction) -> Fraction:
        """What a stop would leave undetermined.

        It is what the map leaves that `run` makes then, if there is the time to make it: else what
        the best one leaves.

        Parameters
        ----------
        undetermined : the share that the cover leaves, of boxes or of strips.
        """
        # half of the time there is: other programs may take the processors meanwhile
        in_time = SAFETY * self.pace.cost(self.boxes(), "map") < LAST_SHARE * LAST_SECONDS / 2
        return min(self._least(), undetermined + self.uncounted) if in_time else self._least()


def _versions() -> dict[str, str]:
    return {
        "ptmcad": __version__,
        "python": sys.version.split()[0],
        "python-flint": flint.__version__,
        "FLINT": flint.__FLINT_VERSION__,
        "numba": numba.__version__,
        "numpy": np.__version__,
    }
