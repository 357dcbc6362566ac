"""Commands that are refused, each in one line, before anything is computed or written."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from support.cases import cases

from ptmcad.cli import run


@pytest.mark.parametrize(("command", "words"), cases("refusals", "commands"))
def test_a_command_is_refused_in_one_line_and_leaves_nothing(
    command: str,
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """``error: WHERE: WHAT``, whether an option's parser or the program itself refuses."""
    monkeypatch.chdir(tmp_path)
    Path("file").touch()
    monkeypatch.setattr("ptmcad.ask.classification.region_map", None)
    assert run(shlex.split(command)) == 2
    out, err = capfd.readouterr()
    (line,) = err.splitlines()
    assert out == "" and line.startswith("error: ") and words in line
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
