"""The plan of the certified engine, as far as it is known before anything is computed.

Guarantee: each saving that is named here is made, or is said to have been switched off. Loads
neither numpy nor numba.
"""

from __future__ import annotations

from ptmcad.answer.plan import saving_step, zero_parameters, zero_terms
from ptmcad.answer.regionmap import PlanStep
from ptmcad.certified.plain.involution import mirrors
from ptmcad.certified.plain.problem import problem_of
from ptmcad.errors import PtmcadError
from ptmcad.question.slice import Slice


def beforehand(slice: Slice, without: frozenset[str]) -> tuple[PlanStep, ...]:
    """What is known of the plan before anything is computed."""
    free_lengths = slice.model.free_lengths
    absent = [
        name
        for name in free_lengths
        if name not in slice.parameters or not slice.parameters[name].numerator
    ]
    zero = [name for name in zero_parameters(slice) if name not in free_lengths]
    steps = [saving_step("imports", without, "imports of matplotlib and sympy")]
    steps += zero_terms([*zero, *absent])
    return (*steps, *_plain(slice, without))


def _plain(slice: Slice, without: frozenset[str]) -> tuple[PlanStep, ...]:
    """The steps of a model without formulas of its own."""
    reason = (
        "its degree is out of reach when springs have free lengths"
        if slice.has_free_lengths
        else "curves are enclosed, as the certified engine was asked for"
    )
    steps = [PlanStep("discriminant variety", False, reason)]
    if slice.count.is_of_stable:
        steps.append(saving_step("folds-of-saddles", without))
        if slice.has_free_lengths:
            steps.append(saving_step("cones-and-creases", without))
    if slice.has_free_lengths:
        steps.append(saving_step("dependent-equations", without))
    if _is_symmetric(slice):
        steps.append(saving_step("mirror-images", without))
    return tuple(steps)


def _is_symmetric(slice: Slice) -> bool:
    """Whether an involution keeps each point of the slice."""
    try:
        problem = problem_of(slice)
    except PtmcadError:
        return False  # the engine says why
    return bool(mirrors(slice, problem))
