"""The energy of a mechanism in any ring, given that of its springs, which may take roots that a ring has not.

Guarantee: exact as far as the ring is. What moments do is in it as far as it has one value for each pose
(`ptmcad.model.work`).

The exact engine and `ptmcad.verification` add up energies of their own, so that one shows the mistakes of another.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from ptmcad.model.description import Mechanism
from ptmcad.model.evaluate import Element, Ring, evaluate
from ptmcad.model.work import split_moments

E = TypeVar("E", bound=Element)


def points_in(mechanism: Mechanism, ring: Ring[E]) -> dict[str, tuple[E, E]]:
    """The coordinates of all points."""
    return {name: (evaluate(x, ring), evaluate(y, ring)) for name, (x, y) in mechanism.points.items()}


def with_springs(mechanism: Mechanism, ring: Ring[E], points: Mapping[str, tuple[E, E]], springs: E) -> E:
    """The energy: that of the springs with the torsion springs', less the work of loads and moments."""
    energy = springs
    for torsion in mechanism.torsion:
        energy = energy + evaluate(torsion.energy, ring)
    for load in mechanism.loads:
        x, y = points[load.point]
        energy = energy - (x * evaluate(load.x, ring) + y * evaluate(load.y, ring))
    for tree in split_moments(mechanism).energies:
        energy = energy + evaluate(tree, ring)
    return energy
