"""The discriminant variety of a slice as an answer of its own, for those who want the curves and no
map.
"""

from __future__ import annotations

from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.errors import A_SLICE, expect
from ptmcad.exact.assembly import versions
from ptmcad.exact.models.elimination import elimination_system
from ptmcad.exact.stages import problem_of, variety_of
from ptmcad.question.domain import proved
from ptmcad.question.slice import Slice, without_free_lengths


def slice_variety(slice: Slice, without: frozenset[str] = frozenset()) -> SliceVariety:
    """The discriminant variety of a slice, the first stage of `exact_map` alone.

    Parameters
    ----------
    without : names of savings to switch off, of `ptmcad.question.savings`.

    Raises
    ------
    ConfigError
        When springs have a free length: then the variety is out of algebra's reach.
    HypothesisError When the slice is degenerate, has infinitely many equilibria, or leaves the
        domain of the geometry.
    """
    expect(slice, Slice, "slice", A_SLICE)
    without_free_lengths(slice.model, slice.parameters, "the discriminant variety is")
    problem = problem_of(proved(slice))
    variety = variety_of(problem, without)
    return SliceVariety(
        slice,
        variety.components,
        variety.complex_solutions,
        elimination_system(problem.on, slice.axis_names, variety.excludes),
        versions(),
    )
