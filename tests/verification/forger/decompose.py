"""A map over components that may be false: decomposed, counted and assembled as the engine does with true ones.

Where the counts then contradict each other, since a curve is missing between them, every cell is given the first one's;
so is a cell whose sample lies on a missing curve.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from flint import fmpq

from forger.consistency import NO_AREAS, kept, settled, with_plan
from ptmcad.algebra.polynomials import Ratio, from_expression, from_fraction
from ptmcad.answer.regionmap import Component, RegionMap
from ptmcad.errors import HypothesisError
from ptmcad.exact.assembly import assemble
from ptmcad.exact.cad.adjacency import cross
from ptmcad.exact.cad.projection import project
from ptmcad.exact.cad.stacks import lift
from ptmcad.exact.counting import Equilibria
from ptmcad.exact.engine import _seen_from, avoided_by_samples, count_at
from ptmcad.exact.models import ParametricSystem, system_of


def decomposed(r: RegionMap, components: Sequence[Component], keep: frozenset[str] | None = None) -> RegionMap:
    """The map with these components, over the same base, and with all that follows from them."""
    system = system_of(r.slice.mechanism)
    parameters = {name: from_expression(r.slice.parameters[name]) for name in system.ring.parameters}
    window = [(from_fraction(a.low), from_fraction(a.high)) for a in r.slice.axes]
    base, keep = r.base, kept(r) if keep is None else keep
    curves, verticals = _seen_from(components, base)
    started = with_plan(replace(r, components=tuple(components)), keep)
    projection = project(curves, list(verticals.values()), window[base], window[1 - base], lambda: None, keep)
    avoided = avoided_by_samples(components, base)
    stacks = lift(curves, projection.abscissae, window[base], window[1 - base], avoided)
    points = [(s.sample, height) if base == 0 else (height, s.sample) for s in stacks for height in s.heights]
    known = [_equilibria(system, parameters, at) for at in points]
    some = next((e for e in known if e is not None), None) or _equilibria(system, parameters, _inside(r))
    assert some is not None
    counts = [some if e is None else e for e in known]
    crossings = [cross(curves, left, right, window[1 - base]) for left, right in pairwise(stacks)]
    lines = {tuple(int(c) for c in p.coeffs()): n for n, p in verticals.items()}
    try:
        found = assemble(started, projection, stacks, points, counts, crossings, lines)
    except ArithmeticError:
        found = assemble(started, projection, stacks, points, counts[:1] * len(counts), crossings, lines)
    areas = {frozenset(tuple(r.cells[n].sample) for n in g.cells): g.area for g in r.regions}
    whole = (Fraction(0), found.regions[0].area[1])
    if NO_AREAS in r.plan:
        areas = {}
    regions = tuple(
        replace(g, area=areas.get(frozenset(tuple(found.cells[n].sample) for n in g.cells), whole))
        for g in found.regions
    )
    return settled(replace(found, regions=regions, status=r.status, versions=r.versions, precision=r.precision))


def _equilibria(system: ParametricSystem, parameters: dict[str, Ratio], at: tuple[fmpq, fmpq]) -> Equilibria | None:
    """The equilibria at a sample; None on a curve of the variety, which may be missing, or outside of the domain."""
    try:
        return count_at("a sample", system, parameters, at)
    except HypothesisError:
        return None


def _inside(r: RegionMap) -> tuple[fmpq, fmpq]:
    """A sample of the true map."""
    x, y = r.cells[0].sample
    return from_fraction(x), from_fraction(y)
