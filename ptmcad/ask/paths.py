"""Paths of stable poses along a line where springs have free lengths, from proved solution to
proved solution.

Guarantee: critical values are enclosed as `ptmcad.certified.intervals` encloses them; every point
of a path is a proved solution, the pose at the end of a snap is one of all the proved stable ones
there.

Not guaranteed: that the points of a path are one branch. From each to the next it is followed in
floating point by Newton's method in small parts, and found among the proved solutions again. Nor
which solutions meet where it vanishes: that is told by the numbers on both sides, of all solutions,
wherever they are. Where several stable poses are left, steepest descent in floating point says to
which of them it falls.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np

from ptmcad.answer.intervals import CertifiedChange, CertifiedIntervals
from ptmcad.answer.motion import Place
from ptmcad.answer.paths import Fate, PathEnd, PathPoint, PosePath
from ptmcad.answer.poses import Pose
from ptmcad.ask.branches import Sample, SolutionsOnLine, values_between
from ptmcad.ask.fields.course import Course
from ptmcad.ask.fields.descent import descent
from ptmcad.ask.fields.equations import Floats, apart, unknowns_of
from ptmcad.ask.fields.track import Track, followed
from ptmcad.ask.quantities import open_chain
from ptmcad.certified.intervals import certified_intervals
from ptmcad.certified.landing import landing, line_formulas, merger
from ptmcad.errors import ConfigError
from ptmcad.model import Mechanism
from ptmcad.question.line import varying_axis
from ptmcad.question.slice import Slice, moved, within_doubles
from ptmcad.text.enclosure import Enclosure

DIGITS = 12
POINTS = 16
"""In each interval, closer to its ends, where branches turn."""
NEAR = Fraction(1, 10**5)
"""How near to a critical value a path comes, against its interval's length, and to the window's
edge.
"""
SAME = 1e-5
_PI = (Fraction(314159265358979323846, 10**20), Fraction(314159265358979323847, 10**20))


def follower(slice: Slice, along: str, at: Mapping[str, Any], start: Fraction) -> JoinedFollower:
    """What follows the poses of a line on which springs have free lengths from one of its values.

    Raises
    ------
    ConfigError When the start is critical, or not distinguished from a critical value, and for
        closed loops.
    """
    mechanism = open_chain(slice.model)
    if mechanism is None:
        raise ConfigError(
            "poses of closed loops are not followed where springs have free lengths: leave --path out, and solve tells "
            "the poses at single points",
            key="--path",
        )
    intervals = certified_intervals(slice, along, at, DIGITS)
    varying, _, value = varying_axis(slice, along, at)
    line = SolutionsOnLine(slice, varying, value, DIGITS)
    inside = any(low < start < high for low, high in intervals.stretches)
    here = line.at(start) if inside else None
    if here is None:
        raise ConfigError(
            f"{along} = {start} is a critical value, or not told from one: start beside it",
            key="--path",
        )
    return JoinedFollower(slice, mechanism, line, here, (varying, value), intervals)


@dataclass(frozen=True, slots=True)
class _Reached:
    """The followed pose: at a value, in floating point with angles that go on beyond a turn, and as
    it is proved.
    """

    value: Fraction
    at: Floats
    pose: Pose


class JoinedFollower:
    """A line on which poses are followed from a value.

    Attributes
    ----------
    poses : all at the start.
    """

    def __init__(
        self,
        slice: Slice,
        mechanism: Mechanism,
        line: SolutionsOnLine,
        start: Sample,
        fixed: tuple[int, Fraction],
        intervals: CertifiedIntervals,
    ):
        self.slice, self.mechanism, self.line, self.start = slice, mechanism, line, start
        self.varying, self.fixed = fixed
        self.axis, self.intervals = intervals.along, intervals
        self.moved = moved(slice.model, line.parameters)

    @property
    def poses(self) -> tuple[Pose, ...]:
        return self.start.poses

    def path(self, number: int) -> PosePath:
        """One of the poses, counted from 1, in both directions."""
        pose, start = self.poses[number - 1], self.start.value
        origin = _Reached(start, unknowns_of(pose), pose)
        with within_doubles(self.slice):
            down, low = self._one_way(origin, -1)
            up, high = self._one_way(origin, 1)
        points = [self._point(r) for r in (*reversed(down), origin, *up)]
        return PosePath.of(number, start, points, (low, high), [point.sides for point in points])

    def _place(self, value: Fraction) -> Place:
        return (value, self.fixed) if self.varying == 0 else (self.fixed, value)

    def _one_way(self, origin: _Reached, side: int) -> tuple[list[_Reached], PathEnd]:
        edge = self.axis.high if side > 0 else self.axis.low
        course = Course((self._place(origin.value), self._place(edge)), (Fraction(0), Fraction(1)))
        track = Track(self.slice, course)
        reached: list[_Reached] = []
        current, done = origin, 0.0
        passed: CertifiedChange | None = None
        for value, ahead in self._values(origin.value, side):
            change = ahead or passed
            share = float((value - origin.value) / (edge - origin.value))
            at, further, leaves = followed(track, current.at, done, share, 0)
            if leaves:
                return reached, replace(self._undecided(current, change), fate=Fate.EXCLUDED)
            if further < share:
                return reached, self._ended(track, current, (at, share), value, change)
            sample = self.line.at(value)
            if sample is None:  # one point less: the pose is looked for among those of the next one
                passed = change
                continue
            pose = self._found(sample, at)
            if pose is None:
                return reached, self._undecided(current, change)
            if _is_pitchfork(change) and self._is_joined(track, current, done, pose, share):
                return reached, self._ended(track, current, (at, share), value, change)
            current, done, passed = _Reached(value, at, pose), share, None
            reached.append(current)
        return reached, PathEnd(Fate.WINDOW, edge, self._point(current))

    def _values(
        self, start: Fraction, side: int
    ) -> Iterator[tuple[Fraction, CertifiedChange | None]]:
        """Values from the start in one direction; with a change the first one beyond it."""
        stretches = self.intervals.stretches
        changes = list(self.intervals.changes)
        if side < 0:
            stretches = [(b, a) for a, b in reversed(stretches)]
        crossed: CertifiedChange | None = None
        for first, last in stretches:
            if (last - start) * side <= 0:
                continue
            for value in values_between(first, last, POINTS, (NEAR,)):
                if (value - start) * side > 0:
                    yield value, crossed
                    crossed = None
            ahead = [c for c in changes if (c.at.center - last) * side >= 0]
            crossed = min(ahead, key=lambda c: abs(c.at.center - last), default=None)

    def _found(self, sample: Sample, at: Floats) -> Pose | None:
        """The proved stable pose that is near, where there is exactly one."""
        near = [pose for pose in sample.poses if pose.stable and self._apart(at, pose) < SAME]
        return near[0] if len(near) == 1 else None

    def _apart(self, at: Floats, pose: Pose) -> float:
        gap = apart(unknowns_of(pose), at, len(self.slice.model.angles))
        return float(np.abs(gap).max())

    def _is_joined(
        self, track: Track, current: _Reached, done: float, beyond: Pose, share: float
    ) -> bool:
        """Whether another stable pose goes on as the one beyond a pitchfork, too."""
        before = self.line.at(current.value)
        for pose in () if before is None else before.poses:
            if pose.stable and self._apart(current.at, pose) > SAME:
                at, further, _ = followed(track, unknowns_of(pose), done, share, 0)
                if further == share and self._apart(at, beyond) < SAME:
                    return True
        return False

    def _undecided(self, current: _Reached, change: CertifiedChange | None) -> PathEnd:
        at = Enclosure(current.value, current.value) if change is None else change.at
        return PathEnd(Fate.UNDECIDED, at, self._point(current))

    def _ended(
        self,
        track: Track,
        current: _Reached,
        lost: tuple[Floats, float],
        value: Fraction,
        change: CertifiedChange | None,
    ) -> PathEnd:
        """What becomes of a pose that could not be followed to a value, where it has to be missing,
        or that at a pitchfork becomes one with others.
        """
        stopped = self._undecided(current, change)
        before, after = self.line.at(current.value), self.line.at(value)
        if change is None or before is None or after is None:
            return stopped
        counts = [Counter(p.index for p in s.poses if p.index is not None) for s in (before, after)]
        meeting, leaving = (tuple(sorted((a - b).elements())) for a, b in (counts, counts[::-1]))
        at, share = lost
        if _is_pitchfork(change):
            # of the three poses that meet there, or that one goes on as, the counts differ by two
            goes_on = track.solved(share, at)
            if goes_on is None or sorted(meeting + leaving) != [0, 1]:
                return stopped
            own = int(goes_on[1].negatives[0])
            meeting, leaving = (
                (tuple(sorted((own, *meeting))), (own,)) if meeting else ((0,), (0, *leaving))
            )
        if 0 not in meeting:
            return stopped
        met = replace(stopped, fate=Fate.VANISH, meeting=meeting, leaving=leaving)
        model = self.mechanism
        if self.moved or model.reals or leaving.count(0) > 1:
            return met
        way = descent(lambda point: track.at(share, point), at)
        goal = None if way is None else self._found(after, way[-1])
        if way is None or goal is None:
            return met
        merges = leaving == (0,)
        places = (self._point(current), self._point(_Reached(value, way[-1], goal)))
        line = line_formulas(model, self.line.parameters)
        found = (merger if merges else landing)(line, change.at, *places)
        if found is None:
            return met
        if not merges:  # a path's angles may have turned on; those of a pose that is jumped to are told as any pose's
            target = replace(found.target, angles=tuple(map(_principal, found.target.angles)))
            found = found._replace(target=target)
        return replace(met, fate=Fate.MERGE if merges else Fate.SNAP, **found._asdict())

    def _point(self, reached: _Reached) -> PathPoint:
        pose = reached.pose
        angles = [
            _on_turn(angle, float(v)) for angle, v in zip(pose.angles, reached.at, strict=False)
        ]
        sides = _sides(pose, self.mechanism.rising)
        return PathPoint(reached.value, tuple(angles), pose.reals, sides)


def _is_pitchfork(change: CertifiedChange | None) -> bool:
    return change is not None and change.proved and change.names == ("pitchfork",)


def _on_turn(angle: Enclosure, near: float) -> Enclosure:
    """The angle with as many whole turns as bring it near a value."""
    turns = round((near - float(angle)) / (2 * pi))
    low, high = sorted(2 * turns * end for end in _PI)
    return Enclosure(angle.low + low, angle.high + high)


def _principal(angle: Enclosure) -> Enclosure:
    return _on_turn(angle, 0.0)


def _sides(pose: Pose, rising: Sequence[str]) -> tuple[int, ...]:
    """Of each rising point 1 when it is proved above the x axis, -1 when below, else 0."""
    heights = [pose.nodes[name][1] for name in rising]
    return tuple(1 if y.low > 0 else -1 if y.high < 0 else 0 for y in heights)
