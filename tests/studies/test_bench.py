"""The benchmark: what it asks QEPCAD is the right question, and its figures are put together rightly."""

from __future__ import annotations

import json
import math
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support.shipped_records import EXACT

from ptmcad.question import config
from ptmcad.studies.bench import ablation, qepcad, suite
from ptmcad.studies.bench.process import Outcome, Usage, run

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


def test_maps_with_free_lengths_are_not_timed_by_default(monkeypatch: pytest.MonkeyPatch) -> None:
    """They take as long as they are given."""
    monkeypatch.chdir(CONFIGS.parent)
    seen: list[Path] = []
    monkeypatch.setattr(suite, "measure", lambda records, plan, date: seen.extend(records))
    monkeypatch.setattr(suite, "to_markdown", lambda found: "")
    assert suite.main([]) == 0
    assert [path.resolve() for path in seen] == list(EXACT)
    assert "fig4" in {path.stem for path in EXACT}


def value(terms: qepcad.Terms, x: float, y: float, t: float) -> float:
    return math.fsum(c * x**i * y**j * t**n for i, j, n, c in terms)


def roots(terms: qepcad.Terms, x: float, y: float) -> list[float]:
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
    asked = qepcad.question(slice)
    assert isinstance(asked, qepcad.Question)
    x, y = (point.get(axis, point.get("F")) for axis in slice.axis_names)
    assert x is not None and y is not None
    found = roots(asked.sextic, x, y)
    assert len(found) == total
    signs = [[math.copysign(1, value(p, x, y, t)) for p in (asked.v, asked.w, asked.slope)] for t in found]
    assert sum(v == w == -slope for v, w, slope in signs) == stable


def test_unloaded_slice_has_no_sextic() -> None:
    assert "theta2 = pi" in str(qepcad.question(config.load(CONFIGS / "fig2.yaml")))


def test_text_for_qepcad() -> None:
    asked = qepcad.Question(
        sextic=((0, 0, 2, 3), (1, 2, 0, -1)),
        slope=((0, 0, 1, 1),),
        v=((0, 0, 1, 1),),
        w=((1, 0, 1, -2),),
        axes=config.slice_from_mapping({"axes": {"rho": ["1/2", 2], "F3": [-30, 0]}}).axes,
    )
    lines = asked.text(qepcad.Task.SIX, swapped=True).splitlines()
    assert lines[1:5] == [
        "(y,x,t)",
        "2",
        "(X6 t)[ 3 t^2 - x y^2 = 0 ].",
        r"assume [ 2 x - 1 > 0 /\ x - 2 < 0 /\ y + 30 > 0 /\ y < 0 ]",
    ]
    stable = asked.text(qepcad.Task.TWO_STABLE)
    assert r"(X2 t)[ 3 t^2 - x y^2 = 0 /\ [[t > 0 /\ -2 x t > 0 /\ t < 0] \/" in stable


def test_process_that_fails_and_process_that_hangs() -> None:
    failed = run([sys.executable, "-c", "import sys; sys.exit('no good')"])
    assert (failed.outcome, failed.message) == (Outcome.FAILED, "no good")
    hanging = run([sys.executable, "-c", "import time; time.sleep(60)"], timeout=0.3)
    assert hanging.outcome is Outcome.TIMED_OUT
    assert hanging.seconds < 30


def test_qepcad_that_ends_without_an_answer_has_failed() -> None:
    usage = Usage(Outcome.DONE, 1.0, 1.0, 1.0, "Failure occurred in: GCSI")
    assert qepcad.judged(usage).outcome is Outcome.FAILED
    answered = Usage(Outcome.DONE, 1.0, 1.0, 1.0, "\nAn equivalent quantifier-free formula:\n\nx > 0 /\\\ny < 0\n\n\n")
    assert qepcad.judged(answered) is answered
    assert qepcad.answer(answered) == "x > 0 /\\ y < 0"


def test_summary() -> None:
    runs = [Usage(Outcome.DONE, seconds, 0.5, peak) for seconds, peak in ((3.0, 10.0), (1.0, 30.0), (2.0, 20.0))]
    found = suite.summary(runs)
    assert found == {"runs": 3, "median": 2.0, "minimum": 1.0, "maximum": 3.0, "processor": 0.5, "peak": 30.0}
    assert suite.summary([*runs, Usage(Outcome.TIMED_OUT, 60.2, 1.0, 1.0)]) == "timed out after 60 s"
    assert suite.summary([]) == "not run"


def test_report_with_and_without_figures() -> None:
    summary = {"runs": 2, "median": 0.25, "minimum": 0.2, "maximum": 0.3, "processor": 0.2, "peak": 60.0}
    rows = [{"name": "fig4", "text": summary, "over_floor": 2.0, "pictures": summary},
            {"name": "fig2", "text": "failed: a | b", "over_floor": 0.0, "pictures": "not run"}]  # fmt: skip
    page = suite.to_markdown({"machine": {"cores": "2"}, "versions": {"python": "3.11"}, "date": "", "seed": 1,
                              "rounds": 2, "floor": summary, "rows": rows})  # fmt: skip
    assert "| fig4 | 0.250 (0.200-0.300) | 2.00 | 0.25 | 60 / 60 |" in page
    assert r"| fig2 | failed: a \| b | - | not run | - / - |" in page


@pytest.mark.parametrize("study", [suite, ablation], ids=["bench", "ablation"])
def test_the_stored_page_is_made_of_the_stored_record(study: Any, request: pytest.FixtureRequest) -> None:
    stored = CONFIGS.parent / "docs" / "benchmarks" / f"{request.node.callspec.id}.json"
    page = stored.with_suffix(".md").read_text(encoding="utf-8")
    assert study.to_markdown(json.loads(stored.read_text(encoding="utf-8"))) == page


@pytest.mark.parametrize("difference", ["", "other neighbours"])
def test_ablation_ends_with_1_where_an_answer_differs(difference: str, monkeypatch: pytest.MonkeyPatch) -> None:
    stored = json.loads((CONFIGS.parent / "docs" / "benchmarks" / "ablation.json").read_text(encoding="utf-8"))
    stored["exact"][0]["switched off"]["all"]["difference"] = difference
    monkeypatch.setattr(ablation, "ablation", lambda *_: stored)
    assert ablation.main([str(CONFIGS / "fig2.yaml")]) == bool(difference)


@pytest.mark.slow
@pytest.mark.skipif(qepcad.program() is None, reason="qepcad is not installed")
@pytest.mark.parametrize("task", qepcad.TOTAL)
def test_qepcad_answers(task: qepcad.Task) -> None:
    asked = qepcad.question(config.load(CONFIGS / "fig3.yaml"))
    command = qepcad.command()
    assert isinstance(asked, qepcad.Question) and command is not None
    usage = qepcad.judged(run(command, text=asked.text(task), timeout=60))
    assert usage.outcome is Outcome.DONE, usage.message
