"""X-joints of a record: what each is on, the points that it adds, and what is wrong with it.

Guarantee: a base is known by direction and length: it lies on a level, from left to right, where no unknown moves it,
or it is the top of a joint that stands above in the record.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.model.derivative import negative, product, total
from ptmcad.model.reading import MAX_UNKNOWNS, NAME_SCHEMA, ZERO, Context, by_names, new_name, two
from ptmcad.model.xjoint import LEVEL, XJoint
from ptmcad.text.codec import Codec, part, reading, record
from ptmcad.text.entry import as_written
from ptmcad.text.node import Node
from ptmcad.text.tree import Tree, names_of

Place = tuple[Tree, Tree]


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


def _joint(name: str, said: Mapping[str, Any], context: Context, below: Mapping[str, XJoint]) -> XJoint:
    base, bars = said["base"], said["bars"]
    angle, other = said["angles"]
    taken = {**context.parameters, **context.unknowns, **{joint.other: joint for joint in below.values()}}
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
