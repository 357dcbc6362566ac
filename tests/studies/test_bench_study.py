"""`ptmcad bench`: what is stored, compared, said and drawn, on studies that are made up; and the
command itself.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.cli import run
from ptmcad.cli.bench import METHODS
from ptmcad.errors import ConfigError
from ptmcad.question.config import load
from ptmcad.show.report.error_curve import read_error_curve
from ptmcad.show.schemas import with_prose
from ptmcad.studies.bench.error import figures, outward
from ptmcad.studies.bench.harness import Row, measurement
from ptmcad.studies.bench.stored import (
    BAD,
    compare,
    comparison_table,
    study_of,
    study_schema,
    write_study,
)
from ptmcad.studies.bench.study import RIVALS
from ptmcad.studies.bench.studyreport import curve_file, page, sentences, terminal

ROOT = Path(__file__).resolve().parents[2]
CONFIGS = ROOT / "configs"
SCHEMA = json.loads((ROOT / "docs" / "bench.schema.json").read_text(encoding="utf-8"))
NONE = figures((0.0, 0.0), 0.0, regions=3, missed=0, faintest=(1.0, 1.0), distance=(0.0, 0.0))


def times(seconds: float, runs: int = 3, spread: float = 0.02) -> Row:
    return {
        "runs": runs,
        "median": seconds,
        "minimum": seconds * (1 - spread),
        "maximum": seconds * (1 + spread),
    }


def pixels(n: int, seconds: float, wrong: float, missed: int, faint: float) -> Row:
    f = figures(
        (wrong, wrong * 1.001), 0.0, wrong_centres=0, regions=3, missed=missed, faintest=(faint, faint),
        distance=(0.5 / n, 0.6 / n),
    )  # fmt: skip
    taken = {"seconds": times(seconds), "computing": times(seconds / 2), "peak": 60.0}
    return measurement("companion", f"N = {n}", **taken, figures={"index": f})


def exact(tolerance: str, seconds: float, width: float) -> Row:
    taken = {"seconds": times(seconds), "computing": times(seconds - 0.1), "peak": 35.0}
    return measurement(
        "exact", f"area tolerance {tolerance}", **taken, figures={"index": NONE}, area_width=width
    )


STUDY: Row = {
    "format": "ptmcad-bench/1",
    "slice": "fig4",
    "heading": "Equal loads",
    "machine": {"cores": "2"},
    "versions": {"python": "3.11"},
    "seed": 1,
    "rounds": 3,
    "time_limit": 60.0,
    "quick": False,
    "verified": True,
    "floor": times(0.2),
    "measurements": (
        exact("1e-2", 0.3, 2e-3),
        exact("1e-8", 0.4, 2e-9),
        pixels(25, 0.2, 0.02, 1, 0.0),
        pixels(400, 1.5, 0.001, 0, 0.4),
        pixels(800, 6.0, 0.0005, 0, 0.992),
        measurement(
            "companion", "N = 1600", reason="left out: the 60 s for each method were used up"
        ),
        measurement(
            "qepcad",
            "where 6, where 4",
            seconds=times(3.0),
            figures={"total": figures((0.0, 0.0), 0.0)},
            note="claimed",
        ),
        measurement("gcad", "", reason="gcad is not installed"),
    ),
}


def changed(number: int, **values: Any) -> Row:
    m = list(STUDY["measurements"])
    m[number] = {**m[number], **values}
    return {**STUDY, "measurements": tuple(m)}


def test_written_and_read_again() -> None:
    text = write_study(STUDY)
    assert study_of(text) == STUDY
    jsonschema.validate(json.loads(text), SCHEMA)


@pytest.mark.parametrize(
    ("path", "value", "told"),
    [
        (("format",), "ptmcad-bench/9", "its format is"),
        (("floor", "median"), 0, "floor.median"),
        (("measurements", 0, "seconds", "runs"), 1.5, "measurements[0].seconds.runs"),
        (("measurements", 0, "figures", "index", "wrong"), [1], "wrong has 1 entries"),
        (("quick",), 1, "quick is not true or false"),
        (("more",), 1, "unknown key"),
        (("slice",), "a\x1bb", "slice"),
    ],
    ids=str,
)
def test_damaged_documents_are_refused_with_the_place(
    path: tuple[Any, ...], value: Any, told: str
) -> None:
    data = json.loads(write_study(STUDY))
    at = data
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    with pytest.raises(ValueError, match=told.replace("[", r"\[").replace("]", r"\]")):
        study_of(json.dumps(data))


@pytest.mark.parametrize(
    "path", sorted((ROOT / "docs" / "benchmarks").glob("*.bench.json")), ids=lambda p: p.stem
)
def test_stored_studies_are_valid(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    jsonschema.validate(json.loads(text), SCHEMA)
    assert write_study(study_of(text)) == text


def test_the_methods_are_those_of_the_command() -> None:
    assert list(RIVALS) == list(METHODS)


def test_the_published_schema_is_that_of_the_codec() -> None:
    """``scripts/schemas`` writes it anew."""
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert with_prose(study_schema(), SCHEMA) == SCHEMA


@given(st.fractions(0, 1), st.fractions(0, 1))
def test_rounding_keeps_bounds(a: Fraction, b: Fraction) -> None:
    low, high = outward(min(a, b), max(a, b))
    assert Fraction(str(low)) <= min(a, b) and max(a, b) <= Fraction(str(high))


def test_smallest_grids() -> None:
    said = " ".join(sentences(STUDY))
    assert (
        "by index: the smallest grid with a pixel in each is 400 x 400; with at least 99% of each, 800 x 800"
        in said
    )
    assert "by equilibria: the smallest grid with a pixel in each is none up to 800 x 800" in said
    assert "no error after 0.30 s; the 400 x 400 grid has 5.0 times that time" in said


def verdicts(found: tuple[Row, ...]) -> dict[tuple[str, str], list[str]]:
    told: dict[tuple[str, str], list[str]] = {}
    for c in found:
        told.setdefault((c["method"], c["setting"]), []).append(c["verdict"])
    return told


def test_the_same_study_has_not_changed() -> None:
    assert {c["verdict"] for c in compare(STUDY, STUDY)} == {"same"}
    assert comparison_table(compare(STUDY, STUDY)).endswith(
        "nothing became slower or worse beyond noise"
    )


@pytest.mark.parametrize(
    ("new", "expected"),
    [
        (changed(0, seconds=times(0.6)), "slower"),
        (changed(0, seconds=times(0.1)), "faster"),
        (changed(0, seconds=times(0.32)), "same"),  # within a tenth and the spread
        (
            changed(0, seconds={**times(0.6), "minimum": 0.31, "maximum": 0.7}),
            "same",
        ),  # one of its runs was as fast
        (
            changed(0, seconds=times(0.42, runs=1, spread=0.0)),
            "same",
        ),  # once: half as much again is noise
        (changed(0, seconds=times(0.6, runs=1, spread=0.0)), "slower"),
        (changed(0, area_width=3e-3), "worse"),
        (changed(0, area_width=1e-3), "better"),
        (changed(0, figures={"index": {**NONE, "missed": 1}}), "worse"),
        (changed(0, figures={"index": {**NONE, "wrong": (1e-10, 1e-9)}}), "worse"),
        (changed(0, figures={"stable": NONE}), "lost"),
        (changed(0, seconds=None, reason="timed out"), "lost"),
        ({**STUDY, "measurements": STUDY["measurements"][1:]}, "lost"),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_verdicts(new: Row, expected: str) -> None:
    found = verdicts(compare(STUDY, new))
    assert found.pop(("exact", "area tolerance 1e-2")) == [expected]
    assert all(v == ["same"] for v in found.values())


def test_a_slower_machine_is_no_slower_program() -> None:
    """Everything takes three times as long, the reference job too."""

    def slow(m: Row) -> Row:
        t = m["seconds"]
        return {
            **m,
            "seconds": t and {name: x if name == "runs" else 3 * x for name, x in t.items()},
        }

    there = {**STUDY, "floor": times(0.6), "measurements": tuple(map(slow, STUDY["measurements"]))}
    assert not {*BAD} & {c["verdict"] for c in compare(STUDY, there)}
    there = {**there, "floor": STUDY["floor"]}
    assert "slower" in {c["verdict"] for c in compare(STUDY, there)}


def test_what_is_gained() -> None:
    new = changed(5, seconds=times(24.0), reason="")
    assert verdicts(compare(STUDY, new))["companion", "N = 1600"] == ["gained"]


def test_studies_of_different_slices_are_not_compared() -> None:
    with pytest.raises(ConfigError, match="differ in slice: fig4 and fig3"):
        compare(STUDY, {**STUDY, "slice": "fig3"})


def test_a_record_is_there_in_any_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What ``ptmcad bench`` measures without CONFIG."""
    monkeypatch.chdir(tmp_path)
    assert load("fig4").name == "fig4"
    with pytest.raises(
        ConfigError, match="fig6: there is no such file, and no record of this name is shipped"
    ):
        load("fig6")


@pytest.mark.slow
def test_one_slice_by_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """All files are written, belong together, and can be read by what reads them; the reference
    passed verify.
    """
    arguments = ["bench", str(CONFIGS / "fig2.yaml"), "--quick", "--rounds", "1", "--method", "exact", "--method",
                 "companion", "--page", "--out", str(tmp_path)]  # fmt: skip
    assert run(arguments) == 0
    shown = capsys.readouterr().out
    names = {
        f"fig2.{s}"
        for s in ("bench.json", "bench.csv", "bench.svg", "bench.png", "error-time.json")
    }
    assert {path.name for path in tmp_path.iterdir()} == names | {"error-time.md"}
    study = study_of((tmp_path / "fig2.bench.json").read_text(encoding="utf-8"))
    assert study["verified"] is True
    assert [(m["method"], m["setting"]) for m in study["measurements"]][:2] == [
        ("exact", "area tolerance 1e-2"), ("exact", "area tolerance 1e-4")
    ]  # fmt: skip
    for m in study["measurements"]:
        assert None not in (m["seconds"], m["computing"], m["figures"])
        wrong = m["figures"]["index"]["wrong"]
        assert wrong == (0.0, 0.0) if m["method"] == "exact" else 0 < wrong[0] < 0.1
    assert terminal(study) in shown
    assert len(read_error_curve(tmp_path / "fig2.error-time.json")[1]) == 2
    assert "![Error against seconds for fig2](fig2.bench.svg)" in (
        tmp_path / "error-time.md"
    ).read_text(encoding="utf-8")


def test_what_is_written_for_the_report_is_positive(tmp_path: Path) -> None:
    path = tmp_path / "fig4.error-time.json"
    path.write_text(curve_file(STUDY), encoding="utf-8")
    found = read_error_curve(path)
    assert [len(points) for _, points in found[1]] == [2, 3]
    assert found[1][0][1][1] == (0.4, 2e-9)


def test_page_tells_what_is_left_out_and_what_is_claimed() -> None:
    text = page([STUDY])
    assert "- companion, N = 1600: left out: the 60 s for each method were used up" in text
    assert "- gcad: gcad is not installed" in text
    assert r"- \* qepcad: claimed" in text
    assert "passed `ptmcad verify`" in text
    assert "did NOT pass" in page([{**STUDY, "verified": False}])
    assert "](fig4.bench.svg)" in text
    assert ".svg" not in page(
        [{**STUDY, "measurements": STUDY["measurements"][-1:]}]
    )  # nothing to draw
