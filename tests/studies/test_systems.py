"""Systems side by side: programs get the right question, and what they answer or do not answer is told as that."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from support.maps import CONFIGS, shipped

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.studies.bench.process import Outcome, Usage
from ptmcad.studies.bench.systems import agreement, programs, questions, table
from ptmcad.studies.bench.systems.__main__ import RECORDS, differs, main
from ptmcad.studies.bench.systems.exchange import Answers, Question
from ptmcad.studies.bench.systems.measuring import Job, attempt, jobs, read, shown
from ptmcad.studies.bench.systems.programs import AnswerError, Programs, Tool

STORED = CONFIGS.parent / "docs" / "benchmarks" / "systems.json"
NOTHING = Programs(msolve=None, singular=None, qepcad=None, gcad=False)
ALL = Programs("msolve", "Singular", ("qepcad",), True)
CUBIC = Question(
    name="cubic",
    axes=("a", "b"),
    facts={},
    system="x,a,b\n0\n-x*a+x^3+b,\n3*x^2-a\n",
    unknowns=1,
    points=(("1", "0"), ("-1", "0")),
    at_points=("x\n0\nx^3-x\n", "x\n0\nx^3+x\n"),
    qepcad="[ cubic ]\n",
    gcad="{}",
)


def told(output: str) -> Usage:
    return Usage(Outcome.DONE, 1.0, 0.5, 30.0, output)


# -------------------------------------------------------------------------------------------------------- the questions


def test_the_question_about_a_slice(tmp_path: Path) -> None:
    """At a = 1, b = 0 the cubic is x^3 - x; QEPCAD gets the axis first over which the map's stacks stand."""
    record, answer = CONFIGS / "systems" / "cubic.yaml", tmp_path / "cubic.json"
    result = ptmcad.classify(record)
    answer.write_text(result.to_json(), encoding="utf-8")
    asked = questions.question(record, answer, points=3)
    assert asked.system == ptmcad.slice_variety(ptmcad.load(record)).text("msolve")
    assert (asked.unknowns, asked.variables, len(asked.points)) == (1, ("a", "b"), 3)
    variety = ptmcad.slice_variety(ptmcad.load(record))
    assert questions.at_point(variety.system, (Fraction(1), Fraction(0)), ("x",)) == "x\n0\nx^3-x\n"
    assert questions.at_point(variety.system, (Fraction(1, 2), Fraction(2, 3)), ("x",)) == "x\n0\n6*x^3-3*x+4\n"
    answer.write_text(replace(result, base=1 - result.base).to_json(), encoding="utf-8")
    assert [questions.question(record, path, 1).qepcad.splitlines()[1] for path in (answer,)] == ["(b, a)"]
    assert asked.qepcad.splitlines()[1] == "(a, b)"


def test_without_a_map_nothing_is_known_of_the_curves() -> None:
    asked = questions.question(CONFIGS / "systems" / "kuramoto.yaml", None, points=4)
    assert (asked.qepcad, asked.gcad, asked.facts, len(set(asked.points))) == ("", "", {}, 4)
    assert asked.system == ptmcad.slice_variety(ptmcad.load(CONFIGS / "systems" / "kuramoto.yaml")).text("msolve")


# ------------------------------------------------------------------------------------------ programs that do not answer


def test_a_program_that_is_missing_is_told_as_that(tmp_path: Path) -> None:
    found = jobs(Path("cubic.yaml"), CUBIC, tmp_path / "cubic.json", tmp_path, NOTHING)
    assert {tool for tool, job in found.items() if job == "not installed"} == set(Tool) - {Tool.MAP, Tool.SOLVE}
    there = jobs(Path("cubic.yaml"), CUBIC, tmp_path / "cubic.json", tmp_path, ALL)
    assert all(isinstance(job, Job) for job in there.values())


def test_without_a_map_there_are_no_curves_to_decompose(tmp_path: Path) -> None:
    found = jobs(Path("cubic.yaml"), CUBIC, None, tmp_path, ALL)
    assert {tool for tool, job in found.items() if job == "cannot (no finished curves)"} == {Tool.QEPCAD, Tool.GCAD}


def test_a_program_that_fails_hangs_or_is_silent(tmp_path: Path) -> None:
    def python(code: str, tool: Tool = Tool.GCAD, *answers: Path, times: int = 1) -> Usage:
        return attempt(Job(tool, ((sys.executable, "-c", code),) * times, answers=answers), timeout=5.0)

    failed = python("import sys; sys.exit('no good')")
    assert shown([failed], 5.0) == "failed: no good"
    assert shown([python("pass", Tool.GCAD, tmp_path / "answer")], 5.0) == "failed: 1 of 1 answers missing"
    assert "stopped within its script" in str(shown([python("print('x')", Tool.SINGULAR)], 5.0))
    hanging = attempt(Job(Tool.MAP, ((sys.executable, "-c", "import time; time.sleep(60)"),)), timeout=0.3)
    assert shown([told(""), hanging], 0.3) == "not in 0.3 s"
    twice = python(f"open({str(tmp_path / 'answer')!r}, 'w').write('{{}}')", Tool.SOLVE, tmp_path / "answer", times=2)
    assert (twice.outcome, read(Job(Tool.SOLVE, (), answers=(tmp_path / "answer",)), twice)) == (Outcome.DONE, ("{}",))


def test_an_answer_of_an_earlier_round_does_not_count(tmp_path: Path) -> None:
    answer = tmp_path / "answer"
    answer.write_text('{"open": 3, "cells": 3}')
    usage = attempt(Job(Tool.GCAD, ((sys.executable, "-c", "pass"),), answers=(answer,)), timeout=5.0)
    assert usage.outcome is Outcome.FAILED


# ------------------------------------------------------------------------------------------------- answers, as recorded

SINGULAR = "4*v1^3-27*v2^2\nv1+1\n-- the script was read to its end --\n"
MSOLVE = """#Reduced Groebner basis data
#---
#length of basis:      1 element
#---
[4*a^3-27*b^2]:
"""
QEPCAD = """
---------- Information about the cell (1) ----------

Truth value                 : ?    by trial evaluation.
Coordinate 1 = -1
----------------------------------------------------
---------- Information about the cell (1,1) ----------

Truth value                 : *    by trial evaluation.
Coordinate 1 = -1
Coordinate 2 = -3
             = -3.0000000000

----------------------------------------------------
---------- Information about the cell (1,3) ----------

Truth value                 : T    by trial evaluation.
The sample point is in a PRIMITIVE representation.

Coordinate 1 = -1
             = -1.0000000000
Coordinate 2 = 1/2
             = 0.5000000000

----------------------------------------------------

Before Solution >
Quitting the QEPCAD system... Bye!
"""


def test_recorded_answers_are_read() -> None:
    assert programs.singular_curves(told(SINGULAR)) == ["4*v1^3-27*v2^2", "v1+1"]
    assert programs.msolve_curves(MSOLVE) == ["4*a^3-27*b^2"]
    assert programs.qepcad_samples(told(QEPCAD)) == [("-1", "1/2")]
    assert agreement.real_solutions("[0, [1,\n[[[-6 / 2^3, -5 / 2^3]], [[0, 0]]]\n]]:\n", "x\n0\nx^2+x\n") == 2
    assert agreement.real_solutions("[-1]:\n", "x\n0\nx^2+1\n") == 0


@pytest.mark.parametrize(
    "output",
    ["   ? error occurred in or before STDIN line 3: `x`\n" + SINGULAR, SINGULAR[:20], ""],
)
def test_singular_without_an_answer(output: str) -> None:
    with pytest.raises(AnswerError):
        programs.singular_curves(told(output))


@pytest.mark.parametrize(
    "output",
    [
        QEPCAD[: QEPCAD.index("Quitting")],
        QEPCAD.replace("Before Solution", "Failure occurred in: GCSI\nReason for the failure: too few cells"),
        QEPCAD.replace(": T", ": F"),
        QEPCAD.replace("Coordinate 2 = 1/2", "Coordinate 2 = the unique root of x^2 - 2 between 1 and 2"),
    ],
)
def test_qepcad_without_an_answer(output: str) -> None:
    with pytest.raises(AnswerError):
        programs.qepcad_samples(told(output))


@pytest.mark.parametrize("answer", ["", "[4*a^3-27*b^2", "[1, 2, -1, []]:"])
def test_msolve_without_an_answer(answer: str) -> None:
    with pytest.raises(AnswerError):
        programs.msolve_curves(answer)
    with pytest.raises(AnswerError):
        agreement.real_solutions(answer, "x,y\n0\nx*y-y\n")


def test_singular_gets_the_system_of_msolve_in_names_of_its_own() -> None:
    """A variable may be called as something else is in Singular, as the axis r of orthogonal-3r."""
    script = programs.singular_script("x,ring,b\n0\n-x*ring+x^3+b,\n3*x^2-ring\n", 1)
    assert "ring r = 0, (v0,v1,v2), dp;\n" in script
    assert "ideal i = -v0*v1+v0^3+v2,3*v0^2-v1;\n" in script
    assert "eliminate(std(i), v0);" in script


def test_singular_answers_in_these_names(tmp_path: Path) -> None:
    answer = tmp_path / "cubic.json"
    answer.write_text(ptmcad.classify(CONFIGS / "systems" / "cubic.yaml").to_json(), encoding="utf-8")
    found = agreement.checks(CUBIC, answer, Answers(singular=["4*v1^3-27*v2^2"]))
    assert found == {Tool.SINGULAR.value: (True, "the critical curve")}
    assert agreement.checks(CUBIC, answer, Answers(singular=["4*v2^3-27*v1^2"]))[Tool.SINGULAR.value].agrees is False


# ------------------------------------------------------------------------------------------------------ the comparisons


def in_order(result: RegionMap) -> list[tuple[str, str]]:
    base = result.base
    return [(str(cell.sample[base]), str(cell.sample[1 - base])) for cell in result.cells]


def test_curves_are_compared_as_sets_of_irreducible_ones() -> None:
    result = shipped("fig2")
    lines = [c.polynomial.text(("L2", "rho")).replace(" ", "") for c in result.components if c.kind.value == "critical"]
    product = agreement.curves(lines, ("L2", "rho"), factors=True)
    assert agreement.same_curves(result, product).agrees
    assert agreement.curves(["2*L2^2-2*rho^2", "1/3*L2+1/3*rho"], ("L2", "rho")) == agreement.curves(
        ["L2+rho"], ("L2", "rho"), factors=True
    )
    assert agreement.same_curves(result, set(list(product)[1:])).agrees is False
    other = agreement.curves(["7*L2-3*rho"], ("L2", "rho"))
    assert agreement.same_curves(result, product | other).found == "0 of 4 curves missing, 1 others"
    with pytest.raises(AnswerError):
        agreement.curves(["L2+q"], ("L2", "rho"))


@pytest.mark.parametrize("name", ["fig2", "fig4"])
def test_cells_are_compared_by_samples(name: str) -> None:
    result = shipped(name)
    samples = in_order(result)
    assert agreement.same_cells(result, samples).found == f"the same {len(samples)} cells"
    assert agreement.same_cells(result, [*samples, samples[0]]).found.endswith(f"refine the map's {len(samples)}")
    assert agreement.same_cells(result, samples[1:]).agrees is False
    assert agreement.same_cells(result, [*samples, ("100", "100")]).agrees is False


def answers(counts: Iterable[int]) -> tuple[str, ...]:
    return tuple(json.dumps({"equilibria": [{}] * n}) for n in counts)


def boxes(counts: Iterable[int]) -> tuple[str, ...]:
    return tuple(f"[0, [1, [{', '.join(['[[0, 0]]'] * n)}]]]:" if n else "[-1]:" for n in counts)


def test_numbers_of_solutions_are_compared(tmp_path: Path) -> None:
    answer = tmp_path / "cubic.json"
    answer.write_text(ptmcad.classify(CONFIGS / "systems" / "cubic.yaml").to_json(), encoding="utf-8")
    right = agreement.checks(CUBIC, answer, Answers(solve=answers([3, 1]), points=boxes([3, 1]), gcad=4))
    assert {name: check.agrees for name, check in right.items()} == {
        Tool.SOLVE.value: True,
        Tool.POINTS.value: True,
        Tool.GCAD.value: True,
    }
    wrong = agreement.checks(CUBIC, answer, Answers(solve=answers([3, 1]), points=boxes([1, 1]), gcad=5))
    assert wrong[Tool.POINTS.value] == (False, "1 of 2 counts of the map")
    assert wrong[Tool.GCAD.value] == (None, "5 cells, the map has 4")


def test_without_a_map_the_points_are_compared_with_each_other() -> None:
    found = agreement.checks(CUBIC, None, Answers(solve=answers([3, 1]), points=boxes([3, 0]), curve=MSOLVE))
    assert found == {Tool.POINTS.value: (False, "1 of 2 counts of the points of ptmcad")}
    assert agreement.checks(CUBIC, None, Answers(points=boxes([3, 0]))) == {}


def test_an_answer_that_cannot_be_read_does_not_agree(tmp_path: Path) -> None:
    answer = tmp_path / "cubic.json"
    answer.write_text(ptmcad.classify(CONFIGS / "systems" / "cubic.yaml").to_json(), encoding="utf-8")
    found = agreement.checks(CUBIC, answer, Answers(singular=["4v13-27v22"]))
    assert found[Tool.SINGULAR.value].agrees is False


# ------------------------------------------------------------------------------------------------------------- the page


def test_the_stored_page_is_made_of_the_stored_record() -> None:
    page = STORED.with_suffix(".md").read_text(encoding="utf-8")
    assert table.to_markdown(json.loads(STORED.read_text(encoding="utf-8"))) == page


def test_the_stored_record_is_of_the_twelve_systems_and_all_agree() -> None:
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    assert [row["name"] for row in stored["rows"]] == [Path(name).name for name in RECORDS]
    assert len(RECORDS) == 12
    assert not differs(stored)


def test_what_is_missing_late_or_different_is_told_on_the_page() -> None:
    found = json.loads(STORED.read_text(encoding="utf-8"))
    row = found["rows"][0]
    row["tools"][Tool.SINGULAR.value] = "not installed"
    row["tools"][Tool.QEPCAD.value] = "not in 60 s"
    row["agreement"] = {Tool.CURVE.value: {"agrees": False, "found": "1 of 4 curves missing, 0 others"}}
    figures = {"median": 4.0, "processor": 0.5, "peak": found["floor"], "points": 20}
    row["tools"][Tool.POINTS.value] = figures
    row["tools"][Tool.CURVE.value] = {**figures, "points": 1, "peak": 1000.2}
    times, peaks, compared = (line for line in table.to_markdown(found).splitlines() if line.startswith("| fig2 |"))
    assert "| not installed | not in 60 s |" in times
    assert times.endswith("| 0.20 (0.025) | no |")
    assert "| 4.00 (0.50) |" in times
    assert "| 1000 | not installed | not in 60 s |" in peaks
    assert peaks.endswith(f"under {found['floor'] + 1:.0f} |")
    assert "| **differs**: 1 of 4 curves missing, 0 others | - | - |" in compared
    assert differs(found)


@pytest.mark.parametrize(
    "arguments", [["--timeout", "0"], ["--points", "0"], ["--rounds", "0"]], ids=lambda arguments: arguments[0]
)
def test_options_that_mean_nothing(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    assert arguments[0] in capsys.readouterr().err


@pytest.mark.slow
def test_a_whole_study(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With whatever is installed: everything that can be compared agrees."""
    record = CONFIGS / "systems" / "cubic.yaml"
    assert main([str(record), "--rounds", "1", "--points", "2", "--out", str(tmp_path)]) == 0
    found = json.loads((tmp_path / "systems.json").read_text(encoding="utf-8"))
    assert (tmp_path / "systems.md").read_text(encoding="utf-8") == table.to_markdown(found)
    (row,) = found["rows"]
    assert row["tools"][Tool.MAP.value]["runs"] == 1
    assert row["agreement"][Tool.SOLVE.value]["agrees"]
    assert main([str(record), str(record)]) == 2
    assert "two slices are called cubic" in capsys.readouterr().err
    assert main([str(tmp_path / "nothing.yaml")]) == 2
