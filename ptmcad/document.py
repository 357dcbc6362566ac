"""A region map as a JSON document, and back: the stored result with its certificate.

Guarantee: reading what was written gives an equal map. A document that is not one is refused with the place of the
first fault: every key must be known and present, every value of its type and within the limits below, and no key may
occur twice. Whether what it claims is true is not asked here; `ptmcad.verify` does that.

The schema is published as docs/region-map.schema.json; its version is part of `FORMAT`.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import Any, TypeVar

from ptmcad.errors import ExpressionError
from ptmcad.expressions import NAME, Expression, parse
from ptmcad.expressions import axis as axis_function
from ptmcad.numerals import decimal, fraction_of, integer_text, shortest_text, text_of
from ptmcad.plane import PlanePolynomial
from ptmcad.regionmap import (
    Adjacency,
    Cell,
    Component,
    CriticalValue,
    Kind,
    Merge,
    MorseIndex,
    NonAdjacency,
    PlanStep,
    Reason,
    Region,
    RegionMap,
    Segment,
    Solution,
    Stack,
    Status,
    System,
    Wall,
)
from ptmcad.slice import Axis, Count, Point, Slice

FORMAT = "ptmcad-region-map/2"

# Limits far beyond any slice's result; they bound the time in which a damaged document is refused.
MAX_TEXT = 20_000_000
MAX_ITEMS = 100_000
MAX_COMPONENTS = 1_000
MAX_DEGREE = 400
MAX_NUMBER = 10**6
"""Of cells, regions, equilibria."""
MAX_NAME = 100
MAX_TITLE = 300

Item = TypeVar("Item")
Choice = TypeVar("Choice", bound=Enum)


# ------------------------------------------------------------------------------------------------------- writing


def write(result: RegionMap, timings: bool = True) -> str:
    """The map as JSON text, one record a line, so that differences between two files stay small."""
    data = _encode(result)
    if timings:
        data["timings"] = {name: round(seconds, 6) for name, seconds in result.timings.items()}
    lines = []
    for key, value in data.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            items = ",\n".join("    " + json.dumps(item, ensure_ascii=False) for item in value)
            lines.append(f"  {json.dumps(key)}: [\n{items}\n  ]")
        else:
            lines.append(f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _encode(result: RegionMap) -> dict[str, Any]:
    names = result.slice.axis_names
    return {
        "format": FORMAT,
        "status": result.status.value,
        "slice": {
            "name": result.slice.name,
            "title": result.slice.title,
            "mechanism": result.slice.mechanism,
            "axes": {a.name: [text_of(a.low), text_of(a.high)] for a in result.slice.axes},
            "parameters": {n: e.to_text(names) for n, e in result.slice.parameters.items()},
            "text": dict(result.slice.text),
            "count": result.slice.count.value,
            "reference": dict(result.slice.reference),
        },
        "system": {
            "unknowns": result.system.unknowns,
            "relations": result.system.relations,
            "potential": result.system.potential,
            "gradient": result.system.gradient,
            "hessian": result.system.hessian,
        },
        "base": names[result.base],
        "complex_solutions": result.complex_solutions,
        "undetermined": text_of(result.undetermined),
        "regions": [
            {
                "stable": r.stable,
                "total": r.total,
                "index": r.index,
                "area": [decimal(r.area[0], up=False), decimal(r.area[1], up=True)],
                "sample": _point(r.sample),
                "cells": r.cells,
            }
            for r in result.regions
        ],
        "components": [
            {
                "kind": c.kind.value,
                "separates": c.separates,
                "left_out": c.left_out,
                "polynomial": c.polynomial.text(names),
            }
            for c in result.components
        ],
        "critical_values": [
            {
                "polynomial": [integer_text(c) for c in v.polynomial],
                "low": text_of(v.low),
                "high": text_of(v.high),
                "origin": v.origin,
            }
            for v in result.critical_values
        ],
        "stacks": [
            {
                "left": s.left,
                "right": s.right,
                "sample": text_of(s.sample),
                "walls": [[w.component, w.root] for w in s.walls],
                "cells": s.cells,
            }
            for s in result.stacks
        ],
        "cells": [
            {
                "stack": c.stack,
                "level": c.level,
                "sample": _point(c.sample),
                "region": c.region,
                "total": c.total,
                "stable": c.stable,
                "index": c.index,
                "solutions": [
                    {
                        "center": [shortest_text(x) for x in s.center],
                        "radius": shortest_text(s.radius),
                        "signs": s.signs,
                    }
                    for s in c.solutions
                ],
            }
            for c in result.cells
        ],
        "adjacencies": [
            {
                "cells": [a.first, a.second],
                "merge": a.merge.value,
                "component": a.component,
                "segment": _segment(a.segment),
            }
            for a in result.adjacencies
        ],
        "non_adjacencies": [
            {
                "critical_value": a.critical_value,
                "left": a.left,
                "right": a.right,
                "below": _segment(a.below),
                "above": _segment(a.above),
                "reason": a.reason.value,
            }
            for a in result.non_adjacencies
        ],
        "plan": [{"what": p.what, "done": p.done, "reason": p.reason} for p in result.plan],
        "versions": dict(result.versions),
        "precision": dict(result.precision),
    }


def _point(point: Point) -> dict[str, str]:
    return {name: text_of(point[name]) for name in point.names}


def _solution_data(s: Solution) -> dict[str, Any]:
    return {"center": [shortest_text(x) for x in s.center], "radius": shortest_text(s.radius), "signs": s.signs}


def _segment(segment: Segment | None) -> list[str] | None:
    return None if segment is None else [text_of(q) for q in segment]


# ------------------------------------------------------------------------------------------------------- reading


@dataclass(frozen=True, slots=True)
class _Node:
    """A value of the document with its place, such as ``cells[3].sample``."""

    value: Any
    place: str

    def fault(self, problem: str) -> ValueError:
        return ValueError(f"{self.place or 'the document'} {problem}")

    def record(self, *keys: str) -> dict[str, _Node]:
        """An object with exactly these keys; those that end in ``?`` may be missing."""
        required = [key for key in keys if not key.endswith("?")]
        known = {key.rstrip("?") for key in keys}
        values = self.mapping()
        for key in required:
            if key not in values:
                raise self.fault(f"lacks the key {key!r}")
        for key in values:
            if key not in known:
                raise self.fault(f"has the unknown key {key[:40]!r}")
        return values

    def mapping(self) -> dict[str, _Node]:
        if not isinstance(self.value, dict):
            raise self.fault("is not an object")
        if len(self.value) > MAX_ITEMS:
            raise self.fault(f"has more than {MAX_ITEMS} keys")
        start = f"{self.place}." if self.place else ""
        return {key: _Node(value, start + key[:40]) for key, value in self.value.items()}

    def items(self, length: int | None = None) -> Iterator[_Node]:
        if not isinstance(self.value, list):
            raise self.fault("is not a list")
        if len(self.value) > MAX_ITEMS:
            raise self.fault(f"has more than {MAX_ITEMS} entries")
        if length is not None and len(self.value) != length:
            raise self.fault(f"has {len(self.value)} entries, not {length}")
        return (_Node(value, f"{self.place}[{k}]") for k, value in enumerate(self.value))

    def each(self, read: Callable[[_Node], Item], length: int | None = None) -> tuple[Item, ...]:
        return tuple(read(item) for item in self.items(length))

    def text(self) -> str:
        if not isinstance(self.value, str):
            raise self.fault("is not a text")
        return self.value

    def line(self, most: int) -> str:
        """A short text that a terminal shows as it is."""
        text = self.text()
        if len(text) > most or not text.isprintable():
            raise self.fault(f"is not a line of at most {most} printable characters")
        return text

    def truth(self) -> bool:
        if not isinstance(self.value, bool):
            raise self.fault("is not true or false")
        return self.value

    def natural(self) -> int:
        if not isinstance(self.value, int) or isinstance(self.value, bool):
            raise self.fault("is not an integer")
        if not 0 <= self.value <= MAX_NUMBER:
            raise self.fault(f"is not between 0 and {MAX_NUMBER}")
        return self.value

    def number(self) -> float:
        """For timings only."""
        if not isinstance(self.value, int | float) or isinstance(self.value, bool):
            raise self.fault("is not a number")
        if not 0 <= self.value < 1e9:
            raise self.fault("is not a number of seconds")
        return float(self.value)

    def optional(self, read: Callable[[_Node], Item]) -> Item | None:
        return None if self.value is None else read(self)

    def fraction(self) -> Fraction:
        try:
            return fraction_of(self.text())
        except ValueError as error:
            raise self.fault(f"is wrong: {error}") from error

    def size(self) -> Fraction:
        """A number that is not negative."""
        value = self.fraction()
        if value < 0:
            raise self.fault("is negative")
        return value

    def choice(self, kind: type[Choice]) -> Choice:
        text = self.text()
        if text not in {member.value for member in kind}:
            raise self.fault(f"is {text[:40]!r}, not one of {', '.join(str(member.value) for member in kind)}")
        return kind(text)


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        key = next(k for n, (k, _) in enumerate(pairs) if k in (other for other, _ in pairs[:n]))
        raise ValueError(f"the key {key[:40]!r} occurs twice")
    return found


def _constant(text: str) -> Any:
    raise ValueError(f"{text} is not a number of JSON")


def read(text: str) -> RegionMap:
    """The map in a JSON document.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    if len(text) > MAX_TEXT:
        raise ValueError(f"the document has {len(text)} characters, more than {MAX_TEXT}")
    try:
        data = json.loads(text, object_pairs_hook=_distinct, parse_constant=_constant)
    except RecursionError as error:
        raise ValueError("the document is nested too deeply") from error
    node = _Node(data, "")
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, dict) else None
        raise ValueError(f"its format is {str(found)[:40]!r}, not {FORMAT!r}; make it anew with ptmcad classify")
    return _decode(node)


def _decode(document: _Node) -> RegionMap:
    data = document.record(
        "format", "status", "slice", "system", "base", "complex_solutions", "undetermined", "regions", "components",
        "critical_values", "stacks", "cells", "adjacencies", "non_adjacencies", "plan", "versions", "precision",
        "timings?",
    )  # fmt: skip
    slice = _slice(data["slice"])
    names = slice.axis_names

    def point(node: _Node) -> Point:
        values = node.record(*names)
        return Point(names, values[names[0]].fraction(), values[names[1]].fraction())

    def component(node: _Node) -> Component:
        c = node.record("kind", "separates", "left_out", "polynomial")
        polynomial = _polynomial(c["polynomial"], names)
        return Component(polynomial, c["kind"].choice(Kind), c["left_out"].text(), c["separates"].truth())

    def region(node: _Node) -> Region:
        r = node.record("stable", "total", "index", "area", "sample", "cells")
        low, high = r["area"].each(_Node.size, 2)
        stable, total = r["stable"].optional(_Node.natural), r["total"].optional(_Node.natural)
        cells = r["cells"].each(_Node.natural)
        return Region(stable, total, r["index"].optional(_index), (low, high), cells, point(r["sample"]))

    def cell(node: _Node) -> Cell:
        c = node.record("stack", "level", "sample", "region", "total", "stable", "index", "solutions")
        return Cell(
            stack=c["stack"].natural(),
            level=c["level"].natural(),
            sample=point(c["sample"]),
            region=c["region"].natural(),
            total=c["total"].optional(_Node.natural),
            stable=c["stable"].optional(_Node.natural),
            index=c["index"].optional(_index),
            solutions=c["solutions"].each(_solution),
        )

    if (base := data["base"].text()) not in names:
        raise data["base"].fault(f"is {base[:40]!r}, which is not an axis")
    if len(tuple(data["components"].items())) > MAX_COMPONENTS:
        raise data["components"].fault(f"has more than {MAX_COMPONENTS} entries")
    if (undetermined := data["undetermined"].size()) > 1:
        raise data["undetermined"].fault("is more than the whole window")
    return RegionMap(
        slice=slice,
        status=data["status"].choice(Status),
        system=_system(data["system"]),
        base=names.index(base),
        complex_solutions=data["complex_solutions"].natural(),
        components=data["components"].each(component),
        critical_values=data["critical_values"].each(_critical_value),
        stacks=data["stacks"].each(_stack),
        cells=data["cells"].each(cell),
        adjacencies=data["adjacencies"].each(_adjacency),
        non_adjacencies=data["non_adjacencies"].each(_non_adjacency),
        regions=data["regions"].each(region),
        plan=data["plan"].each(_plan_step),
        undetermined=undetermined,
        versions={name: node.text() for name, node in data["versions"].mapping().items()},
        precision={name: node.natural() for name, node in data["precision"].mapping().items()},
        timings={n: s.number() for n, s in data["timings"].mapping().items()} if "timings" in data else {},
    )


def _slice(node: _Node) -> Slice:
    head = node.record("name", "title", "mechanism", "axes", "parameters", "text", "count", "reference")
    axes = [Axis(name, *ends.each(_Node.fraction, 2)) for name, ends in head["axes"].mapping().items()]
    if len(axes) != 2 or not all(NAME.fullmatch(a.name) for a in axes):
        raise head["axes"].fault("does not hold two named axes")
    for a in axes:
        if a.low >= a.high:
            raise head["axes"].fault(f"has an empty range for {a.name}")
    name = head["name"].line(MAX_NAME)
    if not all(c.isalnum() or c in "._-" for c in name):
        raise head["name"].fault("can not name a file")
    functions = {axes[0].name: axis_function(0), axes[1].name: axis_function(1)}

    def expression(value: _Node) -> Expression:
        try:
            return parse(value.text(), functions)
        except ExpressionError as error:
            raise value.fault(f"is wrong: {error}") from error

    return Slice(
        name=name,
        mechanism=head["mechanism"].line(MAX_NAME),
        axes=(axes[0], axes[1]),
        parameters={name: expression(value) for name, value in head["parameters"].mapping().items()},
        count=head["count"].choice(Count),
        title=head["title"].line(MAX_TITLE),
        text={name: value.text() for name, value in head["text"].mapping().items()},
        reference={name: value.value for name, value in head["reference"].mapping().items()},
    )


def _system(node: _Node) -> System:
    s = node.record("unknowns", "relations", "potential", "gradient", "hessian")
    return System(
        unknowns=s["unknowns"].each(_Node.text),
        relations=s["relations"].each(_Node.text),
        potential=s["potential"].text(),
        gradient=s["gradient"].each(_Node.text),
        hessian=s["hessian"].each(lambda row: row.each(_Node.text)),
    )


def _polynomial(node: _Node, names: tuple[str, str]) -> PlanePolynomial:
    try:
        polynomial = PlanePolynomial.parse(node.text(), names)
    except ValueError as error:
        raise node.fault(f"is wrong: {error}") from error
    if max(polynomial.degrees) > MAX_DEGREE:
        raise node.fault(f"has a degree over {MAX_DEGREE}")
    return polynomial


def _whole(node: _Node) -> int:
    value = node.fraction()
    if value.denominator != 1:
        raise node.fault("is not an integer")
    return value.numerator


def _critical_value(node: _Node) -> CriticalValue:
    v = node.record("polynomial", "low", "high", "origin")
    return CriticalValue(v["polynomial"].each(_whole), v["low"].fraction(), v["high"].fraction(), v["origin"].text())


def _stack(node: _Node) -> Stack:
    s = node.record("left", "right", "sample", "walls", "cells")

    def wall(pair: _Node) -> Wall:
        component, root = pair.each(_Node.natural, 2)
        return Wall(component, root)

    left, right = s["left"].optional(_Node.natural), s["right"].optional(_Node.natural)
    return Stack(left, right, s["sample"].fraction(), s["walls"].each(wall), s["cells"].each(_Node.natural))


def _index(node: _Node) -> MorseIndex:
    minima, saddles, maxima = node.each(_Node.natural, 3)
    return (minima, saddles, maxima)


def _solution(node: _Node) -> Solution:
    s = node.record("center", "radius", "signs")
    return Solution(s["center"].each(_Node.fraction), s["radius"].fraction(), s["signs"].text())


def _adjacency(node: _Node) -> Adjacency:
    a = node.record("cells", "merge", "component", "segment")
    first, second = a["cells"].each(_Node.natural, 2)
    component = a["component"].optional(_Node.natural)
    return Adjacency(first, second, component, a["segment"].optional(_triple), a["merge"].choice(Merge))


def _non_adjacency(node: _Node) -> NonAdjacency:
    a = node.record("critical_value", "left", "right", "below", "above", "reason")
    return NonAdjacency(
        critical_value=a["critical_value"].natural(),
        left=a["left"].each(_Node.natural),
        right=a["right"].each(_Node.natural),
        below=a["below"].optional(_triple),
        above=a["above"].optional(_triple),
        reason=a["reason"].choice(Reason),
    )


def _triple(node: _Node) -> Segment:
    low, high, height = node.each(_Node.fraction, 3)
    return (low, high, height)


def _plan_step(node: _Node) -> PlanStep:
    p = node.record("what", "done", "reason")
    return PlanStep(p["what"].text(), p["done"].truth(), p["reason"].text())
