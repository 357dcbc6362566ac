"""A slice and its model as parts of JSON documents.

Guarantee: reading what was written gives an equal slice: a built-in mechanism by its name, any
other model by its whole description.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from ptmcad.model import Model, built_in, described, described_system, known_of, recognised
from ptmcad.model.closed import without_loops
from ptmcad.question.counts import Count
from ptmcad.question.slice import MAX_UNIT, Axes, Axis, Slice
from ptmcad.text.codec import (
    DATA,
    RATIONAL,
    TEXT,
    Codec,
    Key,
    choice,
    converted,
    line,
    listed,
    named,
    record,
)
from ptmcad.text.expressions import Expression
from ptmcad.text.expressions import axis as axis_function
from ptmcad.text.node import Node
from ptmcad.text.parsing import parse
from ptmcad.text.plane import Names, PlanePolynomial
from ptmcad.text.syntax import NAME
from ptmcad.version import __version__

MAX_DEGREE = 400
MAX_NAME = 100
MAX_TITLE = 300
UNITS = Key(named(line(MAX_UNIT)), default={})
VERSIONS = Key(named(TEXT), lambda _: {"ptmcad": __version__}, made=False)
"""That of the program that writes: what is read holds whichever wrote it."""


def stored_model(model: Model) -> Any:
    """The model's name where that says all, else its description."""
    return (
        {"name": model.name, **model.source}
        if model.source and model.name not in built_in()
        else model.name
    )


def model_from(kind: str, data: Mapping[str, Any]) -> Model:
    """The model of a description, which is that of a mechanism or of a system."""
    return (
        described_system(data) if kind == "system" else without_loops(recognised(described(data)))
    )


def _model(node: Node) -> Model:
    values = node.mapping()
    found = [kind for kind in _DESCRIPTIONS if kind in values]
    if len(found) != 1:
        raise node.fault(
            "holds both a mechanism and a system" if found else "lacks the key 'mechanism'"
        )
    kind, place = found[0], values[found[0]]
    if kind == "mechanism" and isinstance(place.value, str):
        return place.made(known_of, place.line(MAX_NAME))
    return place.made(model_from, kind, place.data())


_DESCRIPTIONS = {
    "mechanism": {"anyOf": [{"type": "string", "maxLength": MAX_NAME}, {"type": "object"}]},
    "system": {"type": "object"},
}
MODEL = Key(
    Codec(
        lambda model: {model.record_key: stored_model(model)},
        _model,
        {"properties": _DESCRIPTIONS, "oneOf": [{"required": [key]} for key in _DESCRIPTIONS]},
    ),
    beside=tuple(_DESCRIPTIONS),
)
"""A model under one of two keys."""


def _axes(found: Mapping[str, tuple[Fraction, ...]]) -> Axes:
    if len(found) != 2 or not all(map(NAME.fullmatch, found)):
        raise ValueError("it does not hold two named axes")
    first, second = (Axis(name, *ends) for name, ends in found.items())
    for axis in first, second:
        if axis.low >= axis.high:
            raise ValueError(f"it has an empty range for {axis.name}")
    return first, second


_AXES: Codec[Axes] = converted(
    named(listed(RATIONAL, 2)),
    lambda axes: {axis.name: (axis.low, axis.high) for axis in axes},
    _axes,
).narrowed(minProperties=2, maxProperties=2)


def _file_name(node: Node) -> str:
    name = node.line(MAX_NAME)
    if not all(c.isalnum() or c in "._-" for c in name):
        raise node.fault("cannot name a file")
    return name


def _slice(node: Node) -> Slice:
    first, second = _AXES.read(node.entry("axes"))
    found = slice_over((first.name, second.name)).read(node)
    for name in found.text.keys() - found.model.parameters.keys():
        raise node.entry("text").fault(f"has the unknown key {name[:40]!r}")
    return found


def polynomial_over(names: Names) -> Codec[PlanePolynomial]:
    """The codec of a polynomial in axes of these names."""

    def made(text: str) -> PlanePolynomial:
        polynomial = PlanePolynomial.parse(text, names)
        if max(polynomial.degrees) > MAX_DEGREE:
            raise ValueError(f"it has a degree over {MAX_DEGREE}")
        return polynomial

    return converted(TEXT, lambda polynomial: polynomial.text(names), made)


def slice_over(names: Names, **keys: Codec[Any] | Key | None) -> Codec[Slice]:
    """The codec of a slice over axes of these names, with some keys in place of its own."""
    known = {name: axis_function(k) for k, name in enumerate(names)}
    expression: Codec[Expression] = Codec(
        lambda found: found.to_text(names),
        lambda node: node.made(parse, node.text(), known),
        TEXT.schema,
    )
    own: dict[str, Any] = {
        "name": Codec(str, _file_name, line(MAX_NAME).schema), "title": line(MAX_TITLE), "model": MODEL, "axes": _AXES,
        "parameters": named(expression), "text": named(TEXT), "count": choice(Count), "units": UNITS, "reference": DATA,
    }  # fmt: skip
    return record(Slice, **{name: key for name, key in {**own, **keys}.items() if key is not None})


SLICE: Codec[Slice] = Codec(
    lambda slice: slice_over(slice.axis_names).write(slice), _slice, slice_over(("x", "y")).schema
)
