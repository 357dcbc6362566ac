"""The pace of a search: when it hands over a map on the way, when it ends so that the last map is
made in time, and how far it has come.

Guarantee: maps on the way take at most `MAP_TIME_SHARE` of the time and `ALLOWANCE` seconds, as far
as the time of a map is foreseen; the search is asked to end while `SAFETY` times the time foreseen
for the last map is left. The progress reaches `PARTS` at no share above the tolerance.

Nothing here decides what is in a map: only when it is made.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf, log
from sys import float_info
from time import perf_counter, process_time

MAP_TIME_SHARE = 0.06
"""Of the time, spent on maps on the way."""
ALLOWANCE = 0.4
"""Seconds for the first of them, whose worth is largest."""
SAFETY = 2.0
MIN_RESERVE = 1.0
"""Seconds kept for the last map in any case, of a processor that does nothing else ..."""
RESERVE_SHARE = 0.02
"""... or this part of the time that there is in all, if that is more."""
MAX_RESERVE_SHARE = 1 / 3
"""Of the time in all, kept for the last map on a busy machine while it is not known what a map
takes.
"""
MIN_TIMED_BOXES = 4000
"""Of fewer boxes the time says nothing about what each of them takes."""


RATES = {"strips": 1e-5, "map": 2e-5, "text": 5e-6}
"""Seconds for a box, before anything is known: to find the strips, to make a map of their cover, and
to hand that over.
"""


@dataclass(slots=True)
class Pace:
    """The time that a computation has, and how it has been spent.

    Attributes
    ----------
    deadline : reading of the clock at which all has to be done; None without a limit.
    work : reading of a clock that runs only while this process works: on a busy machine the other
        one runs ahead of it.
    started : reading of the clock at the start.
    spent : seconds that maps on the way took.
    """

    deadline: float | None
    clock: Callable[[], float] = perf_counter
    work: Callable[[], float] = process_time
    started: float = 0.0
    spent: float = 0.0
    _known: dict[str, list[tuple[int, float]]] = field(default_factory=dict)
    _look_at: float = -inf
    _asked: float = inf
    _longest: float = 0.0
    _worked: float = 0.0

    def __post_init__(self) -> None:
        self.started, self._worked = self.clock(), self.work()

    def left(self) -> float:
        """Seconds until the deadline."""
        return inf if self.deadline is None else self.deadline - self.clock()

    def last(self, boxes: int) -> float:
        """Seconds to keep for the last map, of so many boxes."""
        total = 0.0 if self.deadline is None else self.deadline - self.started
        busy = max(1.0, (self.clock() - self.started) / max(self.work() - self._worked, 0.01))
        unknown = min(busy * MIN_RESERVE, max(MIN_RESERVE, MAX_RESERVE_SHARE * total))
        return max(unknown, RESERVE_SHARE * total, SAFETY * self.cost(boxes)) + self._longest

    def record(self, kind: str, boxes: int, seconds: float) -> None:
        """A kind of work on so many boxes took so many seconds."""
        self._known[kind] = [*self._known.get(kind, [])[-1:], (boxes, seconds)]

    def cost(self, boxes: int, *kinds: str) -> float:
        """Seconds that some kinds of work on so many boxes will take, or all for a map, by the last
        two times that each was done: with more boxes more, with fewer no less.
        """
        return sum(
            max(
                (
                    seconds * max(1.0, boxes / max(known, MIN_TIMED_BOXES))
                    for known, seconds in self._known.get(kind, ())
                ),
                default=RATES[kind] * boxes,
            )
            for kind in kinds or RATES
        )

    def late(self, boxes: int) -> bool:
        """Whether the search has to end; to be asked after each of its tasks, which it measures
        too.
        """
        now = self.clock()
        if self.deadline is None:
            return False
        self._longest = max(self._longest, now - self._asked)
        self._asked = now
        return now > self.deadline - self.last(boxes)

    def resumed(self) -> None:
        """What passed since `late` was asked was no task of the search."""
        self._asked = self.clock()

    def looked(self, seconds: float) -> None:
        """It took so many seconds to see whether a map on the way is worthwhile: that is not done
        all the time.
        """
        self.spent += seconds
        self._look_at = self.clock() + seconds / (MAP_TIME_SHARE / 2)

    def due(self, boxes: int, *, thinned: bool = True) -> bool:
        """Whether there is time for a map on the way, without strips if they are not wanted or
        known.
        """
        if self.clock() < self._look_at:
            return False
        cost = self.cost(boxes) if thinned else self.cost(boxes, "map", "text")
        affordable = self.spent + cost <= ALLOWANCE + MAP_TIME_SHARE * (self.clock() - self.started)
        return affordable and cost + self.last(boxes) < self.left()


PARTS = 1000
"""Of the whole way, from a window of which all is undetermined to the tolerance."""
LEVEL_SHRINKAGE = 0.5
"""What a level leaves of the share, about: half as wide boxes along a curve are twice as many."""


def parts_done(share: float, level: float, tolerance: float) -> int:
    """The parts of the way that are behind when a level that began at a share is done to the part
    ``level``.

    >>> parts_done(1.0, 0.0, 1e-3), parts_done(0.1, 0.0, 1e-3), parts_done(0.0, 1.0, 1e-3)
    (0, 333, 1000)
    """
    # a tolerance below all floats has become zero, which has no logarithm
    least = max(tolerance, float_info.min)
    left = max(share * LEVEL_SHRINKAGE ** min(max(level, 0.0), 1.0), least)
    return min(int(PARTS * log(min(left, 1.0)) / log(least)), PARTS - 1 if share > least else PARTS)
