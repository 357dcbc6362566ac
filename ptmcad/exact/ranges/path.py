"""Paths of stable poses along a line: how far each one can be followed, and where it snaps to.

Guarantee: the pose at every step of a path is the same branch (`tracking`). What a branch is said to meet at a critical
value, and that it vanishes there, is proved (`meeting`); that it is not bridged is not enough for that.

Where a stable pose vanishes and one is left, as always with the paper's mechanism, which never has more than two
(theorem 1 of docs/method.md), the energy descends to it from the place where the first one was: on a torus every
descent of a function ends at an equilibrium, and all but those that run exactly into a saddle end at a minimum. Where
several are left, where unknowns are on the line, where there is no energy, and where a moment works, nothing is said
about where a solution goes: a moment turns a bar for ever where nothing stops it, as the energy less its work is lower
by each turn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import arb, ctx

from ptmcad.answer.paths import Fate, PathEnd, PathPoint, PosePath, PosePaths, Target
from ptmcad.answer.poses import Pose
from ptmcad.errors import ConfigError
from ptmcad.exact.models import system_from
from ptmcad.exact.poses import exact_poses
from ptmcad.exact.ranges.equations import LineSystem
from ptmcad.exact.ranges.landing import DIGITS, beside, ends_from, landing
from ptmcad.exact.ranges.line import critical_values, is_regular
from ptmcad.exact.ranges.matrices import Vector
from ptmcad.exact.ranges.meeting import parameters_at, value_at, what_meets
from ptmcad.exact.ranges.tracking import BITS, Reached, at_value, bridge, follow
from ptmcad.model.compile import compiled
from ptmcad.question.line import Line, line_of
from ptmcad.question.slice import Slice, moved
from ptmcad.text.balls import ball_of, ball_over, enclosure_of
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.parsing import number_for

_MIN_DISTANCE = Fraction(1, 10**5)
"""How near to a critical value a branch is followed, against the window's width."""

_MIN_STEPS = 64
"""The longest step is this part of the window, so that a polyline through the points looks smooth."""


def pose_paths(slice: Slice, along: str, at: Mapping[str, Any], start: object, number: int | None = None) -> PosePaths:
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
        As for `ptmcad.ask.ranges.intervals`.

    Of a system that does not say what a stable solution is, all solutions are followed.
    """
    line = line_of(slice, along, at)
    axis = line.along
    value = number_for("--path", start)
    if not axis.low < value < axis.high:
        raise ConfigError(f"{value} is not inside the window of {along}, {axis.low} to {axis.high}", key="--path")
    numbers = tuple(n for n, _ in critical_values(line))
    if any(n.compare(value) == 0 for n in numbers) and not is_regular(line, value):
        raise ConfigError(f"{along} = {value} is a critical value: start beside it", key="--path")
    system = system_from(slice.model)
    family = LineSystem(slice.model, system, line.parameters)
    poses = exact_poses(slice.model, parameters_at(family, line, value), DIGITS)
    stable = range(len(poses.working))
    if number is not None and number - 1 not in stable:
        what = f"{len(stable)} {slice.model.criterion.poses}"
        raise ConfigError(f"{number} is none of the {what} at {along} = {value}, counted from 1", key="--pose")
    chosen = stable if number is None else (number - 1,)
    return PosePaths(
        slice.name,
        slice.model,
        axis,
        line.at,
        value,
        tuple(_path(family, line, numbers, poses.equilibria[k], k + 1, value) for k in chosen),
        moved(slice.model, line.parameters),
    )


def _path(
    family: LineSystem, line: Line, numbers: Sequence[AlgebraicNumber], pose: Pose, number: int, start: Fraction
) -> PosePath:
    box = at_value(family, start, _guess(pose))
    if box is None:
        raise ConfigError(
            f"pose {number} at {line.along.name} = {start} is too near to a degenerate one to be followed at "
            f"{BITS} bits: start farther away",
            key="--path",
        )
    origin = Reached(start, box, box)
    left = _one_way(family, line, [n for n in reversed(numbers) if n.compare(start) < 0], origin, -1)
    right = _one_way(family, line, [n for n in numbers if n.compare(start) > 0], origin, 1)
    reached = [*reversed(left[0]), origin, *right[0]]
    sides = [_sides(family, r.over.low, r.over.high, r.over.hull()) for r in reached]
    upright, reverse = (all(signs and set(signs) == {of} for signs in sides) for of in (1, -1))
    points = tuple(_point(family, r) for r in reached)
    return PosePath(number, start, points, left[1], right[1], upright, reverse)


def _guess(pose: Pose) -> Vector:
    with ctx.workprec(BITS):
        return tuple(ball_of(a.center) for a in (*pose.angles, *pose.reals))


def _sides(family: LineSystem, low: Fraction, high: Fraction, unknowns: Vector) -> tuple[int, ...]:
    """Of each rising point of a mechanism, 1 when it is proved above the x axis, -1 when below, else 0."""
    with ctx.workprec(BITS):
        heights = family.values_of(compiled(family.model).heights, low, high, unknowns)
        return tuple(1 if y > 0 else -1 if y < 0 else 0 for y in heights)


def _one_way(
    family: LineSystem, line: Line, numbers: Sequence[AlgebraicNumber], origin: Reached, side: int
) -> tuple[list[Reached], PathEnd]:
    """Follow a branch in one direction through all critical values that do not concern it."""
    window = line.along.high - line.along.low
    edge = line.along.high if side > 0 else line.along.low
    reached: list[Reached] = []
    current = origin
    for k, number in enumerate(numbers):
        near, far = ends_from(number, side)
        following = ends_from(numbers[k + 1], side)[0] if k + 1 < len(numbers) else edge
        gap = min(abs(near - current.value), abs(following - far)) / 8
        crossed, end = None, None
        for least in _distances(window, gap):
            while crossed is None and gap > least:
                after = beside(far, side, gap)
                steps, done = follow(family, current, beside(near, -side, gap), window / _MIN_STEPS)
                reached += steps
                current = steps[-1] if steps else current
                if not done:
                    return reached, PathEnd(Fate.UNDECIDED, number, _point(family, current))
                crossed = bridge(family, current, after)
                gap = gap / 4
            if crossed is not None:
                break
            end = _meeting(family, line, number, current, after)
            if len(end.meeting) > 1 or end.fate is Fate.VANISH:
                break
        if crossed is None:
            assert end is not None
            return reached, end
        if (fate := _condition(family, line, crossed)) is not None:
            return reached, PathEnd(fate, number, _point(family, current))
        reached.append(crossed)
        current = crossed
    steps, done = follow(family, current, beside(edge, -side, window / 10**6), window / _MIN_STEPS)
    reached += steps
    return reached, PathEnd(
        Fate.WINDOW if done else Fate.UNDECIDED, edge, _point(family, steps[-1] if steps else current)
    )


def _distances(window: Fraction, gap: Fraction) -> tuple[Fraction, Fraction]:
    """How near to a critical value a branch is followed before it is asked what it meets: at first, and at last.

    Where the next critical value is near, the distance is a part of that to it: a branch that only passes is bridged.
    """
    least = window * _MIN_DISTANCE
    first = least if gap > least else gap / 2**12
    return first, first / 2**10


def _condition(family: LineSystem, line: Line, reached: Reached) -> Fate | None:
    """What a solution loses at a critical value that it passes: an inequality, or stability that is given by signs."""
    system = family.system
    conditions = ((Fate.EXCLUDED, system.inequalities), (Fate.UNSTABLE, system.stability))
    for fate, p in ((fate, p) for fate, some in conditions for p in some):
        value = value_at(family, line, reached, p)
        if not value > 0:
            return fate if value < 0 else Fate.UNDECIDED
    return None


def _meeting(family: LineSystem, line: Line, number: AlgebraicNumber, current: Reached, after: Fraction) -> PathEnd:
    """Which solutions meet at a critical value that the path does not pass."""
    stopped = PathEnd(Fate.UNDECIDED, number, _point(family, current))
    found = what_meets(family, line, current, after)
    if found is None:
        return stopped
    stable = [s.place for s in found.beyond if s.negative == 0]
    told = _descends(family, line) and len(stable) == 1
    if len(found.meeting) == len(found.leaving) == 1 and not told:
        return stopped  # it goes on, and has not been followed
    met = replace(stopped, fate=Fate.VANISH, meeting=found.meeting, leaving=found.leaving, among=found.among)
    at = landing(family, line, number, found, current, stable[0]) if told else None
    if at is None:
        return met
    sides = _sides(family, number.low, number.high, tuple(_ball(u) for u in at.unknowns))
    return replace(
        met,
        fate=Fate.MERGE if 0 in found.leaving else Fate.SNAP,
        energy=at.energy,
        target=Target(at.unknowns[: family.angles], at.unknowns[family.angles :], sides),
        target_energy=at.target_energy,
    )


def _descends(family: LineSystem, line: Line) -> bool:
    """Whether every descent ends at an equilibrium: solutions are all critical points of one function on a torus."""
    system = family.system
    return system.is_on_torus and not (system.criterion.no_descent or moved(family.model, line.parameters))


def _ball(enclosure: Enclosure) -> arb:
    with ctx.workprec(BITS):
        return ball_over(enclosure.low, enclosure.high)


def _point(family: LineSystem, reached: Reached) -> PathPoint:
    with ctx.workprec(BITS):
        unknowns = tuple(map(enclosure_of, reached.point))
    sides = _sides(family, reached.value, reached.value, reached.point)
    return PathPoint(reached.value, unknowns[: family.angles], unknowns[family.angles :], sides)
