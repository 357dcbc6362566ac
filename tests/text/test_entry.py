"""Parts of records: shapes, keys and places, and that all faults are noted, by hand and by codecs."""

from __future__ import annotations

from typing import Any

import pytest

from ptmcad.errors import ConfigError, Faults, Place
from ptmcad.text.codec import Codec, listed, named, part, reading, record
from ptmcad.text.entry import from_python, place_at
from ptmcad.text.node import Node
from ptmcad.text.yamltree import read_text

DATA = {"size": "2", "parts": [{"name": "a"}, {"nam": "b"}, 3], "colour": "red"}
TEXT = 'size: "2"\nparts:\n- {name: a}\n- {nam: b}\n- 3\ncolour: red\n'


def of(kind: str, faults: Faults) -> Node:
    return Node.of(
        from_python(DATA, Place()) if kind == "data" else read_text(TEXT, "record.yaml"), faults
    )


def word(entry: Node) -> str:
    if not isinstance(entry.plain, str):
        raise entry.fault("is no word")
    return entry.plain


WORD = reading(word, type="string")
PART: Codec[dict[str, Any]] = record(dict, "{name: a}", name=part(WORD, "Its name.", instead=""))
WHOLE: Codec[dict[str, Any]] = record(
    dict,
    size=part(WORD, default=""),
    parts=part(listed(PART, most=9), "Of it."),
    weight=part(WORD, instead="none"),
)


@pytest.mark.parametrize("kind", ["data", "nodes"])
def test_all_faults_are_noted_and_the_rest_is_read(kind: str) -> None:
    faults = Faults()
    read = WHOLE.read(of(kind, faults))
    assert read == {"size": "2", "weight": "none", "parts": ({"name": "a"}, {"name": ""})}
    said = [(fault.key, fault.message.split(";")[0]) for fault in faults.found]
    assert said == [
        ("colour", "unknown key"), ("weight", "is missing"), ("parts.2.nam", "unknown key"),
        ("parts.2.name", "is missing"), ("parts.3", "expected a mapping, such as {name: a}"),
    ]  # fmt: skip
    assert faults.found[2].message == "unknown key; did you mean 'name'?"
    assert (
        [fault.line for fault in faults.found] == [6, 1, 4, 4, 5] if kind == "nodes" else [None] * 5
    )
    with pytest.raises(ConfigError) as refused:
        faults.check()
    assert len(refused.value.faults) == 5


def test_what_has_nothing_instead_is_left_out_with_one_fault_for_each_key() -> None:
    pair: Codec[dict[str, Any]] = record(dict, first=part(WORD), second=part(WORD))
    faults = Faults()
    found = named(pair).read(
        Node.of(from_python({"a": {"first": 1, "second": [2]}, "b": {}}, Place()), faults)
    )
    assert found == {}
    assert [fault.key for fault in faults.found] == ["a.first", "a.second", "b.first", "b.second"]


def test_a_document_is_refused_at_its_first_fault() -> None:
    with pytest.raises(ValueError, match=r"^the document lacks the key 'parts'$"):
        WHOLE.read(Node({"size": 3}, ""))


def test_the_schema_is_what_is_read() -> None:
    assert WHOLE.schema == {
        "type": "object", "additionalProperties": False, "required": ["parts", "weight"],
        "properties": {
            "size": {"type": "string"}, "weight": {"type": "string"},
            "parts": {"type": "array", "items": PART.schema, "maxItems": 9, "description": "Of it."},
        },
    }  # fmt: skip


def test_a_key_is_found_in_the_tree_and_a_missing_one_where_it_would_be() -> None:
    tree = read_text(TEXT, "record.yaml")
    places = [
        place_at(tree, key) for key in ("parts.2.nam", "parts.2.name", "size.x", "", "parts.7")
    ]
    assert [(p.key, p.line) for p in places] == [
        ("parts.2.nam", 4), ("parts.2.name", 4), ("size.x", 1), (None, 1), ("parts.7", 2),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("value", "shape", "message"),
    [
        ([1, 2], "mapping", "expected a mapping, such as {a: 1}"),
        ("a", "items", "expected a list, such as {a: 1}"),
        (None, "items", "has no value: write one, such as {a: 1}, or leave the key out"),
        (
            {str(n): n for n in range(401)},
            "mapping",
            "401 entries, more than the 400 that can be computed with",
        ),
    ],
)
def test_another_shape_is_refused(value: Any, shape: str, message: str) -> None:
    with pytest.raises(ConfigError, match=r".") as refused:
        getattr(Node.of(from_python(value, Place("x")), Faults()), shape)(like="{a: 1}")
    assert refused.value.message == message
    assert refused.value.key == "x"
