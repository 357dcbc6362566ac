"""Paths of stable poses along a line: how far each one can be followed, and where it snaps to.

Guarantee: the pose at every step of a path is the same branch (`ptmcad.formulas.continuation`).
What a branch is said to meet at a critical value, and that it vanishes there, is proved
(`meeting`); that it is not bridged is not enough for that.

Where a stable pose vanishes and one is left, as always with the paper's mechanism, which never has
more than two (theorem 1 of docs/method.md), the energy descends to it from the place where the
first one was: on a torus every descent of a function ends at an equilibrium, and all but those that
run exactly into a saddle end at a minimum. Where several are left, where unknowns are on the line,
where there is no energy, and where a moment works, nothing is said about where a solution goes: a
moment turns a bar for ever where nothing stops it, as the energy less its work is lower by each
turn.

Not guaranteed: with free lengths, where several stable poses are left, steepest descent in floating
point chooses that to which the mechanism snaps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
from flint import ctx

from ptmcad.answer.intervals import Change
from ptmcad.answer.paths import Fate, PathEnd, PathPoint, PosePath, PosePaths
from ptmcad.answer.poses import Pose
from ptmcad.ask.fields.descent import descent
from ptmcad.ask.fields.equations import Floats, apart, state_at
from ptmcad.ask.lines.landing import CriticalValue, beside, ends_from, landed
from ptmcad.ask.lines.linesystem import DIGITS, LineSystem, guess_of, line_system
from ptmcad.ask.lines.meeting import Meeting, PlacedSolution, what_meets
from ptmcad.ask.quantities import open_chain
from ptmcad.errors import ConfigError
from ptmcad.formulas.continuation import BITS, Reached, at_value, bridge, follow
from ptmcad.options import Progress
from ptmcad.question.line import Line, has_free_lengths, line_of, varying_axis
from ptmcad.question.slice import Slice, moved, within_doubles
from ptmcad.text.balls import enclosure_of
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.parsing import number_for

_MIN_DISTANCE = Fraction(1, 10**5)
"""How near to a critical value a branch is followed, against the window's width."""

_MIN_STEPS = 64
"""The longest step is this part of the window, so that a polyline through the points looks smooth.
"""
_SAME = 1e-5
"""How near the end of a descent is to a proved pose in each unknown."""


def pose_paths(
    slice: Slice,
    along: str,
    at: Mapping[str, Any],
    start: object,
    number: int | None = None,
    progress: Progress | None = None,
) -> PosePaths:
    """Follow stable poses along a line, from their places at one value of the axis.

    Parameters
    ----------
    start : the value, inside the window and not critical.
    number : which pose, counted from 1 as ``ptmcad solve`` lists them; None for every stable one.
    progress : with free lengths called as progress("paths: pose", done, total).

    Raises
    ------
    ConfigError
        When the start is outside the window or critical, or there is no such stable pose.
    HypothesisError
        As for `ptmcad.intervals`.

    Of a system that does not say what a stable solution is, all solutions are followed.
    """
    criterion, begin = slice.model.criterion, number_for("--path", start)
    family, critical, here = _solved(slice, along, at, begin)
    stable = [k for k, pose in enumerate(here, 1) if criterion.works(pose.stable)]
    if number is not None and number not in stable:
        what = f"{len(stable)} {criterion.poses}"
        raise ConfigError(
            f"{number} is none of the {what} at {along} = {begin}, counted from 1", key="--pose"
        )
    found = []
    chosen = stable if number is None else [number]
    for done, k in enumerate(chosen):
        if family.lengths and progress is not None:
            progress("paths: pose", done, len(chosen))
        with within_doubles(slice):
            found.append(_path(family, critical, begin, k, here[k - 1]))
    line = family.line
    rests = moved(slice.model, line.parameters)
    return PosePaths(slice.name, slice.model, line.along, line.at, begin, tuple(found), rests)


def _solved(
    slice: Slice, along: str, at: Mapping[str, Any], begin: Fraction
) -> tuple[LineSystem, tuple[Change, ...], tuple[Pose, ...]]:
    """The line's system, its critical values in the window, and the solutions at the start.

    Raises
    ------
    ConfigError
        As `pose_paths` does.
    """
    axis = slice.axes[varying_axis(slice, along, at)[0]]
    if not axis.holds(begin):
        raise ConfigError(
            f"{begin} is not inside the window of {along}, {axis.low} to {axis.high}", key="--path"
        )
    enclosed = has_free_lengths(slice, along, at)
    if enclosed and open_chain(slice.model) is None:
        raise ConfigError(
            "poses of closed loops are not followed where springs have free lengths: leave --path out, and solve tells "
            "the poses at single points",
            key="--path",
        )
    line = line_of(slice, along, at, free=enclosed)
    critical = _changes_on(slice, line, enclosed=enclosed)
    family = line_system(line)
    is_open = enclosed and any(_order(c.at, begin) == 0 for c in critical)
    here = None if is_open else family.solutions.at(begin)
    if here is None:
        doubt = ", or not distinguished from one" * enclosed
        raise ConfigError(
            f"{along} = {begin} is a critical value{doubt}: start beside it", key="--path"
        )
    return family, critical, here


def _changes_on(slice: Slice, line: Line, *, enclosed: bool) -> tuple[Change, ...]:
    """The critical values of a line; nothing is counted on the sides of exact ones."""
    if enclosed:
        from ptmcad.ask.lines.along import certified_intervals

        return certified_intervals(slice, line.along.name, line.at, DIGITS).changes
    from ptmcad.exact.ranges.exactline import critical_values

    return tuple(Change(number, None, None) for number, _ in critical_values(line))


def _order(number: CriticalValue, value: Fraction) -> int:
    """The sign of a critical value less another value; 0 where they cannot be distinguished."""
    if isinstance(number, Enclosure):
        return (number.low > value) - (number.high < value)
    return number.compare(value)


def _path(
    family: LineSystem, critical: Sequence[Change], start: Fraction, number: int, pose: Pose
) -> PosePath:
    """One of the poses, counted from 1, in both directions.

    Parameters
    ----------
    critical : the critical values of the line in the window, in increasing order.

    Raises
    ------
    ConfigError
        Where it is too near to a degenerate one.
    """
    box = at_value(family.branches, start, guess_of(pose))
    if box is None:
        raise ConfigError(
            f"pose {number} at {family.line.along.name} = {start} is too near to a degenerate one to be followed "
            f"at {BITS} bits: start farther away",
            key="--path",
        )
    origin = Reached(start, box, box)
    left, right = (
        _one_way(
            family, [c for c in critical[::side] if _order(c.at, start) * side > 0], origin, side
        )
        for side in (-1, 1)
    )
    reached = [*reversed(left[0]), origin, *right[0]]
    sides = [family.sides(r.over.low, r.over.high, r.over.hull()) for r in reached]
    return PosePath.of(
        number, start, [_point(family, r) for r in reached], (left[1], right[1]), sides
    )


def _one_way(
    family: LineSystem, numbers: Sequence[Change], origin: Reached, side: int
) -> tuple[list[Reached], PathEnd]:
    """Follow a branch in one direction through all critical values that do not concern it."""
    window = family.line.along.width
    edge = family.line.along.high if side > 0 else family.line.along.low
    reached: list[Reached] = []
    current = origin
    for k, critical in enumerate(numbers):
        number = critical.at
        near, far = ends_from(number, side)
        following = ends_from(numbers[k + 1].at, side)[0] if k + 1 < len(numbers) else edge
        gap = min(abs(near - current.value), abs(following - far)) / 8
        crossed, end = None, None
        for least in _distances(family, gap):
            while crossed is None and gap > least:
                after = beside(far, side, gap)
                steps, done = follow(
                    family.branches, current, beside(near, -side, gap), window / _MIN_STEPS
                )
                reached += steps
                current = steps[-1] if steps else current
                if not done:
                    return reached, PathEnd(Fate.UNDECIDED, number, _point(family, current))
                crossed = bridge(family.branches, current, after)
                gap = gap / 4
            if crossed is not None:
                break
            end = _meeting(family, critical, current, after)
            if len(end.meeting) > 1 or end.fate is Fate.VANISH:
                break
        if crossed is None:
            assert end is not None
            return reached, end
        if (fate := _condition(family, crossed)) is not None:
            return reached, PathEnd(fate, number, _point(family, current))
        reached.append(crossed)
        current = crossed
    steps, done = follow(
        family.branches, current, beside(edge, -side, window / 10**6), window / _MIN_STEPS
    )
    reached += steps
    return reached, PathEnd(
        Fate.WINDOW if done else Fate.UNDECIDED,
        edge,
        _point(family, steps[-1] if steps else current),
    )


def _meeting(family: LineSystem, critical: Change, current: Reached, after: Fraction) -> PathEnd:
    """Which solutions meet at a critical value that the path does not pass."""
    stopped = PathEnd(Fate.UNDECIDED, critical.at, _point(family, current))
    found = what_meets(family, current, after) if critical.proved else None
    if found is None:
        return stopped
    goal = _goal(family, found, current, after) if _descends(family) else None
    if len(found.meeting) == len(found.leaving) == 1 and goal is None:
        return stopped  # it goes on, and has not been followed
    met = replace(
        stopped,
        fate=Fate.VANISH,
        meeting=found.meeting,
        leaving=found.leaving,
        among=found.among,
    )
    end = None if goal is None else landed(family, met, found, current, goal.place)
    if end is None:
        return met
    several = sum(s.negative == 0 for s in found.beyond) > 1
    return replace(end, fallen=end.fate is Fate.SNAP and several)


def _goal(
    family: LineSystem, met: Meeting, current: Reached, after: Fraction
) -> PlacedSolution | None:
    """The stable pose beyond to which the energy descends: the only one, or that of steepest
    descent.
    """
    stable = [s for s in met.beyond if s.negative == 0]
    if len(stable) == 1:
        return stable[0]
    if not family.lengths or met.leaving.count(0) > 1:
        return None
    model = family.line.model
    values = {name: float(value) for name, value in family.line.values(after).items()}
    way = descent(lambda at: state_at(model, values, at), _floats(current))
    if way is None:
        return None
    gaps = (apart(way[-1], _floats(s.place), family.angles) for s in stable)
    near = [s for s, gap in zip(stable, gaps, strict=True) if abs(gap).max() < _SAME]
    return near[0] if len(near) == 1 else None


def _point(family: LineSystem, reached: Reached) -> PathPoint:
    with ctx.workprec(BITS):
        unknowns = tuple(map(enclosure_of, reached.point))
    sides = family.sides(reached.value, reached.value, reached.point)
    return PathPoint(reached.value, unknowns[: family.angles], unknowns[family.angles :], sides)


def _distances(family: LineSystem, gap: Fraction) -> tuple[Fraction, ...]:
    """How near to a critical value a branch is followed each time before it is decided what it
    meets.

    Where the next critical value is near, the distance is a part of that to it: a branch that only
    passes is bridged. With free lengths solutions are not separated as near as without.
    """
    least = family.line.along.width * _MIN_DISTANCE
    first = least if gap > least else gap / 2**12
    return tuple(first / 2**bits for bits in ((0, 3, 6, 10) if family.lengths else (0, 10)))


def _condition(family: LineSystem, reached: Reached) -> Fate | None:
    """What a solution loses at a critical value that it passes: an inequality, or stability that is
    given by signs.
    """
    conditions = (
        (Fate.EXCLUDED, family.formulas.inequalities),
        (Fate.UNSTABLE, family.formulas.stability),
    )
    for fate, formulas in conditions:
        for value in family.values_at(formulas, reached):
            if not value > 0:
                return fate if value < 0 else Fate.UNDECIDED
    return None


def _descends(family: LineSystem) -> bool:
    """Whether every descent ends at an equilibrium: solutions are all critical points of one
    function on a torus.
    """
    model = family.line.model
    return family.is_on_torus and not (
        model.criterion.no_descent or moved(model, family.line.parameters)
    )


def _floats(reached: Reached) -> Floats:
    return np.array([float(x) for x in reached.point])
