"""A family as a JSON document: its free parameter, its surfaces, its changes, and the files of its
members' maps.

Guarantee: numbers are exact; reading gives what was written, and refuses what contradicts itself.
The maps themselves are documents of their own, in files beside this one.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from operator import itemgetter
from pathlib import PurePath
from typing import Any

from ptmcad.answer.arrangement import SIDES, Arrangement
from ptmcad.answer.family import TOLERANCE, Changes, FamilyMap
from ptmcad.question.slice import Axis
from ptmcad.show.document.exactnumbers import ALGEBRAIC, AXIS, LINE, NUMBER
from ptmcad.text.codec import (
    NATURAL,
    RATIONAL,
    Codec,
    Key,
    converted,
    line,
    listed,
    named,
    record,
    record_of,
)
from ptmcad.text.documents import document_text
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.node import Node, opened

FORMAT = "ptmcad-family/1"
MAX_DOCUMENT = 60_000_000
MAX_MEMBERS = 10_000


def write_family(family: FamilyMap) -> str:
    """The document as JSON text; it names the members' files by their slices."""
    return document_text(FORMAT, _codec(family.free).write(family))


def read_family(text: str) -> tuple[FamilyMap, tuple[str, ...]]:
    """What `write_family` wrote: the family without its members' maps, and the files of these.

    Raises
    ------
    ValueError
        When the text is not such a document.
    """
    document = opened(text, FORMAT, MAX_DOCUMENT, "ptmcad classify")
    found: tuple[FamilyMap, tuple[str, ...]]
    found = _codec(AXIS.read(document.entry("free"))).read(document)
    return found


def _codec(free: Axis) -> Codec[Any]:
    """The codec of a family with this free parameter."""
    name = line(300)
    member: Codec[tuple[Fraction, str]] = record(
        lambda value, file: (value, file), value=Key(RATIONAL, itemgetter(0)),
        file=Key(converted(name, str, _file), itemgetter(1)),
    )  # fmt: skip
    return record(
        _family, name=name, title=name, free=AXIS, parameters=Key(named(LINE), field="text"),
        surfaces=listed(listed(_TERM)),
        members=Key(
            listed(member), lambda family: [(value, f"{m.slice.name}.json") for value, m in family]
        ),
        changes=Key(changes_codec(free), default=None),
    )  # fmt: skip


def _file(name: str) -> str:
    """A name of a file beside the document, none elsewhere."""
    if PurePath(name).name != name or not name.endswith(".json"):
        raise ValueError("expected the name of a file beside it")
    return name


def _family(
    members: tuple[tuple[Fraction, str], ...], **entries: Any
) -> tuple[FamilyMap, tuple[str, ...]]:
    values = tuple(value for value, _ in members)
    found = FamilyMap(values=values, members=(), **entries)
    free = found.free
    if not all(found.surfaces):
        raise ValueError("a surface has no terms")
    if found.text.get(free.name, free.name) != free.name:
        raise ValueError(f"the free parameter {free.name} is another one")
    if not 1 <= len(values) <= MAX_MEMBERS or any(a >= b for a, b in pairwise(values)):
        raise ValueError("the members' values do not increase")
    if (
        values[0] < free.low
        or values[-1] > free.high
        or len({*found.surfaces}) < len(found.surfaces)
    ):
        raise ValueError("a member is outside of the range, or a surface is listed twice")
    return found, tuple(file for _, file in members)


def _term(node: Node) -> tuple[tuple[int, ...], int]:
    *powers, coefficient = node.items(4)
    return tuple(power.natural() for power in powers), coefficient.integer()


_TERM: Codec[Any] = Codec(lambda term: [*term[0], str(term[1])], _term, {"type": "array"})


# --------------------------------------------------------------------------------------------------------- changes


def changes_codec(free: Axis) -> Codec[Changes]:
    """The codec of the changes over a free parameter."""

    def made(changes: Any, between: Any, **entries: Any) -> Changes:
        if entries["complete"] and not all(change.is_exact for change in changes):
            raise ValueError("a value that is not exact stands where one has to be")
        ends = [
            free.low,
            *(end for change in changes for end in (change.value.low, change.value.high)),
            free.high,
        ]
        if len(between) != len(changes) + 1 or any(
            not low <= value <= high
            for low, (value, _), high in zip(ends[::2], between, ends[1::2], strict=True)
        ):
            raise ValueError("the values between the changes do not lie between them")
        values, arrangements = zip(*between, strict=True)
        return Changes(free, changes, between=values, arrangements=arrangements, **entries)

    member = record(
        lambda value, arrangement: (value, arrangement), value=Key(RATIONAL, itemgetter(0)),
        arrangement=Key(_ARRANGEMENT, itemgetter(1)),
    )  # fmt: skip
    return record_of(
        Changes, {AlgebraicNumber | Enclosure: NUMBER, AlgebraicNumber: ALGEBRAIC}, made, free=None,
        found=Key(field="changes"), arrangements=None, tolerance=Key(default=TOLERANCE, always=True),
        between=Key(listed(member), lambda found: tuple(zip(found.between, found.arrangements, strict=True))),
    )  # fmt: skip


def _pairs(pairs: tuple[tuple[int, int], ...]) -> frozenset[tuple[int, int]]:
    if len(found := frozenset(pairs)) < len(pairs):
        raise ValueError("an arrangement names two neighbours twice")
    return found


def _sides(sides: Mapping[str, tuple[int, ...]]) -> tuple[tuple[int, ...], ...]:
    if set(sides) != set(SIDES):
        raise ValueError(f"an arrangement has the sides {', '.join(SIDES)}")
    return tuple(sides[name] for name in SIDES)


def _arrangement(**entries: Any) -> Arrangement:
    found = Arrangement(**entries)
    numbers = {n for group in (*found.neighbours, *found.sides) for n in group}
    if any(n >= len(found.keys) for n in numbers) or any(a >= b for a, b in found.neighbours):
        raise ValueError("an arrangement names a region that there is not")
    return found


_ARRANGEMENT = record_of(
    Arrangement, {}, _arrangement, counts=Key(field="keys"),
    neighbours=converted(listed(listed(NATURAL, 2)), lambda pairs: tuple(sorted(pairs)), _pairs),
    sides=converted(named(listed(NATURAL)), lambda sides: dict(zip(SIDES, sides, strict=True)), _sides),
)  # fmt: skip
