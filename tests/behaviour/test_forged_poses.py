"""Forged poses of a program of another version: what differs from the truth is refused whoever is
said to have written it.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import ptmcad
from ptmcad.cli import run

BAR = """
name: bar
mechanism:
  name: bar
  parameters:
    a: {kind: length, default: 1}
    k: {kind: stiffness, default: 1}
    f: {kind: free length, default: 3}
    M: {kind: force, default: 2}
  unknowns: {th: angle}
  points:
    O: [0, 0]
    A: [a, 0]
    P: [a*cos(th), a*sin(th)]
  bars: [[O, P]]
  supports: {O: pin, A: pin}
  springs:
    - {between: [A, P], k: k, free: f}
  moments: {th: M}
axes: {a: [1/2, 2], M: [1, 3]}
count: stable
"""
POINTS = {
    "bar": ["bar.yaml", "--at", "a=1,M=1/20,f=3/2"],
    "regular": ["--at", "rho=7/10,L2=3/2,F3=-10,F4=-10"],
    "degenerate": ["cubic", "--at", "a=0,b=0"],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("poses")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(path)
        Path("bar.yaml").write_text(BAR, encoding="utf-8")
        for name, point in POINTS.items():
            assert run(["solve", *point, "--format", "json", "--name", name]) == 0
    return path


@pytest.fixture(autouse=True)
def within(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


def document(kind: str) -> Any:
    return json.loads(Path(f"{kind}.json").read_text(encoding="utf-8"))


def none(data: Any) -> None:
    data["equilibria"] = []


def exchanged(data: Any) -> None:
    """The numbers of stable poses and of those by index stay."""
    one = next(pose for pose in data["equilibria"] if pose["stable"])
    other = next(pose for pose in data["equilibria"] if not pose["stable"])
    one["stable"], other["stable"] = False, True


def inadmissible(data: Any) -> None:
    for pose in data["equilibria"]:
        pose["admissible"] = not pose["admissible"]


def degenerate(data: Any) -> None:
    for pose in data["equilibria"]:
        pose |= {"multiplicity": 2, "index": None, "stable": None}
    if data["status"] == "exact":
        data["status"] = "on the variety"


def regular(data: Any) -> None:
    data["equilibria"][0]["multiplicity"] = 1
    data["status"] = "exact"


def another_status(data: Any) -> None:
    data["status"] = "on the variety"


@pytest.mark.parametrize(
    ("kind", "forge"),
    [
        *(("bar", f) for f in (none, exchanged, inadmissible, degenerate, another_status)),
        *(("regular", f) for f in (none, exchanged, degenerate, another_status)),
        *(("degenerate", f) for f in (none, regular)),
    ],
)
def test_the_proof_refuses_a_false_pose(kind: str, forge: Callable[[Any], None]) -> None:
    data = document(kind)
    assert ptmcad.verify(ptmcad.Poses.from_json(json.dumps(data))).ok
    forge(data)
    assert not ptmcad.verify(ptmcad.Poses.from_json(json.dumps(data))).ok
