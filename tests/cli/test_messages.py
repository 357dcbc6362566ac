"""What the program says, in the words that a newcomer is to read."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.replacing import replace

from ptmcad.answer.regionmap import COMPILATION, RegionMap
from ptmcad.cli import run
from ptmcad.show.table import table

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
FIG2 = str(CONFIGS / "fig2.yaml")
Shipped = Callable[..., RegionMap]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--tolerance", "1/50"], ["--tolerance has no effect here: the exact engine leaves nothing undetermined"]),
        (["--jobs", "1", "--dpi", "90"], ["--jobs has no effect here: the exact engine uses one thread",
                                         "--dpi has no effect here: no picture is written"]),
        (["--samples", "--pixels", "9"], ["--samples has no effect here: no picture is written",
                                          "--pixels has no effect here: only NPZ has a grid, see --format"]),
        (["--boundary-tolerance", "1/9"],
         ["--boundary-tolerance has no effect here: only CSV and NPZ have boundaries, see --format"]),
        (["--format", "csv", "--boundary-tolerance", "1/9"], []),
        (["--no-areas"], []),
    ],
)  # fmt: skip
def test_an_option_without_effect_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], said: list[str]
) -> None:
    assert run(["classify", FIG2, "--format", "json", "--out", str(tmp_path), *options]) == 0
    assert capsys.readouterr().err.splitlines() == [f"note: {line}" for line in said]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("mechanism: ptm\naxes: {rho: [0, 2], L2: [0, 2]}\n",
         "this is a problem record, not a result: run `ptmcad classify` on it first"),
        ('{"axes": {"rho": [0, 2], "L2": [0, 2]}}',
         "this is a problem record, not a result: run `ptmcad classify` on it first"),
        ('{"format": "ptmcad-poses/1"}',
         "this is a ptmcad-poses/1 file, not a region map: `ptmcad classify` makes one"),
        ('{"format": "ptmcad-region-map/1"}',
         "this is a ptmcad-region-map/1 file, and this program reads version 2: make it anew"),
        ("{", "is damaged or not a ptmcad-region-map/2 file: "),
        ('{"format": "ptmcad-region-map/2"}', "is damaged or not a ptmcad-region-map/2 file: "),
        ("name: x\n", "is damaged or not a ptmcad-region-map/2 file: "),
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    "command", [["locate", "--at", "rho=1,L2=1"], ["verify"], ["plot"], ["report"]]
)
def test_a_file_that_is_no_result(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: list[str], text: str, said: str
) -> None:
    path = tmp_path / "given"
    path.write_text(text, encoding="utf-8")
    assert run([command[0], str(path), *command[1:]]) == 2
    assert capsys.readouterr().err.startswith(f"error: {path}: {said}")


@pytest.mark.parametrize("text", ["[]", "{}", "{", '{"format": "ptmcad-sweep/1"}'])
def test_verify_says_what_it_reads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    path = tmp_path / "odd.json"
    path.write_text(text, encoding="utf-8")
    assert run(["verify", str(path)]) == 2
    said = "this is no result that can be verified: those are the JSON files of `ptmcad classify`"
    assert capsys.readouterr().err.startswith(f"error: {path}: {said}")


@pytest.mark.parametrize(
    "command", [["solve", "--at", "rho=1"], ["range", "--along", "rho", "--at", "L2=3/2"]]
)
def test_a_folder_for_no_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: list[str]
) -> None:
    assert run([*command, "--out", str(tmp_path)]) == 0
    assert (
        capsys.readouterr().err
        == "note: --out has no effect here: no file is written, see --format\n"
    )


def test_an_unknown_axis(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["classify", "--slice", "foo,rho"]) == 2
    said = "error: --slice: unknown axis 'foo'; to introduce a new variable add --range foo=LO:HI\n"
    assert capsys.readouterr().err == said


def test_what_is_spared_on_every_slice_is_not_explained(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    common = ["classify", FIG2, "--format", "json", "--out", str(tmp_path), "--explain"]
    assert run(common) == 0
    assert "import" not in capsys.readouterr().out
    plan = json.loads((tmp_path / "fig2.json").read_text(encoding="utf-8"))["plan"]
    assert plan[0]["saving"] == "imports"
    assert run([*common, "--without", "imports"]) == 0
    assert "computed: imports of numpy" in capsys.readouterr().out


def test_the_time_line(shipped: Shipped) -> None:
    exact = replace(shipped("fig2"), timings={"total": 0.314})
    assert (
        table(exact)
        .splitlines()[-1]
        .startswith("time      0.31 s; nothing undetermined; area bounds")
    )
    first = replace(exact, timings={"total": 24.9, COMPILATION: 38.0})
    assert "time      62.9 s, of which 38 s compilation (once); nothing" in table(first)


def test_no_curve_changes_the_count(shipped: Shipped) -> None:
    assert "curves    no curve changes the count" in table(replace(shipped("fig2"), components=()))


def test_verify_shows_progress_on_a_terminal(
    shipped: Shipped, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "fig2.json"
    path.write_text(shipped("fig2").to_json(), encoding="utf-8")
    monkeypatch.setattr("ptmcad.cli.progress.PATIENCE", 0)
    monkeypatch.setattr("ptmcad.cli.progress._INTERVAL", 0)
    for watched in (True, False):
        terminal = io.StringIO()
        monkeypatch.setattr(terminal, "isatty", lambda watched=watched: watched)
        monkeypatch.setattr(sys, "stderr", terminal)
        assert run(["verify", str(path)]) == 0
        assert ("] check 20 of 20: areas ..., " in terminal.getvalue()) == watched


@pytest.mark.parametrize("command", ["classify", "check", "variety"])
def test_a_result_where_a_record_is_needed_is_named(
    command: str, tmp_path: Path, shipped: Shipped, capsys: pytest.CaptureFixture[str]
) -> None:
    result = tmp_path / "fig2.json"
    result.write_text(shipped("fig2").to_json())
    assert run([command, str(result)]) == 2
    said = capsys.readouterr().err
    assert said.count("error") == 1
    assert "a result, not a problem record: `ptmcad plot`" in said
