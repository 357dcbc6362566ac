"""``ptmcad solve``: what it prints and writes, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from ptmcad import Poses, solve
from ptmcad.cli import run

FIG3 = str(Path(__file__).resolve().parents[2] / "configs" / "fig3.yaml")
FIG4 = str(Path(__file__).resolve().parents[2] / "configs" / "fig4.yaml")


def test_the_table_is_printed_and_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["solve", "--at", "rho=1,L2=3/2"]) == 0
    assert capsys.readouterr().out == solve(digits=10, rho=1, L2="3/2").table() + "\n"
    assert list(tmp_path.iterdir()) == []


def test_a_record_gives_what_is_left_open(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["solve", FIG4, "--at", "rho=7/10,L2=3/2", "--digits", "20"]) == 0
    expected = solve(digits=20, rho="7/10", L2="3/2", F3=-10, F4=-10).table()
    assert capsys.readouterr().out == expected + "\n"
    assert run(["solve", FIG4, "--at", "rho=7/10,L2=3/2,F3=5", "--set", "k=2*50+1"]) == 0
    assert (
        capsys.readouterr().out
        == solve(digits=10, rho="7/10", L2="3/2", F3=5, F4=-10, k=101).table() + "\n"
    )


def test_an_axis_that_is_no_parameter_is_part_of_the_point(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(["solve", FIG3, "--at", "rho=1/5,F=-10"]) == 0
    assert capsys.readouterr().out == solve(digits=10, rho="1/5", F3=-10, F4=-10).table() + "\n"


def test_json_is_written_with_the_digits_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [
        "solve",
        "--at",
        "rho=1,L2=3/2",
        "--digits",
        "30",
        "--format",
        "json",
        "--out",
        str(tmp_path / "new"),
    ]
    assert run(arguments) == 0
    assert capsys.readouterr().out == f"written   {tmp_path / 'new' / 'poses.json'}\n"
    written = (tmp_path / "new" / "poses.json").read_text(encoding="utf-8")
    assert Poses.from_json(written) == solve(digits=30, rho=1, L2="3/2")
    assert run([*arguments, "--name", "other"]) == 0
    assert (tmp_path / "new" / "other.json").read_text(encoding="utf-8") == written


@pytest.mark.parametrize(
    ("at", "status"),
    [("rho=0", 3), ("L2=4/3,rho=2/5,F3=-320/3,F4=-60", 0)],
    ids=["infinitely-many", "degenerate"],
)
@pytest.mark.slow_cases("degenerate")
def test_special_points_are_answers(
    at: str, status: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The exit status tells where there are no poses."""
    assert run(["solve", "--at", at, "--landscape", "--out", str(tmp_path)]) == status
    out, error = capsys.readouterr()
    assert "infinitely many equilibria" in out or "1 degenerate, on the variety" in out
    assert ("undecided: infinitely many equilibria" in error) is (status == 3)
    assert [path.name for path in tmp_path.iterdir()] == ["poses-landscape.png"]


def test_an_unwritable_folder_is_told_before_anything_is_computed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("here already")
    assert (
        run(["solve", "--at", "rho=1", "--format", "table,json", "--out", str(tmp_path / "file")])
        == 2
    )
    captured = capsys.readouterr()
    assert "cannot be made" in captured.err
    assert captured.out == ""
