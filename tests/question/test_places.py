"""Every fault of a description is told with its line and whole key, wherever the description
stands.
"""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest
import yaml
from support.cases import cases

import ptmcad
from ptmcad.errors import ConfigError
from ptmcad.question.config import load, slice_from_mapping
from ptmcad.question.config.designkey import design_from

MECHANISM = """\
name: t
mechanism:
  parameters:
    L: {kind: length, default: 1}
    k:
      kind: stiffness
      default: 1
    W: {kind: force}
  unknowns:
    th: angle
    phi: angle
  points:
    O: [0, 0]
    A: [-2, 0]
    B: [2, 0]
    P: [L*sin(th), L*cos(th)]
  bodies:
    seat:
      at: P
      angle: phi
      points:
        Q: [1, 0]
        R: [1/2, 1]
  bars:
    - [O, P]
    - [Q, R]
  supports:
    O: pin
  springs:
    - between: [A, Q]
      k: k
    - between: [B, R]
      k: k
      free: 0
  torsion:
    - angle: phi - th
      k: 1/10
      rest: pi/2
  loads:
    P: {weight: W}
  moments:
    th: 1/10
axes: {L: [0, 2], W: [0, 3]}
count: stable
"""
SYSTEM = """\
name: t
system:
  parameters:
    b:
      kind: number
      default: 1
  unknowns:
    x: real
    y: angle
  equations:
    - x^3 - a*x + b
    - sin(y) - a
  positive:
    - x
  stable:
    - 3*x^2 - a
axes: {a: [-2, 2], c: [-2, 2]}
count: total
"""
K = "      default: 1\n"


@pytest.mark.parametrize("own_file", [False, True], ids=["inline", "in a file"])
@pytest.mark.parametrize(("kind", "old", "new", "below", "key", "part"), cases("places", "faults"))
def test_a_fault_has_its_line_and_key(
    tmp_path: Path,
    kind: str,
    old: str,
    new: str,
    below: int,
    key: str,
    part: str,
    own_file: bool,
) -> None:
    base = {"mechanism": MECHANISM, "system": SYSTEM}[kind]
    assert base.count(old) >= 1
    line = base[: base.index(old)].count("\n") + 1 + below
    if (key, part[:1]) == ("equations", "2"):
        line = base[: base.index("equations:")].count("\n") + 2  # one line was added above
    text = base.replace(old, new, 1)
    path = tmp_path / "t.yaml"
    expected = [(path, line, f"{kind}.{key}")]
    if own_file:
        head, _, rest = text.partition(f"{kind}:\n")
        description, _, tail = rest.partition("axes:")
        own = tmp_path / "own.yaml"
        own.write_text(dedent(description), encoding="utf-8")
        text = f"{head}mechanism: own.yaml\naxes:{tail}"
        expected = [(own, line - 2, key)]
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load(path)
    # an axis is only unused because the description of what uses it is faulty
    found = [fault for fault in caught.value.faults if fault.key != "axes.c"]
    assert [(Path(fault.file or ""), fault.line, fault.key) for fault in found] == expected
    assert part in found[0].message


def test_a_system_without_a_value_of_its_parameters_is_told() -> None:
    system = {"parameters": None, "unknowns": {"x": "real"}, "equations": ["x^3 - a*x + b"]}
    with pytest.raises(ConfigError, match=r"system\.parameters: has no value"):
        slice_from_mapping({"system": system, "axes": {"a": [0, 1], "b": [0, 1]}})


def test_a_design_without_axes_is_told() -> None:
    with pytest.raises(ConfigError, match="axes: is missing: a slice needs two axes"):
        design_from(
            {"parameters": {"k": 1}, "design": {"maximise": "range", "over": {"L2": [1, 2]}}}
        )


def test_faults_of_values_are_told_with_those_of_the_description(tmp_path: Path) -> None:
    text = (
        MECHANISM.replace("[A, Q]", "[A, ZZ]")
        .replace(K, "      default: -1\n")
        .replace("count: stable", "count: all")
    )
    path = tmp_path / "t.yaml"
    path.write_text(f"{text}parameters: {{k: W +, V: 1}}\n", encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load(path)
    assert [(fault.line, fault.key) for fault in caught.value.faults] == [
        (30, "mechanism.springs.1.between"), (44, "count"), (45, "parameters.V"), (45, "parameters.k"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("count", "system"), [("index", True), ("admissible", True), ("stable", False)], ids=str
)
def test_a_count_that_makes_no_sense_has_its_line(tmp_path: Path, count: str, system: bool) -> None:
    text = SYSTEM if system else MECHANISM.replace("th: 1/10", "th: W*sin(phi)")
    text = text.replace("count: total", f"count: {count}").replace("x^3 - a*x + b", "x^3 - a*x + b*c").replace(
        f"    b:\n      kind: number\n{K}", "    b: {default: 1}\n"
    )  # fmt: skip
    path = tmp_path / "t.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load(path)
    assert [(fault.line, fault.key) for fault in caught.value.faults] == [
        (text.count("\n"), "count")
    ]


def test_an_unknown_is_no_axis() -> None:
    system = {"unknowns": {"x": "real"}, "equations": ["x^3 - a*x + b"]}
    with pytest.raises(ConfigError, match=r"axes\.x: x is an unknown"):
        slice_from_mapping(
            {"system": system, "axes": {"a": [0, 1], "x": [0, 1]}, "parameters": {"b": 1}}
        )


# ---------------------------------------------------------------------------------- parameters of the record's own use

PENDULUM = yaml.safe_load("""
parameters: {L: {kind: length}, m: {default: 1}, W: {kind: force}}
unknowns: {th: angle}
points: {O: [0, 0], A: [0, 2], P: [L*sin(th), L*cos(th)]}
springs: [{between: [A, P], k: 1}]
loads: {P: {weight: W}}
""")


def test_a_parameter_that_a_records_expression_uses_is_used() -> None:
    record = {
        "mechanism": PENDULUM,
        "parameters": {"W": "2*m*g"},
        "axes": {"L": [0, 2], "g": [0, 1]},
    }
    slice = slice_from_mapping(record)
    assert slice.parameters["W"].to_text(("L", "g")) == "2*g"
    assert "m" not in slice.parameters  # an engine has no use for it
    assert ptmcad.verify(ptmcad.classify(slice)).ok
    poses = ptmcad.solve(model=slice.model, W="2*m", m=2, L=1)
    assert (poses.parameters["W"], "m" in poses.parameters) == (4, False)
    with pytest.raises(
        ConfigError, match=r"mechanism\.parameters\.m: nothing uses m: leave it out"
    ):
        slice_from_mapping({**record, "parameters": {"W": "2*g", "m": 3}})


def test_an_alias_that_only_a_records_expression_uses_has_its_value() -> None:
    """It was once taken for 1: what nothing in a right description uses was held for something that
    a fault hides.
    """
    parameters = {"a": {"default": 3, "alias": ["b"]}, "c": {}}
    system = {"parameters": parameters, "unknowns": {"x": "real"}, "equations": ["x^3 - a*x + c"]}
    slice = slice_from_mapping(
        {"system": system, "parameters": {"c": "2*b*u"}, "axes": {"u": [0, 1], "a": [1, 2]}}
    )
    assert slice.parameters["c"].to_text(("u", "a")) == "2*u*a"


def test_an_alias_that_nothing_uses_is_told_at_its_parameter() -> None:
    parameters = {**PENDULUM["parameters"], "L": {"kind": "length", "alias": ["l9"]}, "m": {}}
    record = {
        "mechanism": {**PENDULUM, "parameters": parameters},
        "axes": {"L": [0, 2], "W": [0, 1]},
    }
    with pytest.raises(ConfigError) as caught:
        slice_from_mapping(record)
    assert [fault.key for fault in caught.value.faults] == [
        "mechanism.parameters.L.alias",
        "mechanism.parameters.m",
    ]
