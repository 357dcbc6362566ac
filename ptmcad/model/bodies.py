"""Points that bodies and X-joints of a record add.

Those fixed to a rigid body are at + R(angle) local, where R turns by a sum of unknown angles and
quarter turns.

Guarantee: distances within a body are constant, as `ptmcad.model.proofs` proves of bars between its
points. The base of an X-joint is known by direction and length: it lies on a level, from left to
right, where no unknown moves it, or it is the top of a joint that stands above in the record.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.model.antiparallelogram import XJoint
from ptmcad.model.elements import LEVEL, Place
from ptmcad.model.reading import (
    MAX_BODIES,
    MAX_UNKNOWNS,
    NAME_SCHEMA,
    POINTS,
    VALUE,
    Context,
    by_names,
    new_name,
    two,
)
from ptmcad.model.trees import ZERO, cosine_and_sine, negative, product, total
from ptmcad.text.codec import Codec, part, reading, record
from ptmcad.text.entry import as_written
from ptmcad.text.node import Node
from ptmcad.text.tree import Chain, Step, Tree, names_of


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
        Step(operator, Chain(factor, (Step("*", turned),)))
        for operator, factor, turned in (parts[:3], parts[3:])
    )
    if isinstance(start, Chain) and start.is_sum:
        return Chain(start.first, start.steps + steps)
    return Chain(start, steps)


def second_angles(value: object) -> tuple[str, ...]:
    """The names that the record gives to angles of second bars, before anything of it is checked."""
    entries = value.values() if isinstance(value, Mapping) else ()
    angles = (entry.get("angles") for entry in entries if isinstance(entry, Mapping))
    second = (names[1] for names in angles if isinstance(names, list | tuple) and len(names) > 1)
    return tuple(name for name in second if isinstance(name, str))


def xjoints(context: Context) -> Codec[tuple[XJoint, ...]]:
    """The X-joints, whose tops are added to the points."""
    names: dict[str, Any] = two(NAME_SCHEMA)
    joint: Codec[dict[str, Any]] = record(
        dict, "{base: [A, B], bars: L, angles: [th, psi], top: [C, D]}",
        base=part(context.between(), "Left and right end of what the joint stands on."),
        bars=part(context.value(), "Their length, which is not the base's."),
        angles=part(
            reading(lambda entry: entry.pair("two names", "[th, psi]"), **names),
            "Of the bars from the base's left and right end, against the base: an unknown, and a new name for the one "
            "that follows from it.",
        ),
        top=part(
            reading(lambda entry: entry.pair("two names", "[C, D]"), **names),
            "New points: where the bar from the base's right end arrives, and the one from the left end.",
        ),
    )  # fmt: skip
    found: dict[str, XJoint] = {}

    def read(entry: Node) -> None:
        new_name(entry.name, entry.key, {})
        try:
            found[entry.name] = new = _joint(entry.name, joint.read(entry), context, found)
        except ConfigError:
            # what refers to the points of its top is not to blame for it
            top = entry.plain.get("top") if entry.is_mapping else None
            for point in top if isinstance(top, list) else ():
                context.points.setdefault(str(point), (ZERO, ZERO))
            raise
        for point, angle, base in zip(new.top, (new.other, new.angle), new.base[::-1], strict=True):
            (x, y), (c, s) = context.points[base], new.bar(angle)
            context.points[point] = total(x, product(new.bars, c)), total(y, product(new.bars, s))

    like = "{X: {base: [A, B], bars: L, angles: [th, psi], top: [C, D]}}"

    def read_all(node: Node) -> tuple[XJoint, ...]:
        node.gathered(read, node.mapping(MAX_UNKNOWNS, like).values())
        return tuple(found.values())

    return reading(read_all, **by_names(joint.schema, MAX_UNKNOWNS))


def _joint(
    name: str, said: Mapping[str, Any], context: Context, below: Mapping[str, XJoint]
) -> XJoint:
    base, bars = said["base"], said["bars"]
    angle, other = said["angles"]
    taken = {
        **context.parameters,
        **context.unknowns,
        **{joint.other: joint for joint in below.values()},
    }
    second = new_name(other.plain, other.key, taken)
    moving = context.moving.angles
    first = angle.plain
    if first not in moving or first in context.second:
        raise angle.fault(f"{as_written(first)} is no unknown angle")
    if any(joint.angle == first for joint in below.values()):
        raise angle.fault(f"{first} is the angle of another x-joint")
    left, right = said["top"]
    start = new_name(left.plain, left.key, context.points)
    top = (start, new_name(right.plain, right.key, {**context.points, start: None}))
    under = next((joint for joint in below.values() if joint.top == base), None)
    if under is not None:
        return XJoint(name, base, top, first, second, under.length, bars, *under.upper)
    (x, y), (x1, y1) = (context.points[p] for p in base)
    movers = {*moving, *context.unknowns, *context.second}
    if y != y1 or movers & {*names_of(x), *names_of(x1), *names_of(y)}:
        raise ConfigError(
            "the base of an x-joint is the top of another one above, as [left, right], or two points that no unknown "
            "moves, from left to right on one level: turn a frame that moves by its unknowns' angles instead",
            key=f"x-joint.{name}.base",
        )
    return XJoint(name, base, top, first, second, total(x1, negative(x)), bars, LEVEL, 0)
