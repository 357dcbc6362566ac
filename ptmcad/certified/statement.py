"""What a certified map says of its problem: the equations as text, and the plan.

Guarantee: the potential is written from the mechanism's description, in the names of problem
records. Each saving that the plan names is made, or is said to have been switched off. Loads
neither numpy nor numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ptmcad.answer.plan import half_step, saving_step, zero_parameters, zero_terms
from ptmcad.answer.regionmap import PlanStep, System
from ptmcad.certified.plain.mirrors import omissions
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.straight import branches
from ptmcad.errors import PtmcadError
from ptmcad.model import Mechanism, Model
from ptmcad.model.closed import conditions_of
from ptmcad.model.description import equations_in
from ptmcad.model.elements import factor
from ptmcad.model.involutions import Involution
from ptmcad.model.work import split_moments
from ptmcad.question.savings import BY_NAME
from ptmcad.question.slice import Slice
from ptmcad.text.tree import to_text

if TYPE_CHECKING:
    from ptmcad.certified.refinement import CriticalCurve


def system_text(model: Model, has_free_lengths: bool = False) -> System:
    """The potential, of a mechanism with square roots; gradient and Hessian are its derivatives by
    the unknowns.

    The work of constant moments is in it, so that it has another value after each turn; where a
    moment depends on another unknown, moments are stated beside it. Of closed loops with free
    lengths the potential, and as relations what is zero where each loop is closed. Of a system
    without a potential, and of loops without free lengths, the equations. What is positive at
    solutions is there as the record says it.
    """
    unknowns, own, mechanism = tuple(model.unknowns), equations_in(model), model.whole
    written, positive, stable = conditions_of(model)
    equations, conditions, stability = (
        tuple(map(to_text, some)) for some in (written, positive.values(), stable)
    )
    if mechanism is None or (equations and not has_free_lengths):
        potential = "" if own is None or own.potential is None else to_text(own.potential)
        return System(unknowns, (), potential, equations, (), conditions, stability)
    relations = tuple(bar.text(mechanism.points) for bar in mechanism.closing)
    apart = {u: to_text(tree) for u, tree in mechanism.work.items() if mechanism.coupled}
    stated = tuple(apart.get(unknown, "0") for unknown in unknowns if apart)
    return System(unknowns, relations, _energy_text(mechanism), (), (), conditions, moments=stated)


def _energy_text(mechanism: Mechanism) -> str:
    """The energy of springs less the work of loads and of moments; of springs with square roots."""
    moments, energies = split_moments(mechanism)
    stored = [spring.text(mechanism.points) for spring in mechanism.elastic]
    stored += map(factor, energies)
    work = [load.text(mechanism.points) for load in mechanism.loads]
    work += [f" - {factor(value)}*{u}" for u, value in moments if not mechanism.coupled]
    return (" + ".join(stored) or "0") + "".join(work)


def plan_of(
    slice: Slice,
    curves: Sequence[CriticalCurve],
    without: frozenset[str] = frozenset(),
    change: Involution | None = None,
) -> tuple[PlanStep, ...]:
    """What the certified engine does for a slice and what it leaves out.

    Parameters
    ----------
    without : savings that were switched off.
    change : the involution by which one half of the window is enough, if it is.
    """
    return (
        *beforehand(slice, without),
        *(
            PlanStep(
                curve.name,
                True,
                f"enclosed by branch and prune in {len(curve.system.arguments.unknowns)} unknowns",
            )
            for curve in curves
        ),
        *half_step("curves over", change, slice),
    )


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
    return (*steps, *_left_out(slice, without))


def _left_out(slice: Slice, without: frozenset[str]) -> tuple[PlanStep, ...]:
    """The exact engine's method, and the savings: those that are made in the search for each curve,
    and those that were switched off.
    """
    reason = (
        "its degree is out of reach when springs have free lengths"
        if slice.has_free_lengths
        else "curves are enclosed, as the certified engine was asked for"
    )
    variety = PlanStep("discriminant variety", False, reason)
    try:
        found = [
            omissions(slice, branch, slice.count, without)
            for branch in branches(problem_of(slice), slice.axes)
        ]
    except PtmcadError:
        return (variety,)  # the engine says why
    made = frozenset[str].intersection(*(made for made, _, _ in found))
    kept = frozenset[str].union(*(kept for _, kept, _ in found))
    return (variety, *(saving_step(name, without) for name in BY_NAME if name in made | kept))
