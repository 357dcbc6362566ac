"""Equilibria at which torsion springs at rest, or half a turn from it, make all directions rational.

Guarantee: exact. The directions are a guess, by balls; they are taken only where the energy's gradient there is
rational and zero, and the place lies in a box that holds no other equilibrium.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb

from ptmcad.certified.plain.jets import rational_energy
from ptmcad.certified.plain.symmetric import QUARTERS, Point, fixed_turns, point_of
from ptmcad.mechanism import Mechanism
from ptmcad.mechanism.description import TorsionSpring
from ptmcad.mechanism.evaluate import multiples
from ptmcad.text.balls import ball_of

Direction = tuple[Fraction, Fraction]
"""Cosine and sine."""


def rational_point(
    mechanism: Mechanism, parameters: Mapping[str, Fraction], held: Mapping[str, arb], boxes: Mapping[str, arb]
) -> Point:
    """The values of those unknowns of an equilibrium that are proved to be rational, by symmetry or rest.

    Parameters
    ----------
    held : balls around the equilibrium.
    boxes : wider ones, which together hold no other solution.
    """
    turns = fixed_turns(mechanism, parameters, held, boxes)
    resting = {} if turns.keys() == mechanism.unknowns.keys() else _at_rest(mechanism, parameters, held, boxes)
    return resting or point_of(mechanism, turns)


def _at_rest(
    mechanism: Mechanism, parameters: Mapping[str, Fraction], held: Mapping[str, arb], boxes: Mapping[str, arb]
) -> Point:
    """The values of all unknowns, where they are proved to be rational by rest; nothing without a proof."""
    directions = _directions(mechanism, held)
    if not directions or mechanism.moments:
        return {}
    at: Point = {}
    for name in mechanism.unknowns:
        place = arb(0)
        if name in mechanism.angles:
            direction = directions.get(name) or _quarter(held[name])
            at |= {f"cos {name}": direction[0], f"sin {name}": direction[1]}
            place = _angle(direction)
            turns = round(float((held[name] - place) / (2 * arb.pi())))
            place += 2 * arb.pi() * turns
        else:
            at[name] = Fraction(0)
        if not (held[name].overlaps(place) and boxes[name].contains(place)):
            return {}
    jet = rational_energy(mechanism, parameters, at)
    return at if jet is not None and not any(jet.gradient) else {}


def _directions(mechanism: Mechanism, held: Mapping[str, arb]) -> dict[str, Direction]:
    """The angles whose directions follow from torsion springs that seem to be at rest, one after the other."""
    known: dict[str, Direction] = {}
    waiting = list(mechanism.torsion)
    while True:
        ready = [(spring, next(iter(new))) for spring in waiting if len(new := _unknown(spring, known)) == 1]
        found = False
        for spring, name in ready:
            waiting.remove(spring)
            direction = _followed(spring, name, known, held) if name not in known else None
            if direction is not None:
                known[name], found = direction, True
        if not found:
            return known


def _unknown(spring: TorsionSpring, known: Mapping[str, Direction]) -> set[str]:
    return {name for name, m in multiples(spring.angle).items() if m and name not in known}


def _followed(
    spring: TorsionSpring, name: str, known: Mapping[str, Direction], held: Mapping[str, arb]
) -> Direction | None:
    """The direction of the one angle that is not known, if the spring's deflection seems to be 0 or half a turn."""
    parts = {angle: int(m) for angle, m in multiples(spring.angle).items() if m}
    own = parts.pop(name)
    deflection = own * held[name] - _angle(spring.rest)
    for angle, m in parts.items():
        deflection += m * held[angle]
    if abs(own) != 1 or not deflection.sin().contains(0):
        return None
    total = spring.rest if deflection.cos() > 0 else (-spring.rest[0], -spring.rest[1])
    for angle, m in parts.items():
        c, s = known[angle]
        for _ in range(abs(m)):
            total = _product(total, (c, -s if m > 0 else s))
    return total if own == 1 else (total[0], -total[1])


def _product(a: Direction, b: Direction) -> Direction:
    return a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]


def _angle(direction: Direction) -> arb:
    c, s = direction
    if s == 0:
        return arb(0) if c > 0 else arb.pi()
    return arb.atan2(ball_of(s), ball_of(c))


def _quarter(ball: arb) -> Direction:
    """The nearest of the four directions along the axes."""
    c, s = QUARTERS[round(float(2 * ball / arb.pi())) % 4]
    return Fraction(c), Fraction(s)
