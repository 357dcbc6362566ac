"""Paths of stable poses along a line: how far each one can be followed, and where it snaps to.

Guarantee: the pose at every step of a path is the same branch (`tracking`). A branch that is said to end at a critical value
is not continued beyond it: all equilibria on the far side but those named were reached from other equilibria.

Where a stable pose vanishes and one stable pose is left, the mechanism's energy descends to that one from the place where the
first one was, for every descent but those that end exactly on a saddle; by theorem 1 (docs/method.md) there
are never more than two stable poses, so one is left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import Any

from flint import arb, ctx

from ptmcad.algebra.polynomials import from_fraction, to_fraction
from ptmcad.algebra.real_roots import simplest_between
from ptmcad.enclosure import AlgebraicNumber, Enclosure
from ptmcad.errors import ConfigError
from ptmcad.models import system_of
from ptmcad.models.ptm import PARAMETERS
from ptmcad.poses import Pose, Poses
from ptmcad.ranges.line import Line, critical_values, line_of
from ptmcad.ranges.tracking import BITS, Box, Family, Pair, Reached, at_value, bridge, follow
from ptmcad.slice import Axis, Slice
from ptmcad.solving import poses_at

DIGITS = 12
_NEAREST = Fraction(1, 10**9)
"""How near to a critical value a branch is followed, against the window's width."""


class Fate(Enum):
    """What happens to a stable pose at the end of its path."""

    WINDOW = "is stable up to the window's edge"
    SNAP = "vanishes and the mechanism snaps"
    MERGE = "merges with others into one stable pose, without a snap"
    UNDECIDED = "could not be followed further"


@dataclass(frozen=True, slots=True)
class PathPoint:
    """The pose's angles at a value of the axis (not wrapped into one turn, so that they are continuous)."""

    value: Fraction
    angles: tuple[Enclosure, Enclosure]


@dataclass(frozen=True, slots=True)
class PathEnd:
    """One end of a path.

    Attributes
    ----------
    at : the critical value or the window's edge.
    last : the last point of the path, close to ``at``.
    meeting : of the equilibria on the path's side, the Morse indices (numbers of negative eigenvalues) of those that
        meet there, the path's own included.
    leaving : the same for those into which they go on beyond.
    before : the pose close to ``at``; None at the window's edge.
    target : the stable pose beyond, to which the mechanism goes; None at the window's edge.
    """

    fate: Fate
    at: AlgebraicNumber | Fraction
    last: PathPoint
    meeting: tuple[int, ...] = ()
    leaving: tuple[int, ...] = ()
    before: Pose | None = None
    target: Pose | None = None


@dataclass(frozen=True, slots=True)
class PosePath:
    """A stable pose followed in both directions.

    Attributes
    ----------
    number : of the pose at the start, counted from 1 in the order of ``ptmcad solve``.
    points : in increasing order of the axis, the start among them.
    upright : whether y3 > 0 and y4 > 0 are proved for all values between the first and the last point.
    reverse : whether y3 < 0 and y4 < 0 are.
    """

    number: int
    start: Fraction
    points: tuple[PathPoint, ...]
    low: PathEnd
    high: PathEnd
    upright: bool
    reverse: bool


@dataclass(frozen=True, slots=True)
class PosePaths:
    """The paths of stable poses on a line."""

    name: str
    along: Axis
    at: Mapping[str, Fraction]
    start: Fraction
    paths: tuple[PosePath, ...]


def pose_paths(
    slice: Slice, along: str, at: Mapping[str, Any], start: Fraction, number: int | None = None
) -> PosePaths:
    """Follow stable poses along a line, from their places at one value of the axis.

    Parameters
    ----------
    start : the value, inside the window and not critical.
    number : which pose, counted from 1 as ``ptmcad solve`` lists them; None for every stable one.

    Raises
    ------
    ConfigError
        When the start is outside the window or critical, or there is no such stable pose.
    HypothesisError
        As for `ptmcad.ranges.intervals`.
    """
    line = line_of(slice, along, at)
    axis = line.along
    if not axis.low < start < axis.high:
        raise ConfigError(f"{start} is outside the window of {along}, {axis.low} to {axis.high}", key="--path")
    numbers = tuple(n for n, _ in critical_values(line))
    if any(n.compare(start) == 0 for n in numbers):
        raise ConfigError(f"{along} = {start} is a critical value: start beside it", key="--path")
    poses = _poses(line, start)
    stable = [k for k, pose in enumerate(poses.equilibria) if pose.stable]
    if number is not None and number - 1 not in stable:
        raise ConfigError(
            f"{number} is none of the {len(stable)} stable poses at {along} = {start}, counted from 1", key="--pose"
        )
    family = Family(system_of(slice.mechanism), line.parameters)
    chosen = stable if number is None else [number - 1]
    return PosePaths(
        slice.name,
        axis,
        line.at,
        start,
        tuple(_path(family, line, numbers, poses.equilibria[k], k + 1, start) for k in chosen),
    )


def _poses(line: Line, value: Fraction) -> Poses:
    parameters = {n: e.evaluate(value, Fraction(0)) for n, e in line.parameters.items() if n in PARAMETERS}
    return poses_at(parameters, DIGITS)


def _path(
    family: Family, line: Line, numbers: Sequence[AlgebraicNumber], pose: Pose, number: int, start: Fraction
) -> PosePath:
    box = at_value(family, start, _guess(pose))
    if box is None:
        raise ArithmeticError(f"the pose at {line.along.name} = {start} could not be enclosed")
    origin = Reached(start, box, box)
    left = _one_way(family, line, [n for n in reversed(numbers) if n.compare(start) < 0], origin, -1)
    right = _one_way(family, line, [n for n in numbers if n.compare(start) > 0], origin, 1)
    reached = [*reversed(left[0]), origin, *right[0]]
    with ctx.workprec(BITS):
        sines = [(r.over.tight[0].sin(), r.over.tight[1].sin()) for r in reached]
        upright = all(a > 0 and b > 0 for a, b in sines)
        reverse = all(a < 0 and b < 0 for a, b in sines)
    return PosePath(number, start, tuple(_point(r) for r in reached), left[1], right[1], upright, reverse)


def _guess(pose: Pose) -> Pair:
    with ctx.workprec(BITS):
        first, second = (arb(from_fraction(a.center)) for a in pose.angles)
        return first, second


def _one_way(
    family: Family, line: Line, numbers: Sequence[AlgebraicNumber], origin: Reached, side: int
) -> tuple[list[Reached], PathEnd]:
    """Follow a branch in one direction through all critical values that do not concern it."""
    window = line.along.high - line.along.low
    edge = line.along.high if side > 0 else line.along.low
    reached: list[Reached] = []
    current = origin
    for k, number in enumerate(numbers):
        near, far = _ends(number, side)
        following = _ends(numbers[k + 1], side)[0] if k + 1 < len(numbers) else edge
        gap = min(abs(near - current.value), abs(following - far)) / 8
        crossed, after = None, far
        while crossed is None and gap > window * _NEAREST:
            after = _beside(far, side, gap)
            steps, done = follow(family, current, _beside(near, -side, gap))
            reached += steps
            current = steps[-1] if steps else current
            if not done:
                return reached, PathEnd(Fate.UNDECIDED, number, _point(current))
            crossed = bridge(family, current, after)
            gap = gap / 4
        if crossed is None:
            return reached, _meeting(family, line, number, current, after)
        reached.append(crossed)
        current = crossed
    steps, done = follow(family, current, _beside(edge, -side, window / 10**6))
    reached += steps
    return reached, PathEnd(Fate.WINDOW if done else Fate.UNDECIDED, edge, _point(steps[-1] if steps else current))


def _ends(number: AlgebraicNumber, side: int) -> tuple[Fraction, Fraction]:
    """The near and the far end of an isolating interval, seen from where one comes."""
    return (number.low, number.high) if side > 0 else (number.high, number.low)


def _beside(value: Fraction, side: int, gap: Fraction) -> Fraction:
    """A short rational at a distance between gap / 2 and gap, at one side."""
    low, high = sorted((value + side * gap / 2, value + side * gap))
    return to_fraction(simplest_between(from_fraction(low), from_fraction(high)))


def _meeting(family: Family, line: Line, number: AlgebraicNumber, current: Reached, after: Fraction) -> PathEnd:
    """Which equilibria meet at a critical value that the path does not pass."""
    before, beyond = _poses(line, current.value).equilibria, list(_poses(line, after).equilibria)
    ours, meeting = None, []
    for pose in before:
        box = at_value(family, current.value, _guess(pose))
        if box is None:
            return PathEnd(Fate.UNDECIDED, number, _point(current))
        own = _same(box, current.box)
        across = None if own else bridge(family, Reached(current.value, box, box), after)
        if across is None:
            meeting.append(pose)
            ours = pose if own else ours
        else:
            images = [p for p in beyond if _at_pose(across.box, p)]
            if len(images) != 1:
                return PathEnd(Fate.UNDECIDED, number, _point(current))
            beyond.remove(images[0])
    if ours is None:
        return PathEnd(Fate.UNDECIDED, number, _point(current))
    stable_beyond = [p for p in _poses(line, after).equilibria if p.stable]
    if any(p.stable for p in beyond):
        fate = Fate.MERGE
    elif len(stable_beyond) == 1:
        fate = Fate.SNAP
    else:
        fate = Fate.UNDECIDED
    return PathEnd(
        fate,
        number,
        _point(current),
        tuple(p.index for p in meeting if p.index is not None),
        tuple(p.index for p in beyond if p.index is not None),
        ours,
        stable_beyond[0] if len(stable_beyond) == 1 else None,
    )


def _same(first: Box, second: Box) -> bool:
    """Whether two boxes at one value of the parameter hold the same equilibrium, whole turns apart."""
    return _close(first.tight, second.tight)


def _at_pose(box: Box, pose: Pose) -> bool:
    with ctx.workprec(BITS):
        angles = tuple(arb(from_fraction(a.low)).union(arb(from_fraction(a.high))) for a in pose.angles)
        return _close(box.tight, (angles[0], angles[1]))


def _close(first: Pair, second: Pair) -> bool:
    """Whether the boxes overlap, whole turns apart."""
    with ctx.workprec(BITS):
        return all(((a - b) / 2).sin().contains(0) for a, b in zip(first, second, strict=True))


def _point(reached: Reached) -> PathPoint:
    first, second = (Enclosure(_rational(a.lower()), _rational(a.upper())) for a in reached.box.tight)
    return PathPoint(reached.value, (first, second))


def _rational(ball: arb) -> Fraction:
    mantissa, exponent = (int(n) for n in ball.man_exp())
    return Fraction(mantissa) * Fraction(2) ** exponent
