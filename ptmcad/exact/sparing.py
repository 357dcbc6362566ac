"""Counts made once for all cells that are proved to be joined off the variety: a quarter of the
work of one for each.

Guarantee: the counts are those of `ptmcad.exact.stages.counts_of`. What is lost is the check of the
decomposition that counting everywhere is, and the solutions at the other cells' samples; so a map
that is made in this way proves less.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.exact.counting import Equilibria
from ptmcad.exact.decomposition import Decomposition, Report, Sample, unreported
from ptmcad.exact.regions import members
from ptmcad.exact.stages import SampleCounts, SliceProblem, with_keys


def counts_by_component(
    problem: SliceProblem,
    cut: Decomposition,
    component_of: Sequence[int],
    report: Report = unreported,
) -> SampleCounts:
    """The counts of every cell, and the equilibria at one sample of each component, that of least
    height.
    """
    found: list[Equilibria | None] = [None] * len(cut.points)
    components = members(component_of)
    for k, cells in enumerate(components):
        report(k, len(components))
        first = min(cells, key=lambda n: _height(cut.points[n]))
        there = problem.solved_at(cut.points[first])
        for n in cells:
            found[n] = there if n == first else there._replace(solutions=())
    return with_keys(problem, [e for e in found if e is not None])


def _height(at: Sample) -> int:
    """How long a sample's numbers are."""
    return max(int(n).bit_length() for x in at for n in (x.p, x.q))
