"""Forged poses of a program of another version: what differs from the truth is refused whoever is
said to have written it.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import ptmcad
from ptmcad.cli import run
from ptmcad.text.enclosure import Enclosure, exact_text

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
    "symmetric": ["bar.yaml", "--at", "a=1,M=0,f=3/2"],
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


def moved(data: Any) -> None:
    number = data["equilibria"][0]["energy"]
    number["center"] = str(Fraction(number["center"]) + 1)
    number["text"] = Enclosure(*[Fraction(number["center"])] * 2).text(data["digits"])
    number["radius"] = "0"


def in_another_order(data: Any) -> None:
    data["equilibria"].reverse()


def threefold(data: Any) -> None:
    data["equilibria"][0]["multiplicity"] = 2


def another_free_length(data: Any) -> None:
    data["equilibria"][0]["springs"][0]["free_length"] = "7"


def one_more_point(data: Any) -> None:
    data["equilibria"][0]["nodes"]["Z"] = data["equilibria"][0]["nodes"]["O"]


def one_point_less(data: Any) -> None:
    del data["equilibria"][0]["nodes"]["P"]


@pytest.mark.parametrize("versions", [None, {"ptmcad": "0.1.9"}])
@pytest.mark.parametrize(
    ("kind", "forge"),
    [
        *(
            ("bar", f)
            for f in (
                none,
                moved,
                in_another_order,
                another_free_length,
                one_more_point,
                one_point_less,
            )
        ),
        *(("regular", f) for f in (moved, in_another_order)),
        ("degenerate", threefold),
    ],
)
def test_what_contradicts_the_answer_is_false_in_any_version(
    kind: str, forge: Callable[[Any], None], versions: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    data = document(kind)
    forge(data)
    assert _status(data, versions) == 1
    assert "FALSE" in capsys.readouterr().out


def _status(data: Any, versions: Any) -> int:
    known = {**data, "versions": versions}
    Path("forged.json").write_text(
        json.dumps({key: value for key, value in known.items() if value is not None}), "utf-8"
    )
    return run(["verify", "forged.json"])


def wider(data: Any) -> None:
    number = data["equilibria"][0]["eigenvalues"][0]
    number["radius"] = exact_text(2 * Fraction(number["radius"]))


def nothing_of_flat(data: Any) -> None:
    data["equilibria"][0]["flat"] = not data["equilibria"][0]["flat"]


def equal_energies(data: Any) -> None:
    """By symmetry two poses of the bar without a moment have one energy."""
    data["equilibria"][:2] = data["equilibria"][1::-1]


@pytest.mark.parametrize(
    ("kind", "forge", "told"),
    [
        ("regular", wider, "2 claims hold"),
        ("symmetric", equal_energies, "2 claims hold"),
        ("regular", nothing_of_flat, "another version made it; now equilibria[0].flat"),
    ],
)
def test_what_an_earlier_version_wrote_otherwise_is_not_false(
    kind: str, forge: Callable[[Any], None], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    data = document(kind)
    forge(data)
    assert _status(data, None) == 0
    assert told in " ".join(capsys.readouterr().out.split())
