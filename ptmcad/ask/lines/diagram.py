"""Bifurcation diagrams: all solutions at many values of one axis, joined to branches between the
critical values.

Guarantee: critical values are those of `ptmcad.intervals`, or the certified engine's with free
lengths; the solutions at each value are all there are. Between two neighbouring values they are
joined by nearness, each to one of the same Morse index; where that is ambiguous more values are
tried in between. The joins are no claim.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction
from math import cos, pi

from ptmcad.answer.paths import Branch, Branches, BranchPoint
from ptmcad.answer.poses import Pose
from ptmcad.answer.regionmap import Status
from ptmcad.ask.lines.along import intervals
from ptmcad.ask.quantities import Quantity, of_pose, quantity, unit_of
from ptmcad.ask.solving import poses_at
from ptmcad.options import Progress
from ptmcad.question.line import Line
from ptmcad.question.slice import Slice

SAMPLES = 24
"""Values in each interval, closer to its ends, where branches turn."""
NEAR = (Fraction(1, 10**5), Fraction(1, 10**4), Fraction(1, 1000))
"""... and these parts of its length from each end."""
HALVINGS = 5
"""Of the distance of two values between which a join is ambiguous."""
CLEAR = 0.6
"""A join is clear when it is shorter than this part of the next best."""
DIGITS = 6


_Sample = tuple[Fraction, tuple[Pose, ...]]
"""A value, and all solutions there."""


def branch_diagram(
    slice: Slice,
    found: SolutionsOnLine,
    names: Sequence[str],
    progress: Progress | None = None,
) -> Branches:
    """All branches of solutions on a line of a slice, with some quantities at each of their points.

    Parameters
    ----------
    found : the solutions on the line, some of which may be known from other questions.
    names : as `ptmcad.ask.quantities.quantity` takes them.
    progress : called as progress("branches: interval", done, total).

    Raises
    ------
    ConfigError
        For a name that the model does not have, and as the intervals do.
    """
    asked = [quantity(slice.model, name) for name in names]
    line = found.line
    branches: list[Branch] = []
    stretches = intervals(slice, line.along.name, line.at, digits=DIGITS).stretches
    for number, (low, high) in enumerate(stretches):
        if progress is not None:
            progress("branches: interval", number, len(stretches))
        branches += _joined(found.samples(low, high), asked)
    return Branches(
        slice.name,
        slice.model,
        line.along,
        line.at,
        tuple(q.name for q in asked),
        tuple(unit_of(q, slice) for q in asked),
        tuple(branches),
        tuple(found.undecided),
    )


class SolutionsOnLine:
    """The solutions on a line, each found when it is first asked for."""

    def __init__(self, line: Line, digits: int = DIGITS):
        self.line, self.digits = line, digits
        self.undecided: list[Fraction] = []
        self._known: dict[Fraction, tuple[Pose, ...] | None] = {}

    def at(self, value: Fraction) -> tuple[Pose, ...] | None:
        """The solutions at a value; None where they are not all known, or one is degenerate."""
        if value not in self._known:
            found = poses_at(self.line.model, self.line.values(value), self.digits)
            decided = found.status in (Status.EXACT, Status.CERTIFIED)
            self.undecided += () if decided else (value,)
            self._known[value] = found.equilibria if decided else None
        return self._known[value]

    def samples(self, low: Fraction, high: Fraction) -> list[_Sample]:
        """Solutions at values in an interval, close enough to be joined."""
        known = [(v, poses) for v in _values(low, high) if (poses := self.at(v)) is not None]
        result = known[:1]
        for sample in known[1:]:
            result += [*self._between(result[-1], sample, HALVINGS), sample]
        return result

    def _between(self, first: _Sample, second: _Sample, depth: int) -> list[_Sample]:
        if depth == 0 or _pairs(first[1], second[1])[1]:
            return []
        value = _short((first[0] + second[0]) / 2, second[0] - first[0])
        if (poses := self.at(value)) is None:
            return []
        middle = (value, poses)
        return [
            *self._between(first, middle, depth - 1),
            middle,
            *self._between(middle, second, depth - 1),
        ]


def _values(low: Fraction, high: Fraction) -> list[Fraction]:
    """Values in an interval, closer to both ends, where branches turn."""
    parts = {part for share in NEAR for part in (share, 1 - share)}
    parts |= {
        Fraction(round((1 - cos(pi * k / SAMPLES)) * 2**19), 2**20) for k in range(1, SAMPLES)
    }
    return [_short(low + part * (high - low), high - low) for part in sorted(parts)]


def _short(value: Fraction, width: Fraction) -> Fraction:
    """A number near a value with few digits, against the width of where it lies."""
    unit = 2**24 * (width.denominator // width.numerator + 1)
    return Fraction(round(value * unit), unit)


def _pairs(first: Sequence[Pose], second: Sequence[Pose]) -> tuple[dict[int, int], bool]:
    """For the solutions at one value those at the next that are nearest, and whether no other comes
    near to that.
    """
    before, after = (
        [[float(x) for x in (*p.cosines_sines, *p.reals)] for p in s] for s in (first, second)
    )
    distances = sorted(
        (sum((a - b) ** 2 for a, b in zip(before[i], after[j], strict=True)) ** 0.5, i, j)
        for i, p in enumerate(first)
        for j, q in enumerate(second)
        if (p.index, p.stable) == (q.index, q.stable)
    )
    pairs: dict[int, int] = {}
    lengths: dict[int, float] = {}
    for distance, i, j in distances:
        if i not in pairs and j not in pairs.values():
            pairs[i], lengths[i] = j, distance
    clear = all(
        lengths.get(i, 0.0) <= CLEAR * distance for distance, i, j in distances if pairs.get(i) != j
    )
    return pairs, clear and len(pairs) == len(before) == len(after)


def _joined(samples: Sequence[_Sample], asked: Sequence[Quantity]) -> list[Branch]:
    """The branches through the samples of an interval; one that finds no continuation ends."""
    if not samples:
        return []

    def point(value: Fraction, pose: Pose) -> BranchPoint:
        return BranchPoint(value, tuple(of_pose(q, pose) for q in asked))

    done: list[tuple[Pose, list[BranchPoint]]] = []
    (value, poses), *_ = samples
    growing = {k: (p, [point(value, p)]) for k, p in enumerate(poses)}
    for (_, first), (value, second) in itertools.pairwise(samples):
        pairs, _ = _pairs(first, second)
        done += [branch for k, branch in growing.items() if k not in pairs]
        following = {j: growing[i] for i, j in pairs.items()}
        for j, pose in enumerate(second):
            following.setdefault(j, (pose, []))[1].append(point(value, pose))
        growing = following
    done += growing.values()
    return [Branch(pose.stable, pose.index, tuple(points)) for pose, points in done]
