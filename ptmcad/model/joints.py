"""The joints of torsion springs: the points at which the parts meet whose directions a spring's
angle is between.

A part is a bar, a body, or the frame: the points that no unknown moves, and those that slide and do
not turn. As complex numbers, the way from one point of a rigid part to another is C exp(i n.u),
where n are whole numbers and u the angles: n is the part's direction. A spring on the angle m.u
belongs to a point at which parts meet whose directions differ by m or by -m.

Guarantee: exact; the direction is read off the derivatives by the unknowns. A joint is named only
where there is one such point, else none: the sides of a parallelogram have the same angle at two
points, and a description may show neither part. It is for drawings alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

from ptmcad.errors import ExpressionError
from ptmcad.model.description import Mechanism
from ptmcad.model.elements import Support, TorsionSpring
from ptmcad.model.evaluate import multiples
from ptmcad.model.identities import Points, PolynomialRing

MAX_WORK = 20_000
"""Products of terms for all the points' coordinates; larger ones have no derived joints."""
Direction = tuple[Fraction, ...]
"""The multiples of the angles."""
Meeting = dict[str, dict[Direction, tuple[str, ...]]]
"""The parts that meet at each point: by their directions the points of the first."""


class Joint(NamedTuple):
    """Where a torsion spring is drawn: at a point, its outer end towards another one, where there
    is one.
    """

    point: str
    towards: str = ""


@lru_cache(maxsize=8)
def joints_of(mechanism: Mechanism) -> tuple[Joint | None, ...]:
    """The joint of each torsion spring, in their order: where it says, else where it can be
    derived; else None.
    """
    if not mechanism.torsion:
        return ()
    meeting: Meeting = {}
    try:
        for points, direction in _parts(mechanism):
            for point in points:
                meeting.setdefault(point, {}).setdefault(direction, points)
    except ExpressionError:  # too large to be multiplied out
        meeting = {}
    return tuple(
        _joint_at(mechanism, spring.at) if spring.at else _derived(mechanism, meeting, spring)
        for spring in mechanism.torsion
    )


def torsion_springs(mechanism: Mechanism) -> tuple[tuple[TorsionSpring, Joint | None], ...]:
    """The torsion springs, each with its joint, where that is known."""
    return tuple(zip(mechanism.torsion, joints_of(mechanism), strict=True))


def _joint_at(mechanism: Mechanism, point: str) -> Joint:
    """At a point, towards the other end of the first bar there, or the next point of the first
    body.
    """
    for part in (*mechanism.bars, *mechanism.bodies.values()):
        others = [name for name in part if name != point]
        if point in part and others:
            return Joint(point, others[0])
    return Joint(point)


def _derived(mechanism: Mechanism, meeting: Meeting, spring: TorsionSpring) -> Joint | None:
    """The joint by the parts that meet at each point."""
    turned = multiples(spring.angle)
    angle = [turned.get(name, Fraction(0)) for name in _turning(mechanism)]
    if not any(angle):
        return None
    found: dict[str, tuple[str, ...]] = {}
    for point, parts in meeting.items():
        for direction in parts:
            other = tuple(m - n for m, n in zip(direction, angle, strict=True))
            if other in parts:
                # the later one: the frame, which is no arm, is the first of all
                found[point] = parts[max(direction, other, key=list(parts).index)]
    if len({mechanism.points[point] for point in found}) != 1:
        return None
    point, arm = next(iter(found.items()))
    return Joint(point, next(name for name in arm if name != point))


def _turning(mechanism: Mechanism) -> tuple[str, ...]:
    return (*mechanism.angles, *mechanism.followers)


def _parts(mechanism: Mechanism) -> Iterator[tuple[tuple[str, ...], Direction]]:
    """The frame, then bars and bodies, as far as they have a direction."""
    sliding = [name for name, kind in mechanism.supports.items() if kind is not Support.PIN]
    frame = tuple(n for n in mechanism.points if n not in mechanism.moving or n in sliding)
    yield (frame, tuple(Fraction(0) for _ in _turning(mechanism)))
    places = Points(mechanism, PolynomialRing(MAX_WORK))
    for points in (*mechanism.bars, *mechanism.bodies.values()):
        for pair in combinations(points, 2):
            turns = places.turning(*pair)
            if turns is not None and not any(turns[name] for name in mechanism.reals):
                yield (points, tuple(turns[name] for name in _turning(mechanism)))
                break
