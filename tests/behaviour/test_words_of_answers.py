"""What the terminal says is English about what the record has: no internal labels, and nouns agree
with their verbs.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.maps import CONFIGS

from ptmcad.cli import run

SLIDER = """
name: slider
mechanism:
  parameters:
    l: {kind: free length, default: 1}
    m: {kind: free length, default: 1/2}
    K: {kind: stiffness, default: 2}
    a: {kind: number, default: 1/2}
    F: {kind: force}
  unknowns: {x: length}
  points: {O: [0, 0], S: [x, x], A: [a, a]}
  springs: [{between: [O, S], k: 1, free: l}, {between: [A, S], k: K, free: m}]
  loads: {S: [F, F]}
axes: {F: [-1, 1], a: [0, 1]}
count: total
"""
"""A slider with two springs to points of its guide."""
TURNING = """
name: turning
mechanism:
  parameters: {k: {kind: stiffness, default: 1}, l0: {kind: free length, default: 1/2}, F: {kind: force}}
  unknowns: {th: angle}
  points: {O: [0, 0], A: [1, 0], P: [cos(th), sin(th)]}
  bars: [[O, P]]
  supports: {O: pin, A: pin}
  springs: [{between: [A, P], k: k, free: l0}]
  loads: {P: [0, F]}
axes: {F: [-1, 1], l0: [1/4, 1]}
count: stable
"""
"""A spring between two points of one circle, whose line turns by half the angle."""
ANCHORED = """
name: anchored
mechanism:
  parameters: {E1: {kind: stiffness, default: 1}, E2: {kind: stiffness, default: 2}, X: {kind: force}, Y: {kind: force}}
  unknowns: {x: length, y: length}
  points: {A: [0, 0], B: [3, 0], P: [x, y]}
  supports: {A: pin, B: pin}
  springs: [{between: [A, P], k: E1, free: 2}, {between: [B, P], k: E2, free: 2}]
  loads: {P: [X, Y]}
axes: {X: [-6, 6], Y: [-6, 6]}
count: total
"""


def said(record: str, folder: Path, capsys: pytest.CaptureFixture[str], *asked: str) -> str:
    """What a command prints about a record."""
    (folder / "record.yaml").write_text(record)
    assert run([asked[0], str(folder / "record.yaml"), *asked[1:]]) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize(
    ("record", "line", "words"),
    [
        (
            SLIDER,
            ("F", "a=1/2"),
            {f"point where the length of spring {name} is 0" for name in ("OS", "K")},
        ),
        (TURNING, ("F", "l0=1/2"), {"point where the length of spring k is 0"}),
        (
            ANCHORED,
            ("X", "Y=1/2"),
            {"fold", *(f"point where spring {name} has no length" for name in ("E1", "E2"))},
        ),
    ],
)
def test_what_is_met_on_a_line_is_named_as_the_record_names_it(
    record: str,
    line: tuple[str, str],
    words: set[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = said(record, tmp_path, capsys, "range", "--along", line[0], "--at", line[1])
    met = out.partition("what is met\n")[2].partition("\n\n")[0].splitlines()
    assert {re.split("  +", row)[1] for row in met} == words


def test_a_plan_names_no_charts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = [
        "classify",
        "--explain",
        "--tolerance",
        "1/5",
        "--format",
        "json",
        "--out",
        str(tmp_path),
    ]
    out = said(TURNING, tmp_path, capsys, *asked)
    assert "computed: fold of a stable equilibrium with spring k forwards along its line (" in out
    assert "turned by" not in out and "cone " not in out


def test_degenerate_equilibria_agree_with_their_verb(capsys: pytest.CaptureFixture[str]) -> None:
    at = "F=1,G=1/3,L1=1,L2=1,L3=2,b=2"  # the loop folds flat in two ways
    assert run(["solve", str(CONFIGS / "mechanisms" / "four-bar.yaml"), "--at", at]) == 0
    out = capsys.readouterr()
    assert "equilibria 4, 5 are degenerate" in out.out + out.err
