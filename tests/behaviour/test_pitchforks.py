"""`ptmcad range` with free lengths: where a symmetry proves a pitchfork, the end is one, and has
all its digits.
"""

from __future__ import annotations

import json
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

from ptmcad.cli import run

SCHEMA = json.loads(
    (Path(__file__).resolve().parents[2] / "docs" / "range.schema.json").read_text(encoding="utf-8")
)

BALANCER = """
name: balancer
mechanism:
  parameters: {k: {kind: stiffness}, l0: {kind: free length, default: 1/10}, F: {kind: force, default: 0}}
  unknowns: {th: angle}
  points: {O: [0, 0], A: [0, 1], Q: [sin(th)/2, cos(th)/2], P: [2*sin(th), 2*cos(th)]}
  bars: [[O, P]]
  supports: {O: pin, A: pin}
  springs: [{between: [A, Q], k: k, free: l0}]
  loads: {P: [F, -1]}
axes: {k: [3, 6], l0: [0, 1/4]}
"""
"""U' = sin th (k/2 (1 - l0/l) - 2) with l = 1/2 at th = 0 and 3/2 at half a turn."""

ARM = """
name: arm
mechanism:
  parameters: {P: {kind: force}, c: {kind: stiffness}, l0: {kind: free length, default: 1/2}}
  unknowns: {a: angle, b: angle}
  points: {O: [0, 0], A: [sin(a), cos(a)], B: [sin(a) + sin(b), cos(a) + cos(b)], C: [0, 4]}
  bars: [[O, A], [A, B]]
  supports: {O: pin, C: pin}
  springs: [{between: [C, B], k: 1, free: l0}]
  torsion: [{angle: a, k: c}, {angle: b - a, k: c}]
  loads: {B: {weight: P}}
axes: {P: [3, 5], c: [1/2, 2]}
"""


def met(record: str, along: str, at: str, folder: Path) -> dict[str, Any]:
    """The part of the document that is about a line with free lengths."""
    (folder / "record.yaml").write_text(record, encoding="utf-8")
    arguments = [
        "range",
        str(folder / "record.yaml"),
        "--along",
        along,
        "--at",
        at,
        "--format",
        "json",
    ]
    assert run([*arguments, "--out", str(folder)]) == 0
    (path,) = folder.glob("*.json")
    document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(SCHEMA).validate(document)
    found: dict[str, Any] = document["enclosed"]
    return found


def places(found: dict[str, Any]) -> list[float]:
    assert all(change["met"] == ["pitchfork"] and change["proved"] for change in found["changes"])
    return [float(change["at"]["decimal"]) for change in found["changes"]]


@pytest.mark.parametrize(
    ("along", "at", "expected"),
    [
        ("k", "l0=1/10", [30 / 7, 5]),
        pytest.param("l0", "k=9/2", [1 / 18, 1 / 6], marks=pytest.mark.slow),
    ],
    ids=["k", "l0"],
)
def test_ends_of_a_balancer_are_pitchforks(
    along: str, at: str, expected: list[float], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = met(BALANCER, along, at, tmp_path)
    assert places(found) == pytest.approx(expected, abs=1e-9)
    assert [interval["index"] for interval in found["intervals"]] == [[1, 1], [2, 2], [1, 1]]
    told = capsys.readouterr().out
    assert told.count("pitchfork") == 2 and "undecided" not in told


def test_pitchforks_of_two_angles_by_hand(tmp_path: Path) -> None:
    """Where both bars are upright or hang: U'' is linear in P there, less P times the cosines on
    the diagonal.
    """
    expected = []
    for c in map(np.array, product((1.0, -1.0), repeat=2)):
        distance = 4 - c.sum()
        pull = (distance - 0.5) / distance
        bent = np.array([[c[0], 0], [0, 0]]) + c[0] * c[1] * np.array([[1, -1], [-1, 1]])
        hessian = pull * (np.outer(c, c) + distance * np.diag(c)) + bent
        expected += [
            float(v.real) for v in np.linalg.eigvals(np.diag(c) @ hessian) if abs(v.imag) < 1e-9
        ]
    found = met(ARM, "P", "c=1", tmp_path)
    assert places(found) == pytest.approx(sorted(v for v in expected if 3 < v < 5), abs=1e-8)
    totals = [sum(interval["index"]) for interval in found["intervals"]]
    assert {abs(b - a) for a, b in pairwise(totals)} == {2}


def path_ends(
    record: str, along: str, at: str, start: str, folder: Path
) -> list[list[dict[str, Any]]]:
    """The lower and the upper end of each path of a stable pose."""
    (folder / "record.yaml").write_text(record, encoding="utf-8")
    arguments = [
        "range",
        str(folder / "record.yaml"),
        "--along",
        along,
        "--at",
        at,
        "--path",
        start,
    ]
    assert run([*arguments, "--format", "json", "--out", str(folder)]) == 0
    (path,) = folder.glob("*.json")
    document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(SCHEMA).validate(document)
    return [[each["low"], each["high"]] for each in document["path"]["paths"]]


@pytest.mark.slow
def test_paths_end_at_a_pitchfork_as_what_meets_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two stable poses and the unstable one between them become the one that hangs or stands, which
    goes on as them.
    """
    leaning = path_ends(BALANCER, "k", "l0=1/10", "9/2", tmp_path)
    assert [[end["fate"] for end in ends] for ends in leaning] == [["merge", "merge"]] * 2
    for end in [end for ends in leaning for end in ends]:
        assert (end["meeting"], end["leaving"]) == ([0, 0, 1], [0])
    told = capsys.readouterr().out
    assert "the pose goes on, without a snap, as th = 180.0000000°" in told and "as th = 0°" in told
    (((_, high)), *others) = path_ends(BALANCER, "k", "l0=1/10", "7/2", tmp_path)
    assert (high["fate"], high["meeting"], high["leaving"], others) == (
        "vanish",
        [0],
        [0, 0, 1],
        [],
    )
    assert (
        "k = 4.285714286: the stable pose goes on as a minimum, a minimum and a maximum"
        in capsys.readouterr().out
    )


def test_without_the_symmetry_there_is_no_pitchfork(tmp_path: Path) -> None:
    """A load across unfolds both: a fold is left of each, beside a pose that goes on."""
    found = met(BALANCER.replace("default: 0}", "default: 1/1000}"), "k", "l0=1/10", tmp_path)
    assert [change["met"] for change in found["changes"]] == [["fold"], ["fold"]]
    assert all(change["proved"] for change in found["changes"])
