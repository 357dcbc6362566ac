"""Programs beside ptmcad: they get the right question, and what they answer or do not answer is told as that."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from support.maps import CONFIGS, shipped

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.studies.bench import methods, programs
from ptmcad.studies.bench.harness import Case, Job
from ptmcad.studies.bench.methods import RIVALS, jobs
from ptmcad.studies.bench.process import Outcome, Usage
from ptmcad.studies.bench.programs import Elimination

CUBIC = Elimination("x,a,b\n0\n-x*a+x^3+b,\n3*x^2-a\n", ("x",), ("a", "b"))


def told(output: str) -> Usage:
    return Usage(Outcome.DONE, 1.0, 0.5, 30.0, output)


def cubic() -> RegionMap:
    return ptmcad.classify(CONFIGS / "systems" / "cubic.yaml")


def case(folder: Path, exact: RegionMap | None, name: str = "systems/cubic") -> Case:
    record = CONFIGS / f"{name}.yaml"
    return Case(ptmcad.load(record), record, exact, None, folder, True, 1)


def test_the_question_about_a_slice() -> None:
    slice = ptmcad.load(CONFIGS / "systems" / "cubic.yaml")
    asked = programs.elimination(slice, True)
    assert asked.text == ptmcad.slice_variety(slice).text("msolve")
    assert (asked.unknowns, asked.axes) == (("x",), ("a", "b"))
    kuramoto = ptmcad.load(CONFIGS / "systems" / "kuramoto.yaml")
    assert programs.elimination(kuramoto, False).text == ptmcad.slice_variety(kuramoto).text("msolve")


@pytest.mark.skipif(programs.qepcad_command() is None, reason="qepcad is not installed")
@pytest.mark.parametrize("base", [0, 1])
def test_qepcad_gets_the_axis_first_over_which_the_maps_stacks_stand(base: int, tmp_path: Path) -> None:
    found = jobs("qepcad", case(tmp_path, replace(cubic(), base=base)))
    assert not isinstance(found, str)
    (job,) = found
    assert job.text.splitlines()[1] == ("(a, b)" if base == 0 else "(b, a)")


def test_what_cannot_be_asked_has_its_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(programs.shutil, "which", lambda name: None)
    monkeypatch.setattr(programs.msolve, "program", lambda: None)
    monkeypatch.setattr(methods, "find_spec", lambda name: None)
    exact = cubic()
    reasons = {method: jobs(method, case(tmp_path, exact)) for method in RIVALS}
    assert reasons["singular"] == "Singular is not installed"
    assert reasons["msolve"] == "msolve is not installed"
    assert reasons["qepcad"] == "qepcad is not installed"
    assert str(reasons["gcad"]).startswith("gcad is not installed")
    assert reasons["companion"] == "the sextic is the paper's mechanism's, not that of cubic"
    assert len(reasons["exact"]) == 2
    free = case(tmp_path, None, "free02")
    assert jobs("exact", free) == "square roots: springs have a free length"


def test_without_a_map_there_are_no_curves_to_decompose(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(methods, "find_spec", lambda name: True)
    assert jobs("gcad", case(tmp_path, None)) == "there are no finished curves"
    assert jobs("qepcad", case(tmp_path, None)) == "there are no finished curves"


def test_gcad_is_a_process_with_a_script() -> None:
    """Its licence is another: no module of the package imports it."""
    script = programs.gcad_script(cubic())
    compile(script, "script", "exec")
    assert "import gcad" in script
    for path in Path(programs.__file__).parents[2].rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert path.name == "programs.py" or "import gcad" not in text


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


def agreement(program: str, answer: str, folder: Path) -> str:
    """What is said of an answer to the question about the cubic."""
    job = Job("cubic", program, programs.CELLS, [], usages=[told(answer)])
    said: str = RIVALS[program].read(case(folder, cubic()), job)["note"]
    return said.removeprefix("no counts; ")


def test_recorded_answers_are_compared(tmp_path: Path) -> None:
    for program, answer in (("singular", SINGULAR.replace("v1+1\n", "")), ("msolve", MSOLVE)):
        assert agreement(program, answer, tmp_path) == "1 of 1 critical curves, 0 others"
    assert agreement("singular", SINGULAR, tmp_path) == "DIFFERS: 1 of 1 critical curves, 1 others"
    assert agreement("msolve", "[4*b^3-27*a^2]:", tmp_path).startswith("DIFFERS: 0 of 1")
    assert agreement("msolve", "[4a3-27b2]:", tmp_path).startswith("DIFFERS: cannot be read")
    assert agreement("gcad", '{"cells": 5}', tmp_path) == "5 cells, the map has 4"
    assert programs.qepcad_samples(QEPCAD) == [(Fraction(-1), Fraction(1, 2))]
    assert agreement("qepcad", QEPCAD, tmp_path).startswith("DIFFERS: 1 cells, in 1 of the map's 4")
    assert agreement("qepcad", QEPCAD.replace(": T", ": F"), tmp_path).startswith("DIFFERS: cannot be read")
    irrational = QEPCAD.replace("Coordinate 2 = 1/2", "Coordinate 2 = the unique root of x^2 - 2 between 1 and 2")
    assert agreement("qepcad", irrational, tmp_path).startswith("DIFFERS: cannot be read")


@pytest.mark.parametrize(
    ("end", "output"),
    [
        (programs.END, "   ? error occurred in or before STDIN line 3: `x`\n" + SINGULAR),
        (programs.END, SINGULAR[:20]),
        (programs.END, ""),
        (programs.QUIT, QEPCAD[: QEPCAD.index("Quitting")]),
        (programs.QUIT, QEPCAD + "Failure occurred in: GCSI\nReason for the failure: too few cells"),
    ],
)
def test_a_session_without_an_answer(end: str, output: str) -> None:
    assert programs.incomplete(end, told(output))


def test_a_session_with_an_answer() -> None:
    assert programs.incomplete(programs.END, told(SINGULAR)) == programs.incomplete(programs.QUIT, told(QEPCAD)) == ""


def test_singular_gets_the_system_of_msolve_in_names_of_its_own() -> None:
    """A variable may be called as something else is in Singular, as the axis r of orthogonal-3r."""
    asked = Elimination("x,ring,b\n0\n-x*ring+x^3+b,\n3*x^2-ring\n", ("x",), ("ring", "b"))
    script = programs.singular_script(asked)
    assert "ring r = 0, (v0,v1,v2), dp;\n" in script
    assert "ideal i = -v0*v1+v0^3+v2,3*v0^2-v1;\n" in script
    assert "eliminate(std(i), v0);" in script


def test_curves_are_compared_as_sets_of_irreducible_ones() -> None:
    result = shipped("fig2")
    lines = [c.polynomial.text(("L2", "rho")).replace(" ", "") for c in result.components if c.kind.value == "critical"]
    product = programs.curves(lines, ("L2", "rho"), factors=True)
    assert programs.same_curves(result, product)[0]
    assert programs.curves(["2*L2^2-2*rho^2", "1/3*L2+1/3*rho"], ("L2", "rho")) == programs.curves(
        ["L2+rho"], ("L2", "rho"), factors=True
    )
    assert not programs.same_curves(result, set(list(product)[1:]))[0]
    other = programs.curves(["7*L2-3*rho"], ("L2", "rho"))
    assert programs.same_curves(result, product | other) == (False, "4 of 4 critical curves, 1 others")
    with pytest.raises(ValueError, match="not understood"):
        programs.curves(["L2+q"], ("L2", "rho"))


@pytest.mark.parametrize("name", ["fig2", "fig4"])
def test_cells_are_compared_by_samples(name: str) -> None:
    result = shipped(name)
    samples = [(cell.sample[result.base], cell.sample[1 - result.base]) for cell in result.cells]
    number = len(samples)
    words = f"{number} cells, in {number} of the map's {number}"
    assert programs.same_cells(result, samples) == (True, words)
    assert programs.same_cells(result, [*samples, samples[0]])[0]
    assert not programs.same_cells(result, samples[1:])[0]
    assert not programs.same_cells(result, [*samples, (Fraction(100), Fraction(100))])[0]
