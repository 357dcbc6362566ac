"""Steps of a plan that both engines have.

Guarantee: each saving that is named is made in the computation that the plan accompanies, or said
to be switched off.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from ptmcad.answer.regionmap import PlanStep
from ptmcad.question.savings import BY_NAME, GENERAL_SAVING
from ptmcad.question.slice import Slice

if TYPE_CHECKING:
    from ptmcad.model.involutions import Involution

KEPT = "kept, as asked for"
"""The reason for a step that a saving would have left out."""


def saving_step(name: str, without: frozenset[str], what: str = "", why: str = "") -> PlanStep:
    """The step of a saving that is made, unless it is switched off.

    Parameters
    ----------
    what, why : in place of the saving's general words.
    """
    left_out, reason = BY_NAME[name]
    kept = name in without
    return PlanStep(what or left_out, kept, KEPT if kept else why or reason, name)


def own_steps(steps: Iterable[PlanStep]) -> list[PlanStep]:
    """The steps that say something about a slice: what is spared on every slice alike is no news.

    >>> own_steps([PlanStep("imports of numpy", False, "nothing needs them before it asks", GENERAL_SAVING)])
    []
    """
    return [step for step in steps if step.done or step.saving != GENERAL_SAVING]


def zero_parameters(slice: Slice) -> list[str]:
    """The parameters that are zero on the whole slice."""
    return [n for n, e in slice.parameters.items() if e.is_constant and e.constant() == 0]


def zero_terms(names: Sequence[str]) -> list[PlanStep]:
    """The step that says so where parameters are zero: nothing is left of them once numbers are put
    in.
    """
    return (
        [PlanStep("terms of " + ", ".join(names), False, "they are zero on this slice")]
        if names
        else []
    )


def half_step(what: str, change: Involution | None, slice: Slice) -> list[PlanStep]:
    """The step that says so where one half of the window was enough, as an involution takes the
    window to itself.
    """
    if change is None:
        return []
    moves = change.text(tuple(slice.model.unknowns), slice.axis_names)
    return [
        PlanStep(
            f"{what} one half of the window",
            False,
            f"its solutions are those of the other half, by {moves}",
        )
    ]
