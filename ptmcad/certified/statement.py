"""What a certified map says of its problem: the equations as text, and the plan.

Guarantee: the potential is written from the mechanism's description, in the names of problem records.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from ptmcad.answer.plan import half_step
from ptmcad.answer.regionmap import PlanStep, System
from ptmcad.certified.curve import Curve
from ptmcad.certified.plan import beforehand
from ptmcad.model import ClosedMechanism, Mechanism, Model
from ptmcad.model import System as ParametricSystem
from ptmcad.model.involutions import Involution
from ptmcad.model.work import split_moments
from ptmcad.question.slice import Slice
from ptmcad.text.tree import Chain, Negative, Number, Step, Tree, to_text


def system_text(model: Model, has_free_lengths: bool = False) -> System:
    """The potential, of a mechanism with square roots; gradient and Hessian are its derivatives by the unknowns.

    The work of constant moments is in it, so that it has another value after each turn; where a moment depends on
    another unknown, moments are stated beside it. Of closed loops with free lengths the potential, and as relations
    what is zero where each loop is closed. Of a system without a potential, and of loops without free lengths, the
    equations. What is positive at solutions is there as the record says it.
    """
    if isinstance(model, ClosedMechanism) and has_free_lengths:
        relations = tuple(map(to_text, model.equations[:-1]))
        return replace(_of_mechanism(model.mechanism), relations=relations)
    if isinstance(model, ParametricSystem):
        potential = "" if model.potential is None else to_text(model.potential)
        texts = [tuple(map(to_text, trees)) for trees in (model.equations, model.inequalities, model.stability)]
        return System(tuple(model.unknowns), (), potential, texts[0], (), *texts[1:])
    assert isinstance(model, Mechanism)
    return _of_mechanism(model)


def _of_mechanism(model: Mechanism) -> System:
    if model.has_potential:
        return System(tuple(model.unknowns), (), _energy(model), (), ())
    moments = {moment.unknown: to_text(moment.value) for moment in model.moments}
    return System(
        tuple(model.unknowns),
        (),
        _energy(replace(model, moments=())),
        (),
        (),
        moments=tuple(moments.get(unknown, "0") for unknown in model.unknowns),
    )


def _energy(mechanism: Mechanism) -> str:
    energy = []
    for spring in mechanism.springs:
        (x0, y0), (x1, y1) = mechanism.points[spring.start], mechanism.points[spring.end]
        length = f"sqrt(({_difference(x1, x0)})^2 + ({_difference(y1, y0)})^2)"
        energy.append(f"1/2*{_factor(spring.stiffness)}*({length} - {_factor(spring.free)})^2")
    for torsion in mechanism.torsion:
        turned = "".join(
            f" - {_number(value)}*{function}({to_text(torsion.angle)})"
            for value, function in zip(torsion.rest, ("cos", "sin"), strict=True)
            if value
        )
        energy.append(f"{_factor(torsion.stiffness)}*(1{turned})")
    moments = split_moments(mechanism)
    energy += [_factor(tree) for tree in moments.energies]
    work = [
        f" - {_factor(force)}*{_factor(coordinate)}"
        for load in mechanism.loads
        for force, coordinate in zip((load.x, load.y), mechanism.points[load.point], strict=True)
    ]
    work += [f" - {_factor(moment.value)}*{moment.unknown}" for moment in moments.steady]
    return (" + ".join(energy) or "0") + "".join(work)


def _number(value: Fraction) -> str:
    return to_text(Number(value)) if value.denominator == 1 and value > 0 else f"({value})"


def _difference(tree: Tree, less: Tree) -> str:
    match tree, less:
        case _, Number(value) if value == 0:
            return to_text(tree)
        case Chain(first, steps), _ if tree.is_sum:
            return to_text(Chain(first, (*steps, Step("-", less))))
    return to_text(Chain(tree, (Step("-", less),)))


def _factor(tree: Tree) -> str:
    return f"({to_text(tree)})" if isinstance(tree, Chain | Negative) else to_text(tree)


def plan_of(
    slice: Slice, curves: Sequence[Curve], without: frozenset[str] = frozenset(), change: Involution | None = None
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
            PlanStep(curve.name, True, f"enclosed by branch and prune in {len(curve.system.unknowns)} unknowns")
            for curve in curves
        ),
        *half_step("curves over", change, slice),
    )
