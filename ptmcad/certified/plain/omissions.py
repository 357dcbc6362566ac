"""Which savings are made in the search for a problem's curves.

Guarantee: decided here alone. The search leaves out what it says, and nothing else; a result's plan
is written from it. Loads neither numpy nor numba.
"""

from __future__ import annotations

from ptmcad.certified.plain.geometry import turning_directions
from ptmcad.certified.plain.mirrors import mirrors
from ptmcad.certified.plain.problem import Problem
from ptmcad.model.involutions import Involution
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice

SADDLES = "folds-of-saddles"
CONES = "cones-and-creases"
DEPENDENT = "dependent-equations"
IMAGES = "mirror-images"


def omissions(
    slice: Slice, problem: Problem, count: Count, without: frozenset[str]
) -> tuple[frozenset[str], frozenset[str], tuple[Involution, ...]]:
    """What can be left out of a problem of the slice: the names of savings of
    `ptmcad.question.savings` that are made, and of those that could be and were switched off; and
    the involutions about whose fixed points folds are searched.

    Parameters
    ----------
    without : names of savings that are switched off.
    """
    changes = mirrors(slice, problem)
    of_minima = problem.is_gradient and count.is_of_stable
    dependent = not problem.closing and bool(problem.cones or turning_directions(problem))
    is_possible = {
        SADDLES: of_minima,
        CONES: of_minima and bool(problem.cones),
        DEPENDENT: dependent,
        IMAGES: bool(changes),
    }
    possible = frozenset(name for name, holds in is_possible.items() if holds)
    made = possible - without
    if SADDLES not in made or IMAGES in made:
        # only folds of minima alone, in the unknowns themselves, have the points at which a spring
        # without length swallows a minimum
        made -= {CONES}
    return made, possible & without, tuple(changes) if IMAGES in made else ()
