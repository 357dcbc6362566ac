"""Algebraic numbers, enclosures and axes as parts of JSON documents.

Guarantee: numbers are exact; reading what was written gives an equal value, and words and decimals
that are not those of the numbers are refused.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from operator import attrgetter
from typing import Any

from ptmcad.question.slice import Axis
from ptmcad.text.codec import (
    INTEGER,
    NATURAL,
    RATIONAL,
    Codec,
    Key,
    converted,
    derived,
    either,
    line,
    listed,
    optional,
    record,
    record_of,
)
from ptmcad.text.documents import Schema
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure

MAX_TEXT = 10_000
"""Characters of a text that a person wrote."""
LINE = line(MAX_TEXT)
INDEX = optional(listed(NATURAL).narrowed(minItems=2))
"""Numbers of solutions by their number of negative eigenvalues, where they are known."""


def itself(value: Any) -> Any:
    return value


def _enclosure(low: Fraction, high: Fraction) -> Enclosure:
    if low > high:
        raise ValueError("the ends of an interval are exchanged")
    return Enclosure(low, high)


def _algebraic(polynomial: tuple[int, ...], low: Fraction, high: Fraction) -> AlgebraicNumber:
    if len(polynomial) < 2 or polynomial[-1] <= 0:
        raise ValueError("a number's polynomial has no degree")
    _enclosure(low, high)
    return AlgebraicNumber(polynomial, low, high)


INTERVAL: Codec[Enclosure] = converted(
    listed(RATIONAL, 2), attrgetter("low", "high"), lambda ends: _enclosure(ends[0], ends[1])
)
"""An enclosure by its two ends."""
_POLYNOMIAL = listed(INTEGER).narrowed(minItems=2)
ALGEBRAIC = record_of(AlgebraicNumber, {}, _algebraic, polynomial=_POLYNOMIAL)
NUMBER: Codec[AlgebraicNumber | Enclosure] = either(
    "polynomial",
    lambda value: isinstance(value, AlgebraicNumber),
    ALGEBRAIC,
    record_of(Enclosure, {}, _enclosure),
)
AXIS = record_of(Axis, name=LINE)


def with_decimal(text: Callable[[Any], str | None]) -> Codec[Any]:
    """The window's edge, or an algebraic number, beside its decimal, which a function makes."""
    edge: Codec[Fraction] = record(
        lambda window: window, window=Key(RATIONAL, itself), decimal=derived(text)
    )
    return either(
        "window", lambda end: isinstance(end, Fraction), edge, algebraic_with_decimal(text)
    )


def algebraic_with_decimal(text: Callable[[Any], str | None]) -> Codec[AlgebraicNumber]:
    """An algebraic number beside its decimal."""
    return record_of(AlgebraicNumber, {}, _algebraic, decimal=derived(text), polynomial=_POLYNOMIAL)


def merged(one: Schema, other: Schema) -> Schema:
    """The schema of what has one of two shapes, which differ in few keys."""
    if one == other:
        return one
    if one.get("type") == other.get("type") == "array":
        return {**one, "items": merged(one["items"], other["items"])}
    if "properties" not in one or "properties" not in other:
        return {"anyOf": [one, other]}
    both = {**one["properties"], **other["properties"]}
    shared = one["properties"].keys() & other["properties"].keys()
    properties = {
        n: merged(one["properties"][n], other["properties"][n]) if n in shared else s
        for n, s in both.items()
    }
    needed = [name for name in one["required"] if name in other["required"]]
    return {**one, "properties": properties, "required": needed}
