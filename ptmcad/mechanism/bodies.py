"""Points fixed to a rigid body: place = at + R(angle) local, R turns by a sum of unknown angles and quarter turns.

Guarantee: distances within a body are constant, as `ptmcad.mechanism.proofs` proves of bars between its points.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.mechanism.angles import cosine_and_sine
from ptmcad.mechanism.reading import MAX_BODIES, Reader, new_name, point_name
from ptmcad.text.entry import Entry
from ptmcad.text.tree import Chain, Step, Tree

BODY_KEYS = ("at", "angle", "points")
Place = tuple[Tree, Tree]


def add_bodies(bodies: Entry, reader: Reader, points: dict[str, Place]) -> dict[str, tuple[str, ...]]:
    """Add the bodies' points to the others; bodies to the names of their points.

    A body may be at a point of a body above it.
    """
    found: dict[str, tuple[str, ...]] = {}
    faults = bodies.faults
    for name, entry in bodies.entries(most=MAX_BODIES).items():
        with faults:
            new_name(name, entry.key, {})
            fields = entry.fields(BODY_KEYS, BODY_KEYS, "{at: P, angle: phi, points: {Q: [1, 0]}}")
            local = fields.at("points", {}).entries("{Q: [1, 0]}")
            held = fields.at("at").value
            found[name] = (*((held,) if isinstance(held, str) else ()), *local)
            nothing = reader.tree(entry._replace(value=0))
            at = fields.read("at", lambda part: _frame(part, reader, points), (nothing, nothing))
            turned = fields.read("angle", lambda part: cosine_and_sine(*reader.angle(part)), (nothing, nothing))
            for point, pair in local.items():
                with faults:
                    new_name(point, pair.key, points)
                    points[point] = at  # known, whatever is wrong with it
                    points[point] = _placed(at, turned, reader.pair(pair))
    return found


def _frame(entry: Entry, reader: Reader, points: Mapping[str, Place]) -> Place:
    """Where a body is: at a point, or at coordinates."""
    if isinstance(entry.value, str):
        return points[point_name(entry.value, entry.key, points)]
    return reader.pair(entry, moving=True)


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
