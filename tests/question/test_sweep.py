"""The key ``sweep`` of a record: lists, ranges, products and their unions, with exact values and
places of faults.
"""

from __future__ import annotations

import json
from fractions import Fraction
from importlib.resources import files
from itertools import product
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.errors import ConfigError
from ptmcad.question.config import load, point_from_options, slice_from_options
from ptmcad.question.config.sweeps import sweep_from
from ptmcad.question.slice import Slice
from ptmcad.text.numerals import text_of

SCHEMA = json.loads(files("ptmcad").joinpath("record.schema.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
AXES = {"rho": [0, 2], "L2": [0, 2]}
FAMILY = """\
name: loads
title: "of no member"
parameters: {L1: 1, F3: F, F4: F^2/4}
axes: {rho: [0, 2], L2: [0, 2]}
sweep: {F: {from: -4, to: 4, step: 2}}
"""

numbers = st.fractions(min_value=-50, max_value=50, max_denominator=20)
listed = st.lists(numbers, min_size=1, max_size=4).map(
    lambda values: ([text_of(v) for v in values], values)
)


@st.composite
def ranges(draw: st.DrawFn) -> tuple[dict[str, str | int], list[Fraction]]:
    """A range as a record has it, by its step or by the number of values, and its values."""
    low, number = draw(numbers), draw(st.integers(2, 6))
    step = draw(st.fractions(min_value=Fraction(1, 9), max_value=9, max_denominator=9))
    signed = step * draw(st.sampled_from((1, -1)))
    values = [low + k * signed for k in range(number)]
    ends: dict[str, str | int] = {"from": text_of(low), "to": text_of(values[-1])}
    return ends | draw(st.sampled_from(({"step": text_of(step)}, {"steps": number}))), values


@given(
    st.lists(st.tuples(*[st.one_of(listed, ranges())] * 2), min_size=1, max_size=3), st.booleans()
)
def test_members_are_all_combinations_in_their_order(
    parts: list[tuple[Any, Any]], alone: bool
) -> None:
    """A list of mappings is one after another, with names in any order; the last parameter's value
    changes fastest.
    """
    parts = parts[:1] if alone else parts
    mappings = [
        {"F3": first[0], "F4": second[0]} if k % 2 == 0 else {"F4": second[0], "F3": first[0]}
        for k, (first, second) in enumerate(parts)
    ]
    record = {"axes": AXES, "sweep": mappings[0] if alone else mappings}
    VALIDATOR.validate(record)
    sweep = sweep_from(record)
    expected = []
    for k, (first, second) in enumerate(parts):
        if k % 2 == 0:
            expected += [{"F3": a, "F4": b} for a, b in product(first[1], second[1])]
        else:
            expected += [{"F3": a, "F4": b} for b, a in product(second[1], first[1])]
    assert [sweep.values(k) for k in range(len(sweep))] == expected
    with pytest.raises(IndexError):
        sweep.values(len(sweep))
    with pytest.raises(IndexError):
        sweep.values(-1)


@pytest.fixture(name="family")
def family_fixture(tmp_path: Path) -> Path:
    path = tmp_path / "loads.yaml"
    path.write_text(FAMILY, encoding="utf-8")
    return path


def test_a_member_is_the_slice_that_the_options_ask_for(family: Path) -> None:
    sweep = sweep_from(family)
    assert [sweep.slice(k) for k in range(len(sweep))] == [
        slice_from_options(family, sets=[f"F={value}"]) for value in (-4, -2, 0, 2, 4)
    ]
    alone = {"name": "loads", "parameters": {"L1": 1, "F3": -2, "F4": 1}, "axes": AXES}
    assert sweep.slice(1) == slice_of(alone)
    direct = sweep_from({**alone, "parameters": {"L1": 1, "F4": 1}, "sweep": {"F3": ["-4/2"]}})
    assert direct.slice(0) == sweep.slice(1)


def slice_of(record: dict[str, Any]) -> Slice:
    from ptmcad.question.config import slice_from_mapping

    return slice_from_mapping(record)


def test_where_one_slice_is_meant_a_swept_value_has_to_be_given(family: Path) -> None:
    with pytest.raises(ConfigError, match=r"loads.yaml:5: sweep: the record asks for a sweep"):
        load(family)
    with pytest.raises(
        ConfigError, match=r"loads.yaml:5: sweep.F: F is swept too: add --set F=VALUE"
    ):
        slice_from_options(family, sets=["L1=2"])
    with pytest.raises(ConfigError, match=r"sweep.F: F is swept too"):
        point_from_options(family, {"rho": "1", "L2": "1"})
    assert point_from_options(family, {"rho": "1", "L2": "1", "F": "-2"})[1]["F4"] == 1
    assert slice_from_options(family, sets=["F=2", "L1=2"]).text["F4"] == "1"


FAULTS = """\
parameters: {F3: -10}
axes: {rho: [0, 2], L2: [0, 2]}
sweep:
  F3: [1]
  L2: [1]
  F4:
    from: -40
    to: 0
    step: 7
  F5: [1]
  k1: [1, 0]
  k2: {from: 1, to: 2}
  k3: []
  F3x: 3
  F4x: {from: 1, to: 2, stop: 3}
  L1: {from: 1, to: 1, steps: 2}
  k: {from: 1, to: 2, steps: 1}
  l0: [1, yes]
  l0_1: {from: 1, to: 2, step: -1}
  l0_2: {to: 2, step: 1}
  l0_3: {from: 0, to: 1, steps: 1000001}
"""
PLACES = [
    (4, "sweep.F3", "has a value under 'parameters'"),
    (5, "sweep.L2", "is an axis"),
    (9, "sweep.F4.step", "steps of 7 from -40 do not end at 0"),
    (10, "sweep.F5", "no parameter is called F5; or use it in an expression"),
    (11, "sweep.k1", "k1 is 0, but a stiffness must be positive"),
    (12, "sweep.k2", "either step"),
    (13, "sweep.k3", "the list is empty"),
    (14, "sweep.F3x", "expected a list"),
    (15, "sweep.F4x.stop", "unknown key"),
    (16, "sweep.L1", "the range is empty"),
    (17, "sweep.k.steps", "a whole number from 2 on"),
    (18, "sweep.l0.2", "yes-or-no"),
    (19, "sweep.l0_1.step", "a step is positive"),
    (20, "sweep.l0_2.from", "is missing"),
    (21, "sweep.l0_3.steps", "more than 1000000"),
]


def test_all_faults_have_their_places(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(FAULTS, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        sweep_from(path)
    found = caught.value.faults
    assert [(fault.line, fault.key) for fault in found] == [(line, key) for line, key, _ in PLACES]
    for fault, (_, _, words) in zip(found, PLACES, strict=True):
        assert words in fault.message


@pytest.mark.parametrize(
    ("sweep", "words"),
    [
        ({}, "expected parameters"),
        ([], "expected parameters"),
        ("F3", "expected parameters"),
        ([{"F3": [1]}, {"F4": [1]}], "sweeps the same parameters: F3"),
        (
            {"F3": {"from": 0, "to": 1, "steps": 1001}, "F4": {"from": 0, "to": 1, "steps": 1001}},
            "1002001 members",
        ),
        ({"F3": ["rho"]}, "a value is a number, not an expression in rho"),
        ({"l0": [[1]]}, "not a list"),
        ({"2F": [1]}, "cannot name"),
    ],
)
def test_what_is_no_sweep_is_refused(sweep: Any, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        sweep_from({"axes": AXES, "sweep": sweep})


def test_a_record_without_a_sweep_is_told_what_to_write() -> None:
    with pytest.raises(ConfigError, match="sweep: is missing: say what is swept, such as"):
        sweep_from({"axes": AXES})


def test_the_first_member_is_looked_at() -> None:
    with pytest.raises(ConfigError, match="F3: division by zero"):
        sweep_from({"axes": AXES, "parameters": {"F3": "1/F"}, "sweep": {"F": [0]}})


def test_the_schema_knows_the_keys_of_a_range() -> None:
    ends = {"from": 0, "to": 1}
    wrongs: list[Any] = [{"F": []}, {"F": ends}, {"F": ends | {"step": 1, "steps": 2}}, {}, []]
    for wrong in wrongs:
        assert not VALIDATOR.is_valid({"axes": AXES, "sweep": wrong})
