"""A codec for each class that a region map is made of.

Guarantee: numbers are written exactly, areas of an exact map as decimals of 18 digits rounded outwards; what is read
has the types and sizes that the class asks for.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from ptmcad.answer.regionmap import (
    Adjacency,
    Cell,
    Component,
    Continuum,
    CriticalValue,
    Kind,
    Merge,
    NonAdjacency,
    PlanStep,
    Reason,
    Region,
    Segment,
    Solution,
    Stack,
    Wall,
)
from ptmcad.answer.regionmap import System as Equations
from ptmcad.errors import ExpressionError
from ptmcad.mechanism import Model
from ptmcad.question.slice import MAX_UNIT, Axis, Count, Point, Slice
from ptmcad.show.document.codec import (
    COUNT,
    NATURAL,
    RATIONAL,
    SHARE,
    SHORT_DECIMAL,
    TEXT,
    TRUTH,
    Codec,
    Key,
    choice,
    line,
    listed,
    named,
    optional,
    record,
)
from ptmcad.show.document.model import MODEL, either
from ptmcad.show.document.node import Node
from ptmcad.text.expressions import Expression
from ptmcad.text.expressions import axis as axis_function
from ptmcad.text.numerals import decimal, integer_text
from ptmcad.text.parsing import parse
from ptmcad.text.plane import PlanePolynomial
from ptmcad.text.syntax import NAME

MAX_DEGREE = 400
MAX_NAME = 100
MAX_TITLE = 300

INDEX = listed(NATURAL)
SEGMENT: Codec[Segment | None] = optional(listed(RATIONAL, 3))  # type: ignore[arg-type]


def _whole(node: Node) -> int:
    value = node.coefficient()
    if value.denominator != 1:
        raise node.fault("is not an integer")
    return value.numerator


SYSTEM = record(
    Equations,
    unknowns=listed(TEXT),
    relations=listed(TEXT),
    potential=TEXT,
    gradient=listed(TEXT),
    hessian=listed(listed(TEXT)),
    inequalities=Key(listed(TEXT), default=()),
    stability=Key(listed(TEXT), default=()),
    moments=Key(listed(TEXT), default=()),
)
CRITICAL_VALUE = record(
    CriticalValue,
    polynomial=listed(Codec(integer_text, _whole)),
    low=RATIONAL,
    high=RATIONAL,
    origin=TEXT,
)
WALL: Codec[Wall] = Codec(lambda wall: [wall.component, wall.root], lambda node: Wall(*node.each(Node.natural, 2)))
STACK = record(Stack, left=COUNT, right=COUNT, sample=RATIONAL, walls=listed(WALL), cells=listed(NATURAL))
SOLUTION = record(Solution, center=listed(SHORT_DECIMAL), radius=SHORT_DECIMAL, signs=TEXT)
ADJACENCY = record(
    lambda cells, **rest: Adjacency(cells[0], cells[1], **rest),
    cells=Key(listed(NATURAL, 2), lambda a: (a.first, a.second)),
    merge=choice(Merge),
    component=COUNT,
    segment=SEGMENT,
)
NON_ADJACENCY = record(
    NonAdjacency,
    critical_value=NATURAL,
    left=listed(NATURAL),
    right=listed(NATURAL),
    below=SEGMENT,
    above=SEGMENT,
    reason=choice(Reason),
)
PLAN_STEP = record(PlanStep, what=TEXT, done=TRUTH, reason=TEXT, saving=Key(TEXT, default=""))


def sequences(names: tuple[str, str], certified: bool) -> dict[str, Codec[Any]]:
    """The codecs of what a map over axes of these names has several of, by its attribute, in the document's order."""
    point: Codec[Point] = Codec(
        lambda at: {name: RATIONAL.write(at[name]) for name in at.names}, lambda node: _point(node, names)
    )
    admissible = {"admissible": COUNT} if certified else {}
    # an area that a checker is to confirm needs no more digits; one that is a sum of rectangles is exact as it is
    area: Codec[Any] = listed(SHARE, 2) if certified else Codec(_outwards, listed(SHARE, 2).read)
    component = record(
        Component,
        kind=choice(Kind),
        separates=TRUTH,
        left_out=TEXT,
        continuum=Key(optional(choice(Continuum)), default=None),
        polynomial=Codec(lambda p: p.text(names), lambda node: _polynomial(node, names)),
    )
    region = record(
        Region,
        stable=COUNT,
        total=COUNT,
        index=optional(INDEX),
        **admissible,
        area=area,
        sample=point,
        cells=listed(NATURAL),
    )
    cell = record(
        Cell,
        stack=Codec(lambda stack: stack, _no_stack) if certified else NATURAL,
        level=NATURAL,
        sample=point,
        region=NATURAL,
        total=COUNT,
        stable=COUNT,
        index=optional(INDEX),
        **admissible,
        solutions=listed(SOLUTION),
    )
    return {
        "regions": region,
        "components": component,
        "critical_values": CRITICAL_VALUE,
        "stacks": STACK,
        "cells": cell,
        "adjacencies": ADJACENCY,
        "non_adjacencies": NON_ADJACENCY,
        "plan": PLAN_STEP,
    }


def _no_stack(node: Node) -> None:
    if node.value is not None:
        raise node.fault("is not null, as it is in a map with a cover")


def _outwards(area: tuple[Fraction, Fraction]) -> list[str]:
    return [decimal(area[0], up=False), decimal(area[1], up=True)]


def _point(node: Node, names: tuple[str, str]) -> Point:
    values = node.record(*names)
    return Point(names, values[names[0]].fraction(), values[names[1]].fraction())


def _polynomial(node: Node, names: tuple[str, str]) -> PlanePolynomial:
    try:
        polynomial = PlanePolynomial.parse(node.text(), names)
    except ValueError as error:
        raise node.fault(f"is wrong: {error}") from error
    if max(polynomial.degrees) > MAX_DEGREE:
        raise node.fault(f"has a degree over {MAX_DEGREE}")
    return polynomial


# ------------------------------------------------------------------------------------------------------- the slice


def _axes(node: Node) -> tuple[Axis, Axis]:
    axes = [Axis(name, *ends.each(Node.fraction, 2)) for name, ends in node.mapping().items()]
    if len(axes) != 2 or not all(NAME.fullmatch(a.name) for a in axes):
        raise node.fault("does not hold two named axes")
    for a in axes:
        if a.low >= a.high:
            raise node.fault(f"has an empty range for {a.name}")
    return axes[0], axes[1]


def _file_name(node: Node) -> str:
    name = node.line(MAX_NAME)
    if not all(c.isalnum() or c in "._-" for c in name):
        raise node.fault("cannot name a file")
    return name


def _expressions(slice: Slice) -> dict[str, str]:
    return {name: e.to_text(slice.axis_names) for name, e in slice.parameters.items()}


def _parsed(node: Node, axes: tuple[Axis, Axis]) -> Expression:
    try:
        return parse(node.text(), {axis.name: axis_function(k) for k, axis in enumerate(axes)})
    except ExpressionError as error:
        raise node.fault(f"is wrong: {error}") from error


def _slice(
    axes: tuple[Axis, Axis],
    parameters: Mapping[str, Node],
    mechanism: Model | None,
    system: Model | None,
    **rest: Any,
) -> Slice:
    known = {name: _parsed(node, axes) for name, node in parameters.items()}
    model = either(mechanism, system)
    for name in rest["text"].keys() - model.parameters.keys():
        raise ValueError(f"slice.text has the unknown key {name[:40]!r}")
    return Slice(model=model, axes=axes, parameters=known, **rest)


SLICE = record(
    _slice,
    name=Codec(str, _file_name),
    title=line(MAX_TITLE),
    **MODEL,
    axes=Codec(lambda axes: {a.name: [RATIONAL.write(a.low), RATIONAL.write(a.high)] for a in axes}, _axes),
    # what they stand for is known when the axes are
    parameters=Key(Codec(dict, Node.mapping), _expressions),
    text=named(TEXT),
    count=choice(Count),
    units=Key(named(line(MAX_UNIT)), default={}),
    reference=Codec(dict, Node.data),
)
