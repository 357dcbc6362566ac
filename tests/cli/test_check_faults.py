"""Faults that ``ptmcad check`` tells: each with its place, none that follows from another, none left out."""

from __future__ import annotations

from pathlib import Path

import pytest

from ptmcad.cli import run
from ptmcad.errors import MAX_FAULTS


def faults_of(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """The faults of a record as they are printed, without the file: line, key and message."""
    path = folder / "bad.yaml"
    path.write_text(text, encoding="utf-8")
    assert run(["check", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert all(line.startswith(f"error: {path}") for line in lines if line.startswith("error: "))
    return [line.removeprefix(f"error: {path}:") for line in lines]


@pytest.mark.parametrize("springs", [MAX_FAULTS - 1, MAX_FAULTS, MAX_FAULTS + 10])
def test_every_fault_keeps_its_place_however_many_there_are(
    springs: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "mechanism:\n  unknowns: {th: angle}\n  points: {O: [0, 0], A: [1, 2], P: [sin(th), cos(th)]}\n  springs:\n"
    text += "    - {between: [A, Z], k: 1}\n" * springs + "axes: {k: [1, 2], W: [0, 1]}\n"
    found = [fault for fault in faults_of(text, tmp_path, capsys) if "there is no point" in fault]
    assert len(found) == min(springs, MAX_FAULTS)
    for n, fault in enumerate(found):
        assert fault.startswith(f"{5 + n}: mechanism.springs.{n + 1}.between: there is no point 'Z'")


FREE = """\
mechanism:
  parameters: {a: {kind: length}, l0: {kind: free length, default: 1/2}, F: {}}
  unknowns: %s
  points: {A: [a, 3/10], P: %s}
  springs: [{between: [A, P], k: 1, free: l0}]
  torsion: %s
  moments: %s
axes: {a: [5/2, 4], F: [-1, 2]}
count: total
"""


@pytest.mark.parametrize(
    ("parts", "start", "remedy"),
    [
        (("{x: length, y: length}", "[x, y]", "[]", "{x: F*x}"), "3: mechanism.unknowns.x: no bound", "narrow the win"),
    ],
    ids=["no bound"],
)
def test_what_free_lengths_do_not_go_with_is_told_with_its_place(
    parts: tuple[str, ...], start: str, remedy: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (fault,) = faults_of(FREE % parts, tmp_path, capsys)
    assert fault.startswith(start) and remedy in fault and "choose exact" not in fault


SLICE = "axes: {rho: [0, 1], L2: [1, 2]}\n"


@pytest.mark.parametrize(
    ("text", "starts"),
    [
        ("parameters: {k: -1}\n" + SLICE, ["1: parameters.k: k is -1"]),
        ("parameters: {l0: -1, k2: -2}\n" + SLICE, ["1: parameters.k2: k2 is -2", "1: parameters.l0: l0 is -1"]),
        (
            "mechanism:\n  unknowns: {th: angle}\n  points: 7\n  bodies: {b: {at: O, angle: th, points: {Q: [1, 0]}}}\n"
            "  springs: [{between: [A, P], k: 1}]\n  loads: {P: [0, 1]}\n" + SLICE,
            ["3: mechanism.points: expected a mapping"],
        ),
        (
            "mechanism:\n  unknowns: {th: angle}\n  bars: [[O, P]]\n  supports: {O: pin}\n" + SLICE,
            ["1: mechanism.points: is missing"],
        ),
        (
            SLICE + "units: {length: 5, mass: kg, force: []}\n",
            ["2: units.length: a unit", "2: units.mass: unknown", "2: units.force: expected a text"],
        ),
        (
            "parameters: {F3: F}\nfree: {F: [-10, 0]}\nmembers: [5, x, -3, 1/0, -3]\n" + SLICE,
            [f"3: members: {what}" for what in ("5 is outside", "the value of a", "division by", "-3 is given twice")],
        ),
        (
            "axes: {L2: [0, 2], rho: [3, 0], Z: [0, 1]}\n",
            ["1: axes: 3 axes are given", "1: axes.rho: the range of rho is reversed"],
        ),
        (
            "parameters: {k1: L1*rho, L1: k1 + t}\n" + SLICE,
            ["1: parameters.L1: unknown name 't'", "1: parameters.L1: the definition goes round in a circle"],
        ),
        (
            "parameters: {k1: L1 +, L2: 2*(}\naxes: {rho: [0, 1], W: [1, 2]}\n",
            ["1: parameters.L2: ", "1: parameters.k1: "],
        ),
        (
            "mechanism: {unknowns: {th: angel}, points: {P: [cos(th), 0]}}\n"
            "system: {unknowns: {x: real}, equations: [x^2 - a*]}\n" + SLICE,
            ["1: mechanism.unknowns.th: ", "2: system.equations.1: ", "2: system: a record is about"],
        ),
        ("mechanism: nosuch.yaml\n" + SLICE, ["1: mechanism: 'nosuch.yaml': there is no such file"]),
    ],
)
def test_faults_are_told_together_and_none_that_follows_from_another(
    text: str, starts: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = faults_of(text, tmp_path, capsys)
    assert [fault[: len(start)] for fault, start in zip(found, starts, strict=True)] == starts


def test_every_fault_of_a_list_of_aliases_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (
        "mechanism:\n  parameters:\n    L: {}\n    k:\n      kind: stiffness\n      alias:\n        - L\n        - k1\n"
        "        - 2k\n        - k1\n        - cos\n  unknowns: {th: angle}\n\n"
        "  points: {A: [1, 2], P: [cos(th), sin(th)]}\n  springs: [{between: [A, P], k: k1 + L}]\n"
        "axes: {L: [0, 1], k1: [1, 2]}\n"
    )
    found = faults_of(text, tmp_path, capsys)
    starts = [
        "7: mechanism.parameters.k.alias.1: 'L' is a parameter of its own",
        "9: mechanism.parameters.k.alias.3: '2k' is no name",
        "10: mechanism.parameters.k.alias.4: the name 'k1' is given twice",
        "11: mechanism.parameters.k.alias.5: 'cos' has a meaning of its own",
    ]
    assert len(found) == len(starts)
    assert all(fault.startswith(start) for fault, start in zip(found, starts, strict=True)), found


PULLED = """\
mechanism:
  parameters: {L: {kind: length}, k: {kind: stiffness, alias: [k1, k2]}, g: {}}
  unknowns: {th: angle}
  points: {A: [1, 2], P: [L*cos(th), L*sin(th)]}
  springs:
    - {between: [A, P], k: k1}
    - {between: [A, P], k: k2, free: g}
parameters:
  L: (a - b)^2 + 10^-30*(a + b)
  k: 1
  g: %s
axes: {a: [-1, 2], b: [-1, 2]}
"""


@pytest.mark.parametrize(
    ("free", "start"),
    [
        ("1", "9: parameters.L: a length must be positive in the whole window, but L is"),
        ("1 - a", "7: mechanism.springs.2: a free length must not be negative in the whole window"),
    ],
)
def test_what_the_geometry_asks_for_is_told_with_its_place(
    free: str, start: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = PULLED % free
    if free != "1":
        text = text.replace("10^-30*(a + b)", "1")
    (fault,) = faults_of(text, tmp_path, capsys)
    assert fault.startswith(start)
