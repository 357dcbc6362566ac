"""``ptmcad design``: the record's key and the options, what is printed, what is written, and the
exit status.
"""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from ptmcad.cli import run

SCHEMA = Path(__file__).resolve().parents[2] / "docs" / "design.schema.json"
RECORD = """\
name: ball
system:
  unknowns: {u: real}
  equations: ["u^2 - 1 + (x - b)^2 + (a - 1)^2 + (b - 1/2)^2"]
parameters: {b: 0}
axes: {x: [-2, 4], a: [0, 2]}
design:
  maximise: range
  along: x
  over: {a: [0, 2], b: [0, 1]}
  where: {stable: 2}
"""


@pytest.fixture
def record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "ball.yaml"
    path.write_text(RECORD, encoding="utf-8")
    return path


def test_a_record_with_a_design(record: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "design",
        str(record),
        "--tolerance",
        "1/10",
        "--evaluations",
        "40",
        "--format",
        "json,svg",
    ]
    assert run(words) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1] == "maximise  the range of x in [-2, 4] with 2 solutions"
    assert lines[2:5] == [
        "over      a in [0, 2], b in [0, 1]",
        "best      a = 1, b = 0.5",
        "value     2, x from -0.5 to 1.5",
    ]
    assert (
        lines[5].startswith("proof     no design has more than 2.")
        and "by branch and bound" in lines[5]
    )
    assert lines[-1] == "written   ball-design.svg, ball-design.json"
    data = json.loads(Path("ball-design.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, json.loads(SCHEMA.read_text(encoding="utf-8")))
    assert data["best"] == {"a": "1", "b": "1/2"} and data["proved"]


def test_options_replace_parts_of_the_record(
    record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [
        "design",
        str(record),
        "--over",
        "a=0:1/2",
        "--tolerance",
        "1/10",
        "--evaluations",
        "20",
    ]
    assert run([*words, "--condition", "a <= 1/4"]) == 0
    out = capsys.readouterr().out
    assert "over      a in [0, 0.5]\nwhere     a <= 1/4\nbest      a = 0.25\n" in out


def test_a_proof_that_is_stopped_ends_with_3(
    record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["design", str(record), "--boxes", "4", "--evaluations", "20"]) == 3
    assert "which was stopped at" in capsys.readouterr().out


def test_without_a_bound_the_answer_says_so(
    record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [
        "design",
        str(record),
        "--maximise",
        "a - b^2",
        "--over",
        "x=0:1",
        "--over",
        "a=0:2",
        "--over",
        "b=0:1",
    ]
    record.write_text(RECORD.replace("  along: x\n", ""), encoding="utf-8")
    assert run([*words, "--evaluations", "60"]) == 0
    assert (
        "proof     of the value at this design alone; no bound is offered"
        in capsys.readouterr().out
    )


def test_check_tells_every_fault_of_a_design(
    record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record.write_text(
        RECORD.replace("stable: 2", "stable: x, tension: yes").replace("b: [0, 1]", "q: [0, 1]")
    )
    assert run(["check", str(record)]) == 2
    err = capsys.readouterr().err.splitlines()
    assert len(err) == 3 and all(
        line.startswith("error: ball.yaml:") or "ball.yaml:" in line for line in err
    )
    assert "10: design.over.q: no parameter is called q" in err[0]
    assert "11: design.where.stable" in err[1] and "11: design.where.tension" in err[2]


def test_check_says_what_is_designed(record: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["check", str(record)]) == 0
    assert "design      range of x over a in [0, 2], b in [0, 1]" in capsys.readouterr().out


def test_other_commands_take_the_record_without_its_design(
    record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["range", str(record), "--along", "x", "--at", "a=1"]) == 0
    assert "x in (-2, 4) at a = 1" in capsys.readouterr().out


def test_a_record_without_a_design_says_what_is_missing(
    record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record.write_text(RECORD.partition("design:")[0], encoding="utf-8")
    assert run(["design", str(record)]) == 2
    assert "design: is missing: say what is designed" in capsys.readouterr().err
