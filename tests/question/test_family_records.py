"""Records of families: what they say, and what is wrong with them."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from support.cases import cases

from ptmcad.errors import ConfigError
from ptmcad.question.config import (
    family_from,
    question_from_options,
    slice_from_mapping,
    slice_from_options,
)
from ptmcad.question.config.typed import Typed
from ptmcad.text.syntax import parse
from ptmcad.text.tree import Name, Number, names_of, replaced, to_text

RECORD: dict[str, Any] = yaml.safe_load("""
name: loads
axes: {rho: [0, 2], L2: [0, 2]}
parameters: {F3: F, F4: 2*F - 1}
free: {F: [-4, 0]}
""")
TEXT = """name: loads
axes: {rho: [0, 2], L2: [0, 2]}
parameters: {F3: F, F4: 2*F - 1}
free: {F: [-4, 0]}
"""


def _written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "family.yaml"
    path.write_text(text)
    return path


def test_a_member_is_the_slice_that_one_would_type() -> None:
    family = family_from(RECORD)
    typed = slice_from_mapping(
        {"name": "loads-F-3_2", "axes": RECORD["axes"], "parameters": {"F3": "-1.5", "F4": "-4"}}
    )
    assert family.member(Fraction(-3, 2)) == typed
    assert [str(value) for value in family.values] == [
        "-4",
        "-7/2",
        "-3",
        "-5/2",
        "-2",
        "-3/2",
        "-1",
        "-1/2",
        "0",
    ]


def test_a_free_length_may_be_free_from_zero_on() -> None:
    family = family_from(
        yaml.safe_load("{axes: {rho: [1, 2], L2: [1, 2]}, free: {l0: [0, 1]}, members: 2}")
    )
    assert [family.member(value).has_free_lengths for value in family.values] == [False, True]


def test_a_parameter_of_the_model_may_be_free() -> None:
    family = family_from(
        yaml.safe_load("{axes: {rho: [0, 2], L2: [0, 2]}, free: {F3: [-4, 0]}, members: [-1]}")
    )
    assert family.member(Fraction(-1)).parameters["F3"].constant() == -1
    with pytest.raises(ConfigError, match="1 is outside of the range of F3"):
        family.member(Fraction(1))


@pytest.mark.parametrize(
    ("change", "message"),
    cases("family_records", "faults"),
)
def test_what_is_wrong_is_said(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        family_from({**RECORD, **change})


def test_faults_have_their_lines_and_each_is_said_once(tmp_path: Path) -> None:
    text = (
        TEXT.replace("F3: F", "F3: F + G").replace("name:", "titel: 3\nname:")
        + "members: [-1, 5]\n"
    )
    with pytest.raises(ConfigError) as caught:
        family_from(_written(tmp_path, text))
    assert [(fault.key, fault.line) for fault in caught.value.faults] == [
        ("titel", 1), ("parameters.F3", 4), ("members.2", 6),
    ]  # fmt: skip


def test_where_one_slice_is_wanted_the_free_parameter_needs_a_value(tmp_path: Path) -> None:
    path = _written(tmp_path, TEXT)
    with pytest.raises(ConfigError, match="give it a value with --set F=VALUE") as caught:
        slice_from_options(path)
    assert (caught.value.key, caught.value.line) == ("free.F", 4)
    given_value = slice_from_options(path, sets=["F=-1"])
    assert given_value == family_from(path).member(Fraction(-1))


def test_options_make_families() -> None:
    family = question_from_options(
        Typed(slice="rho,L2", sets=("F4=F3",), free="F3=-2:0", members="-2,-1")
    )
    assert [str(value) for value in family.values] == ["-2", "-1"]  # type: ignore[union-attr]
    with pytest.raises(ConfigError, match="there are members where a parameter is free"):
        question_from_options(Typed(slice="rho,L2", members="3"))


def test_the_free_parameter_may_become_an_axis(tmp_path: Path) -> None:
    found = slice_from_options(_written(tmp_path, TEXT), slice="rho,F", sets=["L2=1"])
    assert found.axis_names == ("rho", "F")
    assert (found.axes[1].low, found.axes[1].high) == (-4, 0)


@given(
    st.fractions(max_denominator=50),
    st.sampled_from(["F", "-F^2", "2*F - 1/F", "F^-F", "(F + x)^2*-F", "x/F"]),
)
def test_a_replaced_name_means_its_value(value: Fraction, text: str) -> None:
    tree = replaced(parse(text), {"F": Number(value)})
    assert "F" not in names_of(tree)
    assert parse(to_text(tree)) is not None
    back = to_text(
        replaced(parse(to_text(replaced(parse(text), {"F": Name("G")}))), {"G": Number(value)})
    )
    assert back == to_text(tree)
