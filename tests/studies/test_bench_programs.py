"""Programs beside ptmcad: they get the right question, and what they answer or do not answer is
told as that.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import pytest
from support.maps import CONFIGS, shipped
from support.programs import needs_qepcad
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.studies.bench import programs, study
from ptmcad.studies.bench.harness import Case, Job
from ptmcad.studies.bench.process import Usage
from ptmcad.studies.bench.study import RIVALS, jobs


def told(output: str) -> Usage:
    return Usage(1.0, 0.5, 30.0, output)


def cubic() -> RegionMap:
    return ptmcad.classify(CONFIGS / "systems" / "cubic.yaml")


def case(folder: Path, exact: RegionMap | None, name: str = "systems/cubic") -> Case:
    record = CONFIGS / f"{name}.yaml"
    return Case(ptmcad.load(record), record, exact, None, folder, True)


def terms_of(polynomial: str) -> set[tuple[str, ...]]:
    """The terms, whatever their order and that of their factors."""
    return {
        tuple(sorted(term.split("*")))
        for term in re.findall(r"[+-]?[^+-]+", "+" * (polynomial[0] != "-") + polynomial)
    }


def test_the_question_about_a_slice() -> None:
    """The system that ``ptmcad variety --format msolve`` writes, with other names for its
    variables.
    """
    slice = ptmcad.load(CONFIGS / "systems" / "cubic.yaml")
    assert programs.elimination(slice, True) == (["v0", "u0", "u1"], ["v0^3-v0*u0+u1", "3*v0^2-u0"])
    kuramoto = ptmcad.load(CONFIGS / "systems" / "kuramoto.yaml")
    names, polynomials = programs.elimination(kuramoto, False)
    given, _, *lines = ptmcad.slice_variety(kuramoto).text("msolve").splitlines()
    renamed = dict(zip(given.split(","), names, strict=True))
    expected = [
        re.sub(r"[^\W\d]\w*", lambda name: renamed[name[0]], line.rstrip(",")) for line in lines
    ]
    assert [terms_of(p) for p in polynomials] == [terms_of(p) for p in expected]


@needs_qepcad
@pytest.mark.parametrize("base", [0, 1])
def test_qepcad_gets_the_axis_first_over_which_the_maps_stacks_stand(
    base: int, tmp_path: Path
) -> None:
    found = jobs("qepcad", case(tmp_path, replace(cubic(), base=base)))
    assert not isinstance(found, str)
    (job,) = found
    assert job.text.splitlines()[1] == ("(a, b)" if base == 0 else "(b, a)")


def test_what_cannot_be_asked_has_its_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(programs.shutil, "which", lambda name: None)
    monkeypatch.setattr(programs.msolve, "program", lambda: None)
    monkeypatch.setattr(study, "find_spec", lambda name: None)
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


def test_without_a_map_there_are_no_curves_to_decompose(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study, "find_spec", lambda name: True)
    assert jobs("gcad", case(tmp_path, None)) == "there are no finished curves"
    assert jobs("qepcad", case(tmp_path, None)) == "there are no finished curves"


def test_gcad_is_a_process_with_a_script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its licence is another: no module of the package imports it."""
    monkeypatch.setattr(study, "find_spec", lambda name: True)
    found = jobs("gcad", case(tmp_path, cubic()))
    assert not isinstance(found, str)
    compile(found[0].text, "script", "exec")
    assert "import gcad" in found[0].text
    for path in Path(programs.__file__).parents[2].rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert path.name == "programs.py" or "import gcad" not in text


SINGULAR = "4*u0^3-27*u1^2\nu0+1\n-- the script was read to its end --\n"
MSOLVE = """#Reduced Groebner basis data
#---
#length of basis:      1 element
#---
[4*u0^3-27*u1^2]:
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
    job = Job("cubic", program, "", [], usages=[told(answer)])
    said: str = programs.read(case(folder, cubic()), job)["note"]
    return said.removeprefix("no counts; ")


def test_recorded_answers_are_compared(tmp_path: Path) -> None:
    for program, answer in (("singular", SINGULAR.replace("u0+1\n", "")), ("msolve", MSOLVE)):
        assert agreement(program, answer, tmp_path) == "1 of 1 critical curves, 0 others"
    assert agreement("singular", SINGULAR, tmp_path) == "DIFFERS: 1 of 1 critical curves, 1 others"
    assert agreement("msolve", "[4*u1^3-27*u0^2]:", tmp_path).startswith("DIFFERS: 0 of 1")
    assert agreement("msolve", "[4a3-27b2]:", tmp_path).startswith("DIFFERS: cannot be read")
    assert agreement("gcad", '{"cells": 5}', tmp_path) == "5 cells, the map has 4"
    assert agreement("qepcad", QEPCAD, tmp_path).startswith("DIFFERS: 1 cells, in 1 of the map's 4")
    assert agreement("qepcad", QEPCAD.replace(": T", ": F"), tmp_path).startswith(
        "DIFFERS: cannot be read"
    )
    irrational = QEPCAD.replace(
        "Coordinate 2 = 1/2", "Coordinate 2 = the unique root of x^2 - 2 between 1 and 2"
    )
    assert agreement("qepcad", irrational, tmp_path).startswith("DIFFERS: cannot be read")


@pytest.mark.parametrize(
    ("end", "output"),
    [
        (programs.END, "   ? error occurred in or before STDIN line 3: `x`\n" + SINGULAR),
        (programs.END, SINGULAR[:20]),
        (programs.END, ""),
        (programs.QUIT, QEPCAD[: QEPCAD.index("Quitting")]),
        (
            programs.QUIT,
            QEPCAD + "Failure occurred in: GCSI\nReason for the failure: too few cells",
        ),
    ],
)
def test_a_session_without_an_answer(end: str, output: str) -> None:
    assert programs.incomplete(end, told(output))


def test_a_session_with_an_answer() -> None:
    assert (
        programs.incomplete(programs.END, told(SINGULAR))
        == programs.incomplete(programs.QUIT, told(QEPCAD))
        == ""
    )


def test_singular_gets_the_system_in_names_of_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A variable may be called as something else is in Singular, as the axis r of orthogonal-3r."""
    monkeypatch.setattr(programs.shutil, "which", lambda name: name)
    found = jobs("singular", case(tmp_path, cubic()))
    assert not isinstance(found, str)
    script = found[0].text
    assert "ring r = 0, (v0,u0,u1), dp;\n" in script
    assert "ideal i = v0^3-v0*u0+u1,3*v0^2-u0;\n" in script
    assert "eliminate(std(i), v0);" in script


def printed(samples: Sequence[tuple[Fraction, Fraction]]) -> str:
    """QEPCAD's words for open cells with these samples."""
    return "".join(
        f"---------- Information about the cell (1,{n}) ----------\n\nTruth value : T\n"
        f"Coordinate 1 = {x}\nCoordinate 2 = {y}\n{'-' * 52}\n"
        for n, (x, y) in enumerate(samples)
    )


@pytest.mark.parametrize("name", ["fig2", "fig4"])
def test_cells_are_compared_by_samples(name: str) -> None:
    result = shipped(name)
    samples = [(cell.sample[result.base], cell.sample[1 - result.base]) for cell in result.cells]
    number = len(samples)
    words = f"{number} cells, in {number} of the map's {number}"
    assert programs.by_qepcad(result, printed(samples)) == (True, words)
    assert programs.by_qepcad(result, printed([*samples, samples[0]]))[0]
    assert not programs.by_qepcad(result, printed(samples[1:]))[0]
    assert not programs.by_qepcad(result, printed([*samples, (Fraction(100), Fraction(100))]))[0]
