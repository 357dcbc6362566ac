"""docs/tutorial-mechanism.md, followed literally: its record, each command in order, its messages
and its Python.
"""

from __future__ import annotations

import ast
import re
import shlex
from pathlib import Path

import pytest

from ptmcad.cli import run

TEXT = (Path(__file__).parent.parent / "docs" / "tutorial-mechanism.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)
RESULT = re.compile(r"^(?P<expression>[^#\n]+?)\s*#\s*(?P<value>\S.*)$")


def blocks(language: str) -> list[str]:
    return [text for found, text in BLOCKS if found == language]


def test_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (record,) = blocks("yaml")
    assert len(record.splitlines()) == 10
    Path("seat.yaml").write_text(record, encoding="utf-8")
    answers: dict[str, str] = {}
    for line in (line for block in blocks("sh") for line in block.splitlines()):
        program, *arguments = shlex.split(line)
        assert program == "ptmcad"
        status = run(arguments)
        out, err = capfd.readouterr()
        assert (status, err) == (0, ""), line
        answers[line] = out
    faults, answer = blocks("text")
    checked = answers["ptmcad check seat.yaml"].splitlines()
    assert [line for line in checked if line in answer.splitlines()] == answer.splitlines()
    said = "".join(answers.values())
    for shown in ("index   2-3-1", "1.012636436", "2 stable"):
        assert shown in said
    assert {"first.svg", "first.json", "seat.svg", "seat.json", "seat.html"} <= {
        p.name for p in Path("out").iterdir()
    }
    wrong = record.replace("L*sin(th)", "L*sin(t)").replace("[A, Q]", "[A, Z]")
    Path("seat.yaml").write_text(wrong, encoding="utf-8")
    assert run(["check", "seat.yaml"]) == 2
    assert capfd.readouterr().err == faults
    Path("seat.yaml").write_text(record, encoding="utf-8")
    names: dict[str, object] = {}
    values = 0
    (python,) = blocks("python")
    for line in python.splitlines():
        shown_value = RESULT.match(line)
        if shown_value is None:
            exec(line, names)
        else:
            assert eval(shown_value["expression"], names) == ast.literal_eval(
                shown_value["value"]
            ), line
            values += 1
    assert values == 3


def test_the_seat_is_solved_for_its_poses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("seat.yaml").write_text(blocks("yaml")[0], encoding="utf-8")
    assert run(["solve", "seat.yaml", "--at", "L=1,W=1"]) == 0
    assert "4 equilibria: 1 stable, 2 saddles, 1 maximum, exact" in capsys.readouterr().out
