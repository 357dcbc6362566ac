"""Programs that do a part of the work on any slice: msolve and Singular the critical curve, QEPCAD and gcad cells.

Guarantee: an answer is what a run said that came to the end of its script without an error. It is
compared exactly with ptmcad's map: curves as sets of irreducible polynomials, and cells by locating
each sample of QEPCAD's in the map; gcad gives no samples, so only the number of its cells is compared.

msolve and Singular are given the system that ``ptmcad variety --format msolve`` writes; QEPCAD and
gcad the finished curves, with the map's base axis first.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from ptmcad.algebra import msolve
from ptmcad.algebra.polynomials import common_factor, from_terms, irreducible_factors, to_plane
from ptmcad.answer.regionmap import Kind, RegionMap
from ptmcad.exact.models.elimination import elimination_system
from ptmcad.exact.slicevariety import slice_variety
from ptmcad.exact.stages import domain_limits, problem_of
from ptmcad.question.slice import Slice
from ptmcad.show.polynomial_text import Style, symbols
from ptmcad.studies.bench.process import Usage
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.text.plane import PlanePolynomial

END = "-- the script was read to its end --"
QUIT = "Quitting the QEPCAD system"
STUCK = "[ 0 = 0 ].\nquit\nquit\n"
"""Read only by a session of QEPCAD's that has not understood its formula: it would ask again for ever."""
_ERROR = re.compile(r"^\s*\? .*$|^.*(?:\bError\b|Failure|Reason for|expected!).*$", re.MULTILINE)
_CELL = re.compile(r"Information about the cell \(\d+,\d+\) -+$(.*?)^-{50,}$", re.MULTILINE | re.DOTALL)
_TRUE = re.compile(r"^Truth value\s*: T", re.MULTILINE)
_COORDINATE = re.compile(r"^Coordinate [12] = (-?\d+(?:/\d+)?)$", re.MULTILINE)
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


class Elimination(NamedTuple):
    """A system in msolve's form, and the names of its unknowns and of the axes there."""

    text: str
    unknowns: tuple[str, ...]
    axes: tuple[str, ...]


def elimination(slice: Slice, has_map: bool) -> Elimination:
    """The system from which the unknowns have to be eliminated; the variety's own where that is within reach."""
    if has_map:
        system = slice_variety(slice).system
    else:
        problem = problem_of(slice)
        limits = domain_limits(problem.system, problem.parameters)
        system = elimination_system(problem.system, problem.parameters, slice.axis_names, limits, False)
    variables = symbols((*system.unknowns, *system.axes), Style.MSOLVE)
    polynomials = ",\n".join(text.replace(" ", "") for text in system.texts(variables))
    return Elimination(f"{','.join(variables)}\n0\n{polynomials}\n", variables[:-2], variables[-2:])


def singular_script(asked: Elimination) -> str:
    """The factors of the elimination ideal's common divisor, one on a line.

    A basis in the cheap order comes first: it saves most of the time. The variables are called v0,
    v1 and so on, because an axis may have the name of something else in Singular.
    """
    numbered = {name: f"v{n}" for n, name in enumerate((*asked.unknowns, *asked.axes))}
    polynomials = "".join(asked.text.splitlines()[2:])
    ideal = re.sub(r"[^\W\d]\w*", lambda name: numbered[name[0]], polynomials)
    names = list(numbered.values())
    return f"""ring r = 0, ({",".join(names)}), dp;
short = 0;
ideal i = {ideal};
ideal e = eliminate(std(i), {"*".join(names[: len(asked.unknowns)])});
poly common = 0;
for (int n = 1; n <= size(e); n++) {{ common = gcd(common, e[n]); }}
list factors = factorize(common);
for (n = 1; n <= size(factors[1]); n++) {{ if (deg(factors[1][n]) > 0) {{ print(string(factors[1][n])); }} }}
print("{END}");
quit;
"""


def gcad_script(result: RegionMap) -> str:
    """A script that prints the number of open cells of the window that gcad makes of the map's curves.

    gcad takes inequalities, so the product of the curves is asked to be positive, and then negative.
    """
    curves = [c.polynomial.text(("x", "y")) for c in result.components if not c.left_out]
    product = "*".join(f"({curve.replace('^', '**')})" for curve in curves) or "1"
    window = [(str(a.low), str(a.high)) for a in result.slice.axes]
    return _GCAD_SCRIPT.format(product=product, window=window, step=1 if result.base == 0 else -1)


def incomplete(end: str, usage: Usage) -> str:
    """What is wrong with a session, which exits with status 0 after most errors; empty when nothing is."""
    wrong = _ERROR.search(usage.output)
    if wrong is not None:
        return " ".join(wrong[0].split())[:100]
    return "" if end in usage.output else "stopped within its script"


def agreement(program: str, answer: str, result: RegionMap, asked: Elimination) -> str:
    """What the answer is beside the map, in words, with "DIFFERS" where it is another.

    Parameters
    ----------
    program : ``"msolve"``, ``"singular"``, ``"qepcad"`` or ``"gcad"``.
    answer : its output, or msolve's file.
    """
    try:
        if program == "gcad":
            return f"{json.loads(answer)['cells']} cells, the map has {len(result.cells)}"
        if program == "qepcad":
            same, words = same_cells(result, qepcad_samples(answer))
        elif program == "singular":
            first = len(asked.unknowns)
            found = curves(answer.partition(END)[0].split(), (f"v{first}", f"v{first + 1}"), factors=True)
            same, words = same_curves(result, found)
        else:
            lines = "".join(line for line in answer.splitlines() if not line.startswith("#"))
            same, words = same_curves(result, curves(lines.strip("[]: \n").split(","), asked.axes))
    except ValueError as error:
        same, words = False, f"cannot be read: {error}"
    return words if same else f"DIFFERS: {words}"


def curves(polynomials: Sequence[str], axes: Sequence[str], *, factors: bool = False) -> set[PlanePolynomial]:
    """The irreducible curves on which all the polynomials vanish.

    Parameters
    ----------
    factors : the polynomials are factors of one, so the curves are those of any of them.

    Raises
    ------
    ValueError
        When one is no polynomial in the axes.
    """
    numbered = {name: f"u{n}" for n, name in enumerate(axes)}
    named = re.sub(r"[^\W\d]\w*", lambda name: numbered.get(name[0], name[0]), ",".join(polynomials))
    try:
        basis = msolve.parsed_basis(f"[{named}]:", len(axes))
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


def qepcad_samples(output: str) -> list[tuple[Fraction, Fraction]]:
    """The samples of the open cells of the window, in the order of QEPCAD's variables.

    Raises
    ------
    ValueError
        When there are none, or a cell has no rational sample.
    """
    samples = [_COORDINATE.findall(cell) for cell in _CELL.findall(output) if _TRUE.search(cell)]
    if not samples or any(len(sample) != 2 for sample in samples):
        raise ValueError("no cells, or one without a rational sample")
    return [(Fraction(x), Fraction(y)) for x, y in samples]


def same_cells(result: RegionMap, samples: Sequence[tuple[Fraction, Fraction]]) -> tuple[bool, str]:
    """Whether each of the map's cells has one of the samples at least, and each sample lies in a cell."""
    names = result.slice.axis_names
    order = names if result.base == 0 else names[::-1]
    seen = {result.locate(dict(zip(order, sample, strict=True))).cell for sample in samples}
    words = f"{len(samples)} cells, in {len(seen - {None})} of the map's {len(result.cells)}"
    return None not in seen and len(seen) == len(result.cells), words
