"""Every fault of a description is told with its line and whole key, wherever the description
stands.
"""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest
import yaml

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
KIND = "      kind: stiffness\n"
MECHANISMS = [
    # what is written instead of what; lines below where it begins; key and words of the message
    (K, "      default: -1\n", 0, "parameters.k.default", "k is -1, but a stiffness must be positive"),
    (K, "      default: 1/0\n", 0, "parameters.k.default", "division by zero (character 2 of '1/0')"),
    (K, "      default: 2*W\n", 0, "parameters.k.default", "is written under the record's 'parameters:'"),
    (K, "      default: true\n", 0, "parameters.k.default", "yes-or-no"),
    (K, "      default:\n", 0, "parameters.k.default", "has no value"),
    (K, "", -2, "parameters.k", "k has no value: give it one under 'parameters'"),
    (KIND, "      kind: stifness\n", 0, "parameters.k.kind", "did you mean 'stiffness'?"),
    (KIND, f"{KIND}      range: [2, 1]\n", 1, "parameters.k.range", "reversed or empty"),
    (KIND, f"{KIND}      range: [2, q]\n", 1, "parameters.k.range.2", "expected a number"),
    (KIND, f"{KIND}      alias: [k1, [k2]]\n", 1, "parameters.k.alias.2", "is no name"),
    (KIND, f"{KIND}      alias: k1\n", 1, "parameters.k.alias", "a list, such as [k1, k2]"),
    ("    W: {kind: force}", "    W: {kind: force}\n    M: {}", 1, "parameters.M", "nothing uses M"),
    ("    W: {kind: force}", "    W: {kind: force}\n    θ: {}", 1, "parameters.θ", "use ASCII letters"),
    ("    th: angle", "    th: angel", 0, "unknowns.th", "did you mean 'angle'?"),
    ("    th: angle", "    th:", 0, "unknowns.th", "has no value"),
    ("    th: angle", "    th: angle\n    z: length", 1, "unknowns.z", "no equation holds"),
    ("    A: [-2, 0]", "    A:", 0, "points.A", "has no value"),
    ("    A: [-2, 0]", "    A: [-2, ~]", 0, "points.A.2", "has no value"),
    ("    A: [-2, 0]", "    A: [-2, pi]", 0, "points.A.2", "pi is no rational number"),
    ("    A: [-2, 0]", "    A: [-2, sqrt(2)]", 0, "points.A.2", "'sqrt' is no function"),
    ("    A: [-2, 0]", "    A: [-2, cos(th + 1)]", 0, "points.A.2", "only multiples of pi/2"),
    ("      at: P", "      at: Z", 0, "bodies.seat.at", "there is no point 'Z'"),
    ("      at: P\n", "", -1, "bodies.seat.at", "is missing"),
    ("      angle: phi", "      angle: phi + pi/3", 0, "bodies.seat.angle", "only multiples of pi/2"),
    ("        Q: [1, 0]", "        Q: [1, th]", 0, "bodies.seat.points.Q.2", "th is an unknown"),
    ("    seat:\n", "    seat:\n      more:\n        - 1\n", 1, "bodies.seat.more", "unknown key"),
    ("    - [O, P]", "    - [A, P]", 0, "bars.1", "is not constant"),
    ("    - [O, P]", "    -", 0, "bars.1", "has no value"),
    ("    O: pin", "    O: pn", 0, "supports.O", "did you mean 'pin'?"),
    ("      free: 0", "      free: -1", 0, "springs.2.free", "is not negative, but this is -1"),
    ("      free: 0", "      free: l0", 0, "springs.2.free", "unknown name 'l0'"),
    ("    - between: [B, R]\n", "    - between: [B, [R]]\n", 0, "springs.2.between", "a list is no point's name"),
    ("      k: k\n      free: 0", "      free: 0", -1, "springs.2.k", "is missing"),
    ("    - angle: phi - th", "    - angle: phi - L", 0, "torsion.1.angle", "L is not an unknown angle"),
    ("      rest: pi/2", "      rest:", 0, "torsion.1.rest", "has no value"),
    ("      rest: pi/2", "      rest: pi/3", 0, "torsion.1.rest", "none of 0, pi/2"),
    ("      rest: pi/2", "      at: Z", 0, "torsion.1.at", "there is no point 'Z'"),
    ("    P: {weight: W}", "    P: W", 0, "loads.P", "such as [0, -W], or {weight: W}"),
    ("    P: {weight: W}", "    P: [W]", 0, "loads.P", "expected two components"),
    ("    P: {weight: W}", "    P: {wait: W}", 0, "loads.P.wait", "did you mean 'weight'?"),
    ("    th: 1/10", "    tth: 1/10", 0, "moments.tth", "did you mean 'th'?"),
    ("    th: 1/10", "    th: 1/10\n  x-joint: []", 1, "x-joint", "expected a mapping"),
]  # fmt: skip
SYSTEMS = [
    (K, "      default: 1/0\n", 0, "parameters.b.default", "division by zero"),
    (K, "", -2, "parameters.b", "b has no value"),
    ("    x: real", "    x: rael", 0, "unknowns.x", "did you mean 'real'?"),
    ("    x: real", "    x: real\n    z: real", 0, "equations", "2 equations for 3 unknowns"),
    ("    - x^3 - a*x + b", "    - x^3 - a*x + b + q", 0, "equations.1", "q has no value"),
    ("    - x^3 - a*x + b", "    - x^3 - a*x + b +", 0, "equations.1", "ends too early"),
    ("    - x^3 - a*x + b", "    - sqrt(x)*a + b", 0, "equations.1", "'sqrt' is no function"),
    ("    - x^3 - a*x + b", "    - x^3 + b + cos(y + pi/3)", 0, "equations.1", "only multiples of pi/2"),
    ("    - x^3 - a*x + b", "    - x^3 + b + pi", 0, "equations.1", "pi is no rational number"),
    ("    - x^3 - a*x + b", "    -", 0, "equations.1", "has no value"),
    ("    - x\n", "    - x > 0\n", 0, "positive.1", "write what has to be positive alone"),
    ("    - x\n", "    - -1\n", 0, "positive.1", "never positive"),
    ("    - x\n", "    - b - q\n", 0, "positive.1", "q has no value"),
    ("  positive:\n", "  postive:\n", 0, "postive", "did you mean 'positive'?"),
    ("    - 3*x^2 - a\n", "    - [2]\n", 0, "stable.1", "a list is neither"),
]  # fmt: skip
CASES = [(MECHANISM, "mechanism", *case) for case in MECHANISMS] + [
    (SYSTEM, "system", *case) for case in SYSTEMS
]


@pytest.mark.parametrize("own_file", [False, True], ids=["inline", "in a file"])
@pytest.mark.parametrize(("base", "kind", "old", "new", "below", "key", "part"), CASES)
def test_a_fault_has_its_line_and_key(
    tmp_path: Path,
    base: str,
    kind: str,
    old: str,
    new: str,
    below: int,
    key: str,
    part: str,
    own_file: bool,
) -> None:
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
