"""How much of a slice's curves is real and in the window: the exact engine's first stages, counted.

Guarantee: exact; these are the numbers of the cells that the map will have, and of the walls
between them.
"""

from __future__ import annotations

from typing import NamedTuple

from ptmcad.algebra.resultants import Check, nothing
from ptmcad.exact.stages import SliceProblem, decomposition_of


class Survey(NamedTuple):
    """The decomposition of the window, as far as the cost of what comes after depends on it.

    Attributes
    ----------
    walls : between a cell and the next one above it, of all stacks.
    degree : the largest of a curve along the fibres.
    """

    cells: int
    walls: int
    degree: int


def survey(problem: SliceProblem, check: Check = nothing) -> Survey:
    """The decomposition's sizes.

    Parameters
    ----------
    check : called during the projection; may raise to stop.

    Raises
    ------
    DegenerateSliceError, InfiniteSolutionsError
        When every point of the slice is exceptional.
    """
    cut = decomposition_of(problem, check=check)
    cells = len(cut.points)
    return Survey(
        cells,
        cells - len(cut.stacks),
        max((len(c.in_v) - 1 for c in cut.variety.curves), default=0),
    )
