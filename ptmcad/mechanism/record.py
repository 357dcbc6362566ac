"""A mechanism's description read from a record: a mapping of texts, numbers, lists and mappings, as YAML gives it.

Guarantee: what is wrong is a `ConfigError` with its key, which knows all other faults; what `described` returns is
consistent, see `description`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, TypeVar

from ptmcad.errors import ConfigError, ExpressionError, Faults, quoted
from ptmcad.mechanism.angles import angle_name
from ptmcad.mechanism.bodies import add_bodies
from ptmcad.mechanism.description import Closing, Load, Mechanism, Moment, Parameter, Spring, Support, TorsionSpring
from ptmcad.mechanism.evaluate import value_at
from ptmcad.mechanism.parts import check_numbers
from ptmcad.mechanism.proofs import check_bars, check_springs, check_symmetries, check_unknowns
from ptmcad.mechanism.reading import (
    Reader,
    Unread,
    constant,
    ends,
    faulty_entries,
    member,
    name_of,
    new_name,
    parameters_of,
    point_name,
    title_of,
    unknowns_of,
)
from ptmcad.mechanism.sizes import check_sizes
from ptmcad.mechanism.work import split_moments
from ptmcad.mechanism.xjoint import XJoint
from ptmcad.text.entry import Entry, Place, as_written
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
T = TypeVar("T")
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
    whole = Entry(record, Place(), faults).fields(KEYS)
    name = whole.read("name", name_of, DEFAULT_NAME)
    title = whole.read("title", lambda entry: title_of(entry.value), "")
    parameters: dict[str, Parameter] = {}
    with faults:
        parameters = parameters_of(whole)
    unknowns = unknowns_of(whole, parameters)
    with faults:
        if not whole.has("points"):
            raise whole.at("points").error("is missing")
    second: tuple[str, ...] = ()
    if "x-joint" in record:
        from ptmcad.mechanism.xjoints import add_xjoints, second_angles

        second = second_angles(record["x-joint"])
    parts = _Parts(whole, Reader(parameters, unknowns, faulty_entries(faults, "unknowns"), second))
    points = parts.points()
    xjoints: tuple[XJoint, ...] = ()
    if "x-joint" in record:
        with faults:
            xjoints = add_xjoints(whole.at("x-joint"), parts.reader, points, {**parameters, **unknowns})
    bodies = {}
    with faults:
        bodies = add_bodies(whole.at("bodies", {}), parts.reader, points)
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

    def __init__(self, record: Entry, reader: Reader):
        self.record = record
        self.reader = reader
        self.faults = record.faults

    def _items(self, key: str, read: Callable[[Entry], T]) -> tuple[T, ...]:
        return self.record.at(key, ()).each_item(read, _LIKE[key])

    def _entries(self, key: str, read: Callable[[Entry], T]) -> tuple[T, ...]:
        return self.record.at(key, {}).each_entry(read, _LIKE[key])

    def points(self) -> dict[str, tuple[Tree, Tree]]:
        found: dict[str, tuple[Tree, Tree]] = {}

        def read(entry: Entry) -> None:
            found[entry.name] = (_ZERO, _ZERO)  # known, whatever is wrong with it
            new_name(entry.name, entry.key, {})
            found[entry.name] = self.reader.pair(entry, moving=True)

        self._entries("points", read)
        return Unread(found) if any(fault.key == "points" for fault in self.faults.found) else found

    def bars(self, points: Mapping[str, object]) -> tuple[tuple[str, str], ...]:
        return self._items("bars", lambda entry: ends(entry, points))

    def supports(self, points: Mapping[str, object]) -> dict[str, Support]:
        def read(entry: Entry) -> tuple[str, Support]:
            return point_name(entry.name, entry.key, points), member(Support, entry)

        return dict(self._entries("supports", read))

    def springs(self, points: Mapping[str, object]) -> tuple[Spring, ...]:
        springs: dict[str, Spring] = {}

        def read(entry: Entry) -> None:
            fields = entry.fields(SPRING_KEYS, ("between", "k"), "{between: [A, B], k: 1}")
            start, end = fields.read("between", lambda part: ends(part, points), ("", ""))
            stiffness, free = fields.read("k", self.reader.tree, _ONE), fields.read("free", self.reader.tree, _ZERO)
            between = f"{start}{end}"
            names = (*([stiffness.name] if isinstance(stiffness, Name) else []), between, f"{between}_{entry.name}")
            name = next(name for name in names if name not in springs)
            springs[name] = Spring(name, start, end, stiffness, free)

        self._items("springs", read)
        return tuple(springs.values())

    def torsion(self, points: Mapping[str, object]) -> tuple[TorsionSpring, ...]:
        found: dict[str, TorsionSpring] = {}

        def read(entry: Entry) -> None:
            fields = entry.fields(TORSION_KEYS, ("angle", "k"))
            angle, turns = fields.read("angle", self.reader.angle, (_ZERO, 0))
            stiffness = fields.read("k", self.reader.tree, _ONE)
            rest = fields.read("rest", _rest, (Fraction(1), Fraction(0)))
            at = fields.read("at", lambda part: point_name(part.value, part.key, points), "")
            for _ in range(turns):  # what is added to the angle is taken from the rest
                rest = (rest[1], -rest[0])
            of_angle = angle_name(angle)
            name = of_angle if of_angle and of_angle not in found else f"{of_angle}#{entry.name}"
            found[name] = TorsionSpring(angle, stiffness, rest, name, at)

        self._items("torsion", read)
        return tuple(found.values())

    def closing(self, points: Mapping[str, object]) -> tuple[Closing, ...]:
        found = []

        def read(entry: Entry) -> None:
            fields = entry.fields(CLOSING_KEYS, CLOSING_KEYS, "{between: [B, D], length: L}")
            if fields.has(*CLOSING_KEYS):
                between = ends(fields.at("between"), points)
                found.append(Closing(*between, self.reader.tree(fields.at("length"))))

        self._items("closing", read)
        return tuple(found)

    def loads(self, points: Mapping[str, object]) -> tuple[Load, ...]:
        found = []

        def read(entry: Entry) -> None:
            point_name(entry.name, entry.key, points)
            if not isinstance(entry.value, Mapping):
                like = "[0, -W], or {weight: W}"
                found.append(Load(entry.name, *self.reader.pair(entry, what="components", like=like)))
                return
            fields = entry.fields(("weight",))
            if not entry.value:
                raise entry.error("expected two components, such as [0, -W], or {weight: W}")
            if fields.has("weight"):  # or its key is a fault already
                found.append(Load(entry.name, _ZERO, Negative(self.reader.tree(fields.at("weight")))))

        self._entries("loads", read)
        return tuple(found)

    def moments(self, unknowns: Mapping[str, object]) -> tuple[Moment, ...]:
        def read(entry: Entry) -> Moment:
            if entry.name not in unknowns:
                hint = did_you_mean(str(entry.name), unknowns) or f"; they are {', '.join(unknowns)}"
                raise entry.error(f"there is no unknown {quoted(entry.name)}{hint}")
            return Moment(entry.name, self.reader.tree(entry, moving=True))

        return self._entries("moments", read)

    def symmetries(self) -> tuple[Mapping[str, Tree], ...]:
        return self._items("symmetries", self.reader.symmetry)


def _rest(entry: Entry) -> tuple[Fraction, Fraction]:
    """The cosine and sine of the angle at which a torsion spring is relaxed."""
    value = entry.value
    if isinstance(value, Mapping):
        faults = Faults()
        fields = entry._replace(faults=faults).fields(("cos", "sin"))
        faults.check()
        if set(value) != {"cos", "sin"}:
            raise entry.error("expected both, such as {cos: 3/5, sin: 4/5}")
        c, s = (value_at(parse(constant(fields.at(part))), {}) for part in ("cos", "sin"))
        if c * c + s * s != 1:
            raise entry.error(f"cos^2 + sin^2 is {c * c + s * s}, not 1: no angle has these")
        return c, s
    named = NAMED_RESTS.get(str(value).replace(" ", "") if isinstance(value, str | int) else "")
    if named is None:
        raise entry.error(
            f"{as_written(value)} is none of {', '.join(NAMED_RESTS)}: of other angles give the cosine and sine, such "
            "as {cos: 3/5, sin: 4/5}"
        )
    return Fraction(named[0]), Fraction(named[1])
