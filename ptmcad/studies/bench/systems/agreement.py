"""What the programs answered against ptmcad's map, wherever both say something.

Guarantee: every comparison is exact. Curves are compared as sets of irreducible polynomials, numbers of solutions at
rational points, and cells by locating each sample of QEPCAD's in the map; of gcad's cells only the number is compared,
because it gives no samples.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from ptmcad.algebra.msolve import MsolveError, Terms, parsed, parsed_basis
from ptmcad.algebra.polynomials import Coefficient, common_factor, from_terms, irreducible_factors, to_plane
from ptmcad.answer.regionmap import Kind, RegionMap
from ptmcad.studies.bench.systems.exchange import Answers, Check, Point, Question
from ptmcad.studies.bench.systems.programs import AnswerError, Tool, msolve_curves
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.text.plane import PlanePolynomial


def checks(asked: Question, answer: Path | None, given: Answers) -> Mapping[str, Check]:
    """The comparisons that can be made, by the names of `Tool`.

    Parameters
    ----------
    answer : ptmcad's map, None where there is none.
    """
    result = None if answer is None else RegionMap.from_json(answer.read_text(encoding="utf-8"))
    found: dict[str, Check] = {}
    for tool, compare in _COMPARISONS.items():
        try:
            check = compare(asked, result, given)
        except AnswerError as error:
            check = Check(False, f"cannot be read: {error}")
        if check is not None:
            found[tool.value] = check
    return found


def _curve(asked: Question, result: RegionMap | None, given: Answers) -> Check | None:
    if result is None or given.curve is None:
        return None
    return same_curves(result, curves(msolve_curves(given.curve), asked.variables))


def _singular(asked: Question, result: RegionMap | None, given: Answers) -> Check | None:
    if result is None or given.singular is None:
        return None
    axes = f"v{asked.unknowns}", f"v{asked.unknowns + 1}"
    return same_curves(result, curves(given.singular, axes, factors=True))


def _qepcad(_: Question, result: RegionMap | None, given: Answers) -> Check | None:
    return None if result is None or given.qepcad is None else same_cells(result, given.qepcad)


def _gcad(_: Question, result: RegionMap | None, given: Answers) -> Check | None:
    if result is None or given.gcad is None:
        return None
    ours = len(result.cells)
    if given.gcad == ours:
        return Check(True, f"{ours} cells")
    return Check(None, f"{given.gcad} cells, the map has {ours}")


def _solve(asked: Question, result: RegionMap | None, given: Answers) -> Check | None:
    if result is None or given.solve is None:
        return None
    return _compared(_solved(given.solve), _of_map(asked, result), "map")


def _points(asked: Question, result: RegionMap | None, given: Answers) -> Check | None:
    if given.points is None or (result is None and given.solve is None):
        return None
    if result is not None and result.system.inequalities:
        return Check(None, "solutions that do not meet the inequalities are not left out")
    real = [real_solutions(text, asked.at_points[n]) for n, text in enumerate(given.points)]
    if result is not None:
        return _compared(real, _of_map(asked, result), "map")
    return _compared(real, _solved(given.solve or ()), "points of ptmcad")


_COMPARISONS = {
    Tool.CURVE: _curve,
    Tool.SINGULAR: _singular,
    Tool.QEPCAD: _qepcad,
    Tool.GCAD: _gcad,
    Tool.SOLVE: _solve,
    Tool.POINTS: _points,
}


def _solved(answers: Sequence[str]) -> list[int]:
    return [len(json.loads(text)["equilibria"]) for text in answers]


def _of_map(asked: Question, result: RegionMap) -> list[int | None]:
    return [result.locate(dict(zip(asked.axes, point, strict=True))).total for point in asked.points]


def curves(polynomials: Sequence[str], axes: tuple[str, str], *, factors: bool = False) -> set[PlanePolynomial]:
    """The irreducible curves on which all the polynomials vanish.

    Parameters
    ----------
    factors : the polynomials are factors of one, so the curves are those of any of them.

    Raises
    ------
    AnswerError
        When one is no polynomial in the axes.
    """
    numbered = {name: f"u{n}" for n, name in enumerate(axes)}
    told = re.sub(r"[^\W\d]\w*", lambda name: numbered.get(name[0], name[0]), ",".join(polynomials))
    try:
        read = [_integral(terms) for terms in parsed_basis(f"[{told}]:", len(axes))]
    except MsolveError as error:
        raise AnswerError(str(error)) from None
    groups = read if factors else [common_factor(read)]
    return {to_plane(factor) for p in groups for factor in irreducible_factors(p)}


def _integral(terms: Terms) -> Coefficient:
    """A multiple with whole coefficients."""
    return from_terms((i, j, to_fraction(c)) for (i, j), c in terms.items())[0]


def same_curves(result: RegionMap, found: set[PlanePolynomial]) -> Check:
    """Whether the critical curves are there, and besides them only curves that the map has, too."""
    critical = {c.polynomial for c in result.components if c.kind is Kind.CRITICAL}
    missing, foreign = critical - found, found - {c.polynomial for c in result.components}
    if missing or foreign:
        return Check(False, f"{len(missing)} of {len(critical)} curves missing, {len(foreign)} others")
    number = "the critical curve" if len(critical) == 1 else f"the {len(critical)} critical curves"
    others = len(found - critical)
    return Check(True, number + (f", {others} more of the map's" if others else ""))


def same_cells(result: RegionMap, samples: Sequence[Point]) -> Check:
    """Whether each of the map's cells has one of the samples at least, and each sample lies in a cell."""
    names = result.slice.axis_names
    order = names if result.base == 0 else names[::-1]
    seen = [result.locate(dict(zip(order, sample, strict=True))).cell for sample in samples]
    if None in seen or len(set(seen)) != len(result.cells):
        return Check(False, f"{len(samples)} cells, in {len(set(seen) - {None})} of the map's {len(result.cells)}")
    if len(samples) == len(result.cells):
        return Check(True, f"the same {len(samples)} cells")
    return Check(True, f"{len(samples)} cells, which refine the map's {len(result.cells)}")


def real_solutions(answer: str, system: str) -> int:
    """How many real solutions msolve has isolated.

    Raises
    ------
    AnswerError
        When it tells something else.
    """
    try:
        return len(parsed(answer, len(system.splitlines()[0].split(","))))
    except MsolveError as error:
        raise AnswerError(str(error)) from None


def _compared(found: Sequence[int], expected: Sequence[int | None], source: str) -> Check:
    right = sum(a == b for a, b in zip(found, expected, strict=True))
    return Check(right == len(expected), f"{right} of {len(expected)} counts of the {source}")
