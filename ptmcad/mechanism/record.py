"""A mechanism's description read from a record: a mapping of texts, numbers, lists and mappings, as YAML gives it.

Guarantee: what is wrong is a `ConfigError` with its key, which knows all other faults; what `described` returns is
consistent, see `description`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from ptmcad.errors import ConfigError, ExpressionError, Faults, quoted
from ptmcad.mechanism.angles import angle_name
from ptmcad.mechanism.bodies import add_bodies
from ptmcad.mechanism.description import Closing, Load, Mechanism, Moment, Spring, Support, TorsionSpring
from ptmcad.mechanism.evaluate import value_at
from ptmcad.mechanism.parts import check_numbers
from ptmcad.mechanism.proofs import check_bars, check_springs, check_symmetries, check_unknowns
from ptmcad.mechanism.reading import (
    MAX_BODIES,
    Reader,
    Unread,
    as_written,
    check_keys,
    constant,
    ends,
    faulty_entries,
    listed,
    mapping,
    member,
    new_name,
    parameters_of,
    point_name,
    title_of,
    unknowns_of,
)
from ptmcad.mechanism.sizes import check_sizes
from ptmcad.mechanism.work import split_moments
from ptmcad.mechanism.xjoint import XJoint
from ptmcad.text.syntax import did_you_mean, parse
from ptmcad.text.tree import Name, Negative, Number, Tree

KEYS = (
    "name", "title", "parameters", "unknowns", "points", "bodies", "bars", "supports", "springs", "torsion", "loads",
    "moments", "symmetries", "closing", "x-joint",
)  # fmt: skip
SPRING_KEYS = ("between", "k", "free")
TORSION_KEYS = ("angle", "k", "rest", "at")
CLOSING_KEYS = ("between", "length")
DEFAULT_NAME = "mechanism"
NAMED_RESTS = {
    "0": (1, 0), "pi/2": (0, 1), "pi": (-1, 0), "-pi": (-1, 0), "-pi/2": (0, -1), "3*pi/2": (0, -1),
}  # fmt: skip
"""Cosine and sine of the angles that have both rational and are written with pi."""
_LIKE = {
    "points": "{A: [0, 0]}", "bars": "[[O, P]]", "supports": "{O: pin}", "springs": "[{between: [A, P], k: 1}]",
    "torsion": "[{angle: th, k: 1}]", "loads": "{P: [0, -W]}", "moments": "{th: M}", "symmetries": "[{th: -th}]",
    "closing": "[{between: [B, D], length: L}]",
}  # fmt: skip
"""Examples for messages."""
_ZERO: Tree = Number(Fraction(0))
_ONE: Tree = Number(Fraction(1))


def described(record: Mapping[str, Any], proved: bool = False) -> Mechanism:
    """The mechanism of a record, which is a mapping as YAML gives it: texts, integers, lists and mappings.

    Parameters
    ----------
    proved : whether its bars are known to be rigid and its unknowns to be held, as tests prove of built-in ones.

    Raises
    ------
    ConfigError
        With the key of what is wrong: an unknown key, kind, name or point, a name that is given twice, a text that is
        no expression, or one that has no value in every ring; a bar whose length varies, an unknown that no equation
        holds. Its ``faults`` are all of these.
    """
    faults = Faults()
    found = read_mechanism(record, faults, proved)
    check_numbers(found, faults)
    faults.check()
    return found


def read_mechanism(record: Mapping[str, Any], faults: Faults, proved: bool = False) -> Mechanism:
    """As `described`, but what is wrong is noted, and left out or replaced."""
    check_keys(record, KEYS, "", faults)
    name, title, parameters, unknowns = DEFAULT_NAME, "", {}, {}
    with faults:
        name = new_name(record.get("name", DEFAULT_NAME), "name", {})
    with faults:
        title = title_of(record.get("title", ""))
    with faults:
        parameters = parameters_of(mapping(record.get("parameters", {}), "parameters"), faults)
    for key in ("unknowns", "points"):
        with faults:
            if key not in record:
                raise ConfigError("is missing", key=key)
    with faults:
        unknowns = unknowns_of(record["unknowns"], parameters, faults) if "unknowns" in record else {}
    second: tuple[str, ...] = ()
    if "x-joint" in record:
        from ptmcad.mechanism.xjoints import add_xjoints, second_angles

        second = second_angles(record["x-joint"])
    parts = _Parts(record, Reader(parameters, unknowns, faulty_entries(faults, "unknowns"), second), faults)
    points = parts.points()
    xjoints: tuple[XJoint, ...] = ()
    if "x-joint" in record:
        with faults:
            xjoints = add_xjoints(record["x-joint"], parts.reader, points, {**parameters, **unknowns}, faults)
    bodies = {}
    with faults:
        bodies = add_bodies(mapping(record.get("bodies", {}), "bodies", MAX_BODIES), parts.reader, points, faults)
    bars, supports, loads = parts.bars(points), parts.supports(points), parts.loads(points)
    moments, torsion = parts.moments(unknowns), parts.torsion(points)
    found = Mechanism(
        name,
        parameters,
        unknowns,
        points,
        (*bars, *(bar for joint in xjoints for bar in joint.rigid)),
        supports,
        parts.springs(points),
        loads,
        parts.symmetries(),
        bodies,
        moments,
        torsion,
        parts.closing(points),
        xjoints,
        source=record,
        title=title,
    )
    if not proved:
        if not {(fault.key or "").partition(".")[0] for fault in faults.found} - _FORCELESS:
            check_sizes(found, faults)
        _prove(found, faults)
    return found


_SHAPE = frozenset({"parameters", "unknowns", "points", "bodies", "x-joint"})
_FORCELESS = frozenset({"name", "title", "bars", "supports", "symmetries"})


def _prove(found: Mechanism, faults: Faults) -> None:
    """Note what the parts show together only, where the parts that are concerned are right."""
    faulty = {(fault.key or "").partition(".")[0] for fault in faults.found}
    if not faulty & _SHAPE:
        check_bars(found, faults)
        if found.closing and "closing" not in faulty:
            from ptmcad.mechanism.loops import check_closing

            check_closing(found, faults)
        if "springs" not in faulty and "torsion" not in faulty:
            check_springs(found, faults)
    if not faulty - _FORCELESS:
        check_unknowns(found, faults)
        check_symmetries(found, faults)
        check_moments(found, faults)
        if found.closing or found.xjoints:  # most mechanisms have neither, and do not wait for what reads them
            from ptmcad.mechanism.crossed import check_crossed
            from ptmcad.mechanism.loops import check_loops

            check_loops(found, faults)
            check_crossed(found, faults)


def check_moments(mechanism: Mechanism, faults: Faults) -> None:
    """Note moments that depend on their own unknown and are too large to be integrated."""
    with faults:
        try:
            split_moments(mechanism)
        except ExpressionError as error:
            raise ConfigError(f"they have no energy: {error.message}", key="moments") from None


class _Parts:
    """The parts of a record, each read with its faults noted."""

    def __init__(self, record: Mapping[str, Any], reader: Reader, faults: Faults):
        self.record = record
        self.reader = reader
        self.faults = faults

    def _list(self, key: str) -> Sequence[Any]:
        with self.faults:
            return listed(self.record.get(key, ()), key, _LIKE.get(key, ""))
        return ()

    def _mapping(self, key: str) -> Mapping[str, Any]:
        with self.faults:
            return mapping(self.record.get(key, {}), key, like=_LIKE.get(key, ""))
        return {}

    def points(self) -> dict[str, tuple[Tree, Tree]]:
        entries = self._mapping("points")
        unread = any(fault.key == "points" for fault in self.faults.found)
        found: dict[str, tuple[Tree, Tree]] = Unread() if unread else {}
        for name, pair in entries.items():
            with self.faults:
                found[name] = (_ZERO, _ZERO)  # known, whatever is wrong with it
                new_name(name, f"points.{name}", {})
                found[name] = self.reader.pair(pair, f"points.{name}", moving=True)
        return found

    def bars(self, points: Mapping[str, object]) -> tuple[tuple[str, str], ...]:
        found = []
        for n, bar in enumerate(self._list("bars"), 1):
            with self.faults:
                found.append(ends(bar, f"bars.{n}", points))
        return tuple(found)

    def supports(self, points: Mapping[str, object]) -> dict[str, Support]:
        found = {}
        for name, kind in self._mapping("supports").items():
            with self.faults:
                point_name(name, f"supports.{name}", points)
                found[name] = member(Support, kind, f"supports.{name}")
        return found

    def springs(self, points: Mapping[str, object]) -> tuple[Spring, ...]:
        springs: dict[str, Spring] = {}
        for n, entry in enumerate(self._list("springs"), 1):
            with self.faults:
                spring = self._spring(entry, f"springs.{n}", points)
                stiffness, between = spring.stiffness, f"{spring.start}{spring.end}"
                names = (*([stiffness.name] if isinstance(stiffness, Name) else []), between, f"{between}_{n}")
                name = next(name for name in names if name not in springs)
                springs[name] = spring._replace(name=name)
        return tuple(springs.values())

    def _spring(self, entry: object, key: str, points: Mapping[str, object]) -> Spring:
        fields = mapping(entry, key, like="{between: [A, B], k: 1}")
        check_keys(fields, SPRING_KEYS, key, self.faults)
        for needed in ("between", "k"):
            with self.faults:
                if needed not in fields:
                    raise ConfigError("is missing", key=f"{key}.{needed}")
        start = end = ""
        stiffness, free = _ONE, _ZERO
        with self.faults:
            if "between" in fields:
                start, end = ends(fields["between"], f"{key}.between", points)
        with self.faults:
            if "k" in fields:
                stiffness = self.reader.tree(fields["k"], f"{key}.k")
        with self.faults:
            free = self.reader.tree(fields.get("free", 0), f"{key}.free")
        return Spring("", start, end, stiffness, free)

    def torsion(self, points: Mapping[str, object]) -> tuple[TorsionSpring, ...]:
        found: dict[str, TorsionSpring] = {}
        for n, entry in enumerate(self._list("torsion"), 1):
            with self.faults:
                spring = self._torsion_spring(entry, f"torsion.{n}", points)
                of_angle = angle_name(spring.angle)
                name = of_angle if of_angle and of_angle not in found else f"{of_angle}#{n}"
                found[name] = spring._replace(name=name)
        return tuple(found.values())

    def _torsion_spring(self, entry: object, key: str, points: Mapping[str, object]) -> TorsionSpring:
        fields = mapping(entry, key)
        check_keys(fields, TORSION_KEYS, key, self.faults)
        for needed in ("angle", "k"):
            with self.faults:
                if needed not in fields:
                    raise ConfigError("is missing", key=f"{key}.{needed}")
        angle, turns, stiffness, rest, at = _ZERO, 0, _ONE, (Fraction(1), Fraction(0)), ""
        with self.faults:
            if "angle" in fields:
                angle, turns = self.reader.angle(fields["angle"], f"{key}.angle")
        with self.faults:
            if "k" in fields:
                stiffness = self.reader.tree(fields["k"], f"{key}.k")
        with self.faults:
            rest = _rest(fields.get("rest", 0), f"{key}.rest")
        with self.faults:
            if "at" in fields:
                at = point_name(fields["at"], f"{key}.at", points)
        for _ in range(turns):  # what is added to the angle is taken from the rest
            rest = (rest[1], -rest[0])
        return TorsionSpring(angle, stiffness, rest, at=at)

    def closing(self, points: Mapping[str, object]) -> tuple[Closing, ...]:
        found = []
        for n, entry in enumerate(self._list("closing"), 1):
            key = f"closing.{n}"
            with self.faults:
                fields = mapping(entry, key, like="{between: [B, D], length: L}")
                check_keys(fields, CLOSING_KEYS, key, self.faults)
                for needed in CLOSING_KEYS:
                    with self.faults:
                        if needed not in fields:
                            raise ConfigError("is missing", key=f"{key}.{needed}")
                if all(needed in fields for needed in CLOSING_KEYS):
                    between = ends(fields["between"], f"{key}.between", points)
                    found.append(Closing(*between, self.reader.tree(fields["length"], f"{key}.length")))
        return tuple(found)

    def loads(self, points: Mapping[str, object]) -> tuple[Load, ...]:
        found = []
        for name, force in self._mapping("loads").items():
            key = f"loads.{name}"
            with self.faults:
                point_name(name, key, points)
                if isinstance(force, Mapping):
                    check_keys(force, ("weight",), key, self.faults)
                    if not force:
                        raise ConfigError("expected two components, such as [0, -W], or {weight: W}", key=key)
                    if "weight" not in force:
                        continue  # its key is a fault already
                    weight = self.reader.tree(force["weight"], f"{key}.weight")
                    found.append(Load(name, _ZERO, Negative(weight)))
                else:
                    like = "[0, -W], or {weight: W}"
                    found.append(Load(name, *self.reader.pair(force, key, what="components", like=like)))
        return tuple(found)

    def moments(self, unknowns: Mapping[str, object]) -> tuple[Moment, ...]:
        found = []
        for name, value in self._mapping("moments").items():
            key = f"moments.{name}"
            with self.faults:
                if name not in unknowns:
                    hint = did_you_mean(str(name), unknowns) or f"; they are {', '.join(unknowns)}"
                    raise ConfigError(f"there is no unknown {quoted(name)}{hint}", key=key)
                found.append(Moment(name, self.reader.tree(value, key, moving=True)))
        return tuple(found)

    def symmetries(self) -> tuple[Mapping[str, Tree], ...]:
        found = []
        for n, entry in enumerate(self._list("symmetries"), 1):
            with self.faults:
                found.append(self.reader.symmetry(entry, f"symmetries.{n}"))
        return tuple(found)


def _rest(value: object, key: str) -> tuple[Fraction, Fraction]:
    """The cosine and sine of the angle at which a torsion spring is relaxed."""
    if isinstance(value, Mapping):
        faults = Faults()
        check_keys(value, ("cos", "sin"), key, faults)
        faults.check()
        if set(value) != {"cos", "sin"}:
            raise ConfigError("expected both, such as {cos: 3/5, sin: 4/5}", key=key)
        c, s = (value_at(parse(constant(value[part], f"{key}.{part}")), {}) for part in ("cos", "sin"))
        if c * c + s * s != 1:
            raise ConfigError(f"cos^2 + sin^2 is {c * c + s * s}, not 1: no angle has these", key=key)
        return c, s
    named = NAMED_RESTS.get(str(value).replace(" ", "") if isinstance(value, str | int) else "")
    if named is None:
        raise ConfigError(
            f"{as_written(value)} is none of {', '.join(NAMED_RESTS)}: of other angles give the cosine and sine, such "
            "as {cos: 3/5, sin: 4/5}",
            key=key,
        )
    return Fraction(named[0]), Fraction(named[1])
