"""Programs besides ptmcad: msolve and Singular make the critical curve, gcad and QEPCAD cells.

Guarantee: an answer is what a run said that came to the end of its script without an error. It is
compared exactly with ptmcad's map: curves as sets of irreducible polynomials, and cells by locating
each sample of QEPCAD's in the map; gcad gives no samples, so only the number of its cells is
compared. msolve and Singular are given the system that ``ptmcad variety --format msolve`` writes;
QEPCAD and gcad the finished curves, with the map's base axis first.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from ptmcad.algebra import msolve
from ptmcad.algebra.polynomials import common_factor, from_terms, irreducible_factors, to_plane
from ptmcad.answer.regionmap import Kind, RegionMap
from ptmcad.exact.eliminationsystem import elimination_system, slice_variety
from ptmcad.exact.stages import problem_of
from ptmcad.question.slice import Slice
from ptmcad.studies.bench.harness import Asked, Case, Job, Row
from ptmcad.studies.bench.process import Usage
from ptmcad.studies.texts import texts_beside
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.text.plane import PlanePolynomial

Verdict = tuple[bool, str]
"""Whether an answer is the map's, and what it is in words."""
END = "-- the script was read to its end --"
QUIT = "Quitting the QEPCAD system"
TEXTS = texts_beside(__file__, "programs.yaml")
_ERROR = re.compile(r"^\s*\? .*$|^.*(?:\bError\b|Failure|Reason for|expected!).*$", re.MULTILINE)
_CELL = re.compile(
    r"Information about the cell \(\d+,\d+\) -+$(.*?)^-{50,}$", re.MULTILINE | re.DOTALL
)
_TRUE = re.compile(r"^Truth value\s*: T", re.MULTILINE)
_COORDINATE = re.compile(r"^Coordinate [12] = (-?\d+(?:/\d+)?)$", re.MULTILINE)


# ---------------------------------------------------------------------------- the critical curve by elimination


def elimination(slice: Slice, has_map: bool) -> tuple[list[str], list[str]]:
    """The system from which the unknowns have to be eliminated; the variety's own where that is
    within reach.

    Returns
    -------
    The names of the variables, the axes u0 and u1 being the last two, and the polynomials.
    """
    if has_map:
        system = slice_variety(slice).system
    else:
        system = elimination_system(problem_of(slice).on, slice.axis_names, False)
    names = [*(f"v{n}" for n in range(len(system.unknowns))), "u0", "u1"]
    return names, [text.replace(" ", "") for text in system.texts(tuple(names))]


def for_singular(case: Case) -> Row:
    """Names and polynomials of the system, and what is eliminated."""
    names, polynomials = elimination(case.slice, case.exact is not None)
    return {
        "names": ",".join(names),
        "ideal": ",".join(polynomials),
        "unknowns": "*".join(names[:-2]),
    }


def by_singular(result: RegionMap, said: str) -> Verdict:
    """Whether the curves are the map's."""
    return same_curves(result, curves(said.partition(END)[0].split(), factors=True))


def start_msolve(case: Case) -> Asked:
    """A Groebner basis of the elimination ideal."""
    program = msolve.program()
    if program is None:
        return "msolve is not installed"
    names, polynomials = elimination(case.slice, case.exact is not None)
    system, target = case.folder / "system.ms", case.folder / "msolve"
    system.write_text(f"{','.join(names)}\n0\n" + ",\n".join(polynomials) + "\n", encoding="ascii")
    command = [program, "-e", str(len(names) - 2), "-g", "2", "-f", str(system), "-o", str(target)]
    return {"command": command, "answer": target}


def by_msolve(result: RegionMap, said: str) -> Verdict:
    """Whether the curves are the map's."""
    lines = "".join(line for line in said.splitlines() if not line.startswith("#"))
    return same_curves(result, curves(lines.strip("[]: \n").split(",")))


def curves(polynomials: Sequence[str], *, factors: bool = False) -> set[PlanePolynomial]:
    """The irreducible curves on which all the polynomials in u0 and u1 vanish, or any if they are
    factors of one.

    Raises
    ------
    ValueError
        When one is no such polynomial.
    """
    try:
        basis = msolve.parsed_basis(f"[{','.join(polynomials)}]:", 2)
    except msolve.MsolveError as error:
        raise ValueError(str(error)) from None
    read = [from_terms((i, j, to_fraction(c)) for (i, j), c in terms.items())[0] for terms in basis]
    groups = read if factors else [common_factor(read)]
    return {to_plane(factor) for p in groups for factor in irreducible_factors(p)}


def same_curves(result: RegionMap, found: set[PlanePolynomial]) -> Verdict:
    """Whether the critical curves are there, and besides them only curves that the map has, too."""
    critical = {c.polynomial for c in result.components if c.kind is Kind.CRITICAL}
    missing, foreign = critical - found, found - {c.polynomial for c in result.components}
    words = f"{len(critical - missing)} of {len(critical)} critical curves, {len(found - critical)} others"
    return not (missing or foreign), words


# ------------------------------------------------------------------------------------------------- cells of the curves


def for_gcad(case: Case) -> Row:
    """The product of the map's curves, the window, and the step that puts the map's base axis
    first.
    """
    assert case.exact is not None
    curves = [c.polynomial.text(("x", "y")) for c in case.exact.components if not c.left_out]
    product = "*".join(f"({curve.replace('^', '**')})" for curve in curves) or "1"
    window = [(str(a.low), str(a.high)) for a in case.slice.axes]
    return {"product": product, "window": window, "step": 1 - 2 * case.exact.base}


def by_gcad(result: RegionMap, said: str) -> Verdict:
    """The number of cells, which may be another."""
    return True, f"{json.loads(said)['cells']} cells, the map has {len(result.cells)}"


def for_qepcad(case: Case) -> Row:
    """The problem that ``ptmcad variety --format qepcad`` writes, with the map's base axis first."""
    assert case.exact is not None
    problem = slice_variety(case.slice).text("qepcad").rstrip()
    if case.exact.base == 1:
        order = f"({', '.join(case.slice.axis_names[::-1])})"
        problem = re.sub(r"^\(.*\)$", order, problem, count=1, flags=re.MULTILINE)
    return {"problems": problem}


def by_qepcad(result: RegionMap, said: str) -> Verdict:
    """Whether each of the map's cells has the sample of an open cell at least, and each sample lies
    in a cell.

    Raises
    ------
    ValueError
        When there are no cells, or one has no rational sample.
    """
    samples = [_COORDINATE.findall(cell) for cell in _CELL.findall(said) if _TRUE.search(cell)]
    if not samples or any(len(sample) != 2 for sample in samples):
        raise ValueError("no cells, or one without a rational sample")
    names = result.slice.axis_names
    order = names if result.base == 0 else names[::-1]
    seen = {result.locate(dict(zip(order, sample, strict=True))).cell for sample in samples}
    words = f"{len(samples)} cells, in {len(seen - {None})} of the map's {len(result.cells)}"
    return None not in seen and len(seen) == len(result.cells), words


# --------------------------------------------------------------------------------------------------------- all of them


SESSIONS: Mapping[str, tuple[Sequence[str], str, Callable[[Case], Row]]] = {
    "singular": (("Singular", "--quiet", "--no-rc"), END, for_singular),
    "qepcad": (
        ("qepcad", "-noecho", "+N20000000"),
        QUIT,
        for_qepcad,
    ),  # so many garbage collected cells
    "gcad": ((sys.executable, "-"), "}", for_gcad),
}
"""Programs that read a script from standard input: the command, what it says at the end, and what
is in the script.
"""
COMPARED = {"singular": by_singular, "msolve": by_msolve, "qepcad": by_qepcad, "gcad": by_gcad}


def start(program: str, case: Case, _: str) -> Asked:
    """The job of a program; what is asked is in `TEXTS`, but for msolve, which has files."""
    if program == "msolve":
        return start_msolve(case)
    command, end, words = SESSIONS[program]
    if case.exact is None and program != "singular":
        return "there are no finished curves"
    if shutil.which(command[0]) is None:
        return f"{command[0]} is not installed"
    return {
        "command": command,
        "text": TEXTS["scripts"][program].format(**words(case)),
        "check": partial(incomplete, end),
    }


def incomplete(end: str, usage: Usage) -> str:
    """What is wrong with a session, which exits with status 0 after most errors; empty when nothing
    is.
    """
    wrong = _ERROR.search(usage.output)
    if wrong is not None:
        return " ".join(wrong[0].split())[:100]
    return "" if end in usage.output else "stopped within its script"


def read(case: Case, job: Job) -> Row:
    """How an answer without counts compares with the map, with "DIFFERS" where it is another or cannot
    be read.
    """
    if case.exact is None:
        return {}
    try:
        same, words = COMPARED[job.what](case.exact, job.said())
    except ValueError as error:
        same, words = False, f"cannot be read: {error}"
    return {"note": f"no counts; {words if same else f'DIFFERS: {words}'}"}
