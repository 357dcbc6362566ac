"""A torsion spring on paper: a spiral about its joint whose outer end lies on one of the parts that
meet there.

Floating point throughout: a drawing decides nothing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import atan2, cos, hypot, pi, sin

from ptmcad.model.joints import Joint

Place = tuple[float, float]

TURNS, STEPS = 1.75, 24
"""Of the spiral, and points for each turn."""


def spirals(
    joints: Sequence[Joint | None],
    places: Mapping[str, Place],
    inner: float,
    outer: float,
    gap: float,
) -> dict[int, tuple[Place, ...]]:
    """The spirals of joints as polylines from the inside out, by their numbers from 1; none where
    there is no joint.

    Parameters
    ----------
    places : of the points, y upwards.
    inner, outer : radii; of further springs at one point they are larger, with a gap between them.
    """
    seen, found = Counter[str](), {}
    for number, joint in enumerate(joints, 1):
        if joint is not None:
            shift, centre = seen[joint.point] * (outer - inner + gap), places[joint.point]
            seen[joint.point] += 1
            found[number] = spiral(
                centre, places.get(joint.towards, centre), inner + shift, outer + shift
            )
    return found


def spiral(centre: Place, towards: Place, inner: float, outer: float) -> tuple[Place, ...]:
    """Turns that end towards a place; upwards where that is the centre."""
    x, y = towards[0] - centre[0], towards[1] - centre[1]
    end = atan2(y, x) if hypot(x, y) > 1e-9 else pi / 2
    count = round(TURNS * STEPS)
    found = []
    for k in range(count + 1):
        radius, angle = inner + (outer - inner) * k / count, end - 2 * pi * (count - k) / STEPS
        found.append((centre[0] + radius * cos(angle), centre[1] + radius * sin(angle)))
    return tuple(found)
