"""Lines and rows with free lengths as a command writes them are accepted."""

from __future__ import annotations

from pathlib import Path

import pytest

from ptmcad.cli import run

pytest.importorskip("numba")


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("free02", ["--along", "rho", "--over", "L2", "--rows", "2"], "3 claims hold"),
        ("four-bar-free", ["--along", "F", "--at", "G=1"], "3 claims hold"),
    ],
    ids=["rows over the other axis", "a closed loop, of which stability is not checked"],
)
def test_what_a_command_writes_is_accepted(
    name: str, options: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["range", name, *options, "--format", "json", "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    assert run(["verify", str(tmp_path / f"{name}-range.json")]) == 0
    assert says in capsys.readouterr().out
