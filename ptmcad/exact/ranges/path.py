"""Paths of stable poses along a line: how far each one can be followed, and where it snaps to.

Guarantee: the pose at every step of a path is the same branch (`tracking`). A branch that is said to end at a critical
value is not continued beyond it: all equilibria on the far side but those named were reached from other equilibria.

Where a stable pose vanishes one stable pose is left, as there are never more than two (theorem 1 of docs/method.md).
From the place where the first one was, the energy descends to the one that is left: every descent ends at an
equilibrium, and all but those that run exactly into a saddle end at a minimum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import arb, ctx

from ptmcad.algebra.polynomials import from_fraction, to_fraction
from ptmcad.algebra.real_roots import simplest_between
from ptmcad.answer.paths import Fate, PathEnd, PathPoint, PosePath, PosePaths
from ptmcad.answer.poses import Pose
from ptmcad.errors import ConfigError
from ptmcad.exact.counting import equilibria
from ptmcad.exact.models import ParametricSystem, system_from
from ptmcad.exact.models.system import polynomial_at
from ptmcad.exact.poses import exact_poses
from ptmcad.exact.ranges.line import critical_values
from ptmcad.exact.ranges.tracking import BITS, Family, Pair, Reached, at_value, bridge, follow
from ptmcad.question.line import Line, line_of
from ptmcad.question.slice import Slice
from ptmcad.text.balls import enclosure_of
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.parsing import number_for

DIGITS = 12
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
    """
    line = line_of(slice, along, at)
    axis = line.along
    value = number_for("--path", start)
    if not axis.low < value < axis.high:
        raise ConfigError(f"{value} is outside the window of {along}, {axis.low} to {axis.high}", key="--path")
    numbers = tuple(n for n, _ in critical_values(line))
    if any(n.compare(value) == 0 for n in numbers):
        raise ConfigError(f"{along} = {value} is a critical value: start beside it", key="--path")
    system = system_from(slice.model)
    poses = exact_poses(slice.model, _parameters(system, line, value), DIGITS)
    stable = [k for k, pose in enumerate(poses.equilibria) if pose.stable]
    if number is not None and number - 1 not in stable:
        raise ConfigError(
            f"{number} is none of the {len(stable)} stable poses at {along} = {value}, counted from 1", key="--pose"
        )
    family = Family(system, line.parameters)
    chosen = stable if number is None else [number - 1]
    return PosePaths(
        slice.name,
        axis,
        line.at,
        value,
        tuple(_path(family, line, numbers, poses.equilibria[k], k + 1, value) for k in chosen),
    )


def _parameters(system: ParametricSystem, line: Line, value: Fraction) -> dict[str, Fraction]:
    used = system.ring.parameters
    return {n: e.evaluate(value, Fraction(0)) for n, e in line.parameters.items() if n in used}


def _path(
    family: Family, line: Line, numbers: Sequence[AlgebraicNumber], pose: Pose, number: int, start: Fraction
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
    with ctx.workprec(BITS):
        sines = [(a.sin(), b.sin()) for a, b in (r.over.hull() for r in reached)]
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
        while crossed is None and gap > window * _MIN_DISTANCE:
            after = _beside(far, side, gap)
            steps, done = follow(family, current, _beside(near, -side, gap), window / _MIN_STEPS)
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
    steps, done = follow(family, current, _beside(edge, -side, window / 10**6), window / _MIN_STEPS)
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
    stopped = PathEnd(Fate.UNDECIDED, number, _point(current))
    before, beyond = _equilibria(family, line, current.value), _equilibria(family, line, after)
    if before is None or beyond is None:
        return stopped
    stable = [place for place, negative in beyond if negative == 0]
    meeting, own = [], False
    for place, negative in before:
        ours = _close(place.angles, current.angles)
        across = None if ours else bridge(family, place, after)
        if across is None:
            meeting.append(negative)
            own = own or ours
        else:
            images = [k for k, (image, _) in enumerate(beyond) if _close(across.angles, image.angles)]
            if len(images) != 1:
                return stopped
            del beyond[images[0]]
    leaving = [negative for _, negative in beyond]
    if not own or len(stable) != 1:
        return stopped
    return PathEnd(
        Fate.MERGE if 0 in leaving else Fate.SNAP,
        number,
        _point(current),
        tuple(sorted(meeting)),
        tuple(sorted(leaving)),
        _energy(family, line, current),
        _point(stable[0]),
        _energy(family, line, stable[0]),
    )


def _equilibria(family: Family, line: Line, value: Fraction) -> list[tuple[Reached, int]] | None:
    """All equilibria at a value that is not critical, with their Morse indices; None when one was not enclosed."""
    values = _parameters(family.system, line, value)
    found = []
    for solution in equilibria(family.system, {n: from_fraction(v) for n, v in values.items()}).solutions:
        with ctx.workprec(BITS):
            c1, s1, c2, s2 = (arb(x) for x in solution.center)
            guess = (arb.atan2(s1, c1), arb.atan2(s2, c2))
        place = at_value(family, value, guess)
        if place is None:
            return None
        found.append((Reached(value, place, place), solution.signs.count("-")))
    return found


def _energy(family: Family, line: Line, reached: Reached) -> Enclosure:
    """The potential at a place."""
    values = {n: from_fraction(v) for n, v in _parameters(family.system, line, reached.value).items()}
    potential = family.system.potential
    assert potential is not None  # `Family` has refused other systems
    with ctx.workprec(BITS):
        unknowns = [f(a) for a in reached.angles for f in (arb.cos, arb.sin)]
        total = arb(0)
        for monomial, coefficient in polynomial_at(family.system, potential, values).items():
            term = arb(coefficient)
            for value, e in zip(unknowns, monomial, strict=True):
                for _ in range(e):
                    term = term * value
            total += term
        return enclosure_of(total)


def _close(first: Pair, second: Pair) -> bool:
    """Whether the boxes overlap, whole turns apart."""
    with ctx.workprec(BITS):
        return all(((a - b) / 2).sin().contains(0) for a, b in zip(first, second, strict=True))


def _point(reached: Reached) -> PathPoint:
    with ctx.workprec(BITS):
        first, second = map(enclosure_of, reached.angles)
    return PathPoint(reached.value, (first, second))
