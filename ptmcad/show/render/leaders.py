"""Lines that lead from what stands beside a map to points of it: in which order that stands there,
and their course.

Guarantee: the same for the same geometry. Lines of one side cross each other, a label or another
point only where no course and no exchange of two neighbours that the search tries is without that.

Source: an assignment of least total length has no crossing (of two that cross an exchange is
shorter), which is why length is what is made least after crossings; Bekos, Kaufmann, Symvonis and
Wolff, "Boundary labeling" (2007).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from math import dist

from ptmcad.show.render.labels import Box, Position, Stroke, around, crosses, holds, touch

Course = tuple[Position, ...]
"""From a berth to a point, straight or with one bend."""

_CROSSING, _COVERED, _BEND, _OFF = 100.0, 10.0, 0.5, 0.15
"""What a crossing, a covered box, a bend and an inch off a berth's middle cost, in inches of line.
"""
_STARTS, _BENDS = 7, 13
_HALF, _MARK = 0.035, 0.06
"""Inches: half a line's width with a little space, and half the side of a point's mark."""
_ROUNDS = 3


@dataclass(frozen=True, slots=True)
class Berth:
    """Where a line may begin: an upright edge, in inches, and the upright on which it may bend
    towards the map.
    """

    x: float
    low: float
    high: float
    gutter: float


Order = tuple[int, ...]


def routed(
    targets: Sequence[Position],
    berths_of: Callable[[Order], Sequence[Berth]],
    boxes: Sequence[Box],
    heights: tuple[float, float],
) -> tuple[Order, list[Course]]:
    """The order of the targets along one side, and their lines in that order.

    Parameters
    ----------
    targets : the points, in inches, in the order to begin with.
    berths_of : the berths for the targets in an order, from above.
    boxes : what no line may cover.
    heights : of the map's lower and upper side, between which lines bend.
    """
    order = tuple(range(len(targets)))
    cost, courses = _best(targets, order, berths_of(order), boxes, heights)
    improved = True
    while improved:
        improved = False
        for a, b in combinations(range(len(order)), 2):
            tried = list(order)
            tried[a], tried[b] = tried[b], tried[a]
            other = tuple(tried)
            found, lines = _best(targets, other, berths_of(other), boxes, heights)
            if found < cost - 1e-9:
                cost, courses, order, improved = found, lines, other, True
    return order, courses


def _best(
    targets: Sequence[Position], order: Order, berths: Sequence[Berth], boxes: Sequence[Box],
    heights: tuple[float, float],
) -> tuple[float, list[Course]]:  # fmt: skip
    """Courses of little cost for an order: the cheapest of each alone, then of each beside the
    others.
    """
    offered = []
    for n, berth in zip(order, berths, strict=True):
        marks = [around(other, (_MARK, _MARK)) for k, other in enumerate(targets) if k != n]
        free = [box for box in (*boxes, *marks) if not holds(box, targets[n])]
        offered.append(
            [
                (_alone(course, berth, free), course)
                for course in _courses(berth, targets[n], heights)
            ]
        )
    chosen = [min(courses) for courses in offered]
    for _ in range(_ROUNDS):
        before = list(chosen)
        for k, courses in enumerate(offered):
            others = [course for j, (_, course) in enumerate(chosen) if j != k]
            chosen[k] = min(
                courses, key=lambda each: (each[0] + _CROSSING * _crossed(each[1], others), each)
            )
        if chosen == before:
            break
    found = [course for _, course in chosen]
    crossed = sum(meet(one, other) for one, other in combinations(found, 2))
    return sum(cost for cost, _ in chosen) + _CROSSING * crossed, found


def _courses(berth: Berth, target: Position, heights: tuple[float, float]) -> Iterator[Course]:
    """Straight lines from the berth, and lines along the gutter to a height of the map and from
    there straight.
    """
    nearest = min(max(target[1], berth.low), berth.high)
    for k in range(_STARTS):
        yield (berth.x, berth.low + (berth.high - berth.low) * k / (_STARTS - 1)), target
    yield (berth.x, nearest), target
    for k in range(_BENDS):
        height = heights[0] + (heights[1] - heights[0]) * k / (_BENDS - 1)
        if not berth.low <= height <= berth.high:
            start = min(max(height, berth.low), berth.high)
            yield (berth.x, start), (berth.gutter, height), target


def _alone(course: Course, berth: Berth, boxes: Sequence[Box]) -> float:
    """The cost of a line without the others."""
    strokes = [Stroke(start, end, _HALF) for start, end in pairwise(course)]
    covered = sum(any(crosses(stroke, box) for stroke in strokes) for box in boxes)
    long = sum(dist(stroke.start, stroke.end) for stroke in strokes)
    off = abs(course[0][1] - (berth.low + berth.high) / 2)
    return _COVERED * covered + long + _BEND * (len(course) - 2) + _OFF * off


def _crossed(course: Course, others: Sequence[Course]) -> int:
    return sum(meet(course, other) for other in others)


def meet(one: Course, other: Course) -> bool:
    """Whether two lines have a point in common."""
    return any(touch(*a, *b) for a in pairwise(one) for b in pairwise(other))
