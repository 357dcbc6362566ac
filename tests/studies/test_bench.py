"""The benchmark: whole processes are measured, and their figures are put together rightly."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest
from support.shipped_records import EXACT

from ptmcad.studies.bench import __main__ as command
from ptmcad.studies.bench.harness import Job, summary, table, take_turns
from ptmcad.studies.bench.process import Usage, run

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


def test_maps_with_free_lengths_are_not_timed_by_default(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """They take as long as they are given."""
    monkeypatch.chdir(CONFIGS.parent)
    seen: list[str] = []
    monkeypatch.setattr(
        command, "turns", lambda jobs, options: seen.extend(job.subject for job in jobs)
    )
    monkeypatch.setattr(command, "check", lambda slice: SimpleNamespace(forecast=None))
    assert command.main(["times"]) == 0
    assert {*seen} == {"floor", *(f"configs/{path.stem}" for path in EXACT)}
    assert "fig4" in {path.stem for path in EXACT}
    assert "not run" in capsys.readouterr().out


def test_process_that_fails_and_process_that_hangs() -> None:
    failed = run([sys.executable, "-c", "import sys; sys.exit('no good')"])
    assert failed.fault == "failed: no good"
    hanging = run([sys.executable, "-c", "import time; time.sleep(60)"], timeout=0.3)
    assert hanging.fault == "not in 0.3 s"
    assert hanging.seconds < 30


def job(code: str, answer: Path | None = None, check: Any = lambda usage: "") -> Job:
    return Job("fig4", "python", code, [sys.executable, "-c", code], answer=answer, check=check)


def test_a_job_is_a_row_of_a_table() -> None:
    measured, double, late = job("pass"), job("pass"), job("pass")
    for seconds, peak in ((3.0, 10.0), (1.0, 30.0), (2.0, 20.0)):
        measured.usages.append(Usage(seconds, 0.5, peak))
        double.usages.append(Usage(2 * seconds, 0.5, peak))
    late.usages.append(Usage(1.0, 1.0, 1.0))
    late.reason = "not in 60 s"
    rows = summary([measured, double, late, job("pass")], "one", "seconds")
    row = rows.iloc[0]
    assert (row["runs"], row["seconds"], row["least"], row["most"]) == (3, 2.0, 1.0, 3.0)
    assert (row["processor"], row["peak MiB"]) == (0.5, 30.0)
    assert rows["over one"].tolist()[:2] == [1.0, 2.0] and rows["over one"].isna().tolist()[2:] == [
        True,
        True,
    ]
    assert rows["reason"].tolist()[2:] == ["not in 60 s", "not run"]
    lines = table(rows).splitlines()
    assert lines[0].split()[-1] == "reason" and lines[3].endswith("not in 60 s")


def test_a_program_that_fails_hangs_or_is_silent(tmp_path: Path) -> None:
    for code, reason, more in (
        ("import sys; sys.exit('no good')", "failed: no good", {}),
        ("pass", "failed: no answer", {"answer": tmp_path / "answer"}),
        (
            "print('x')",
            "failed: not that",
            {"check": lambda usage: "not that" if usage.output == "x\n" else ""},
        ),
        ("import time; time.sleep(60)", "not in 0.5 s", {}),
    ):
        failing = job(code, **more)
        failing.attempt(0.5 if "sleep" in code else 30)
        assert failing.reason == reason
        take_turns([failing], 2, Random(1), lambda job: pytest.fail("it is not tried again"))
    written = tmp_path / "answer"
    writing = job(f"open({str(written)!r}, 'x').write('3')", answer=written)
    written.write_text("of an earlier round")
    writing.attempt(30)
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
    arguments: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: Any,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("")
    try:
        status: Any = command.main(arguments)
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert message in capsys.readouterr().err
