"""Entries of records: shapes, keys and places, and that all faults are noted."""

from __future__ import annotations

from typing import Any

import pytest

from ptmcad.errors import ConfigError, Faults
from ptmcad.text.entry import Entry, Place, Scalar
from ptmcad.text.yamltree import read_text

DATA = {"size": "2", "parts": [{"name": "a"}, {"nam": "b"}, 3], "colour": "red"}
TEXT = 'size: "2"\nparts:\n- {name: a}\n- {nam: b}\n- 3\ncolour: red\n'


def of(kind: str, faults: Faults) -> Entry:
    tree = read_text(TEXT, "record.yaml")
    return Entry.of(DATA if kind == "data" else tree, Place() if kind == "data" else tree.place, faults)


def word(entry: Entry) -> str:
    value = entry.value.text if isinstance(entry.value, Scalar) else entry.value
    if not isinstance(value, str):
        raise entry.error("is no word")
    return value


def name_of(entry: Entry) -> str:
    return entry.fields(("name",), ("name",)).read("name", word, "")


@pytest.mark.parametrize("kind", ["data", "nodes"])
def test_all_faults_are_noted_and_the_rest_is_read(kind: str) -> None:
    faults = Faults()
    whole = of(kind, faults).fields(("size", "parts", "weight"), ("weight",))
    assert whole.read("size", word, "") == "2"
    assert whole.read("weight", word, "none") == "none"
    assert whole.at("parts").each_item(name_of) == ("a", "")
    said = [fault.message for fault in faults.found]
    assert [message.split(";")[0] for message in said] == [
        "unknown key", "is missing", "unknown key", "is missing", "expected a mapping",
    ]  # fmt: skip
    assert said[2] == "unknown key; did you mean 'name'?"
    with pytest.raises(ConfigError) as refused:
        faults.check()
    assert len(refused.value.faults) == 5


def test_keys_of_data_count_from_one_and_nodes_know_their_lines() -> None:
    for kind, key, line in (("data", "parts.2.nam", None), ("nodes", "parts.nam", 4)):
        faults = Faults()
        of(kind, faults).at("parts").each_item(name_of)
        assert (faults.found[0].key, faults.found[0].line) == (key, line)


@pytest.mark.parametrize(
    ("value", "shape", "message"),
    [
        ([1, 2], "entries", "expected a mapping, such as {a: 1}"),
        ("a", "items", "expected a list, such as {a: 1}"),
        ({str(n): n for n in range(401)}, "entries", "401 entries, more than the 400 that can be computed with"),
    ],
)
def test_another_shape_is_refused(value: Any, shape: str, message: str) -> None:
    with pytest.raises(ConfigError, match=r".") as refused:
        getattr(Entry(value, Place("x"), Faults()), shape)("{a: 1}")
    assert refused.value.message == message
    assert refused.value.key == "x"
