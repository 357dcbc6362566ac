"""The arrangement of the regions of a slice, without areas.

Guarantee: the arrangement is exact, and that of the slice's region map.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.polynomials import UnivariatePolynomial
from ptmcad.algebra.real_roots import (
    Interval,
    disjoint,
    has_root_between,
    isolate,
    squarefree_part,
)
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.answer.arrangement import Arrangement
from ptmcad.answer.regionmap import Merge
from ptmcad.exact.cad.decomposition import (
    Decomposition,
    Neighbours,
    Sample,
    crossings_of,
    joined_cells,
    members,
    neighbours_of,
)
from ptmcad.exact.cad.projection import FibredCurve
from ptmcad.exact.cad.stacks import StackData, heights_between, level_at
from ptmcad.exact.discriminant_variety import Known
from ptmcad.exact.stages import (
    SliceProblem,
    counts_of_parts,
    decomposition_of,
    problem_without_free_lengths,
)
from ptmcad.question.slice import Slice


class Picture(NamedTuple):
    """A slice's arrangement with the decomposition in which points are found."""

    arrangement: Arrangement
    problem: SliceProblem
    cut: Decomposition
    neighbours: Neighbours

    def region_at(self, at: Sample) -> int | None:
        """The region of a point of the window; None on the curves, and on lines over critical
        abscissae.
        """
        cell = self.cut.cell_at(at)
        return None if cell is None else self.neighbours.region_of[cell]


def picture_of(
    slice: Slice, known: Known | None = None, check: Check = nothing, base: int | None = None
) -> Picture:
    """The arrangement of a slice without free lengths.

    Parameters
    ----------
    known : what is known of the equations from a family that the slice is of.
    check : called now and then; may raise to stop.
    base : 0 or 1, the axis over which the window is cut, on which the arrangement does not depend;
        the cheaper one when None.

    Raises
    ------
    ConfigError
        When springs have a free length.
    HypothesisError
        When the slice is degenerate, has infinitely many equilibria, or leaves the domain of the
        geometry.
    """
    problem = problem_without_free_lengths(slice, "an arrangement is")._replace(known=known)
    cut = decomposition_of(problem, base, check)
    crossings = crossings_of(cut, check=check)
    counts = counts_of_parts(
        problem, cut, joined_cells(cut, crossings), lambda _done, _total: check()
    )
    neighbours = neighbours_of(cut, counts.keys, crossings)
    region_of = neighbours.region_of
    keys = tuple(counts.keys[cells[0]] for cells in members(region_of))
    pairs = (
        tuple(sorted((region_of[a.first], region_of[a.second])))
        for a in neighbours.adjacencies
        if a.merge is Merge.SEPARATED
    )
    sides = _sides(cut, region_of)
    arrangement = Arrangement(keys, frozenset((a, b) for a, b in pairs if a != b), sides)
    return Picture(arrangement, problem, cut, neighbours)


def _sides(cut: Decomposition, region_of: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """The regions along low x, high x, low y, high y."""
    rows = cut.rows(region_of)
    along = [
        _without_repetition([row[0] for row in rows]),
        _without_repetition([row[-1] for row in rows]),
    ]
    across = [
        _without_repetition(
            [rows[end][level] for level in _levels_at(cut.variety.curves, edge, stack, cut.fibre)]
        )
        for end, edge, stack in ((0, cut.base[0], cut.stacks[0]), (-1, cut.base[1], cut.stacks[-1]))
    ]
    return (*across, *along) if cut.variety.base == 0 else (*along, *across)


def _levels_at(
    curves: Sequence[FibredCurve], edge: fmpq, stack: StackData, fibre: Interval
) -> list[int]:
    """The levels of a stack's cells along the window's edge at the end of its base, from below.

    Not all cells reach the edge along an arc: two walls may end in one point of it.
    """
    product = prod((c.polynomial_over(edge) for c in curves), start=UnivariatePolynomial([1]))
    roots = disjoint(isolate(squarefree_part(product), *fibre))
    levels = []
    for height in heights_between(roots, fibre):
        traces = [c.trace(height) for c in curves]
        u = stack.sample
        while any(has_root_between(p, min(u, edge), max(u, edge)) for p in traces):
            u = (u + edge) / 2
        levels.append(
            level_at(curves, u, height, fibre)
        )  # the segment from the edge to this point meets no curve
    return levels


def _without_repetition(regions: Sequence[int]) -> tuple[int, ...]:
    return tuple(r for n, r in enumerate(regions) if n == 0 or regions[n - 1] != r)
