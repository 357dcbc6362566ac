"""Points fixed to a rigid body: place = at + R(angle) local, R turns by a sum of unknown angles and quarter turns.

Guarantee: distances within a body are constant, as `ptmcad.mechanism.proofs` proves of bars between its points.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.errors import ConfigError, Faults
from ptmcad.mechanism.angles import cosine_and_sine
from ptmcad.mechanism.reading import Reader, check_keys, mapping, new_name, point_name
from ptmcad.text.tree import Chain, Step, Tree

BODY_KEYS = ("at", "angle", "points")
Place = tuple[Tree, Tree]


def add_bodies(
    entries: Mapping[str, Any], reader: Reader, points: dict[str, Place], faults: Faults
) -> dict[str, tuple[str, ...]]:
    """Add the bodies' points to the others; bodies to the names of their points.

    A body may be at a point of a body above it.
    """
    bodies: dict[str, tuple[str, ...]] = {}
    for name, entry in entries.items():
        key = f"bodies.{name}"
        with faults:
            new_name(name, key, {})
            fields = mapping(entry, key, like="{at: P, angle: phi, points: {Q: [1, 0]}}")
            check_keys(fields, BODY_KEYS, key, faults)
            for needed in BODY_KEYS:
                with faults:
                    if needed not in fields:
                        raise ConfigError("is missing", key=f"{key}.{needed}")
            local = mapping(fields.get("points", {}), f"{key}.points", like="{Q: [1, 0]}")
            held = fields.get("at")
            bodies[name] = (*((held,) if isinstance(held, str) else ()), *local)
            at, turned = _frame(fields, key, reader, points, faults)
            for point, pair in local.items():
                with faults:
                    new_name(point, f"{key}.points.{point}", points)
                    points[point] = at  # known, whatever is wrong with it
                    points[point] = _placed(at, turned, reader.pair(pair, f"{key}.points.{point}"))
    return bodies


def _frame(
    fields: Mapping[str, Any], key: str, reader: Reader, points: Mapping[str, Place], faults: Faults
) -> tuple[Place, Place]:
    """Where a body is, and the cosine and sine of how it is turned; zeros for what is faulty."""
    nothing = reader.tree(0, key)
    at = turned = (nothing, nothing)
    with faults:
        if isinstance(fields.get("at"), str):
            at = points[point_name(fields["at"], f"{key}.at", points)]
        elif "at" in fields:
            at = reader.pair(fields["at"], f"{key}.at", moving=True)
    with faults:
        if "angle" in fields:
            turned = cosine_and_sine(*reader.angle(fields["angle"], f"{key}.angle"))
    return at, turned


def _placed(at: Place, turned: Place, local: Place) -> Place:
    (x, y), (c, s), (a, b) = at, turned, local
    return _sum(x, "+", a, c, "-", b, s), _sum(y, "+", a, s, "+", b, c)


def _sum(start: Tree, *parts: Any) -> Tree:
    """start + a f + b g; a sum goes on flat, so that bodies on bodies nest no deeper."""
    steps = tuple(
        Step(operator, Chain(factor, (Step("*", turned),))) for operator, factor, turned in (parts[:3], parts[3:])
    )
    if isinstance(start, Chain) and start.is_sum:
        return Chain(start.first, start.steps + steps)
    return Chain(start, steps)
