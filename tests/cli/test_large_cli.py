"""msolve as the command line sees it: what went wrong with it is one line, and it does not outlive
the program.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from ptmcad import cli
from ptmcad.algebra import bases
from ptmcad.algebra.fibre_algebra import WorkLimit

SQUARE = """
system:
  unknowns: {x: real, y: real}
  equations: ["x^2 - a", "y^2 - b"]
axes: {a: [1, 2], b: [1, 2]}
"""
LARGE = """
system:
  unknowns: {x: real, y: real, z: real}
  equations:
    - (x + 2*y + z + 1)^6 - x*y - a
    - (x - 3*y - z + 2)^6 - 2*x*y^2 - b
    - (x - y + 2*z)^6 - x*z - 1
axes: {a: [1, 2], b: [1, 2]}
"""


def fake(folder: Path, lines: str) -> str:
    """The PATH with a program named msolve before all others."""
    program = folder / "msolve"
    program.write_text(f"#!{sys.executable}\nimport os, sys, time\n{lines}\n")
    program.chmod(0o755)
    return f"{folder}{os.pathsep}{os.environ['PATH']}"


def record(folder: Path, text: str) -> str:
    (folder / "record.yaml").write_text(text)
    return str(folder / "record.yaml")


def test_a_lost_root_is_one_line_of_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lost = "[u0*u1+u0+u1+1, u0^2-1, u1^2-1]:"
    monkeypatch.setenv("PATH", fake(tmp_path, f"open(sys.argv[-1], 'w').write({lost!r})"))
    monkeypatch.setattr(bases, "MANY", 1)
    monkeypatch.setattr(bases, "SMALL", WorkLimit(0, 0, 0, 0))
    assert cli.run(["solve", record(tmp_path, SQUARE), "--at", "a=1,b=1"]) == 0
    said = capsys.readouterr()
    why = "msolve's basis is not proved to lie in the ideal of the equations: it may miss solutions"
    assert said.err == f"warning: {why}; its basis is not used\n"
    assert "4 solutions" in said.out


def test_check_and_explain_say_whose_bases_are_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["check", record(tmp_path, LARGE)]) == 0
    assert "bases       up to 216 solutions: by ptmcad while small, then" in capsys.readouterr().out
