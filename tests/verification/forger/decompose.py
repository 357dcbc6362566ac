"""A map over components that may be false: decomposed, counted and assembled as the engine does
with true ones.

Where the counts then contradict each other, since a curve is missing between them, every cell is
given the first one's; so is a cell whose sample lies on a missing curve.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from support.replacing import replace

from forger.consistency import NO_AREAS, settled, with_plan
from ptmcad.answer.regionmap import Component, RegionMap
from ptmcad.errors import HypothesisError
from ptmcad.exact.cad.decomposition import Sample, crossings_of, cut_along, neighbours_of, seen_from
from ptmcad.exact.counting import Equilibria
from ptmcad.exact.mapassembly import PartialMap, assemble
from ptmcad.exact.stages import Cells, SliceProblem, problem_of, with_keys
from ptmcad.options import Options
from ptmcad.text.flint_numbers import from_fraction


def decomposed(r: RegionMap, components: Sequence[Component]) -> RegionMap:
    """The map with these components, over the same base, and with all that follows from them."""
    problem = problem_of(r.slice)
    cut = cut_along(
        problem.window, seen_from(components, r.base, r.complex_solutions)._replace(costs=(1, 2))
    )
    known = [_equilibria(problem, at) for at in cut.points]
    some = next((e for e in known if e is not None), None) or _equilibria(problem, _inside(r))
    assert some is not None
    counts = with_keys(problem, [some if e is None else e for e in known])
    crossings = crossings_of(cut)
    try:
        neighbours = neighbours_of(cut, counts.keys, crossings)
    except ArithmeticError:
        counts = with_keys(problem, counts.found[:1] * len(known))
        neighbours = neighbours_of(cut, counts.keys, crossings)
    options = Options(areas=NO_AREAS not in r.plan)
    cells = Cells(cut, counts, neighbours)
    found = replace(
        assemble(problem, options, PartialMap(cut.variety, cells)), plan=r.plan, system=r.system
    )
    found = with_plan(found)
    areas = {frozenset(tuple(r.cells[n].sample) for n in g.cells): g.area for g in r.regions}
    whole = (Fraction(0), found.regions[0].area[1])
    if NO_AREAS in r.plan:
        areas = {}
    regions = tuple(
        replace(g, area=areas.get(frozenset(tuple(found.cells[n].sample) for n in g.cells), whole))
        for g in found.regions
    )
    return settled(
        replace(
            found,
            regions=regions,
            status=r.status,
            versions=r.versions,
            precision=r.precision,
            timings=r.timings,
        )
    )


def _equilibria(problem: SliceProblem, at: Sample) -> Equilibria | None:
    """The equilibria at a sample; None on a curve of the variety, which may be missing, or outside
    of the domain.
    """
    try:
        return problem.solved_at(at)
    except HypothesisError:
        return None


def _inside(r: RegionMap) -> Sample:
    """A sample of the true map."""
    x, y = r.cells[0].sample
    return from_fraction(x), from_fraction(y)
