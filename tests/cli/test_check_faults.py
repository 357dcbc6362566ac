"""Faults that ``ptmcad check`` tells: each with its place, none that follows from another, none
left out.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.cases import cases

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
        assert fault.startswith(
            f"{5 + n}: mechanism.springs.{n + 1}.between: there is no point 'Z'"
        )


FREE = """\
mechanism:
  parameters: {a: {kind: length}, l0: {kind: free length, default: 1/2}, F: {}}
  unknowns: {x: length, y: length}
  points: {A: [a, 3/10], P: [x, y]}
  springs: [{between: [A, P], k: 1, free: l0}]
  torsion: []
  moments: {x: F*x}
axes: {a: [5/2, 4], F: [-1, 2]}
count: total
"""


def test_what_free_lengths_do_not_go_with_is_told_with_its_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (fault,) = faults_of(FREE, tmp_path, capsys)
    assert fault.startswith("3: mechanism.unknowns.x: no bound")
    assert "narrow the win" in fault and "choose exact" not in fault


def test_every_fault_of_a_list_of_aliases_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
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
        (
            "1 - a",
            "7: mechanism.springs.2.free: a free length must not be negative in the whole window",
        ),
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


AXES = "axes: {L: [0, 2], W: [0, 3]}\n"
SPRUNG = """\
mechanism:
  parameters: {L: {kind: length, default: 1}, W: {kind: force}%s}
  unknowns: {th: angle}
  points: {O: [0, 0], A: [-2, 0], P: [L*sin(th), L*cos(th)]}
  springs:
    - {between: [A, P], k: %s, free: %s}
  torsion: [{angle: th, k: %s}]
  loads: {P: {weight: W}}
"""


@pytest.mark.parametrize(
    ("stiffness", "says"),
    cases("check_faults", "stiffnesses"),
)
def test_a_stiffness_written_in_a_spring_is_proved_positive(
    stiffness: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = SPRUNG % ("", stiffness, "0", stiffness) + AXES
    found = faults_of(text, tmp_path, capsys)
    assert [fault.partition(f": {says}")[0] for fault in found] == [
        "6: mechanism.springs.1.k", "7: mechanism.torsion.1.k",
    ]  # fmt: skip
    path = tmp_path / "bad.yaml"
    assert run(["classify", str(path), "--out", str(tmp_path)]) == 2
    assert f"{path}:{found[0]}" in capsys.readouterr().err


def test_a_free_length_written_in_a_spring_is_proved_not_negative(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (fault,) = faults_of(SPRUNG % ("", "1", "L - 1", "1") + AXES, tmp_path, capsys)
    assert fault.startswith(
        "6: mechanism.springs.1.free: a free length must not be negative in the whole window"
    )


def test_a_stiffness_is_positive_at_a_single_point_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "sprung.yaml"
    path.write_text(
        SPRUNG % ("", "W - 1", "0", "1") + "axes: {L: [0, 2], W: [2, 3]}\n", encoding="utf-8"
    )
    assert run(["solve", str(path), "--at", "L=1,W=2"]) == 0
    capsys.readouterr()
    assert run(["solve", str(path), "--at", "L=1,W=1/2"]) == 2
    err = capsys.readouterr().err
    assert (
        f"{path}:6: mechanism.springs.1.k: a stiffness is positive, but this is W - 1 = -1/2" in err
    )


@pytest.mark.parametrize(
    ("text", "starts"),
    cases("check_faults", "together"),
)
def test_no_fault_keeps_others_from_being_told(
    text: str, starts: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = faults_of(text, tmp_path, capsys)
    assert [fault[: len(start)] for fault, start in zip(found, starts, strict=True)] == starts


def test_a_long_expression_is_shown_around_what_is_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    long = "+".join(["L*L"] * 30)
    (fault,) = faults_of(SPRUNG % ("", f"{long}+q", "0", "1") + AXES, tmp_path, capsys)
    shown = fault.partition("(character 121 of ")[2]
    assert shown.startswith("'...*L+L*L+") and shown.endswith("+q')") and len(shown) < 70


def test_a_model_without_parameters_is_not_asked_for_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = faults_of(
        "mechanism: {}\nparameters: {L: 1}\naxes: {a: [0, 1], b: [0, 1]}\n", tmp_path, capsys
    )
    assert "2: parameters.L: unknown parameter 'L': mechanism has none" in found


@pytest.mark.parametrize(
    ("spring", "says"),
    cases("check_faults", "idle springs"),
)
def test_a_spring_that_does_nothing_is_a_fault(
    spring: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (
        "mechanism:\n  parameters: {L: {kind: length}, W: {kind: force}}\n  unknowns: {th: angle}\n"
        f"  points: {{O: [0, 0], A: [-2, 0], P: [L*sin(th), L*cos(th)]}}\n  {spring}\n  loads: {{P: {{weight: W}}}}\n"
    )
    (fault,) = faults_of(text + AXES, tmp_path, capsys)
    assert fault.startswith(f"5: mechanism.{says}")


@pytest.mark.parametrize(
    ("text", "says"),
    cases("check_faults", "characters"),
)
def test_a_character_that_yaml_does_not_take_is_named(
    text: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (fault,) = faults_of(text, tmp_path, capsys)
    assert fault.startswith(says)


LINE = "system:\n  unknowns: {x: real}\n  equations: [%s]\n  stable: [%s]\naxes: {a: [-2, 2], b: [-2, 2]}\n"


@pytest.mark.parametrize(
    ("text", "start"),
    [
        (LINE % ("(x - a)^2", "x"), "1: system: the slice lies inside the discriminant variety"),
        (
            LINE % ("x^3 - a*x + b", "x^3 - a*x + b"),
            "4: system.stable.1: at every point of the slice",
        ),
        (
            "mechanism:\n  parameters: {L: {kind: length}, l0: {kind: free length, default: 1}}\n"
            "  unknowns: {a: angle, b: angle, c: angle, d: angle, p: angle, q: angle}\n"
            "  points: {A: [2, 0], P: [sin(a) + sin(b) + sin(c), L*cos(d) + cos(p) + cos(q)]}\n"
            "  springs: [{between: [A, P], k: 1, free: l0}]\naxes: {L: [0, 1], l0: [0, 1]}\n",
            "3: mechanism.unknowns: the certified engine takes up to 3 unknowns",
        ),
        (
            "parameters: {L1: (a - b)^2 + 10^-30*(a + b), k: 1}\naxes: {a: [-1, 2], b: [-1, 2]}\n",
            "1: parameters.L1: a length must be positive in the whole window, but L1 is",
        ),
    ],
)
@pytest.mark.slow_cases(
    "system:\\n  unknowns: {x: real}\\n  equations: [(x - a)^2]\\n  stable: [x]\\naxes: {a: [-2, 2]"
    ", b: [-2, 2]}\\n-1: system: the slice lies inside the discriminant variety"
)
def test_what_an_engine_refuses_has_its_place_in_every_command(
    text: str, start: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (fault,) = faults_of(text, tmp_path, capsys)
    assert fault.startswith(start)
    path = tmp_path / "bad.yaml"
    for command in (["classify", str(path), "--out", str(tmp_path)], ["variety", str(path)]):
        if command[0] == "variety" and "free length" in text:
            continue  # which it does not take
        assert run(command) == 2
        assert capsys.readouterr().err.startswith(f"error: {path}:{start}"), command


def test_what_an_engine_refuses_of_an_option_names_the_option(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "good.yaml"
    path.write_text(
        "axes: {a: [-1, 2], b: [-1, 2]}\nparameters: {L2: 1 + a^2, rho: 1 + b^2}\n",
        encoding="utf-8",
    )
    given = ["--set", "L1=(a - b)^2 + 10^-30*(a + b)"]
    assert run(["classify", str(path), *given, "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.startswith("error: --set L1: a length must be positive")
