"""``ptmcad check``: all faults of a record, one a line; or what it asks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from ptmcad.ask import checking, classification
from ptmcad.ask.checking import check, warning
from ptmcad.cli import run
from ptmcad.errors import ConfigError, DegenerateSliceError, LimitReached
from ptmcad.question.config import load, slice_from_mapping

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
BAD = """\
name: a/b
mechanism:
  parameters:
    L: {kind: lenght, default: 1}
    W: {kind: force}
  unknowns: {th: angle}
  points:
    O: [0, 0]
    P: [L*cos(th), L*sin(t)]
  springs:
    - {between: [O, Q], k: 1}
  loads: {R: [0, W]}
parameters: {L: [1]}
axes: {W: [0, 2]}
count: many
more: 1
"""
FAULTS = [
    (1, "name"),
    (4, "mechanism.parameters.L.kind"),
    (9, "mechanism.points.P.2"),
    (11, "mechanism.springs.1.between"),
    (12, "mechanism.loads.R"),
    (13, "parameters.L"),
    (14, "axes"),
    (15, "count"),
    (16, "more"),
]


def test_all_faults_are_printed_one_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(BAD, encoding="utf-8")
    assert run(["check", str(path)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    lines = err.splitlines()
    assert len(lines) == len(FAULTS)
    for line, (number, key) in zip(lines, FAULTS, strict=True):
        assert line.startswith(f"error: {path}:{number}: {key}: ")
    assert run(["classify", str(path)]) == 2
    assert capsys.readouterr().err == f"{lines[0]} (and 8 more: ptmcad check lists them)\n"


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        (
            "fig4",
            [
                "mechanism   ptm",
                "th1 (angle), th2 (angle)",
                "6 complex ones",
                "engine      exact",
                "F3 = -10",
            ],
        ),
        ("free02", ["not counted", "engine      certified", "l0 = 1/5"]),
    ],
)
def test_a_right_record_is_told(
    name: str, parts: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["check", str(CONFIGS / f"{name}.yaml")]) == 0
    out = capsys.readouterr().out
    assert all(part in out for part in parts)


def test_a_system_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "cusp.yaml"
    path.write_text(
        "system: {unknowns: {x: real}, equations: [x^3 - a*x + b]}\naxes: {a: [0, 1], b: [0, 1]}\n"
    )
    assert run(["check", str(path)]) == 0
    out = capsys.readouterr().out
    assert "system      system" in out
    assert "3 complex ones" in out
    assert "count       total" in out


def test_loading_knows_all_faults(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(BAD, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load(path)
    assert [(fault.line, fault.key) for fault in caught.value.faults] == FAULTS


def chain(**further: Any) -> dict[str, Any]:
    record = yaml.safe_load(
        (CONFIGS / "mechanisms" / "three-bar-chain.yaml").read_text(encoding="utf-8")
    )
    return {**record, "mechanism": record["mechanism"] | further}


def test_what_is_soon_done_is_not_warned_of() -> None:
    for name in ("fig4", "free02", "systems/duffing", "mechanisms/two-bar-chain"):
        assert not warning(load(CONFIGS / f"{name}.yaml"))


def test_classify_says_at_once_that_it_will_take_long(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def unreached(*_: object) -> None:
        raise ConfigError("nothing is computed here")

    monkeypatch.setattr(classification, "region_map", unreached)
    asked = [
        "classify",
        str(CONFIGS / "mechanisms" / "three-bar-chain.yaml"),
        "--out",
        str(tmp_path),
    ]
    assert run(asked) == 2
    first, *_, last = capsys.readouterr().err.splitlines()
    assert (
        first.startswith("note: the equations have 20 complex solutions")
        and "--engine certified" in first
    )
    assert "nothing is computed" in last
    assert run([*asked, "--engine", "certified"]) == 2
    assert "note" not in capsys.readouterr().err


def test_equations_with_long_parameters_are_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """The certified engine's, in which parameters are functions of the axes."""
    monkeypatch.setattr(checking, "MAX_EXPANDING", 0.5)
    slice = slice_from_mapping(yaml.safe_load("""
        mechanism:
          parameters: {L: {kind: length}, W: {kind: force}}
          unknowns: {th: angle}
          points: {A: ['-2', '0'], P: [(L+W+sin(th))^8, L*cos(th)]}
          springs: [{between: [A, P], k: '1', free: '1'}]
        parameters: {L: (u+v+1)^16/(u+2)^3, W: (v+1)^20/(u^2+v+1)}
        axes: {u: [0, 2], v: [0, 3]}
    """))  # fmt: skip
    found = check(slice)
    assert found.engine == "certified" and found.cost.startswith(
        "not known: with such long expressions"
    )


def test_what_is_known_is_printed_before_the_rest_is_stopped(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped(_: object) -> None:
        raise LimitReached("stopped")

    monkeypatch.setattr(checking, "check", stopped)
    assert run(["check", str(CONFIGS / "fig4.yaml")]) == 3
    out = capsys.readouterr().out
    assert all(key in out for key in ("unknowns", "parameters", "axes")) and "solutions" not in out


def test_a_proof_that_takes_long_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    slice = slice_from_mapping(yaml.safe_load("""
        system: {unknowns: {x: real}, equations: [(x - a)^2]}
        axes: {a: [-2, 2], b: [-2, 2]}
    """))  # fmt: skip
    with pytest.raises(DegenerateSliceError, match="only 1 of 2 solutions are different"):
        check(slice)
    monkeypatch.setattr(checking, "MAX_SECONDS", 0.001)
    found = check(slice)
    assert found.complex_solutions == 1
    assert found.cost.startswith("not known: at 5 points") and found.cost.endswith(
        "not proved in the time"
    )


def test_the_law_of_torsion_springs_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "hinge.yaml"
    path.write_text(
        "mechanism:\n  parameters: {W: {kind: force}, c: {kind: number}}\n  unknowns: {th: angle}\n"
        "  points: {P: [sin(th), cos(th)]}\n  torsion: [{angle: th, k: c}]\n  loads: {P: {weight: W}}\n"
        "axes: {W: [0, 1], c: [0, 2]}\n",
        encoding="utf-8",
    )
    assert run(["check", str(path)]) == 0
    out = capsys.readouterr().out
    assert (
        "torsion     energy k (1 - cos(angle - rest)), moment k sin(angle - rest): for small angles"
        in out
    )
    assert run(["check", str(CONFIGS / "fig4.yaml")]) == 0
    assert "torsion" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("value", "unused"),
    [("0", True), ("Q - Q", False), ("Q*(", False)],
    ids=["not named", "named", "not readable"],
)
def test_an_axis_that_nothing_names_is_told_beside_other_faults(
    value: str, unused: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "q.yaml").write_text(
        f"axes: {{rho: [2, 1], Q: [0, 1]}}\nparameters: {{L1: {value}}}\n"
    )
    assert run(["check", str(tmp_path / "q.yaml")]) == 2
    told = capsys.readouterr().err
    assert "axes.rho" in told
    assert ("the axis Q is not used" in told) is unused
