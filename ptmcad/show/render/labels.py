"""Places for labels clear of drawn strokes and of each other, with lines that lead to them.

Guarantee: the same for the same drawing. A label covers a stroke, a box or another label, or its
line passes one, only where none of the places that are tried within the bounds is free; then it
stands where it meets the fewest. Which labels are clear of all boxes and others is known.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan2, cos, hypot, pi, sin

Position = tuple[float, float]
Box = tuple[float, float, float, float]
"""Left, bottom, right, top."""

_DIRECTIONS = 32
DISTANCES = (4.0, 6.0, 9.0, 13.0, 18.0, 24.0, 31.0, 40.0, 52.0, 66.0, 84.0, 110.0, 140.0, 180.0)
_NEAR = 11.0
"""Points: a label that is farther from its point than this has a line that leads to it."""


Stroke = tuple[Position, Position, float]
"""A straight line from its start to its end with half its width, all in points."""


@dataclass(frozen=True, slots=True)
class Label:
    """A text and the point that it names, and where it is placed.

    Attributes
    ----------
    half : half its width and height.
    towards : the direction that it had best lie in.
    across : whether a line to it may lie across strokes.
    center : its centre, once it is placed.
    leader : the end of a line that leads from its point to it when it lies far from there.
    clear : whether label and line meet no box, and no label that was placed before.
    """

    text: str
    at: Position
    half: Position
    towards: Position = (1.0, 0.0)
    across: bool = True
    center: Position = (0.0, 0.0)
    leader: Position | None = None
    clear: bool = False

    @property
    def box(self) -> Box:
        """What the label covers."""
        return around(self.center, self.half)


def polyline(points: Sequence[Position], half: float) -> Iterator[Stroke]:
    """The strokes of a line through the points."""
    for start, end in pairwise(points):
        yield start, end, half


def place(
    labels: Iterable[Label],
    strokes: Iterable[Stroke],
    boxes: Iterable[Box],
    bounds: Box,
    distances: Sequence[float] = DISTANCES,
    skip: bool = False,
) -> list[Label]:
    """The labels at their places, found one after the other.

    Parameters
    ----------
    strokes, boxes : what no label may cover.
    bounds : the box that no label may leave.
    distances : from a point to its label, in the order in which they are tried.
    skip : whether labels that are not clear are left out, so that nothing has to be clear of them.
    """
    drawn, taken = list(strokes), list(boxes)
    result = []
    for label in labels:
        placed = _best(label, drawn, taken, bounds, distances)
        result.append(placed)
        if skip and not placed.clear:
            continue
        taken.append(placed.box)
        if placed.leader is not None:
            drawn.append((label.at, placed.leader, 0.5))
    return result


def _best(
    label: Label,
    strokes: Sequence[Stroke],
    boxes: Sequence[Box],
    bounds: Box,
    distances: Sequence[float],
) -> Label:
    least, best = (len(strokes) + len(boxes) + 1, 0), replace(label, center=label.at)
    for distance, wanted in _candidates(label, distances):
        center = _within(wanted, label.half, bounds)
        box = around(center, label.half)
        on_boxes = sum(overlap(box, other) for other in boxes)
        covered = on_boxes + sum(crosses(stroke, box) for stroke in strokes)
        if covered > least[0]:
            continue
        leader, passed = None, 0
        if distance > _NEAR:
            leader = _edge(label.at, box)
            line = label.at, leader, 0.5
            passed = sum(crosses(line, other) for other in boxes if not holds(other, label.at))
            on_boxes += passed
            if not label.across:
                passed += sum(touch(line, stroke) for stroke in strokes)
        if (covered, passed) < least:
            least = covered, passed
            best = replace(label, center=center, leader=leader, clear=not on_boxes)
            if least == (0, 0):
                break
    return best


def _candidates(label: Label, distances: Sequence[float]) -> Iterator[tuple[float, Position]]:
    """Distances and centres, from the nearest and from the direction in which the label had best
    lie.
    """
    start = atan2(label.towards[1], label.towards[0])
    for distance in distances:
        for k in range(_DIRECTIONS):
            # 0, 1, -1, 2, -2, ... steps away from the wanted direction
            angle = start + 2 * pi / _DIRECTIONS * ((k + 1) // 2) * (1 if k % 2 else -1)
            yield distance, _beside(label, angle, distance)


def _beside(label: Label, angle: float, distance: float) -> Position:
    """The centre of a label whose nearest edge or corner is at a distance from its point."""
    dx, dy = cos(angle), sin(angle)
    width, height = label.half
    reach = min(
        width / abs(dx) if abs(dx) > 1e-9 else 1e9, height / abs(dy) if abs(dy) > 1e-9 else 1e9
    )
    return label.at[0] + dx * (reach + distance), label.at[1] + dy * (reach + distance)


def _within(center: Position, half: Position, bounds: Box) -> Position:
    """The nearest centre of a label that does not leave the bounds, if it is not larger than they
    are.
    """
    x, y = (min(max(center[k], bounds[k] + half[k]), bounds[k + 2] - half[k]) for k in (0, 1))
    return x, y


def _edge(at: Position, box: Box) -> Position:
    """The point of the box that is nearest to a point."""
    return min(max(at[0], box[0]), box[2]), min(max(at[1], box[1]), box[3])


def around(center: Position, half: Position) -> Box:
    """The box with such a middle."""
    return center[0] - half[0], center[1] - half[1], center[0] + half[0], center[1] + half[1]


def holds(box: Box, point: Position) -> bool:
    """Whether a point is in a box or on its edge."""
    return box[0] <= point[0] <= box[2] and box[1] <= point[1] <= box[3]


def overlap(a: Box, b: Box) -> bool:
    """Whether two boxes have inner points in common."""
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def crosses(stroke: Stroke, box: Box) -> bool:
    """Whether a stroke meets a box: its middle line is clipped to the box, which is made larger by
    half the width.
    """
    (start, end, half), low, high = stroke, 0.0, 1.0
    for k in (0, 1):
        origin, step = start[k], end[k] - start[k]
        near, far = box[k] - half, box[k + 2] + half
        if abs(step) < 1e-12:
            if not near < origin < far:
                return False
            continue
        first, last = (near - origin) / step, (far - origin) / step
        if step < 0:
            first, last = last, first
        low, high = max(low, first), min(high, last)
        if not low < high:
            return False  # nearly always: most strokes are far from a label
    return low < high


def distance(point: Position, stroke: Stroke) -> float:
    """From a point to a stroke's middle line."""
    (ax, ay), (bx, by), _ = stroke
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    t = (
        0.0
        if square == 0
        else min(1.0, max(0.0, ((point[0] - ax) * dx + (point[1] - ay) * dy) / square))
    )
    return hypot(point[0] - ax - t * dx, point[1] - ay - t * dy)


def touch(one: Stroke, other: Stroke) -> bool:
    """Whether two strokes' middle lines have a point in common."""
    (a, b, _), (c, d, _) = one, other
    if any(max(a[k], b[k]) < min(c[k], d[k]) or max(c[k], d[k]) < min(a[k], b[k]) for k in (0, 1)):
        return False
    return _turn(a, b, c) * _turn(a, b, d) <= 0 and _turn(c, d, a) * _turn(c, d, b) <= 0


def _turn(a: Position, b: Position, c: Position) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
