"""Programs beside ptmcad: msolve and Singular make the critical curve, gcad and QEPCAD cells; QEPCAD counts, too.

Guarantee: an answer is what a run said that came to the end of its script without an error. It is compared exactly with
ptmcad's map: curves as sets of irreducible polynomials, and cells by locating each sample of QEPCAD's in the map; gcad
gives no samples, so only the number of its cells is compared. msolve and Singular are given the system that
``ptmcad variety --format msolve`` writes; QEPCAD and gcad the finished curves, with the map's base axis first.

QEPCAD counts as an expert would let it, one quantifier elimination for each count, on a sextic made by hand. Where
`question` returns a `Question`, the sextic's real roots t2 = tan(theta2/2) are, over all parameters outside a set of
measure zero, in one-to-one correspondence with the equilibria of the slice. On that set QEPCAD is allowed to be wrong
(it is two to five times faster so); and an equilibrium at theta2 = pi has no t2. The elimination is that of
`ptmcad.studies.sextic`, with roots t of p = N. Up to positive factors H11 is V W and, where that is positive, the
second derivative of the energy along the curve E1 = 0 is -V p'(t). So a root is a stable equilibrium exactly if V W > 0
and V p' < 0.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from collections.abc import Callable, Sequence
from enum import Enum
from fractions import Fraction
from typing import NamedTuple

from ptmcad.algebra import msolve
from ptmcad.algebra.polynomials import common_factor, from_terms, irreducible_factors, to_plane
from ptmcad.answer.regionmap import Kind, RegionMap
from ptmcad.exact.models.elimination import elimination_system
from ptmcad.exact.slicevariety import slice_variety
from ptmcad.exact.stages import domain_limits, problem_of
from ptmcad.question.slice import Axis, Slice
from ptmcad.studies.bench.error import figures
from ptmcad.studies.bench.harness import Case, Job, Make, Row
from ptmcad.studies.bench.process import Usage
from ptmcad.studies.sextic import sextic
from ptmcad.text.expressions import Expression
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.text.plane import PlanePolynomial
from ptmcad.text.terms import signed_terms

CELLS = "cells of the curves"
NO_CURVES = "there are no finished curves"
LOSES_PI = "an equilibrium at theta2 = pi over the whole window: t2 = tan(theta2/2) loses it"
FORMULA = "an exact formula by its own claim, up to a set of measure zero; the sextic was given"
END = "-- the script was read to its end --"
QUIT = "Quitting the QEPCAD system"
_QEPCAD_END = "\nquit\n[ 0 = 0 ].\nquit\nquit\n"
"""What comes after the first quit is read only by a session that has not understood its formula, and would ask again
for ever."""
_GARBAGE_COLLECTED_CELLS = 20_000_000
_FORMULA = re.compile(r"An equivalent quantifier-free formula:\s*(.*?)\n\s*\n", re.DOTALL)
_ERROR = re.compile(r"^\s*\? .*$|^.*(?:\bError\b|Failure|Reason for|expected!).*$", re.MULTILINE)
_CELL = re.compile(r"Information about the cell \(\d+,\d+\) -+$(.*?)^-{50,}$", re.MULTILINE | re.DOTALL)
_TRUE = re.compile(r"^Truth value\s*: T", re.MULTILINE)
_COORDINATE = re.compile(r"^Coordinate [12] = (-?\d+(?:/\d+)?)$", re.MULTILINE)
_SINGULAR_SCRIPT = """ring r = 0, ({names}), dp;
short = 0;
ideal i = {ideal};
ideal e = eliminate(std(i), {unknowns});
poly common = 0;
for (int n = 1; n <= size(e); n++) {{ common = gcd(common, e[n]); }}
list factors = factorize(common);
for (n = 1; n <= size(factors[1]); n++) {{ if (deg(factors[1][n]) > 0) {{ print(string(factors[1][n])); }} }}
print("{end}");
quit;
"""
_GCAD_SCRIPT = """
import json, time
import gcad, sympy
start = time.perf_counter()
x, y = sympy.symbols("x y")
product = sympy.sympify({product!r}, locals={{"x": x, "y": y}})
window = []
for s, (low, high) in zip((x, y), {window!r}):
    window += [s - sympy.Rational(low) > 0, sympy.Rational(high) - s > 0]
order = [x, y][::{step}]
sides = [gcad.GCAD([*window, side], order) for side in (product > 0, product < 0)]
print(json.dumps({{"cells": sum(map(len, sides)), "computing": time.perf_counter() - start}}))
"""
"""For an interpreter of its own: the package has another licence, and is no part of this one."""


# ---------------------------------------------------------------------------- the critical curve by elimination


def elimination(slice: Slice, has_map: bool) -> tuple[list[str], list[str]]:
    """The system from which the unknowns have to be eliminated; the variety's own where that is within reach.

    Returns
    -------
    The names of the variables, the axes u0 and u1 being the last two, and the polynomials.
    """
    if has_map:
        system = slice_variety(slice).system
    else:
        problem = problem_of(slice)
        limits = domain_limits(problem.system, problem.parameters)
        system = elimination_system(problem.system, problem.parameters, slice.axis_names, limits, False)
    names = [*(f"v{n}" for n in range(len(system.unknowns))), "u0", "u1"]
    return names, [text.replace(" ", "") for text in system.texts(tuple(names))]


def start_singular(case: Case, _: str, make: Make) -> Job | str:
    """The factors of the elimination ideal's common divisor, one on a line.

    A basis in the cheap order comes first: it saves most of the time.
    """
    if shutil.which("Singular") is None:
        return "Singular is not installed"
    names, polynomials = elimination(case.slice, case.exact is not None)
    script = _SINGULAR_SCRIPT.format(
        names=",".join(names), ideal=",".join(polynomials), unknowns="*".join(names[:-2]), end=END
    )
    return make(["Singular", "--quiet", "--no-rc"], script, check=lambda usage: incomplete(END, usage))


def by_singular(result: RegionMap, said: str) -> tuple[bool, str]:
    """Whether the curves are the map's."""
    return same_curves(result, curves(said.partition(END)[0].split(), factors=True))


def start_msolve(case: Case, _: str, make: Make) -> Job | str:
    """A Groebner basis of the elimination ideal."""
    program = msolve.program()
    if program is None:
        return "msolve is not installed"
    names, polynomials = elimination(case.slice, case.exact is not None)
    system, target = case.folder / "system.ms", case.folder / "msolve"
    system.write_text(f"{','.join(names)}\n0\n" + ",\n".join(polynomials) + "\n", encoding="ascii")
    command = [program, "-e", str(len(names) - 2), "-g", "2", "-f", str(system), "-o", str(target)]
    return make(command, answer=target)


def by_msolve(result: RegionMap, said: str) -> tuple[bool, str]:
    """Whether the curves are the map's."""
    lines = "".join(line for line in said.splitlines() if not line.startswith("#"))
    return same_curves(result, curves(lines.strip("[]: \n").split(",")))


def beside(compared: Callable[[RegionMap, str], tuple[bool, str]], case: Case, job: Job) -> Row:
    """What an answer without counts is beside the map, with "DIFFERS" where it is another or cannot be read."""
    if case.exact is None:
        return {}
    try:
        same, words = compared(case.exact, job.said())
    except ValueError as error:
        same, words = False, f"cannot be read: {error}"
    return {"note": f"no counts; {words if same else f'DIFFERS: {words}'}"}


def curves(polynomials: Sequence[str], *, factors: bool = False) -> set[PlanePolynomial]:
    """The irreducible curves on which all the polynomials in u0 and u1 vanish, or any if they are factors of one.

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


def same_curves(result: RegionMap, found: set[PlanePolynomial]) -> tuple[bool, str]:
    """Whether the critical curves are there, and besides them only curves that the map has, too."""
    critical = {c.polynomial for c in result.components if c.kind is Kind.CRITICAL}
    missing, foreign = critical - found, found - {c.polynomial for c in result.components}
    words = f"{len(critical - missing)} of {len(critical)} critical curves, {len(found - critical)} others"
    return not (missing or foreign), words


# ------------------------------------------------------------------------------------------------- cells of the curves


def start_gcad(case: Case, _: str, make: Make) -> Job | str:
    """The number of open cells that gcad makes of the map's curves, in an interpreter of its own.

    gcad takes inequalities, so the product of the curves is asked to be positive, and then negative.
    """
    if case.exact is None:
        return NO_CURVES
    curves = [c.polynomial.text(("x", "y")) for c in case.exact.components if not c.left_out]
    product = "*".join(f"({curve.replace('^', '**')})" for curve in curves) or "1"
    window = [(str(a.low), str(a.high)) for a in case.slice.axes]
    script = _GCAD_SCRIPT.format(product=product, window=window, step=1 - 2 * case.exact.base)
    return make([sys.executable, "-"], script)


def by_gcad(result: RegionMap, said: str) -> tuple[bool, str]:
    """The number of cells, which may be another."""
    return True, f"{json.loads(said)['cells']} cells, the map has {len(result.cells)}"


def start_qepcad(case: Case, setting: str, make: Make) -> Job | str:
    """Cells of the curves, or formulas for where there are so many equilibria, with the map's base axis first."""
    if setting == CELLS and case.exact is None:
        return NO_CURVES
    command = qepcad_command()
    if command is None:
        return "qepcad is not installed"
    swapped = case.exact is not None and case.exact.base == 1
    if setting == CELLS:
        order = f"({', '.join(case.slice.axis_names[::-1])})"
        problem = slice_variety(case.slice).text("qepcad")
        problem = re.sub(r"^\(.*\)$", order, problem, count=1, flags=re.MULTILINE) if swapped else problem
        return make(command, qepcad_session([problem]), check=lambda usage: incomplete(QUIT, usage))
    asked = question(case.slice)
    if isinstance(asked, str):
        return asked
    problems = [
        asked.problem(task, swapped=swapped) for task in Task if (task is Task.TWO_STABLE) == ("stable" in setting)
    ]
    return make(
        command,
        qepcad_session(problems),
        check=lambda usage: "" if len(formulas(usage.output)) == len(problems) else "no answer",
    )


def read_qepcad(case: Case, job: Job) -> Row:
    """What is known of either answer."""
    if job.setting == CELLS:
        return beside(by_qepcad, case, job)
    count = "stable" if "stable" in job.setting else "total"
    return {"figures": {count: figures((0.0, 0.0), 0.0)}, "note": FORMULA}


def qepcad_command() -> tuple[str, ...] | None:
    """The command that reads a session from standard input, None when QEPCAD is not installed."""
    where = shutil.which("qepcad")
    return (where, "-noecho", f"+N{_GARBAGE_COLLECTED_CELLS}") if where is not None else None


def qepcad_session(problems: Sequence[str]) -> str:
    """QEPCAD's standard input for several problems, each without a final ``quit``."""
    return "\ncontinue\n".join(problem.rstrip() for problem in problems) + _QEPCAD_END


def formulas(output: str) -> list[str]:
    """The quantifier-free formulas that QEPCAD wrote; after most errors it writes none and exits with 0."""
    return [" ".join(found.split()) for found in _FORMULA.findall(output)]


def incomplete(end: str, usage: Usage) -> str:
    """What is wrong with a session, which exits with status 0 after most errors; empty when nothing is."""
    wrong = _ERROR.search(usage.output)
    if wrong is not None:
        return " ".join(wrong[0].split())[:100]
    return "" if end in usage.output else "stopped within its script"


def by_qepcad(result: RegionMap, said: str) -> tuple[bool, str]:
    """Whether each of the map's cells has the sample of an open cell at least, and each sample lies in a cell.

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


# ------------------------------------------------------------------------------------------------- counts by the sextic


class Task(Enum):
    """What QEPCAD is asked: in which part of the window are there exactly so many equilibria?"""

    SIX = "6 equilibria"
    FOUR = "4 equilibria"
    TWO_STABLE = "2 stable equilibria"


Terms = list[tuple[int, int, int, Fraction]]
"""A polynomial in x, y and t: ``(i, j, n, c)`` means c x^i y^j t^n."""


class Question(NamedTuple):
    """The sextic over a window, its derivative in t, and the numerators of V and W, up to positive factors."""

    sextic: Terms
    slope: Terms
    v: Terms
    w: Terms
    axes: tuple[Axis, Axis]

    def problem(self, task: Task, *, swapped: bool = False, then: Sequence[str] = ("solution T",)) -> str:
        """One problem of a session.

        Parameters
        ----------
        swapped : eliminate the first axis before the second, instead of the second before the first.
        then : the commands that are given once the decomposition is made.
        """
        p, slope, v, w = (
            " ".join(signed_terms((((i, j, n), c) for i, j, n, c in terms), "xyt", times=" ", number=str))
            for terms in self[:4]
        )
        condition = f"{p} = 0"
        if task is Task.TWO_STABLE:
            condition += rf" /\ [[{v} > 0 /\ {w} > 0 /\ {slope} < 0] \/ [{v} < 0 /\ {w} < 0 /\ {slope} > 0]]"
        (x0, x1), (y0, y1) = ((axis.low, axis.high) for axis in self.axes)
        return "\n".join((
            f"[ x is {self.axes[0].name}, y is {self.axes[1].name} ]",
            "(y,x,t)" if swapped else "(x,y,t)",
            "2",
            f"(X{task.value.split()[0]} t)[ {condition} ].",
            rf"assume [ x > {x0} /\ x < {x1} /\ y > {y0} /\ y < {y1} ]",
            "measure-zero-error",
            *("go",) * 3,
            *then,
        ))  # fmt: skip


def question(slice: Slice) -> Question | str:
    """The sextic of a slice, or the reason why there is none to put to QEPCAD."""
    if slice.mechanism != "ptm":
        return f"the sextic is the paper's mechanism's, not that of {slice.mechanism}"
    if slice.has_free_lengths:
        return "with free lengths there is no sextic"
    if not all(value.is_polynomial for value in slice.parameters.values()):
        return "a parameter is not a polynomial in the axes"
    coefficients, v, w, _ = sextic(slice.parameters)
    if not coefficients[6].numerator:
        return LOSES_PI
    slope = [n * coefficient for n, coefficient in enumerate(coefficients)][1:]
    return Question(_terms(coefficients), _terms(slope), _terms(v), _terms(w), slice.axes)


def _terms(polynomial: Sequence[Expression]) -> Terms:
    return [(i, j, n, c) for n, coefficient in enumerate(polynomial) for i, j, c in coefficient.numerator]
