"""The sketch of a pose: bars, zigzag springs, spirals, supports, load arrows and labels as lines on
paper, in points.

Spirals are torsion springs, where their joints are known (`ptmcad.model.joints`).

Guarantee: nodes are where the pose has them, at one scale for all poses. A spring that would lie on
a bar or on another spring, or is too short for its turns, is drawn aside and led back to its nodes.
Labels keep clear of all that is drawn (`ptmcad.show.render.labels`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import copysign, dist, hypot

from ptmcad.answer.poses import Pose, Poses
from ptmcad.model import Mechanism, Support
from ptmcad.model.elements import Load
from ptmcad.model.joints import joints_of
from ptmcad.model.work import LoadsAt, loads_at
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.labels import (
    Box,
    Label,
    Position,
    Stroke,
    distance,
    place,
    polyline,
)
from ptmcad.show.render.view import Point
from ptmcad.show.spiral import spirals

BAR_WIDTHS = (5.5, 3.2)
"""Of two bars, which are distinguished; more are alike."""
MANY_BARS = 4.2
WIDTH, MAX_HEIGHT, MIN_HEIGHT, MARGIN = 200.0, 210.0, 112.0, 36.0
PIN = 2.4
SUPPORT, GROUND = (7.0, 10.0), 4.0
SLIDER, RAIL = (7.5, 4.2), 17.0
"""Half its width and height."""
MIN_TURNS, TURN = 6, 6.0
"""A spring has so many turns, or one for each such length: else the teeth of a long one lie so flat
that it looks like stairs."""
AMPLITUDE = 3.4
SPIRAL, SPIRAL_GAP = (PIN + 1.3, 8.8), 2.4
"""The inner and the outer radius of a torsion spring, and what is left free between two at one
joint.
"""
_END, _MIN_LENGTH = 7.0, 19.0
_ASIDE = (9.0, -9.0, 15.5, -15.5, 22.0, -22.0)
MAX_ARROW, MIN_ARROW = 27.0, 8.5
_SAME = 2.5
LABEL_HALF_HEIGHT, LABEL_SIZE = 5.6, 9.0


Nodes = Mapping[str, Position]
"""The points' places on paper."""


@dataclass(frozen=True, slots=True)
class PanelFrame:
    """What all panels have in common: points to the unit of length, and their sides in points."""

    scale: Fraction
    height: float
    width: float = WIDTH

    def sketch(self, mechanism: Mechanism, pose: Pose, arrows: Mapping[str, float]) -> Sketch:
        """A pose in the middle of its panel; ``arrows`` are lengths of loads."""
        exact = _centers(pose)
        (left, right), (bottom, top) = _sides(exact.values())
        nodes = {
            name: (
                self.width / 2 + float((x - (left + right) / 2) * self.scale),
                self.height / 2 + float((y - (bottom + top) / 2) * self.scale),
            )
            for name, (x, y) in exact.items()
        }
        return sketched(mechanism, nodes, (self.width, self.height), arrows)


Arrow = tuple[str, Position, Position]
"""A load's component at a node: its name, such as F3x, its start and its end."""


@dataclass(frozen=True, slots=True)
class Sketch:
    """A pose on paper.

    Attributes
    ----------
    sides : of the paper, in points.
    rails : what sliders slide on: a telescopic base from a fixed support at their height, else a
        short one.
    bars : in the order of the mechanism's.
    coils : the springs' polylines by their names in a picture: zigzags, and spirals from the joint
        outwards.
    """

    mechanism: Mechanism
    sides: Position
    nodes: Nodes
    rails: tuple[tuple[Position, Position], ...]
    bars: tuple[tuple[Position, Position], ...]
    coils: Mapping[str, tuple[Position, ...]]
    arrows: tuple[Arrow, ...]
    labels: tuple[Label, ...]


def frame_of(
    shown: Sequence[Pose], width: float = WIDTH, most_height: float = MAX_HEIGHT
) -> PanelFrame:
    """The frame that shows all these poses at one scale, as large as the width and the height
    allow.
    """
    sides = [[high - low for low, high in _sides(_centers(pose).values())] for pose in shown]
    wide, tall = (max(side[k] for side in sides) for k in (0, 1))
    room = (Fraction(width - 2 * MARGIN), Fraction(most_height - 2 * MARGIN))
    scale = min(
        (r / side for r, side in zip(room, (wide, tall), strict=True) if side), default=Fraction(1)
    )
    return PanelFrame(scale, max(MIN_HEIGHT, float(tall * scale) + 2 * MARGIN), width)


def _centers(pose: Pose) -> dict[str, Point]:
    return {name: (x.center, y.center) for name, (x, y) in pose.nodes.items()}


def _sides(points: Iterable[Point]) -> tuple[Point, Point]:
    """The least and the largest x, and the same for y."""
    xs, ys = zip(*points, strict=True)
    return (min(xs), max(xs)), (min(ys), max(ys))


def arrow_lengths(poses: Poses) -> dict[str, float]:
    """The loads that are not zero, and the lengths of their arrows: by force, but none shorter than
    is seen.
    """
    mechanism = poses.model.whole
    assert mechanism is not None
    forces = components(loads_at(mechanism, poses.parameters))
    return arrows_of(forces, max(map(abs, forces.values()), default=Fraction(0)))


def arrows_of(forces: Mapping[str, Fraction], largest: Fraction) -> dict[str, float]:
    """The lengths of the arrows of those that are not zero, in proportion to the largest."""
    return {
        name: copysign(max(MIN_ARROW, MAX_ARROW * float(abs(force) / largest)), force)
        for name, force in forces.items()
        if force
    }


def components(loads: LoadsAt) -> dict[str, Fraction]:
    """The components of all loads by their names; constants and expressions are named by their
    text.
    """
    return {
        name: force
        for load, forces in loads
        for name, force in zip(load.names, forces, strict=True)
    }


def bar_width(mechanism: Mechanism, number: int) -> float:
    """In points."""
    return BAR_WIDTHS[number] if len(mechanism.bars) <= len(BAR_WIDTHS) else MANY_BARS


def sketched(
    mechanism: Mechanism, nodes: Nodes, sides: Position, arrows: Mapping[str, float],
    turns: int | None = None, offsets: Nodes | None = None,
) -> Sketch:  # fmt: skip
    """A mechanism whose nodes are at places on paper of these sides, with arrows of these lengths.

    Parameters
    ----------
    turns : of every spring; as many as its length asks for, where it is None.
    offsets : where the label of each node had best lie, by its text; if not given nodes that
        coincide have one label, away from the middle.
    """
    bars = tuple((nodes[a], nodes[b]) for a, b in mechanism.bars)
    drawn = [(a, b, bar_width(mechanism, number) / 2) for number, (a, b) in enumerate(bars)]
    coils = {}
    for number, (start, end) in enumerate(mechanism.spring_ends, 1):
        coils[f"spring-{number}"] = line = _spring(nodes[start], nodes[end], drawn, turns)
        drawn += polyline(line, 0.5)
    for number, line in spirals(joints_of(mechanism), nodes, *SPIRAL, SPIRAL_GAP).items():
        coils[f"torsion-{number}"] = line
        drawn += polyline(line, 0.5)
    placed_arrows = tuple(_arrows(mechanism.loads, nodes, arrows))
    rails = tuple(_rails(mechanism, nodes))
    strokes = [*drawn, *((a, b, 1.0) for a, b in rails)]
    strokes += [(start, end, 3.0) for _, start, end in placed_arrows]
    placed = place(
        _labels(nodes, offsets),
        strokes,
        _symbols(mechanism, nodes),
        (2.0, 2.0, sides[0] - 2.0, sides[1] - 2.0),
    )
    return Sketch(mechanism, sides, nodes, rails, bars, coils, placed_arrows, tuple(placed))


def _rails(mechanism: Mechanism, nodes: Nodes) -> Iterator[tuple[Position, Position]]:
    fixed = next(
        (nodes[name] for name, kind in mechanism.supports.items() if kind is Support.PIN), None
    )
    for name, kind in mechanism.supports.items():
        x, y = nodes[name]
        if kind is Support.SLIDER_Y:
            yield (x, y - RAIL), (x, y + RAIL)
        elif kind is Support.SLIDER_X:
            yield (
                (fixed, (x, y))
                if fixed is not None and abs(fixed[1] - y) < 1e-6
                else ((x - RAIL, y), (x + RAIL, y))
            )


def _symbols(mechanism: Mechanism, nodes: Nodes) -> Iterator[Box]:
    """What pins, supports and sliders cover."""
    for x, y in nodes.values():
        yield x - PIN, y - PIN, x + PIN, y + PIN
    for name, kind in mechanism.supports.items():
        x, y = nodes[name]
        if kind is Support.PIN:
            yield x - SUPPORT[0] - 2, y - SUPPORT[1] - GROUND - 1, x + SUPPORT[0] + 2, y
        else:
            wide, tall = SLIDER if kind is Support.SLIDER_X else SLIDER[::-1]
            yield x - wide, y - tall, x + wide, y + tall


def _spring(
    start: Position, end: Position, drawn: Sequence[Stroke], turns: int | None
) -> tuple[Position, ...]:
    """The zigzag between two nodes, aside when something is already drawn there or they are too
    near.
    """
    span = complex(end[0] - start[0], end[1] - start[1])
    along = span / abs(span) if abs(span) > 1e-6 else complex(1)
    if along.real < -1e-9 or (abs(along.real) <= 1e-9 and along.imag < 0):
        return _spring(end, start, drawn, turns)[::-1]  # aside means above first, not below
    wound = max(_MIN_LENGTH, abs(span) - 2 * _END)
    number = max(MIN_TURNS, round(wound / TURN)) if turns is None else turns
    tried = (0.0, *_ASIDE) if abs(span) >= _MIN_LENGTH + 2 * _END else _ASIDE
    for aside in tried:
        middle = complex(*start) + span / 2 + 1j * along * aside
        line = (start, *coil(middle, along, wound, number), end)
        if not _covered(line, drawn):
            break
    return line


def coil(middle: complex, along: complex, length: float, turns: int) -> list[Position]:
    """A zigzag about a middle, in a direction of length 1."""
    teeth = 2 * turns
    tips = [
        complex(length * ((k + 0.5) / teeth - 0.5), AMPLITUDE if k % 2 else -AMPLITUDE)
        for k in range(teeth)
    ]
    points = [middle + along * tip for tip in (-length / 2, *tips, length / 2)]
    return [(point.real, point.imag) for point in points]


def _covered(line: Sequence[Position], drawn: Sequence[Stroke]) -> bool:
    """Whether more than a third of the zigzag's middle line runs along strokes that are already
    drawn.
    """
    first, last = line[1], line[-2]
    points = [
        (first[0] + (last[0] - first[0]) * k / 20, first[1] + (last[1] - first[1]) * k / 20)
        for k in range(21)
    ]
    return sum(any(distance(p, s) < AMPLITUDE + s[2] for s in drawn) for p in points) > 7


def _arrows(loads: Sequence[Load], nodes: Nodes, lengths: Mapping[str, float]) -> Iterator[Arrow]:
    """The loads' arrows; where some would lie on each other, they stand side by side."""
    at = [nodes[load.point] for load in loads]
    for number, load in enumerate(loads):
        x, y = at[number]
        near = [k for k, other in enumerate(at) if dist(other, at[number]) < 5]
        side = 5.2 * (near.index(number) - (len(near) - 1) / 2)
        for name, (u, v) in zip(load.names, ((1, 0), (0, 1)), strict=True):
            if name in lengths:
                rim = copysign(PIN, lengths[name])
                start, end = (
                    (x + u * r + v * side, y + v * r + u * side) for r in (rim, rim + lengths[name])
                )
                yield name, start, end


def _labels(nodes: Nodes, offsets: Nodes | None) -> Iterator[Label]:
    """One label for each node, or for the nodes that coincide on paper."""
    groups: list[list[str]] = []
    for name, at in nodes.items():
        near = [g for g in groups if offsets is None and dist(at, nodes[g[0]]) < _SAME]
        if near:
            near[0].append(name)
        else:
            groups.append([name])
    middle = tuple(sum(p[k] for p in nodes.values()) / len(nodes) for k in (0, 1))
    for group in groups:
        at = nodes[group[0]]
        text = ", ".join(symbol(name) for name in group)
        away = (at[0] - middle[0], at[1] - middle[1])
        towards = away if offsets is None and hypot(*away) > 1 else (0.0, 1.0)
        wide = sum(max(6.9, 3.45 * len(symbol(name))) for name in group)
        half = wide + 2.9 * (len(group) - 1), LABEL_HALF_HEIGHT
        yield Label(text, at, half, (offsets or {}).get(text, towards))
