"""The paper's five slices, their region maps, and the counts, poses and ranges in them that its claims are about.

Guarantee: exact. Maps are computed once for each process; ranges end in isolating intervals of roots of the variety.

Figure 5 is two slices, because its text and its caption give different values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import pairwise

from ptmcad.algebra.polynomials import coefficients_in, from_plane, univariate
from ptmcad.algebra.real_roots import RealRoot, disjoint, isolate, refine, simplest_between, squarefree_part
from ptmcad.answer.counts import MorseIndex
from ptmcad.answer.regionmap import Component, RegionMap, Solution
from ptmcad.ask.classification import classify
from ptmcad.exact.counting import equilibria
from ptmcad.exact.models import system_of
from ptmcad.question.slice import Count, Slice
from ptmcad.studies.slices import Exact, ptm_slice
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.parsing import rational

_RECORDS: Mapping[str, tuple[str, Mapping[str, Exact], Mapping[str, tuple[int, int]]]] = {
    "fig2": ("Unloaded mechanism, L1 = 1", {}, {"L2": (0, 4), "rho": (0, 4)}),
    "fig3": ("Symmetric mechanism, L1 = L2 = 1, F3 = F4 = F, k = 100", {"L2": 1, "F3": "F", "F4": "F"},
             {"rho": (0, 2), "F": (-10, 0)}),
    "fig4": ("Equal loads, L1 = 1, F3 = F4 = -10, k = 100", {"F3": -10, "F4": -10}, {"rho": (0, 2), "L2": (0, 2)}),
    "fig5-text": ("Unequal loads, L1 = 1, L2 = 3/2, F3 = -10, k = 100", {"L2": "3/2", "F3": -10},
                  {"rho": (0, 2), "F4": (-30, 0)}),
    "fig5-caption": ("Unequal loads, L1 = L2 = 1, F3 = -30, k = 100", {"L2": 1, "F3": -30},
                     {"rho": (0, 2), "F4": (-30, 0)}),
}  # fmt: skip
FIGURES = tuple(_RECORDS)

POINTS: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "fig2": ("fig. 2, right", {"L2": "3/2", "rho": "1"}),
    "fig3": ("fig. 3, right", {"rho": "3/4", "F": "-10"}),
    "fig4": ("fig. 4, right", {"L2": "3/2", "rho": "7/10"}),
    "fig5-text": ("a point of the two-solution region; the paper shows no poses", {"rho": "3/4", "F4": "-20"}),
    "fig5-caption": ("a point of the two-solution region; the paper shows no poses", {"rho": "1/2", "F4": "-20"}),
}
"""For each figure: the point whose poses are drawn, and whose choice it is."""

FINENESS = Fraction(1, 10**15)
"""Ends of ranges are known at least this well."""


@cache
def slice_of(figure: str) -> Slice:
    """The slice of a figure of the paper."""
    title, parameters, axes = _RECORDS[figure]
    return replace(ptm_slice(figure, axes, **{"L1": 1, "k": 100, **parameters}), title=title, count=Count.STABLE)


@cache
def region_map(figure: str) -> RegionMap:
    """The region map of a figure of the paper."""
    return classify(slice_of(figure))


def curves(figure: str) -> tuple[Component, ...]:
    """The components of the discriminant variety that have a point in the figure's window."""
    return tuple(c for c in region_map(figure).components if not c.left_out)


def parameters_at(figure: str, at: Mapping[str, Exact]) -> dict[str, Fraction]:
    """Every parameter of the mechanism at a point of a figure, which need not lie in its window."""
    wanted = slice_of(figure)
    x, y = (rational(at[name]) for name in wanted.axis_names)
    return {name: expression.evaluate(x, y) for name, expression in wanted.parameters.items()}


@dataclass(frozen=True, slots=True)
class Counted:
    """All equilibria at a rational point, each in a box; ``index`` counts minima, saddles and maxima."""

    index: MorseIndex
    solutions: tuple[Solution, ...]

    @property
    def total(self) -> int:
        return sum(self.index)

    @property
    def stable(self) -> int:
        return self.index[0]

    @property
    def stable_solutions(self) -> tuple[Solution, ...]:
        return tuple(s for s in self.solutions if s.signs == "++")


def equilibria_at(**given: Exact) -> Counted:
    """All equilibria at rational parameters; those not given are L1 = L2 = rho = 1, k = 100 and no load.

    Raises
    ------
    DegeneratePoint
        When an equilibrium is singular there.
    """
    system = system_of("ptm")
    defaults: dict[str, Exact] = {"L1": 1, "L2": 1, "rho": 1, "k": 100, "F3": 0, "F4": 0, "F3x": 0, "F4x": 0}
    values = {name: rational(value) for name, value in (defaults | given).items()}
    stiffness = values.pop("k")
    values = {"k1": stiffness, "k2": stiffness, "k3": stiffness} | values
    found = equilibria(system, {name: from_fraction(values[name]) for name in system.ring.parameters})
    solutions = tuple(
        Solution(tuple(map(to_fraction, e.center)), to_fraction(e.radius), e.signs) for e in found.solutions
    )
    assert found.counts.index is not None
    return Counted(found.counts.index, solutions)


def heights(solution: Solution) -> tuple[int, int]:
    """The signs of y3 and y4 of an equilibrium, which are those of its sines; 0 where its box meets zero."""
    first, second = ((s > solution.radius) - (s < -solution.radius) for s in (solution.center[1], solution.center[3]))
    return first, second


@dataclass(frozen=True, slots=True)
class Range:
    """An interval of constant stable count on a line through a figure: between two roots of the variety."""

    stable: int
    low: Fraction | RealRoot
    high: Fraction | RealRoot

    def bounds(self) -> tuple[Fraction, Fraction, Fraction, Fraction]:
        """Rational bounds below and above the low end, below and above the high end."""
        return (*_bounds(self.low), *_bounds(self.high))

    def width(self) -> tuple[Fraction, Fraction]:
        """A lower and an upper bound of its length."""
        a, b, c, d = self.bounds()
        return c - b, d - a


def _bounds(end: Fraction | RealRoot) -> tuple[Fraction, Fraction]:
    if isinstance(end, Fraction):
        return end, end
    return to_fraction(end.low), to_fraction(end.high)


def ranges(figure: str, along: str, fixed: Exact) -> tuple[Range, ...]:
    """The intervals of constant stable count along one axis of a figure, the other axis being fixed.

    Parameters
    ----------
    along : the name of the axis that varies, from the window's low end.
    fixed : the other axis's value, which may lie outside the window.

    Guarantee
    ---------
    Neighbouring intervals have different counts, and each end is a root of the variety, known to `FINENESS`.
    """
    map_ = region_map(figure)
    number = map_.slice.axis_names.index(along)
    axis, other = map_.slice.axes[number], map_.slice.axes[1 - number]
    at = rational(fixed)
    span = (from_fraction(axis.low), from_fraction(axis.high))
    # all components: what has no point in the window may have one on a line outside it
    traces = [univariate(coefficients_in(from_plane(c.polynomial), number), from_fraction(at)) for c in map_.components]
    common = traces[0]
    for p in traces[1:]:
        common = common * p
    roots = list(disjoint(isolate(squarefree_part(common), *span)))
    roots = [refine(r, from_fraction(FINENESS)) for r in roots]
    ends: list[Fraction | RealRoot] = [axis.low, *roots, axis.high]
    found: list[Range] = []
    for a, b in pairwise(ends):
        sample = simplest_between(from_fraction(_bounds(a)[1]), from_fraction(_bounds(b)[0]))
        values = parameters_at(figure, {axis.name: to_fraction(sample), other.name: at})
        stable = equilibria_at(**values).stable
        if found and found[-1].stable == stable:
            found[-1] = Range(stable, found[-1].low, b)
        else:
            found.append(Range(stable, a, b))
    return tuple(found)


def operation_range(figure: str, along: str, fixed: Exact) -> Range | None:
    """The only interval with two stable equilibria along a line; None when there is none.

    Raises
    ------
    ArithmeticError
        When there are several.
    """
    two = [r for r in ranges(figure, along, fixed) if r.stable == 2]
    if len(two) > 1:
        raise ArithmeticError(f"{len(two)} intervals with two stable equilibria at {fixed} in {figure}")
    return two[0] if two else None
