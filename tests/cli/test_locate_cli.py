"""``ptmcad locate`` and ``ptmcad verify`` from the command line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli import run


@pytest.fixture(name="fig2")
def fig2_file(tmp_path: Path, shipped: Callable[..., RegionMap]) -> Path:
    path = tmp_path / "fig2.json"
    path.write_text(shipped("fig2").to_json(), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("at", "status"),
    [
        ("L2=3/2,rho=5/4", "on the variety"),
        ("L2=9,rho=1", "outside the window"),
        ("L2=0,rho=1", "on the window's edge"),
        ("L2=0,rho=-1", "outside the window"),
        ("L2=3/2,rho=1.25000000000000000000000000000000000000001", "stable  1"),
        ("L2=3/2,rho=1.24999999999999999999999999999999999999999", "stable  2"),
    ],
)
def test_near_a_boundary(
    fig2: Path, at: str, status: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["locate", str(fig2), "--at", at]) == 0
    assert status in capsys.readouterr().out


def test_many_points(fig2: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = tmp_path / "points.csv"
    table.write_text("name,rho, L2\na,7/10,3/2\nb,5/4,3/2\nc,1,9\n", encoding="utf-8")
    assert run(["locate", str(fig2), "--csv", str(table)]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[0] == "L2,rho,status,region,cell,total,stable,index"
    assert rows[1].startswith("3/2,7/10,exact,")
    assert rows[1].endswith(",6,2,2-3-1")
    assert rows[2:] == ["3/2,5/4,on the variety,,,,,", "9,1,outside the window,,,,,"]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["--at", "rho=1"],
        ["--at", "rho"],
        ["--at", "rho=1,L2=x"],
        ["--at", "rho=1,L2=1,k=3"],
        ["--csv", "none.csv"],
    ],
)
def test_bad_points(fig2: Path, arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["locate", str(fig2), *arguments]) == 2
    assert capsys.readouterr().err.startswith("error: ")


def test_a_bad_row_is_named(fig2: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = tmp_path / "points.csv"
    table.write_text("rho,L2\n1,1\n1,nan\n", encoding="utf-8")
    assert run(["locate", str(fig2), "--csv", str(table)]) == 2
    assert "points.csv:3" in capsys.readouterr().err


@pytest.mark.parametrize("command", [["verify"], ["locate", "--at", "L2=1,rho=1"]])
@pytest.mark.parametrize("damage", ["", "{}", "[]", "null", "{" * 100_000, "\0", "\udcff", "half"])
def test_a_damaged_file(
    fig2: Path, command: list[str], damage: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = fig2.read_text(encoding="utf-8")
    damaged = text[: len(text) // 2] if damage == "half" else damage
    fig2.write_bytes(damaged.encode("utf-8", "surrogateescape"))
    assert run([command[0], str(fig2), *command[1:]]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1
    assert str(fig2) in error
