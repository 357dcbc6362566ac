"""X-joints of a record: what each is on, the points that it adds, and what is wrong with it.

Guarantee: a base is known by direction and length: it lies on a level, from left to right, where no unknown moves it,
or it is the top of a joint that stands above in the record.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.errors import ConfigError
from ptmcad.mechanism.derivative import negative, product, total
from ptmcad.mechanism.reading import MAX_UNKNOWNS, Reader, ends, new_name
from ptmcad.mechanism.xjoint import LEVEL, XJoint
from ptmcad.text.entry import Entry, as_written
from ptmcad.text.tree import Number, Tree, names_of

XJOINT_KEYS = ("base", "bars", "angles", "top")
LIKE = "{X: {base: [A, B], bars: L, angles: [th, psi], top: [C, D]}}"
Place = tuple[Tree, Tree]
_ZERO: Tree = Number(Fraction(0))


def second_angles(value: object) -> tuple[str, ...]:
    """The names that the record gives to angles of second bars, before anything of it is checked."""
    entries = value.values() if isinstance(value, Mapping) else ()
    return tuple(name for entry in entries for name in _named(entry, "angles")[1:2])


def add_xjoints(
    xjoints: Entry, reader: Reader, points: dict[str, Place], taken: Mapping[str, object]
) -> tuple[XJoint, ...]:
    """Add the joints' tops to the points.

    Parameters
    ----------
    taken : parameters and unknowns.
    """
    found: dict[str, XJoint] = {}
    for name, entry in xjoints.entries(LIKE, MAX_UNKNOWNS).items():
        with xjoints.faults:
            new_name(name, entry.key, {})
            fields = entry.fields(XJOINT_KEYS, XJOINT_KEYS, "{base: [A, B], bars: L, angles: [th, psi], top: [C, D]}")
            if fields.has(*XJOINT_KEYS):
                joint = _joint(name, fields, reader, points, {**taken, **{j.other: j for j in found.values()}}, found)
                for point, angle, (x, y) in zip(
                    joint.top, (joint.other, joint.angle), (points[p] for p in joint.base[::-1]), strict=True
                ):
                    c, s = joint.bar(angle)
                    points[point] = total(x, product(joint.bars, c)), total(y, product(joint.bars, s))
                found[name] = joint
        if name not in found:  # what refers to the points of its top is not to blame for it
            for point in _named(entry.value, "top"):
                points.setdefault(point, (_ZERO, _ZERO))
    return tuple(found.values())


def _named(entry: object, key: str) -> tuple[str, ...]:
    """The names in a list of an entry, before anything of it is checked."""
    listed = entry.get(key) if isinstance(entry, Mapping) else None
    return tuple(name for name in listed if isinstance(name, str)) if isinstance(listed, list | tuple) else ()


def _joint(
    name: str,
    fields: Entry,
    reader: Reader,
    points: Mapping[str, Place],
    taken: Mapping[str, object],
    below: Mapping[str, XJoint],
) -> XJoint:
    key = fields.key
    base = ends(fields.at("base"), points)
    angles, top = (_two_names(fields.at(k), like) for k, like in (("angles", "[th, psi]"), ("top", "[C, D]")))
    new_name(angles[1], f"{key}.angles.2", taken)
    if angles[0] not in reader.moving.angles or angles[0] in reader.second:
        raise ConfigError(f"{as_written(angles[0])} is no unknown angle", key=f"{key}.angles.1")
    if any(joint.angle == angles[0] for joint in below.values()):
        raise ConfigError(f"{angles[0]} is the angle of another x-joint", key=f"{key}.angles.1")
    for n, point in enumerate(top, 1):
        new_name(point, f"{key}.top.{n}", {**points, **({top[0]: None} if n == 2 else {})})
    bars = reader.tree(fields.at("bars"))
    under = next((joint for joint in below.values() if joint.top == base), None)
    if under is not None:
        return XJoint(name, base, top, *angles, under.length, bars, *under.upper)
    (x, y), (x1, y1) = (points[p] for p in base)
    moving = {*reader.moving.angles, *(u for u in taken if u in reader.excluded)}
    if y != y1 or moving & {*names_of(x), *names_of(x1), *names_of(y)}:
        raise ConfigError(
            "the base of an x-joint is the top of another one above, as [left, right], or two points that no unknown "
            "moves, from left to right on one level: turn a frame that moves by its unknowns' angles instead",
            key=f"{key}.base",
        )
    return XJoint(name, base, top, *angles, total(x1, negative(x)), bars, LEVEL, 0)


def _two_names(entry: Entry, like: str) -> tuple[str, str]:
    value = entry.value
    if not (isinstance(value, list | tuple) and len(value) == 2 and all(isinstance(name, str) for name in value)):
        raise entry.error(f"expected two names, such as {like}")
    return value[0], value[1]
