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
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

from flint import ctx

from ptmcad.answer.paths import Fate, PathEnd, PathPoint, PosePath
from ptmcad.answer.poses import Pose
from ptmcad.errors import ConfigError
from ptmcad.exact.exactposes import exact_poses
from ptmcad.exact.ranges.equations import LineSystem, line_system
from ptmcad.exact.ranges.landing import DIGITS, beside, ends_from, landing
from ptmcad.exact.ranges.line import critical_values, is_regular
from ptmcad.exact.ranges.meeting import what_meets
from ptmcad.formulas.continuation import BITS, Reached, Vector, at_value, bridge, follow
from ptmcad.question.line import line_of
from ptmcad.question.slice import Slice, moved
from ptmcad.text.balls import ball_of, enclosure_of
from ptmcad.text.enclosure import AlgebraicNumber

_MIN_DISTANCE = Fraction(1, 10**5)
"""How near to a critical value a branch is followed, against the window's width."""

_MIN_STEPS = 64
"""The longest step is this part of the window, so that a polyline through the points looks smooth.
"""


class ExactFollower(NamedTuple):
    """A line on which poses are followed from a value that is not critical.

    Attributes
    ----------
    critical : the critical values of the line in the window, in increasing order.
    poses : all at the start.
    """

    family: LineSystem
    critical: tuple[AlgebraicNumber, ...]
    start: Fraction
    poses: tuple[Pose, ...]

    def path(self, number: int) -> PosePath:
        """One of the poses, counted from 1, in both directions.

        Raises
        ------
        ConfigError
            Where it is too near to a degenerate one.
        """
        family, start, pose = self.family, self.start, self.poses[number - 1]
        box = at_value(family.branches, start, _guess(pose))
        if box is None:
            raise ConfigError(
                f"pose {number} at {family.line.along.name} = {start} is too near to a degenerate one to be followed "
                f"at {BITS} bits: start farther away",
                key="--path",
            )
        origin = Reached(start, box, box)
        left = _one_way(
            family, [n for n in reversed(self.critical) if n.compare(start) < 0], origin, -1
        )
        right = _one_way(family, [n for n in self.critical if n.compare(start) > 0], origin, 1)
        reached = [*reversed(left[0]), origin, *right[0]]
        sides = [family.sides(r.over.low, r.over.high, r.over.hull()) for r in reached]
        return PosePath.of(
            number, start, [_point(family, r) for r in reached], (left[1], right[1]), sides
        )


def follower(slice: Slice, along: str, at: Mapping[str, Any], start: Fraction) -> ExactFollower:
    """What follows the poses of a line from one of its values.

    Raises
    ------
    ConfigError
        When the start is critical, and as `ptmcad.question.line.line_of`.
    HypothesisError
        As for `ptmcad.ask.ranges.intervals`.
    """
    line = line_of(slice, along, at)
    numbers = tuple(n for n, _ in critical_values(line))
    if any(n.compare(start) == 0 for n in numbers) and not is_regular(line, start):
        raise ConfigError(f"{along} = {start} is a critical value: start beside it", key="--path")
    poses = exact_poses(slice.model, line.values(start), DIGITS).equilibria
    return ExactFollower(line_system(line), numbers, start, poses)


def _guess(pose: Pose) -> Vector:
    with ctx.workprec(BITS):
        return tuple(ball_of(a.center) for a in (*pose.angles, *pose.reals))


def _one_way(
    family: LineSystem, numbers: Sequence[AlgebraicNumber], origin: Reached, side: int
) -> tuple[list[Reached], PathEnd]:
    """Follow a branch in one direction through all critical values that do not concern it."""
    window = family.line.along.width
    edge = family.line.along.high if side > 0 else family.line.along.low
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
            end = _meeting(family, number, current, after)
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


def _distances(window: Fraction, gap: Fraction) -> tuple[Fraction, Fraction]:
    """How near to a critical value a branch is followed before it is asked what it meets: at first,
    and at last.

    Where the next critical value is near, the distance is a part of that to it: a branch that only
    passes is bridged.
    """
    least = window * _MIN_DISTANCE
    first = least if gap > least else gap / 2**12
    return first, first / 2**10


def _condition(family: LineSystem, reached: Reached) -> Fate | None:
    """What a solution loses at a critical value that it passes: an inequality, or stability that is
    given by signs.
    """
    conditions = (
        (Fate.EXCLUDED, family.formulas.inequalities),
        (Fate.UNSTABLE, family.formulas.stability),
    )
    for fate, formula in ((fate, f) for fate, some in conditions for f in some):
        (value,) = family.values_at([formula], reached)
        if not value > 0:
            return fate if value < 0 else Fate.UNDECIDED
    return None


def _meeting(
    family: LineSystem, number: AlgebraicNumber, current: Reached, after: Fraction
) -> PathEnd:
    """Which solutions meet at a critical value that the path does not pass."""
    stopped = PathEnd(Fate.UNDECIDED, number, _point(family, current))
    found = what_meets(family, current, after)
    if found is None:
        return stopped
    stable = [s.place for s in found.beyond if s.negative == 0]
    told = _descends(family) and len(stable) == 1
    if len(found.meeting) == len(found.leaving) == 1 and not told:
        return stopped  # it goes on, and has not been followed
    met = replace(
        stopped, fate=Fate.VANISH, meeting=found.meeting, leaving=found.leaving, among=found.among
    )
    landed = landing(family, number, found, current, stable[0]) if told else None
    if landed is None:
        return met
    return replace(met, fate=Fate.MERGE if 0 in found.leaving else Fate.SNAP, **landed._asdict())


def _descends(family: LineSystem) -> bool:
    """Whether every descent ends at an equilibrium: solutions are all critical points of one
    function on a torus.
    """
    system = family.system
    return system.is_on_torus and not (
        system.criterion.no_descent or moved(family.line.model, family.line.parameters)
    )


def _point(family: LineSystem, reached: Reached) -> PathPoint:
    with ctx.workprec(BITS):
        unknowns = tuple(map(enclosure_of, reached.point))
    sides = family.sides(reached.value, reached.value, reached.point)
    return PathPoint(reached.value, unknowns[: family.angles], unknowns[family.angles :], sides)
