"""Counts made once for all cells that are proved to be joined off the variety: a quarter of the work of one for each.

Guarantee: the counts are those of `ptmcad.exact.stages.counts_of`. What is lost is the check of the decomposition that
counting everywhere is, and the solutions at the other cells' samples; so a map that is made in this way proves less.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.exact.cad.adjacency import Crossing
from ptmcad.exact.cad.projection import Projection
from ptmcad.exact.counting import Equilibria
from ptmcad.exact.regions import Link, members, merge
from ptmcad.exact.stages import (
    Report,
    Sample,
    SampleCounts,
    SliceProblem,
    Stacks,
    Variety,
    adjacencies_of,
    lines_across,
    unreported,
    with_keys,
)


def joined_cells(
    variety: Variety, projection: Projection, stacks: Stacks, crossings: Sequence[Crossing]
) -> tuple[int, ...]:
    """The component of the variety's complement in which each cell lies, as far as it is proved that cells are joined.

    Components are numbered in the order of their first cells. Within one there is a path that meets the variety
    nowhere, on which no solution comes, goes, or changes its signs: counts are equal in all its cells.
    """
    keys = [()] * len(stacks.points)
    links = adjacencies_of(stacks.stacks, crossings, lines_across(variety, projection), keys)
    return merge(keys, [Link(a.first, a.second, None) for a in links if a.component is None])


def counts_by_component(
    problem: SliceProblem, stacks: Stacks, component_of: Sequence[int], report: Report = unreported
) -> SampleCounts:
    """The counts of every cell, and the equilibria at one sample of each component, that of least height."""
    found: list[Equilibria | None] = [None] * len(stacks.points)
    components = members(component_of)
    for k, cells in enumerate(components):
        report(k, len(components))
        first = min(cells, key=lambda n: _height(stacks.points[n]))
        there = problem.solved_at(stacks.points[first])
        for n in cells:
            found[n] = there if n == first else there._replace(solutions=())
    return with_keys(problem, [e for e in found if e is not None])


def _height(at: Sample) -> int:
    """How long a sample's numbers are."""
    return max(int(n).bit_length() for x in at for n in (x.p, x.q))
