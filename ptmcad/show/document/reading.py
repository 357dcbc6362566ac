"""Reading a region map from JSON.

Guarantee: what is returned has the types and sizes that `RegionMap` asks for; every fault is a ValueError that names
its place.
"""

from __future__ import annotations

from ptmcad.answer.regionmap import (
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
from ptmcad.errors import ExpressionError
from ptmcad.question.slice import Axis, Count, Point, Slice
from ptmcad.show.document.cover import read_cover
from ptmcad.show.document.node import Node, opened
from ptmcad.show.document.writing import FORMAT
from ptmcad.text.expressions import Expression, parse
from ptmcad.text.expressions import axis as axis_function
from ptmcad.text.plane import PlanePolynomial
from ptmcad.text.syntax import NAME

# Limits far beyond any slice's result, like those of `ptmcad.show.document.node`.
MAX_TEXT = 60_000_000
MAX_COMPONENTS = 1_000
MAX_DEGREE = 400
MAX_NAME = 100
MAX_TITLE = 300
_EXACT_ONLY = ("components", "critical_values", "stacks", "adjacencies", "non_adjacencies")
"""What a certified map does not have."""


def read(text: str) -> RegionMap:
    """The map in a JSON document.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    return _decode(opened(text, FORMAT, MAX_TEXT, "ptmcad classify"))


def _decode(document: Node) -> RegionMap:
    data = document.record(
        "format", "status", "slice", "system", "base", "complex_solutions", "undetermined", "regions", "components",
        "critical_values", "stacks", "cells", "adjacencies", "non_adjacencies", "plan", "versions", "precision",
        "timings?", "cover?",
    )  # fmt: skip
    slice = _slice(data["slice"])
    status = data["status"].choice(Status)
    cover = read_cover(data["cover"]) if "cover" in data else None
    if cover is None and (status is Status.CERTIFIED or slice.count is Count.ADMISSIBLE):
        raise document.fault("lacks the key 'cover', which a certified map has")
    if cover is not None:
        if status not in (Status.CERTIFIED, Status.PARTIAL):
            raise data["status"].fault("is not that of a map with a cover")
        for key in _EXACT_ONLY:
            if data[key].value != []:
                raise data[key].fault("is not empty, as it is in a map with a cover")
    also = ("admissible",) if cover is not None else ()
    names = slice.axis_names

    def point(node: Node) -> Point:
        values = node.record(*names)
        return Point(names, values[names[0]].fraction(), values[names[1]].fraction())

    def component(node: Node) -> Component:
        c = node.record("kind", "separates", "left_out", "polynomial")
        polynomial = _polynomial(c["polynomial"], names)
        return Component(polynomial, c["kind"].choice(Kind), c["left_out"].text(), c["separates"].truth())

    def region(node: Node) -> Region:
        r = node.record("stable", "total", "index", *also, "area", "sample", "cells")
        low, high = r["area"].each(Node.size, 2)
        stable, total = r["stable"].optional(Node.natural), r["total"].optional(Node.natural)
        cells = r["cells"].each(Node.natural)
        index, admissible = r["index"].optional(_index), r["admissible"].optional(Node.natural) if also else None
        return Region(stable, total, index, (low, high), cells, point(r["sample"]), admissible)

    def cell(node: Node) -> Cell:
        c = node.record("stack", "level", "sample", "region", "total", "stable", "index", *also, "solutions")
        if cover is not None and c["stack"].value is not None:
            raise c["stack"].fault("is not null, as it is in a map with a cover")
        return Cell(
            stack=c["stack"].natural() if cover is None else None,
            level=c["level"].natural(),
            sample=point(c["sample"]),
            region=c["region"].natural(),
            total=c["total"].optional(Node.natural),
            stable=c["stable"].optional(Node.natural),
            index=c["index"].optional(_index),
            solutions=c["solutions"].each(_solution),
            admissible=c["admissible"].optional(Node.natural) if also else None,
        )

    if (base := data["base"].text()) not in names:
        raise data["base"].fault(f"is {base[:40]!r}, which is not an axis")
    if len(tuple(data["components"].items())) > MAX_COMPONENTS:
        raise data["components"].fault(f"has more than {MAX_COMPONENTS} entries")
    if (undetermined := data["undetermined"].size()) > 1:
        raise data["undetermined"].fault("is more than the whole window")
    return RegionMap(
        slice=slice,
        status=status,
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
        cover=cover,
    )


def _slice(node: Node) -> Slice:
    head = node.record("name", "title", "mechanism", "axes", "parameters", "text", "count", "reference")
    axes = [Axis(name, *ends.each(Node.fraction, 2)) for name, ends in head["axes"].mapping().items()]
    if len(axes) != 2 or not all(NAME.fullmatch(a.name) for a in axes):
        raise head["axes"].fault("does not hold two named axes")
    for a in axes:
        if a.low >= a.high:
            raise head["axes"].fault(f"has an empty range for {a.name}")
    name = head["name"].line(MAX_NAME)
    if not all(c.isalnum() or c in "._-" for c in name):
        raise head["name"].fault("cannot name a file")
    functions = {axes[0].name: axis_function(0), axes[1].name: axis_function(1)}

    def expression(value: Node) -> Expression:
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
        reference=head["reference"].data(),
    )


def _system(node: Node) -> System:
    s = node.record("unknowns", "relations", "potential", "gradient", "hessian")
    return System(
        unknowns=s["unknowns"].each(Node.text),
        relations=s["relations"].each(Node.text),
        potential=s["potential"].text(),
        gradient=s["gradient"].each(Node.text),
        hessian=s["hessian"].each(lambda row: row.each(Node.text)),
    )


def _polynomial(node: Node, names: tuple[str, str]) -> PlanePolynomial:
    try:
        polynomial = PlanePolynomial.parse(node.text(), names)
    except ValueError as error:
        raise node.fault(f"is wrong: {error}") from error
    if max(polynomial.degrees) > MAX_DEGREE:
        raise node.fault(f"has a degree over {MAX_DEGREE}")
    return polynomial


def _whole(node: Node) -> int:
    value = node.coefficient()
    if value.denominator != 1:
        raise node.fault("is not an integer")
    return value.numerator


def _critical_value(node: Node) -> CriticalValue:
    v = node.record("polynomial", "low", "high", "origin")
    return CriticalValue(v["polynomial"].each(_whole), v["low"].fraction(), v["high"].fraction(), v["origin"].text())


def _stack(node: Node) -> Stack:
    s = node.record("left", "right", "sample", "walls", "cells")

    def wall(pair: Node) -> Wall:
        component, root = pair.each(Node.natural, 2)
        return Wall(component, root)

    left, right = s["left"].optional(Node.natural), s["right"].optional(Node.natural)
    return Stack(left, right, s["sample"].fraction(), s["walls"].each(wall), s["cells"].each(Node.natural))


def _index(node: Node) -> MorseIndex:
    minima, saddles, maxima = node.each(Node.natural, 3)
    return (minima, saddles, maxima)


def _solution(node: Node) -> Solution:
    s = node.record("center", "radius", "signs")
    return Solution(s["center"].each(Node.fraction), s["radius"].fraction(), s["signs"].text())


def _adjacency(node: Node) -> Adjacency:
    a = node.record("cells", "merge", "component", "segment")
    first, second = a["cells"].each(Node.natural, 2)
    component = a["component"].optional(Node.natural)
    return Adjacency(first, second, component, a["segment"].optional(_triple), a["merge"].choice(Merge))


def _non_adjacency(node: Node) -> NonAdjacency:
    a = node.record("critical_value", "left", "right", "below", "above", "reason")
    return NonAdjacency(
        critical_value=a["critical_value"].natural(),
        left=a["left"].each(Node.natural),
        right=a["right"].each(Node.natural),
        below=a["below"].optional(_triple),
        above=a["above"].optional(_triple),
        reason=a["reason"].choice(Reason),
    )


def _triple(node: Node) -> Segment:
    low, high, height = node.each(Node.fraction, 3)
    return (low, high, height)


def _plan_step(node: Node) -> PlanStep:
    p = node.record("what", "done", "reason", "saving?")
    saving = p["saving"].text() if "saving" in p else ""
    return PlanStep(p["what"].text(), p["done"].truth(), p["reason"].text(), saving)
