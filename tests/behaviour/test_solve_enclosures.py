"""`ptmcad solve` where a number cannot be told from zero, or a box stays open: the poses that are
proved are shown.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import ptmcad
from ptmcad.cli import run

SCHEMA = json.loads(
    (Path(__file__).resolve().parents[2] / "docs" / "poses.schema.json").read_text(encoding="utf-8")
)

BAR = """
name: bar
mechanism:
  parameters: {X: {kind: force}, Y: {kind: force}}
  unknowns: {p: angle, x: length, y: length}
  points: {A: [0, 0], B: [3, 0], P: [x, y], Q: [x + cos(p), y + sin(p)]}
  bars: [[P, Q]]
  springs: [{between: [A, P], k: 1, free: 1}, {between: [B, Q], k: 1, free: 1}]
  loads: {Q: [X, Y]}
axes: {X: [-3, 0], Y: [-2, 2]}
"""
"""Loads at Q alone: the bar and the spring AP are in line, or AP has its free length and pulls
nothing.
"""

BALANCER = """
name: balancer
mechanism:
  parameters: {r: {kind: length}, k: {kind: stiffness}, l0: {kind: free length, default: 1/10}}
  unknowns: {th: angle}
  points: {O: [0, 0], A: [0, 1], Q: [r*sin(th), r*cos(th)], P: [2*sin(th), 2*cos(th)]}
  bars: [[O, P]]
  supports: {O: pin, A: pin}
  springs: [{between: [A, Q], k: k, free: l0}]
  loads: {P: {weight: 1}}
axes: {k: [3, 6], r: [1/2, 2]}
"""
"""At r = 1 the spring has no length where the bar is upright: a kink of the energy."""


def solved(record: str, at: str, folder: Path, status: int) -> dict[str, Any]:
    """The document that the command writes, which the schema and the reader take."""
    (folder / "record.yaml").write_text(record, encoding="utf-8")
    arguments = [
        "solve",
        str(folder / "record.yaml"),
        "--at",
        at,
        "--format",
        "table,json,svg",
        "--out",
        str(folder),
    ]
    assert run(arguments) == status
    text = (folder / "poses.json").read_text(encoding="utf-8")
    document: dict[str, Any] = json.loads(text)
    jsonschema.Draft202012Validator(SCHEMA).validate(document)
    assert ptmcad.Poses.from_json(text).to_json() == text
    return document


@pytest.mark.parametrize("at", ["X=-2,Y=1/5", "X=-1,Y=1e-9"])
@pytest.mark.slow_cases("X=-1,Y=1e-9")
def test_a_force_that_may_be_zero_is_enclosed(
    at: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By hand: both stable poses have AP at its free length, as the moment about P is that of the
    load alone.
    """
    document = solved(BAR, at, tmp_path, 0)
    assert document["status"] == "certified"
    forces = [pose["springs"][0]["force"] for pose in document["equilibria"] if pose["stable"]]
    assert len(forces) == 2
    for force in forces:
        assert Fraction(force["center"]) == 0 < Fraction(force["radius"]) < Fraction(1, 10**30)
        assert force["text"] == f"0 ± {force['radius']}"
    bound = forces[0]["radius"]
    table = capsys.readouterr().out
    assert f"|force AP| < {bound} in equilibria 1, 2" in table
    assert [pose["admissible"] for pose in document["equilibria"]].count(None) == 2, (
        "tense or not is not decided"
    )
    assert "undecided" in table
    assert all(pose["stable"] is not None for pose in document["equilibria"])


def test_poses_beside_a_kink_are_shown_and_the_open_box_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    decided = solved(
        BALANCER, "k=4,r=1.000000000001", tmp_path, 0
    )  # the peak is a smooth one, and more digits tell it
    assert [pose["stable"] for pose in decided["equilibria"]] == [True, True, False, False]
    capsys.readouterr()
    document = solved(BALANCER, f"k=4,r=1.{'0' * 149}1", tmp_path, 3)
    assert (document["status"], document["undecided"]) == ("undecided", 1)
    # at r = 1, by hand: l = 1/5 by cos th = 1 - l^2/2 from k (l - 1/10) = 2 l, and th = pi
    assert [pose["stable"] for pose in document["equilibria"]] == [True, True, False]
    degrees = sorted(abs(float(pose["degrees"][0]["text"])) for pose in document["equilibria"])
    assert degrees == pytest.approx([11.47834, 11.47834, 180], abs=1e-4)
    told = capsys.readouterr()
    assert "at least 3 equilibria: 2 stable, 1 maximum" in told.out
    assert "1 box of configurations undecided" in told.out
    assert told.err.startswith("undecided: ")


def test_verify_takes_the_poses_that_are_listed_beside_an_open_box(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The slopes of a slider's springs are 2x - 5 beyond B, 2x - 3 between A and B: at F = 1, x = 2
    and the kink B.
    """
    record = """
name: slider
mechanism:
  parameters: {F: {kind: force}, l0: {kind: free length, default: 1}}
  unknowns: {x: length}
  points: {A: [0, 0], B: [3, 0], P: [x, 0]}
  springs: [{between: [A, P], k: 1, free: l0}, {between: [B, P], k: 1, free: 1}]
  loads: {P: [F, 0]}
axes: {F: [-6, 6], l0: [1/2, 2]}
"""
    document = solved(record, "F=1,l0=1", tmp_path, 3)
    assert [pose["reals"][0]["text"] for pose in document["equilibria"]] == ["2"]
    assert run(["verify", str(tmp_path / "poses.json")]) == 0
    assert "whether there are more than the 1" in capsys.readouterr().out
    document["equilibria"][0] |= {"index": 1, "stable": False}
    (tmp_path / "poses.json").write_text(json.dumps(document), encoding="utf-8")
    assert run(["verify", str(tmp_path / "poses.json")]) == 1


def test_all_poses_are_certified_where_no_box_is_open(tmp_path: Path) -> None:
    document = solved(BALANCER, "k=4,r=1", tmp_path, 0)
    assert document["status"] == "certified" and "undecided" not in document
    assert len(document["equilibria"]) == 3


@pytest.mark.slow
def test_the_paper_s_mechanism_beside_a_spring_without_length(tmp_path: Path) -> None:
    """At rho = L1 spring 2 may have no length: the poses that are proved are there, and open boxes
    are counted.
    """
    record = "name: p\nmechanism: ptm\nparameters: {l0: 1/2}\naxes: {rho: [0, 2], L2: [0, 2]}\n"
    whole = solved(record, "rho=4/5,L2=4/5", tmp_path, 0)
    assert len(whole["equilibria"]) == 10 and "undecided" not in whole
    near = solved(record, "rho=1,L2=3/2", tmp_path, 3)
    assert near["undecided"] > 0
    assert sum(pose["stable"] is True for pose in near["equilibria"]) == 2


def test_a_torsion_spring_half_a_turn_from_rest_is_near_half_a_turn(tmp_path: Path) -> None:
    """Without a load the bar hangs free of the spring's moment at 0 and, beside it, at half a turn."""
    record = """
name: elbow
mechanism:
  parameters: {W: {kind: force}, V: {kind: force}}
  unknowns: {th: angle, phi: angle}
  points:
    A: [3, 4]
    B: [-1, 2]
    Q: [cos(th) + cos(phi), sin(th) + sin(phi)]
  springs: [{between: [A, Q], k: 1, free: 1/2}, {between: [B, Q], k: 2, free: 1/2}]
  torsion: [{angle: phi - th, k: 1/10}]
  loads: {Q: [W, V]}
axes: {W: [-1, 1], V: [-1, 1]}
"""
    document = solved(record, "W=0,V=0", tmp_path, 0)
    turns = [float(pose["torsion"][0]["degrees"]["center"]) for pose in document["equilibria"]]
    assert sum(abs(turn - 180) < 1e-30 for turn in turns) == 2
    assert sum(abs(turn) < 1e-30 for turn in turns) == 2
