"""Codecs read off annotations: what is written is read back and valid, and what is wrong is refused
with its place.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from operator import attrgetter
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.text.codec import (
    NATURAL,
    Key,
    by_name,
    choice,
    derived,
    record_of,
    unless_default,
)
from ptmcad.text.documents import document_schema, document_text
from ptmcad.text.node import Node, opened


class Shape(Enum):
    """Of a part."""

    ROUND = "round as a ball"
    FLAT = "flat"


@dataclass(frozen=True)
class Part:
    """One of several."""

    size: Fraction
    shape: Shape
    marks: tuple[int, ...] = ()


@dataclass(frozen=True)
class Whole:
    """What parts are of."""

    name: str
    parts: tuple[Part, ...]
    ends: tuple[Fraction, Fraction] | None
    by_name: Mapping[str, bool]
    notes: Mapping[str, str] = field(default_factory=dict)

    @property
    def number(self) -> int:
        return len(self.parts)


PART = record_of(Part, {Shape: choice(Shape, by_name)}, **unless_default(Part, "marks"))
WHOLE = record_of(
    Whole, {Part: PART}, pieces=Key(field="parts"), number=derived(attrgetter("number"), NATURAL),
    **unless_default(Whole, "notes"),
)  # fmt: skip
SCHEMA = document_schema("ptmcad-whole/1", WHOLE.schema)

texts = st.text(st.characters(categories=["Lu", "Ll", "Nd"]), max_size=8)
numbers = st.fractions(max_denominator=10**6)
parts = st.builds(
    Part, numbers, st.sampled_from(Shape), st.lists(st.integers(0, 9), max_size=3).map(tuple)
)
wholes = st.builds(
    Whole,
    texts,
    st.lists(parts, max_size=3).map(tuple),
    st.none() | st.tuples(numbers, numbers),
    st.dictionaries(texts, st.booleans(), max_size=3),
    st.dictionaries(texts, texts, max_size=3),
)


@given(wholes)
def test_what_is_written_is_read_back_and_valid(whole: Whole) -> None:
    text = document_text("ptmcad-whole/1", WHOLE.write(whole))
    jsonschema.Draft202012Validator(SCHEMA).validate(json.loads(text))
    assert WHOLE.read(opened(text, "ptmcad-whole/1", 10**6, "nothing")) == whole


GIVEN: Any = {
    "name": "a",
    "pieces": [{"size": "1/2", "shape": "flat"}],
    "number": 1,
    "ends": None,
    "by_name": {},
}


def test_defaults_are_not_written() -> None:
    assert WHOLE.write(WHOLE.read(Node(GIVEN, ""))) == GIVEN


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"name": 1}, "name is not a text"),
        ({"pieces": [{"size": "1/2"}]}, "pieces[0] lacks the key 'shape'"),
        (
            {"pieces": [{"size": "1/2", "shape": "flat", "colour": 1}]},
            "pieces[0] has the unknown key 'colour'",
        ),
        ({"pieces": [{"size": "x", "shape": "flat"}]}, "pieces[0].size is wrong"),
        (
            {"pieces": [{"size": "1/2", "shape": "square"}]},
            "pieces[0].shape is 'square', not one of round, flat",
        ),
        ({"pieces": []}, "number is not '0', as the rest says"),
        ({"ends": ["1"]}, "ends has 1 entries, not 2"),
        ({"by_name": {"b": 0}}, "by_name.b is not true or false"),
        ({"format": "x"}, "the document has the unknown key 'format'"),
    ],
)
def test_what_is_wrong_is_refused_with_its_place(change: dict[str, Any], fault: str) -> None:
    with pytest.raises(ValueError, match=r".") as refused:
        WHOLE.read(Node(GIVEN | change, ""))
    assert fault in str(refused.value)
    if "number" not in fault:
        assert not jsonschema.Draft202012Validator(SCHEMA).is_valid(
            {"format": "ptmcad-whole/1", **GIVEN} | change
        )


def test_a_document_without_a_derived_key_is_an_earlier_one_where_it_has_a_default() -> None:
    codec = record_of(
        Part, {Shape: choice(Shape)}, area=derived(lambda part: 7, NATURAL, default=0)
    )
    found = Part(Fraction(1), Shape.FLAT, (1,))
    data = json.loads(json.dumps(codec.write(found)))
    assert data["area"] == 7
    del data["area"]
    assert codec.read(Node(data, "")) == found
    with pytest.raises(ValueError, match="area is not '7'"):
        codec.read(Node({**data, "area": 8}, ""))
