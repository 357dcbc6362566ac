"""What holds at the critical value at which a branch ends: the pose that is reached there, and the
energies.

Guarantee: every enclosure holds the number at the critical value itself, wherever that lies in its
isolating interval; so it does not depend on where a path began. A pose that is simple there is
carried to it by tubes. Poses that merge there are enclosed by a region that none of them leaves
meanwhile (`meeting`), or by what a symmetry or an exact solution at a rational value says of them.
An energy is that at a place beside, which differs by no more than the distance times the largest
slope: along a branch of critical points the energy changes with the parameter alone, which is
bounded on the torus.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import pi

from flint import arb, ctx

from ptmcad.answer.paths import Fate, PathEnd, Target
from ptmcad.ask.lines.linesystem import DIGITS, LineSystem
from ptmcad.ask.lines.meeting import Meeting, what_meets
from ptmcad.exact.exactposes import exact_poses
from ptmcad.formulas.continuation import BITS, Reached, in_the_limit, nearer, over_range
from ptmcad.text.balls import ball_over, enclosure_of
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.flint_numbers import simplest_fraction

CriticalValue = AlgebraicNumber | Enclosure
"""Exact, or enclosed where springs have free lengths."""
_NEAREST = Fraction(1, 2**56)
"""How near to a critical value branches are followed for what holds there, against the window's
width.
"""


def landed(
    family: LineSystem, end: PathEnd, met: Meeting, current: Reached, target: Reached
) -> PathEnd | None:
    """The end of a path with what holds at its critical value; None where the pose that is reached
    is not proved.

    Its angles are not wrapped into one turn.

    Parameters
    ----------
    end : at the only critical value between ``current`` and ``target``.
    met : what the branch meets there.
    target : the only stable pose beyond.
    """
    number = end.at
    assert not isinstance(number, Fraction)  # which is the window's edge
    potential = family.potential
    assert potential is not None  # snaps and mergers are those of a potential

    def energy(place: Reached) -> Enclosure:
        found = in_the_limit(potential, place, number.low, number.high, family.angles)
        with ctx.workprec(BITS):
            return enclosure_of(found)

    side = 1 if target.value > current.value else -1
    distance = family.line.along.width * _NEAREST
    near, far = ends_from(number, side)
    before = nearer(family.branches, current, beside(near, -side, distance))
    after = nearer(family.branches, target, beside(far, side, distance))
    at = None
    if 0 in met.leaving:
        unknowns = _merged(family, number, before, after)
    else:
        at = over_range(family.branches, after, number.low, number.high)
        with ctx.workprec(BITS):
            unknowns = None if at is None else tuple(map(enclosure_of, at.hull()))
    if unknowns is None:
        return None
    with ctx.workprec(BITS):
        sides = family.sides(
            number.low, number.high, tuple(ball_over(u.low, u.high) for u in unknowns)
        )
    reached = Target(unknowns[: family.angles], unknowns[family.angles :], sides)
    return replace(
        end,
        fate=Fate.SNAP if at is not None else Fate.MERGE,
        target=reached,
        energy=energy(before),
        target_energy=energy(before if at is None else Reached(near, at, at)),
    )


def ends_from(number: CriticalValue, side: int) -> tuple[Fraction, Fraction]:
    """The near and the far end of an isolating interval, seen by one who goes to this side."""
    return (number.low, number.high) if side > 0 else (number.high, number.low)


def beside(value: Fraction, side: int, gap: Fraction) -> Fraction:
    """A short rational at a distance between gap / 2 and gap, at one side."""
    return simplest_fraction(value + side * gap / 2, value + side * gap)


def _merged(
    family: LineSystem, number: CriticalValue, before: Reached, after: Reached
) -> tuple[Enclosure, ...] | None:
    """The pose in which several merge, at the critical value between two places."""
    found = what_meets(family, before, after.value)
    if found is None or found.box is None:
        return None
    with ctx.workprec(BITS):
        region = list(map(enclosure_of, found.box))
        for k, mirror in found.fixed.items():
            angle = mirror.angle(number.low, number.high)
            if k >= family.angles:
                region[k] = Enclosure(Fraction(0), Fraction(0))
            elif angle is not None:
                region[k] = _half_turned(region[k], angle)
    if isinstance(number, Enclosure) or number.exact is None:
        return tuple(region)
    poses = exact_poses(family.line.model, family.line.values(number.exact), DIGITS).equilibria
    near = [_turned((*pose.angles, *pose.reals), region, family.angles) for pose in poses]
    inside = [p for p in near if _overlap(p, region)]
    return inside[0] if len(inside) == 1 else tuple(region)


def _half_turned(x: Enclosure, angle: arb) -> Enclosure:
    """An unknown that is an angle up to half turns; as it is where several of these are in its
    enclosure.
    """
    nearest = round((float(x) - float(angle)) / pi)
    turned = [
        enclosure_of(angle + n * arb.pi()) for n in range(nearest - 2, nearest + 3)
    ]  # it is less than 6 wide
    within = [t for t in turned if _overlap((t,), (x,))]
    return within[0] if len(within) == 1 else x


def _turned(
    pose: Sequence[Enclosure], region: Sequence[Enclosure], angles: int
) -> tuple[Enclosure, ...]:
    """A pose with its angles whole turns further, as near to a region as they come."""
    turned = list(pose)
    with ctx.workprec(BITS):
        for k in range(angles):
            turns = round((float(region[k]) - float(pose[k])) / (2 * pi))
            if turns:
                ball = ball_over(pose[k].low, pose[k].high) + 2 * turns * arb.pi()
                turned[k] = enclosure_of(ball)
    return tuple(turned)


def _overlap(first: Sequence[Enclosure], second: Sequence[Enclosure]) -> bool:
    return all(a.low <= b.high and b.low <= a.high for a, b in zip(first, second, strict=True))
