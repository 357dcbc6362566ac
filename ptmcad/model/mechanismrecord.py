"""A mechanism's description read from a record: a mapping of texts, numbers, lists and mappings, as
YAML gives it.

Guarantee: what is wrong is a `ConfigError` with its key, which knows all other faults; what
`described` returns is consistent, see `description`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from ptmcad.errors import ConfigError, ExpressionError, Faults, Place
from ptmcad.model.bodies import bodies, second_angles, xjoints
from ptmcad.model.description import Mechanism
from ptmcad.model.elements import Closing, Load, Moment, Spring, Support, TorsionSpring
from ptmcad.model.evaluate import value_at
from ptmcad.model.proofs import (
    check_bars,
    check_closing,
    check_elements,
    check_loops,
    check_numbers,
    check_symmetries,
    check_unknowns,
)
from ptmcad.model.reading import (
    NAME_SCHEMA,
    NUMBER,
    POINTS,
    VALUE,
    Context,
    constant,
    new_name,
    two,
)
from ptmcad.model.termbounds import check_sizes
from ptmcad.model.trees import ONE, ZERO, angle_name
from ptmcad.model.work import split_moments
from ptmcad.text.codec import Codec, Key, choice, converted, listed, named, part, reading, record
from ptmcad.text.entry import as_written, from_python
from ptmcad.text.node import MAX_ENTRIES, Node
from ptmcad.text.syntax import parse
from ptmcad.text.tree import Name, Negative, Tree

DEFAULT_NAME = "mechanism"
NAMED_RESTS = {
    "0": (1, 0),
    "pi/2": (0, 1),
    "pi": (-1, 0),
    "-pi": (-1, 0),
    "-pi/2": (0, -1),
    "3*pi/2": (0, -1),
}
"""Cosine and sine of the angles that have both rational and are written with pi."""
_UNWRITTEN: Callable[[Any], Any] = list
"""Of what is only read."""


def described(record: Mapping[str, Any], proved: bool = False) -> Mechanism:
    """The mechanism of a record, which is a mapping as YAML gives it: texts, integers, lists and
    mappings.

    Parameters
    ----------
    proved : whether its bars are known to be rigid and its unknowns to be held, as tests prove of
        built-in ones.

    Raises
    ------
    ConfigError
        With the key of what is wrong: an unknown key, kind, name or point, a name that is given
        twice, a text that is no expression, or one that has no value in every ring; a bar whose
        length varies, an unknown that no equation holds. Its ``faults`` are all of these.
    """
    faults = Faults()
    found = read_mechanism(record, faults, proved)
    check_numbers(found, faults)
    faults.check()
    return found


def read_mechanism(record: Mapping[str, Any], faults: Faults, proved: bool = False) -> Mechanism:
    """As `described`, but what is wrong is noted, and left out or replaced."""
    second = second_angles(record["x-joint"]) if "x-joint" in record else ()
    read = mechanism_codec(Context(faults, second)).read(
        Node.of(from_python(record, Place()), faults)
    )
    read["bars"] += tuple(bar for joint in read["xjoints"] for bar in joint.rigid)
    found = Mechanism(**read, source=record)
    if not proved:
        if not faults.parts - _FORCELESS:
            check_sizes(found, faults)
        _prove(found, faults)
    return found


def mechanism_codec(context: Context) -> Codec[dict[str, Any]]:
    """A mechanism's keys, read in this order."""
    closing = record(
        lambda between, length: Closing(between[0], between[1], length),
        "{between: [B, D], length: L}",
        between=part(context.between()),
        length=part(context.value()),
    )
    return record(
        dict,
        **context.start(DEFAULT_NAME),
        **_bodies(context),
        **_forces(context),
        symmetries=part(
            listed(
                reading(context.symmetry, type="object", additionalProperties=VALUE),
                most=MAX_ENTRIES,
                like="[{th: -th}]",
            ),
            "Substitutions under which the energy changes by what no unknown is in.",
            (),
        ),
        closing=part(
            listed(closing, most=MAX_ENTRIES, like="[{between: [B, D], length: L}]"),
            "Bars that close loops: two points whose distance stays the length. Where they leave more than one degree "
            "of freedom, the tension of each, divided by its length, is a further unknown.",
            (),
        ),
    )


def _bodies(context: Context) -> dict[str, Key]:
    """The keys of what moves, and of what holds it."""
    return {
        "points": part(
            reading(lambda node: _points(node, context), **POINTS),
            "Names to coordinates, polynomials in parameters, lengths, and cos and sin of sums of angles.",
            instead={},
        ),
        "x-joint": part(
            xjoints(context),
            "X-joints: two crossed bars of one length from a base to a top that is as long as the base. The base "
            "is two points on one level, from left to right, which no unknown moves, or the top of a joint above. "
            "The first bar, from the base's left end to the top's right one, turns by an unknown angle against the "
            "base; the other bar's angle follows, and its name may be used like an unknown's.",
            (),
        )._replace(field="xjoints"),
        "bodies": part(
            bodies(context),
            "Rigid bodies: place, angle, and points in coordinates that turn with the body.",
            {},
        ),
        "bars": part(
            listed(context.between(), most=MAX_ENTRIES, like="[[O, P]]"),
            "Pairs of points, drawn; that their distances are constant is proved.",
            (),
        ),
        "supports": part(
            named(choice(Support), context.known_point, MAX_ENTRIES, "{O: pin}"),
            "What holds a point, for drawings.",
            {},
        ),
    }


def _forces(context: Context) -> dict[str, Key]:
    """The keys of what forces there are."""
    return {
        "springs": part(
            converted(
                listed(_spring(context), None, MAX_ENTRIES, "[{between: [A, P], k: 1}]"),
                _UNWRITTEN,
                _springs,
            ),
            "Springs between points, along their lines.",
            (),
        ),
        "torsion": part(
            converted(
                listed(_torsion_spring(context), None, MAX_ENTRIES, "[{angle: th, k: 1}]"),
                _UNWRITTEN,
                _torsion,
            ),
            "Springs between directions: energy k (1 - cos(angle - rest)), moment k sin(angle - rest). For small "
            "angles that is the linear spring of energy k (angle - rest)^2/2, which is no polynomial in cosines and "
            "sines and no function on a circle.",
            (),
        ),
        "loads": part(
            converted(
                named(_load(context), context.known_point, MAX_ENTRIES, "{P: [0, -W]}"),
                _UNWRITTEN,
                lambda loads: tuple(Load(point, x, y) for point, (x, y) in loads.items()),
            ),
            "Dead forces at points: two components, or a weight, in parameters.",
            (),
        ),
        "moments": part(
            converted(
                named(context.value(moving=True), context.known_unknown, MAX_ENTRIES, "{th: M}"),
                _UNWRITTEN,
                lambda moments: tuple(Moment(*moment) for moment in moments.items()),
            ),
            "Generalised forces on unknowns. Of one that depends on its own unknown the part that varies is the slope "
            "of an energy; the work of the constant part is in no energy that is shown. With one that depends on "
            "another unknown nothing says what is stable.",
            (),
        ),
    }


def _spring(context: Context) -> Codec[dict[str, Any]]:
    value = context.value()
    return record(
        dict,
        "{between: [A, B], k: 1}",
        between=part(context.between(), instead=("", "")),
        k=part(value, "Stiffness.", instead=ONE),
        free=part(value, "Free length.", ZERO, shown=0),
    )


def _torsion_spring(context: Context) -> Codec[dict[str, Any]]:
    return record(
        dict,
        "{angle: th, k: 1}",
        angle=part(
            reading(context.angle, **VALUE),
            "A sum of whole multiples of unknown angles, and of quarter turns such as pi/2.",
            instead=(ZERO, 0),
        ),
        k=part(context.value(), "Stiffness, a moment.", instead=ONE),
        rest=part(
            reading(_rest, anyOf=[{"enum": [0, *NAMED_RESTS]}, _DIRECTION.schema]),
            "The angle at which it is relaxed, or its cosine and sine.",
            (Fraction(1), Fraction(0)),
            shown=0,
        ),
        at=part(
            reading(lambda entry: context.known_point(entry, entry.plain), **NAME_SCHEMA),
            "The point at which it is drawn, where bodies, bars and supports do not tell the joint; it changes no "
            "result.",
            "",
        ),
    )


_SHAPE = frozenset({"parameters", "unknowns", "points", "bodies", "x-joint"})
_FORCELESS = frozenset({"name", "title", "bars", "supports", "symmetries"})


def _prove(found: Mechanism, faults: Faults) -> None:
    """Note what the parts show together only, where the parts that are concerned are right."""
    faulty = faults.parts
    if not faulty & _SHAPE:
        check_bars(found, faults)
        if found.closing and "closing" not in faulty:
            check_closing(found, faults)
        if "springs" not in faulty and "torsion" not in faulty:
            check_elements(found, faults)
    if not faulty - _FORCELESS:
        check_unknowns(found, faults)
        check_symmetries(found, faults)
        check_loops(found, faults)
        with faults:
            try:
                split_moments(found)
            except ExpressionError as error:  # too large to be integrated
                raise ConfigError(f"they have no energy: {error.message}", key="moments") from None


def _points(node: Node, context: Context) -> dict[str, tuple[Tree, Tree]]:
    entries = node.mapping(like="{A: [0, 0]}")
    context.points = {}

    def read(entry: Node) -> None:
        context.points[entry.name] = (ZERO, ZERO)  # known, whatever is wrong with it
        new_name(entry.name, entry.key, {})
        context.points[entry.name] = context.pair(entry, moving=True)

    node.gathered(read, entries.values())
    return context.points


def _springs(found: tuple[dict[str, Any], ...]) -> tuple[Spring, ...]:
    springs: dict[str, Spring] = {}
    for n, said in enumerate(found, 1):
        (start, end), stiffness = said["between"], said["k"]
        names = (
            *([stiffness.name] if isinstance(stiffness, Name) else []),
            f"{start}{end}",
            f"{start}{end}_{n}",
        )
        name = next(name for name in names if name not in springs)
        springs[name] = Spring(name, start, end, stiffness, said["free"])
    return tuple(springs.values())


def _torsion(found: tuple[dict[str, Any], ...]) -> tuple[TorsionSpring, ...]:
    springs: dict[str, TorsionSpring] = {}
    for n, said in enumerate(found, 1):
        (angle, turns), rest = said["angle"], said["rest"]
        for _ in range(turns):  # what is added to the angle is taken from the rest
            rest = (rest[1], -rest[0])
        of_angle = angle_name(angle)
        name = of_angle if of_angle and of_angle not in springs else f"{of_angle}#{n}"
        springs[name] = TorsionSpring(angle, said["k"], rest, name, said["at"])
    return tuple(springs.values())


def _weight(weight: Tree) -> tuple[Tree, Tree]:
    return ZERO, Negative(weight)


def _load(context: Context) -> Codec[tuple[Tree, Tree]]:
    """Two components, or a weight."""
    weight = record(_weight, "{weight: W}", weight=part(context.value(), default=ZERO)).narrowed(
        required=["weight"]
    )

    def read(entry: Node) -> tuple[Tree, Tree]:
        if entry.is_mapping and entry.mapping():
            return weight.read(entry)
        return context.pair(entry, what="components", like="[0, -W], or {weight: W}")

    return reading(read, anyOf=[two(VALUE), weight.schema])


_DIRECTION = record(
    lambda cos, sin: (cos, sin),
    "{cos: 3/5, sin: 4/5}",
    **{
        name: part(reading(lambda entry: value_at(parse(constant(entry)), {}), **NUMBER))
        for name in ("cos", "sin")
    },
)


def _rest(entry: Node) -> tuple[Fraction, Fraction]:
    """The cosine and sine of the angle at which a torsion spring is relaxed."""
    if entry.is_mapping:
        c, s = _DIRECTION.read(entry)
        if c * c + s * s != 1:
            raise entry.fault(f"cos^2 + sin^2 is {c * c + s * s}, not 1: no angle has these")
        return c, s
    value = entry.plain
    named = NAMED_RESTS.get(str(value).replace(" ", "") if isinstance(value, str | int) else "")
    if named is None:
        raise entry.fault(
            f"{as_written(value)} is none of {', '.join(NAMED_RESTS)}: of other angles give the cosine and sine, such "
            "as {cos: 3/5, sin: 4/5}"
        )
    return Fraction(named[0]), Fraction(named[1])
