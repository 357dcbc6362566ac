"""The sketch of a pose: bars, zigzag springs, supports, load arrows and labels as lines on paper, in points.

Guarantee: nodes are where the pose has them, at one scale for all poses; a spring has the same number of
turns at any length. A spring that would lie on a bar or on another spring, or is too short for its turns, is drawn
aside and led back to its nodes. Labels keep clear of all that is drawn (`ptmcad.show.render.clearance`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import hypot

from ptmcad.answer.poses import Pose, Poses
from ptmcad.mechanism import Support, ptm
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.clearance import Box, Label, Placed, Position, Stroke, distance, place, polyline

MECHANISM = ptm()
BASE = (MECHANISM.held(Support.PIN), MECHANISM.held(Support.SLIDER_X))
"""The points at the ends of the telescopic base."""
BAR_WIDTHS = (5.5, 3.2)
WIDTH, MAX_HEIGHT, LEAST_HEIGHT, MARGIN = 200.0, 210.0, 112.0, 36.0
PIN = 2.4
SUPPORT, GROUND = (7.0, 10.0), 4.0
SLIDER = (7.5, 4.2)
"""Half its width and height."""
MIN_TURNS, TURN = 6, 6.0
"""A spring has so many turns, or one for each such length: else the teeth of a long one lie so flat that it looks like
stairs."""
AMPLITUDE = 3.4
_END, _SHORTEST = 7.0, 19.0
_ASIDE = (9.0, -9.0, 15.5, -15.5, 22.0, -22.0)
LONGEST_ARROW, SHORTEST_ARROW = 27.0, 8.5
_SAME = 2.5
LABEL_HALF_HEIGHT, LABEL_SIZE = 5.6, 9.0


@dataclass(frozen=True, slots=True)
class Frame:
    """What all panels have in common: points to the unit of length, and their sides in points."""

    scale: Fraction
    height: float
    width: float = WIDTH

    def nodes(self, pose: Pose) -> dict[str, Position]:
        """The places of a pose's nodes, the pose in the middle of its panel."""
        exact = _centers(pose)
        (left, right), (bottom, top) = _sides(exact.values())
        return {
            name: (
                self.width / 2 + float((x - (left + right) / 2) * self.scale),
                self.height / 2 + float((y - (bottom + top) / 2) * self.scale),
            )
            for name, (x, y) in exact.items()
        }


@dataclass(frozen=True, slots=True)
class Arrow:
    """A load's component at a node, by its name, such as F3x."""

    name: str
    start: Position
    end: Position


@dataclass(frozen=True, slots=True)
class Sketch:
    """A pose on paper.

    Attributes
    ----------
    bars : in the order of the mechanism's.
    springs : polylines in the order of the pose's springs.
    """

    nodes: Mapping[str, Position]
    bars: tuple[tuple[Position, Position], ...]
    springs: tuple[tuple[Position, ...], ...]
    arrows: tuple[Arrow, ...]
    labels: tuple[Placed, ...]


def frame_of(shown: Sequence[Pose], width: float = WIDTH, most_height: float = MAX_HEIGHT) -> Frame:
    """The frame that shows all these poses at one scale, as large as the width and the height allow."""
    sides = [[high - low for low, high in _sides(_centers(pose).values())] for pose in shown]
    wide, tall = (max(side[k] for side in sides) for k in (0, 1))
    room = (Fraction(width - 2 * MARGIN), Fraction(most_height - 2 * MARGIN))
    scale = min(r / side for r, side in zip(room, (wide, tall), strict=True) if side)
    return Frame(scale, max(LEAST_HEIGHT, float(tall * scale) + 2 * MARGIN), width)


def _centers(pose: Pose) -> dict[str, tuple[Fraction, Fraction]]:
    return {name: (x.center, y.center) for name, (x, y) in pose.nodes.items()}


def _sides(points: Iterable[tuple[Fraction, Fraction]]) -> tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]:
    """The least and the largest x, and the same for y."""
    xs, ys = zip(*points, strict=True)
    return (min(xs), max(xs)), (min(ys), max(ys))


def arrow_lengths(poses: Poses) -> dict[str, float]:
    """The loads that are not zero, and the lengths of their arrows: by force, but none shorter than is seen."""
    loads = {name: poses.parameters.get(name, Fraction(0)) for load in MECHANISM.loads for name in load.names}
    largest = max(map(abs, loads.values()))
    return {
        name: (1 if load > 0 else -1) * max(SHORTEST_ARROW, LONGEST_ARROW * float(abs(load) / largest))
        for name, load in loads.items()
        if load
    }


def sketch(pose: Pose, frame: Frame, arrows: Mapping[str, float]) -> Sketch:
    """A pose in a frame, with arrows of these lengths."""
    nodes = frame.nodes(pose)
    bars = tuple((nodes[a], nodes[b]) for a, b in MECHANISM.bars)
    drawn = [Stroke(a, b, width / 2) for (a, b), width in zip(bars, BAR_WIDTHS, strict=True)]
    springs = []
    for spring in pose.springs:
        line = _spring(nodes[spring.start], nodes[spring.end], drawn)
        springs.append(line)
        drawn += polyline(line, 0.5)
    placed_arrows = tuple(_arrows(nodes, arrows))
    strokes = [*drawn, Stroke(nodes[BASE[0]], nodes[BASE[1]], 1.0)]
    strokes += [Stroke(arrow.start, arrow.end, 3.0) for arrow in placed_arrows]
    labels = place(_labels(nodes), strokes, _symbols(nodes), (2.0, 2.0, frame.width - 2.0, frame.height - 2.0))
    return Sketch(nodes, bars, tuple(springs), placed_arrows, tuple(labels))


def _symbols(nodes: Mapping[str, Position]) -> Iterator[Box]:
    """What pins, the support and the slider cover."""
    for x, y in nodes.values():
        yield x - PIN, y - PIN, x + PIN, y + PIN
    (x, y) = nodes[BASE[0]]
    yield x - SUPPORT[0] - 2, y - SUPPORT[1] - GROUND - 1, x + SUPPORT[0] + 2, y
    (x, y) = nodes[BASE[1]]
    yield x - SLIDER[0], y - SLIDER[1], x + SLIDER[0], y + SLIDER[1]


def _spring(start: Position, end: Position, drawn: Sequence[Stroke]) -> tuple[Position, ...]:
    """The zigzag between two nodes, aside when something is already drawn there or they are too near."""
    length = hypot(end[0] - start[0], end[1] - start[1])
    along = ((end[0] - start[0]) / length, (end[1] - start[1]) / length) if length > 1e-6 else (1.0, 0.0)
    if along[0] < -1e-9 or (abs(along[0]) <= 1e-9 and along[1] < 0):  # aside means above first, not below
        return _spring(end, start, drawn)[::-1]
    straight = _zigzag(start, end, along, 0.0)
    if length >= _SHORTEST + 2 * _END and not _covered(straight, drawn):
        return straight
    tried = [_zigzag(start, end, along, aside) for aside in _ASIDE]
    return next((line for line in tried if not _covered(line, drawn)), tried[-1])


def _zigzag(start: Position, end: Position, along: Position, aside: float) -> tuple[Position, ...]:
    length = hypot(end[0] - start[0], end[1] - start[1])
    wound = max(_SHORTEST, length - 2 * _END)
    across = (-along[1], along[0])
    middle = ((start[0] + end[0]) / 2 + across[0] * aside, (start[1] + end[1]) / 2 + across[1] * aside)
    teeth = 2 * max(MIN_TURNS, round(wound / TURN))
    offsets = [(-wound / 2, 0.0)]
    for k in range(teeth):
        offsets.append((wound * ((k + 0.5) / teeth - 0.5), AMPLITUDE if k % 2 else -AMPLITUDE))
    offsets.append((wound / 2, 0.0))
    inner = tuple(
        (middle[0] + along[0] * u + across[0] * v, middle[1] + along[1] * u + across[1] * v) for u, v in offsets
    )
    return (start, *inner, end)


def _covered(line: Sequence[Position], drawn: Sequence[Stroke]) -> bool:
    """Whether more than a third of the zigzag's middle line runs along strokes that are already drawn."""
    first, last = line[1], line[-2]
    points = [(first[0] + (last[0] - first[0]) * k / 20, first[1] + (last[1] - first[1]) * k / 20) for k in range(21)]
    return sum(any(distance(p, s) < AMPLITUDE + s.half for s in drawn) for p in points) > 7


def _arrows(nodes: Mapping[str, Position], lengths: Mapping[str, float]) -> Iterator[Arrow]:
    """The loads' arrows; where two would lie on each other, they stand side by side."""
    first, second = (nodes[load.point] for load in MECHANISM.loads)
    shift = 2.6 if hypot(*(a - b for a, b in zip(first, second, strict=True))) < 5 else 0.0
    for load, side in zip(MECHANISM.loads, (-shift, shift), strict=True):
        x, y = nodes[load.point]
        horizontal, vertical = load.names
        if horizontal in lengths:
            sign = 1 if lengths[horizontal] > 0 else -1
            yield Arrow(horizontal, (x + sign * PIN, y + side), (x + sign * PIN + lengths[horizontal], y + side))
        if vertical in lengths:
            sign = 1 if lengths[vertical] > 0 else -1
            yield Arrow(vertical, (x + side, y + sign * PIN), (x + side, y + sign * PIN + lengths[vertical]))


def _labels(nodes: Mapping[str, Position]) -> Iterator[Label]:
    """One label for each node, or for the nodes that coincide on paper."""
    groups: list[list[str]] = []
    for name, at in nodes.items():
        near = [g for g in groups if hypot(at[0] - nodes[g[0]][0], at[1] - nodes[g[0]][1]) < _SAME]
        if near:
            near[0].append(name)
        else:
            groups.append([name])
    middle = tuple(sum(p[k] for p in nodes.values()) / len(nodes) for k in (0, 1))
    for group in groups:
        at = nodes[group[0]]
        text = ", ".join(symbol(name) for name in group)
        away = (at[0] - middle[0], at[1] - middle[1])
        towards = away if hypot(*away) > 1 else (0.0, 1.0)
        yield Label(text, at, (6.9 * len(group) + 2.9 * (len(group) - 1), LABEL_HALF_HEIGHT), towards)
