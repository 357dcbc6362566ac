"""Points fixed to a rigid body: place = at + R(angle) local, R turns by a sum of unknown angles and quarter turns.

Guarantee: distances within a body are constant, as `ptmcad.model.proofs` proves of bars between its points.
"""

from __future__ import annotations

from typing import Any

from ptmcad.model.angles import cosine_and_sine
from ptmcad.model.reading import MAX_BODIES, NAME_SCHEMA, POINTS, VALUE, ZERO, Context, by_names, new_name, two
from ptmcad.text.codec import Codec, part, reading, record
from ptmcad.text.node import Node
from ptmcad.text.tree import Chain, Step, Tree

Place = tuple[Tree, Tree]


def bodies(context: Context) -> Codec[dict[str, tuple[str, ...]]]:
    """The bodies, to the names of their points, which are added to the others.

    A body may be at a point of a body above it.
    """
    nothing = (ZERO, ZERO)
    body: Codec[dict[str, Any]] = record(
        dict, "{at: P, angle: phi, points: {Q: [1, 0]}}",
        at=part(
            reading(lambda entry: _frame(entry, context), anyOf=[NAME_SCHEMA, two(VALUE)]),
            "A point, or two coordinates.", instead=((), nothing),
        ),
        angle=part(
            reading(lambda entry: cosine_and_sine(*context.angle(entry)), **VALUE),
            "A sum of whole multiples of unknown angles, and of quarter turns such as pi/2.", instead=nothing,
        ),
        points=part(
            reading(lambda entry: entry.mapping(like="{Q: [1, 0]}"), **POINTS),
            "Local coordinates, in parameters only.", instead={},
        ),
    )  # fmt: skip

    def read(entry: Node) -> tuple[str, tuple[str, ...]]:
        new_name(entry.name, entry.key, {})
        said = body.read(entry)
        held, at = said["at"]

        def read_point(local: Node) -> None:
            new_name(local.name, local.key, context.points)
            context.points[local.name] = at  # known, whatever is wrong with it
            context.points[local.name] = _placed(at, said["angle"], context.pair(local))

        entry.gathered(read_point, said["points"].values())
        return entry.name, (*held, *said["points"])

    return reading(
        lambda node: dict(node.gathered(read, node.mapping(MAX_BODIES).values())),
        **by_names(body.schema, MAX_BODIES),
    )


def _frame(entry: Node, context: Context) -> tuple[tuple[str, ...], Place]:
    """Where a body is: at a point, which has a name, or at coordinates."""
    if isinstance(entry.plain, str):
        name = context.known_point(entry, entry.plain)
        return (name,), context.points[name]
    return (), context.pair(entry, moving=True)


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
