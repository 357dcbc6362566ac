"""A region map as a JSON document, docs/region-map.schema.json, and back: the stored result with
its certificate.

Guarantee: reading what was written gives an equal map; numbers are written exactly, areas of an
exact map as decimals of 18 digits rounded outwards; the same map gives the same text, timings
apart. A document that is not one is refused with the place of the first fault: every key must be
known and present, every value of its type and within limits, and no key may occur twice; a
cover's rectangles lie in the window, sorted and distinct. Whether what it claims is true is not
asked here; `ptmcad.verify` does that. Slanted pieces of earlier versions become rectangles.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import islice, pairwise
from operator import attrgetter
from typing import Any

from ptmcad.answer.regionmap import (
    Adjacency,
    Cell,
    Component,
    CriticalValue,
    PlanStep,
    Region,
    RegionMap,
    Solution,
    Status,
    System,
    Wall,
)
from ptmcad.cover.rectangles import MAX_STEPS, Cover
from ptmcad.question.counts import PREDICATES, Count
from ptmcad.question.slice import Point, Slice
from ptmcad.show.document.exactnumbers import INDEX, merged
from ptmcad.show.document.slantedpieces import rectangles_around, with_cover
from ptmcad.show.document.slicedocument import SLICE, polynomial_over
from ptmcad.text.codec import (
    COUNT,
    INTEGER,
    NATURAL,
    RATIONAL,
    SECONDS,
    SHARE,
    SHORT_DECIMAL,
    TEXT,
    Codec,
    Key,
    choice,
    converted,
    listed,
    named,
    record_of,
    unless_default,
)
from ptmcad.text.documents import document_text
from ptmcad.text.node import Node, opened
from ptmcad.text.numerals import decimal
from ptmcad.text.plane import Names, PlanePolynomial

FORMAT = "ptmcad-region-map/2"
MAX_TEXT = 60_000_000
MAX_COMPONENTS = 1_000
_EXACT_ONLY = ("components", "critical_values", "stacks", "adjacencies", "non_adjacencies")
"""What a certified map does not have."""


def write(result: RegionMap, timings: bool = True) -> str:
    """The map as JSON text."""
    cover = result.cover
    codec = _codec(result.slice.axis_names, cover is not None)
    kept = {name: round(seconds, 6) for name, seconds in result.timings.items()} if timings else {}
    data = codec.write(replace(result, timings=kept, cover=None))
    return document_text(FORMAT, data, () if cover is None else (cover_line(cover),))


def read(text: str) -> RegionMap:
    """The map in a JSON document.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    document = opened(text, FORMAT, MAX_TEXT, "ptmcad classify")
    slice = SLICE.read(document.entry("slice"))
    certified = "cover" in document.value
    status = _STATUS.read(document.entry("status"))
    if not certified and (status is Status.CERTIFIED or _needs_cover(slice.count)):
        raise document.fault("lacks the key 'cover', which a certified map has")
    if certified and status not in (Status.CERTIFIED, Status.PARTIAL):
        raise document.entry("status").fault("is not that of a map with a cover")
    for key in _EXACT_ONLY if certified else ():
        if (place := document.entry(key)).value != []:
            raise place.fault("is not empty, as it is in a map with a cover")
    found = _codec(slice.axis_names, certified, slice).read(document)
    if found.cover is not None and document.entry("cover").has("patches"):
        return with_cover(found, found.cover)
    return found


def _needs_cover(count: Count) -> bool:
    predicate = count.kind.predicate
    return predicate is not None and predicate.needs_free_lengths


_ALWAYS = Key(COUNT, entry_of="further")
_WHERE_COUNTED = Key(NATURAL, default=None, entry_of="further")
"""Numbers of solutions at which predicates hold."""
_STATUS = choice(Status).narrowed(enum=["exact", "certified", "partial", "undecided"])


def _codec(names: Names, certified: bool, slice: Slice | None = None) -> Codec[RegionMap]:
    """The codec of a map over axes of these names.

    Parameters
    ----------
    slice : that of the map, where it has been read.
    """
    point: Codec[Point] = Codec(
        lambda at: {name: RATIONAL.write(at[name]) for name in names},
        lambda node: _point(node, names),
        named(RATIONAL).narrowed(minProperties=2, maxProperties=2).schema,
    )
    base: Codec[int] = Codec(lambda k: names[k], lambda node: _axis(node, names), TEXT.schema)
    known: dict[Any, Codec[Any]] = {
        Slice: SLICE if slice is None else SLICE._replace(read=lambda _: slice),
        Point: point,
        PlanePolynomial: polynomial_over(names),
        System: record_of(System, **unless_default(System, "inequalities", "stability", "moments")),
        CriticalValue: record_of(CriticalValue, polynomial=listed(INTEGER)),
        Solution: record_of(Solution, {Fraction: SHORT_DECIMAL}, signs=TEXT.narrowed(pattern="^[-+0]*$")),
        Wall: converted(listed(NATURAL, 2), attrgetter("component", "root"), lambda pair: Wall(*pair)),
        Adjacency: record_of(
            Adjacency, {}, lambda cells, **rest: Adjacency(cells[0], cells[1], **rest), first=None, second=None,
            cells=Key(listed(NATURAL, 2), attrgetter("first", "second")),
        ),
        PlanStep: record_of(PlanStep, **unless_default(PlanStep, "saving")),
    }  # fmt: skip
    # an area that a checker is to confirm needs no more digits; one that is a sum of rectangles is
    # exact as it is
    area: Codec[Any] = listed(SHARE, 2)
    if not certified:
        area = area._replace(write=lambda ends: [decimal(ends[0], False), decimal(ends[1], True)])
    known[Status] = _STATUS
    known[Component] = record_of(Component, known, **unless_default(Component, "continuum"))
    predicates = {
        name: each for name, each in PREDICATES.items() if certified or not each.needs_free_lengths
    }
    further = {
        name: _ALWAYS if each.is_always_stored else _WHERE_COUNTED
        for name, each in predicates.items()
    }
    known[Region] = record_of(Region, known, area=area, index=INDEX, further=None, **further)
    stack = _NO_STACK if certified else NATURAL
    known[Cell] = record_of(Cell, known, index=INDEX, stack=stack, further=None, **further)
    return record_of(
        RegionMap, known, base=base, undetermined=Codec(RATIONAL.write, _share, SHARE.schema),
        components=listed(known[Component], most=MAX_COMPONENTS),
        timings=Key(named(SECONDS), default={}), cover=Key(COVER, default=None),
    )  # fmt: skip


def _point(node: Node, names: Names) -> Point:
    values = node.record(names, names)
    return Point(names, values[names[0]].fraction(), values[names[1]].fraction())


def _axis(node: Node, names: Names) -> int:
    if (name := node.text()) not in names:
        raise node.fault(f"is {name[:40]!r}, which is not an axis")
    return names.index(name)


def _share(node: Node) -> Fraction:
    if (share := node.size()) > 1:
        raise node.fault("is more than the whole window")
    return share


def _null(node: Node) -> None:
    if node.value is not None:
        raise node.fault("is not null, as it is in a map with a cover")


_NO_STACK: Codec[None] = Codec(lambda stack: stack, _null, {"type": "null"})


def schema() -> Mapping[str, Any]:
    """Of an exact map and of a certified one."""
    return merged(*(_codec(("x", "y"), certified).schema for certified in (False, True)))


MAX_RECTANGLES = 1_000_000


def _cover(node: Node) -> Cover:
    """The cover: its rectangles are one list of integers, four for each.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    entry = node.record(("steps", "rectangles", "patches"), ("steps", "rectangles"))
    steps = entry["steps"].value
    if type(steps) is not int or not 0 < steps <= MAX_STEPS or steps & (steps - 1):
        raise entry["steps"].fault(f"is not a power of two up to {MAX_STEPS}")
    # not by `Node.each`, which would make an object of each of millions of numbers
    place, numbers = entry["rectangles"], entry["rectangles"].value
    if (
        not isinstance(numbers, list)
        or len(numbers) % 4
        or not all(type(n) is int for n in numbers)
    ):
        raise place.fault("is not a list of integers, four for each rectangle")
    if len(numbers) > 4 * MAX_RECTANGLES:
        raise place.fault(f"has more than {MAX_RECTANGLES} rectangles")
    rectangles = tuple(zip(numbers[::4], numbers[1::4], numbers[2::4], numbers[3::4], strict=True))
    for k, (left, right, bottom, top) in enumerate(rectangles):
        if not (0 <= left < right <= steps and 0 <= bottom < top <= steps):
            raise place.fault(
                f"has a rectangle, number {k}, that does not lie in the window: left, right, bottom, top"
            )
    for k, (one, next_one) in enumerate(pairwise(rectangles)):
        if one >= next_one:
            raise place.fault(
                f"is not sorted, or not of distinct rectangles: see numbers {k} and {k + 1}"
            )
    if "patches" in entry:
        around = rectangles_around(entry["patches"], steps)
        rectangles = tuple(sorted({*rectangles, *islice(around, MAX_RECTANGLES)}))
        if next(around, None) is not None:
            raise entry["patches"].fault(f"needs more than {MAX_RECTANGLES} rectangles")
    return Cover(steps, rectangles)


def cover_line(cover: Cover) -> str:
    """The cover with a line for each rectangle and nothing more: there may be a million of them."""
    rectangles = ",\n".join(
        f"{left},{right},{low},{high}" for left, right, low, high in cover.rectangles
    )
    return f'  "cover": {{"steps": {cover.steps}, "rectangles": [\n{rectangles}\n]}}'


_INTEGERS = {"type": "array", "items": {"type": "integer", "minimum": 0}}
COVER: Codec[Cover] = Codec(
    lambda cover: json.loads("{" + cover_line(cover) + "}")["cover"],
    _cover,
    {
        "type": "object",
        "properties": {
            "steps": {"type": "integer", "minimum": 1, "maximum": MAX_STEPS},
            "rectangles": _INTEGERS,
            "patches": {"type": "array", "items": {"type": "array", "minItems": 6}},
        },
        "required": ["steps", "rectangles"],
        "additionalProperties": False,
    },
)
