"""The benchmark: what it asks QEPCAD is the right question, and its figures are put together rightly."""

from __future__ import annotations

import json
import math
import sys
from fractions import Fraction
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest
from support.shipped_records import EXACT

from ptmcad.question import config
from ptmcad.studies.bench import __main__ as command
from ptmcad.studies.bench import programs, records
from ptmcad.studies.bench.harness import Job, summary, table, take_turns
from ptmcad.studies.bench.process import Outcome, Usage, run

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


def test_maps_with_free_lengths_are_not_timed_by_default(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """They take as long as they are given."""
    monkeypatch.chdir(CONFIGS.parent)
    seen: list[str] = []
    monkeypatch.setattr(records, "turns", lambda jobs, options: seen.extend(job.subject for job in jobs))
    monkeypatch.setattr(records, "check", lambda slice: SimpleNamespace(forecast=None))
    assert command.main(["times"]) == 0
    assert {*seen} == {"floor", *(f"configs/{path.stem}" for path in EXACT)}
    assert "fig4" in {path.stem for path in EXACT}
    assert "not run" in capsys.readouterr().out


def value(terms: programs.Terms, x: float, y: float, t: float) -> float:
    return math.fsum(float(c) * x**i * y**j * t**n for i, j, n, c in terms)


def roots(terms: programs.Terms, x: float, y: float) -> list[float]:
    """The real roots in t, in floating point: good enough for points far from the variety."""
    numpy = pytest.importorskip("numpy")
    coefficients = [0.0] * 7
    for i, j, n, c in terms:
        coefficients[6 - n] += float(c * Fraction(x) ** i * Fraction(y) ** j)
    return [root.real for root in numpy.roots(coefficients) if abs(root.imag) < 1e-9]


@pytest.mark.parametrize(
    ("name", "point", "total", "stable"),
    [
        ("fig4", {"rho": 0.7, "L2": 1.5}, 6, 2),
        ("fig4", {"rho": 0.3, "L2": 1.5}, 4, 1),
        ("fig4", {"rho": 1.5, "L2": 0.5}, 4, 1),
        ("fig3", {"rho": 0.75, "F": -10.0}, 6, 2),
        ("fig3", {"rho": 0.1, "F": -10.0}, 4, 1),
        ("fig3", {"rho": 0.0015, "F": -10.0}, 6, 1),
        ("fig5-text", {"rho": 0.75, "F4": -20.0}, 6, 2),
        ("fig5-caption", {"rho": 0.5, "F4": -20.0}, 6, 2),
        ("fig5-caption", {"rho": 0.8, "F4": -20.0}, 4, 1),
    ],
)
def test_sextic_has_the_known_counts(name: str, point: dict[str, float], total: int, stable: int) -> None:
    """Counts of the reference, from the sextic and from the sign conditions that QEPCAD is given."""
    slice = config.load(CONFIGS / f"{name}.yaml")
    asked = programs.question(slice)
    assert isinstance(asked, programs.Question)
    x, y = (point.get(axis, point.get("F")) for axis in slice.axis_names)
    assert x is not None and y is not None
    found = roots(asked.sextic, x, y)
    assert len(found) == total
    signs = [[math.copysign(1, value(p, x, y, t)) for p in (asked.v, asked.w, asked.slope)] for t in found]
    assert sum(v == w == -slope for v, w, slope in signs) == stable


def test_unloaded_slice_has_no_sextic() -> None:
    assert "theta2 = pi" in str(programs.question(config.load(CONFIGS / "fig2.yaml")))


def test_text_for_qepcad() -> None:
    asked = programs.Question(
        sextic=[(0, 0, 2, Fraction(3, 2)), (1, 2, 0, Fraction(-1))],
        slope=[(0, 0, 1, Fraction(1))],
        v=[(0, 0, 1, Fraction(1))],
        w=[(1, 0, 1, Fraction(-2))],
        axes=config.slice_from_mapping({"axes": {"rho": ["1/2", 2], "F3": [-30, 0]}}).axes,
    )
    lines = asked.problem(programs.Task.SIX, swapped=True).splitlines()
    assert lines[1:5] == [
        "(y,x,t)",
        "2",
        "(X6 t)[ 3/2 t^2 - x y^2 = 0 ].",
        r"assume [ x > 1/2 /\ x < 2 /\ y > -30 /\ y < 0 ]",
    ]
    stable = asked.problem(programs.Task.TWO_STABLE)
    assert r"(X2 t)[ 3/2 t^2 - x y^2 = 0 /\ [[t > 0 /\ -2 x t > 0 /\ t < 0] \/" in stable


def test_process_that_fails_and_process_that_hangs() -> None:
    failed = run([sys.executable, "-c", "import sys; sys.exit('no good')"])
    assert (failed.outcome, failed.message) == (Outcome.FAILED, "no good")
    hanging = run([sys.executable, "-c", "import time; time.sleep(60)"], timeout=0.3)
    assert hanging.outcome is Outcome.TIMED_OUT
    assert hanging.seconds < 30


def test_qepcad_that_ends_without_an_answer_has_none() -> None:
    assert programs.formulas("Failure occurred in: GCSI") == []
    one = "\nAn equivalent quantifier-free formula:\n\nx > 0 /\\\ny < 0\n\n\n"
    assert programs.formulas(one + "QEPCAD" + one) == ["x > 0 /\\ y < 0"] * 2


def job(code: str, answer: Path | None = None, check: Any = lambda usage: "") -> Job:
    return Job("fig4", "python", code, [sys.executable, "-c", code], answer=answer, check=check)


def test_a_job_is_a_row_of_a_table() -> None:
    measured, double, late = job("pass"), job("pass"), job("pass")
    for seconds, peak in ((3.0, 10.0), (1.0, 30.0), (2.0, 20.0)):
        measured.usages.append(Usage(Outcome.DONE, seconds, 0.5, peak))
        double.usages.append(Usage(Outcome.DONE, 2 * seconds, 0.5, peak))
    late.usages.append(Usage(Outcome.DONE, 1.0, 1.0, 1.0))
    late.reason = "not in 60 s"
    rows = summary([measured, double, late, job("pass")], "one", "seconds")
    row = rows.iloc[0]
    assert (row["runs"], row["seconds"], row["least"], row["most"]) == (3, 2.0, 1.0, 3.0)
    assert (row["processor"], row["peak MiB"]) == (0.5, 30.0)
    assert rows["over one"].tolist()[:2] == [1.0, 2.0] and rows["over one"].isna().tolist()[2:] == [True, True]
    assert rows["reason"].tolist()[2:] == ["not in 60 s", "not run"]
    lines = table(rows).splitlines()
    assert lines[0].split()[-1] == "reason" and lines[3].endswith("not in 60 s")


def test_a_program_that_fails_hangs_or_is_silent(tmp_path: Path) -> None:
    for code, reason, more in (
        ("import sys; sys.exit('no good')", "failed: no good", {}),
        ("pass", "failed: no answer", {"answer": tmp_path / "answer"}),
        ("print('x')", "failed: not that", {"check": lambda usage: "not that" if usage.output == "x\n" else ""}),
        ("import time; time.sleep(60)", "not in 0.5 s", {}),
    ):
        failing = job(code, **more)
        failing.attempt(0.5 if "sleep" in code else 30)
        assert failing.reason == reason
        take_turns([failing], 2, Random(1), lambda job: pytest.fail("it is not tried again"))
    written = tmp_path / "answer"
    writing = job(f"open({str(written)!r}, 'x').write('3')", answer=written)
    written.write_text("of an earlier round")
    assert writing.attempt(30).outcome is Outcome.DONE
    assert (writing.said(), len(writing.usages)) == ("3", 1)


def test_jobs_take_turns() -> None:
    order: list[str] = []
    jobs = [job(name) for name in "abc"]
    take_turns(jobs, 3, Random(1), lambda job: order.append(job.setting))
    assert [sorted(order[k : k + 3]) for k in (0, 3, 6)] == [["a", "b", "c"]] * 3
    assert order[:3] != order[3:6] or order[3:6] != order[6:]


@pytest.mark.parametrize("difference", ["", "other neighbours"])
def test_a_study_ends_with_1_where_an_answer_differs(
    difference: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    rows = pd.DataFrame([{"subject": "fig2", "differs": difference}, {"subject": "fig3"}])
    monkeypatch.setitem(command.STUDIES, "ablation", ("ablation", lambda options: rows, ""))
    assert command.main(["ablation", "--out", str(tmp_path / "out")]) == bool(difference)
    found = json.loads((tmp_path / "out" / "ablation.json").read_text(encoding="utf-8"))
    assert found["rows"] == [{"subject": "fig2", "differs": difference}, {"subject": "fig3"}]
    assert found["machine"]["cores"] and found["versions"]["python-flint"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["times", "--rounds", "0"], "--rounds must be positive"),
        (["scaling", "--timeout", "nan"], "--timeout must be positive"),
        (["scaling", "folds"], "no family 'folds'; there are degree"),
        (["ablation", "nowhere.yaml"], "nowhere.yaml"),
        (["times", "--out", "file"], "file"),
    ],
    ids=lambda x: " ".join(x) if isinstance(x, list) else "",
)
def test_bad_input(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("")
    try:
        status: Any = command.main(arguments)
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_ablation(tmp_path: Path) -> None:
    """One round on the smallest slice: every saving is there, and nothing differs."""
    assert command.main(["ablation", str(CONFIGS / "fig2.yaml"), "--rounds", "1", "--out", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "ablation.json").read_text(encoding="utf-8"))["rows"]
    assert {row["subject"] for row in rows} == {"fig2", "fig2, axes exchanged"}
    assert {"all made", "axis-order", "imports", "all"} <= {row["setting"] for row in rows}
    assert {row["differs"] for row in rows} == {""}
    assert all(row["over all made"] > 0 for row in rows)


@pytest.mark.slow
@pytest.mark.skipif(programs.qepcad_command() is None, reason="qepcad is not installed")
def test_qepcad_answers() -> None:
    asked = programs.question(config.load(CONFIGS / "fig3.yaml"))
    command = programs.qepcad_command()
    assert isinstance(asked, programs.Question) and command is not None
    problems = [asked.problem(task) for task in (programs.Task.SIX, programs.Task.FOUR)]
    usage = run(command, text=programs.qepcad_session(problems), timeout=60)
    assert len(programs.formulas(usage.output)) == 2, usage.message
