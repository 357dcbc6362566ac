"""Refinement of the curves' enclosure, level by level: each level quarters the area at which boxes
are left alone.

Guarantee: at every moment the boxes that are left contain all curves over the rectangles at the
start: also where an exception (a signal's, a lack of memory or of threads) breaks into any
statement here. Such a break may leave boxes twice, which costs time, but never leaves one out. The
boxes of a finished level depend on nothing but the system and the start: not on the number of
threads, nor on the time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.branchandprune import Boxes, SearchResult, search_curve
from ptmcad.certified.equationsystem import EquationSystem

BUDGET = 20_000
"""Boxes that a task treats before it returns: about a tenth of a second."""
BATCH = 64
"""Boxes that a task starts with."""


@dataclass(slots=True)
class CurveEnclosure:
    """The boxes of one curve: those that the present level has not reached, and those that it has
    left alone.
    """

    curve: CriticalCurve
    waiting: list[Boxes]
    small: list[Boxes] = field(default_factory=list)

    def number(self) -> int:
        """How many boxes there are."""
        return sum(map(len, self.waiting)) + sum(map(len, self.small))

    def boxes(self) -> Boxes:
        """All of them; none where the curve does not enter the window."""
        none = self.curve.start(np.empty((0, 4)))
        return np.concatenate([none, *self.waiting, *self.small])


def begin(curves: Sequence[CriticalCurve], rectangles: Boxes) -> list[CurveEnclosure]:
    """Everything over the rectangles (k, 4: low x, low y, high x, high y) is open."""
    return [CurveEnclosure(curve, [curve.start(rectangles)]) for curve in curves]


def refine(
    enclosures: Sequence[CurveEnclosure],
    area: float,
    jobs: int,
    report: Callable[[int, int], None] | None = None,
    late: Callable[[], bool] | None = None,
) -> bool:
    """One level: bisect until every box's projection has at most the given area. False when it was
    to end before.

    Parameters
    ----------
    report : called with the numbers of boxes treated and waiting.
    late : called before the first task and after each, when the enclosures have what the tasks have
        found; it may take its time, in which the running tasks end. No task is begun after it has
        said True.
    """
    for enclosure in enclosures:
        enclosure.waiting = [*enclosure.waiting, *enclosure.small]
        enclosure.small = []
    with ThreadPoolExecutor(jobs) as pool:
        for enclosure in enclosures:
            if not _refine_one(enclosure, area, pool, jobs, report, late):
                return False
    return True


def _refine_one(
    enclosure: CurveEnclosure,
    area: float,
    pool: ThreadPoolExecutor,
    jobs: int,
    report: Callable[[int, int], None] | None,
    late: Callable[[], bool] | None,
) -> bool:
    arguments, weights = enclosure.curve.system.arguments, enclosure.curve.weights
    queue = list(_batches(enclosure.waiting))
    running: dict[Future[SearchResult], Boxes] = {}
    treated = 0
    ending = late is not None and late()
    while running or (queue and not ending):
        while queue and len(running) < jobs and not ending:
            batch = queue[-1]
            running[pool.submit(search_curve, arguments, batch, area, BUDGET, weights)] = batch
            queue.pop()
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            found = future.result()
            treated += found.used
            if len(found.small):
                enclosure.small.append(found.small)
            queue.extend(_batches([found.waiting]))
            del running[future]
        # The only statement that takes boxes away. Until it is done the batches of before are still
        # there: of those that an interruption cuts short nothing is lost, and what they have left
        # is there twice at worst.
        enclosure.waiting = [*queue, *running.values()]
        if report is not None:
            report(treated, sum(len(batch) for batch in queue))
        ending = ending or (late is not None and late())
    return not queue


def _batches(boxes: Sequence[Boxes]) -> Iterator[Boxes]:
    together = np.concatenate(boxes) if boxes else np.empty((0, 0))
    for start in range(0, len(together), BATCH):
        yield together[start : start + BATCH]


@dataclass(frozen=True, slots=True, eq=False)
class CriticalCurve:
    """One curve: its name, why counts change there, and the system that defines it.

    The variables of its boxes are x, y and those that ``ranges`` gives.
    """

    name: str
    reason: str
    system: EquationSystem
    ranges: tuple[tuple[float, float], ...]
    weights: NDArray[np.float64]
    """Of the variables' widths in the choice which one to bisect."""

    def start(self, window: Boxes) -> Boxes:
        """Boxes over rectangles (low x, low y, high x, high y) of the window that hold the whole
        curve over them.
        """
        count = len(window)
        low = np.tile(np.array([r[0] for r in self.ranges]), (count, 1))
        high = np.tile(np.array([r[1] for r in self.ranges]), (count, 1))
        return np.concatenate([window[:, :2], low, window[:, 2:], high], axis=1)
