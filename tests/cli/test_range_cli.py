"""``ptmcad range`` from the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema
import pytest

import ptmcad
from ptmcad.cli import range_answers, run
from ptmcad.cli.range_answers import RangeRequest
from ptmcad.question.counts import Count

ROOT = Path(__file__).resolve().parents[2]
FIG4 = str(ROOT / "configs" / "fig4.yaml")
FIG3 = str(ROOT / "configs" / "fig3.yaml")
SCHEMA = json.loads((ROOT / "docs" / "range.schema.json").read_text(encoding="utf-8"))


def test_no_count_is_named_of_which_the_table_has_no_column(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(range_answers, "_answers", lambda *_: ())
    slice = ptmcad.slice_from_options(slice="rho,L2", sets=["l0=1/5"], count=Count.ADMISSIBLE)
    asked = RangeRequest("rho", {"L2": "1"}, False, 1, None, None, 10, ())
    text, *_ = range_answers.answer(slice, asked, lambda *_: None)
    assert text.split()[-2:] == ["count", "stable"]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["--along", "rho", "--at", "L2=3/2"], "operation range: 0.25 to 1.25, width 1"),
        (
            ["--along", "rho", "--at", "L2=3/2,F3=-10,F4=-10"],
            "operation range: 0.4981306959 to 1.041432630",
        ),
        (
            ["--along", "L2", "--at", "rho=1/2"],
            "operation range: 0 to 2, width 2 (its lower end is the window's edge)",
        ),
        ([FIG4, "--along", "F3", "--at", "L2=3/2,rho=1"], "operation range: -16.51890610 to 0"),
        (
            [FIG4, "--along", "k", "--at", "rho=1,L2=3/2", "--digits", "4"],
            "operation range: 75.22 to 200",
        ),
        (
            [FIG3, "--along", "rho", "--at", "F=-10"],
            "operation range: 0.2149411958 to 0.8034910267",
        ),
        (
            [FIG4, "--along", "rho", "--at", "L2=1", "--range", "rho=1/2:3/5"],
            "width 0.1 (the whole window)",
        ),
        (["--along", "rho", "--at", "L2=9/10", "--range", "rho=3:4"], "operation range: none"),
    ],
    ids=lambda v: " ".join(v) if isinstance(v, list) else "",
)
def test_lines_of_all_kinds(
    arguments: list[str], line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["range", *arguments]) == 0
    assert line in capsys.readouterr().out


FREE02 = str(ROOT / "configs" / "free02.yaml")


def test_a_line_with_free_lengths_as_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("numba")
    arguments = [
        FREE02,
        "--along",
        "rho",
        "--at",
        "L2=3/2",
        "--range",
        "rho=3/10:3/5",
        "--format",
        "json",
    ]
    assert run(["range", *arguments, "--out", str(tmp_path), "--name", "x"]) == 0
    data = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, SCHEMA, cls=jsonschema.Draft202012Validator)
    intervals = data["enclosed"]["intervals"]
    assert [(i["total"], i["stable"], i["index"]) for i in intervals] == [
        (4, 1, [1, 2, 1]),
        (6, 2, [2, 3, 1]),
    ]
    assert intervals[0]["high"] == intervals[1]["low"] == data["enclosed"]["changes"][0]["at"]
    assert intervals[0]["high"]["decimal"] == "0.4634527060"
    # each count that is said is compared, also where another version's answer need not be today's
    data["versions"]["ptmcad"], intervals[0]["total"], intervals[0]["stable"] = "0.1.0", None, 5
    (tmp_path / "false.json").write_text(json.dumps(data), encoding="utf-8")
    capsys.readouterr()
    assert run(["verify", str(tmp_path / "false.json")]) == 1
    assert "stable 5, index [1, 2, 1] is said to be at" in " ".join(capsys.readouterr().out.split())
    assert run(["range", *arguments[:-1], "json,svg", "--out", str(tmp_path), "--name", "y"]) == 0
    assert "1 stable of 4; " in (tmp_path / "y.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "at",
    [pytest.param([], marks=pytest.mark.slow), ["--at", "L2=3/2"]],
    ids=["over alone", "with a line"],
)
def test_a_band_with_free_lengths(
    at: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """At L2 = 3/2 the row's ends are those that `ptmcad range --at` gives."""
    pytest.importorskip("numba")
    window = [
        "--range",
        "rho=3/10:7/5",
        *(["--range", "L2=1:2", "--rows", "1"] if at else ["--rows", "3"]),
    ]
    asked = ["--along", "rho", "--over", "L2", *at, *window, "--digits", "6"]
    files = ["--format", "json,svg", "--out", str(tmp_path), "--name", "x"]
    assert run(["range", FREE02, *asked, *files]) == 0
    out = capsys.readouterr().out
    assert "operation range: where there are at least two stable equilibria" in out
    assert re.search(r"^1\.5 +0\.463453 +1\.23166 +0\.768210$", out, re.MULTILINE), out
    assert "; nothing is proved of the values between them" in out
    data = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, SCHEMA, cls=jsonschema.Draft202012Validator)
    assert [row["value"] for row in data["bands"]["rows"]] == (
        ["3/2"] if at else ["1/2", "1", "3/2"]
    )
    assert ("enclosed" in data) == bool(at)
    picture = (tmp_path / "x-over.svg").read_text(encoding="utf-8")
    assert "bars: where there are at least two stable equilibria" in picture


@pytest.mark.parametrize(
    ("asked", "key"),
    [
        (["--along", "foo", "--at", "L2=1"], "--along"),
        (["--along", "rho", "--over", "foo"], "--over"),
        (["--slice", "foo,L2", "--along", "foo", "--at", "L2=1"], "--slice"),
    ],
)
def test_an_unknown_axis_is_told_by_the_option_that_named_it(
    asked: list[str], key: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["range", str(ROOT / "configs" / "fig4.yaml"), *asked]) == 2
    expected = (
        f"error: {key}: unknown axis 'foo'; to introduce a new variable add --range foo=LO:HI\n"
    )
    assert capsys.readouterr().err == expected
