"""The curves of a slice at which counts of a mechanism with closed loops and springs of free lengths change.

Guarantee: as that of `ptmcad.certified.plain.curves`: folds, places where a loop folds flat, and equilibria that a
spring's cone swallows (Theorem 5 of docs/soundness.md).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ptmcad.certified.curve import Curve
from ptmcad.certified.formula import Formula
from ptmcad.certified.plain.bounds import TURN
from ptmcad.certified.plain.excesses import boundaries
from ptmcad.certified.plain.infinity import Patch
from ptmcad.certified.plain.loopchart import LoopChart, loop_chart
from ptmcad.certified.plain.problem import FIRST, Problem
from ptmcad.certified.scales import TURNING_WEIGHT, short_lengths, variable_weights
from ptmcad.certified.system import system
from ptmcad.question.slice import Count, Slice

_REASON = "equilibria meet, or a loop folds flat: the Jacobian is singular"


def curves_of_loops(slice: Slice, count: Count, patch: Patch) -> Iterator[Curve]:
    """The folds, every spring with a free length long; the same with one short, in its chart; and the cones.

    And places at which a spring along one line has no length, on one side of it.
    """
    problem, ranges, at = patch.problem, patch.ranges, loop_chart(patch.problem)
    variables = 0, 1, *problem.variables
    weights = variable_weights(slice, at.equations, ranges)
    shorts = short_lengths(slice, at.lengths, ranges)
    long = [extent - short for extent, short in zip(at.lengths, shorts, strict=True)]
    sides = _sides(problem, at)
    fold = system([*at.equations, at.determinant()], variables, ((), ()), [*long, *sides])
    yield Curve(f"fold{problem.where}", _REASON, fold, ranges, np.array(weights))
    stable = [at.determinant()] if count.is_of_stable else []
    for k, (side, condition) in enumerate(zip(sides, problem.inequalities, strict=True)):
        yield Curve(
            f"point where {condition.text} is 0{problem.where}",
            f"solutions count where {condition.text} > 0, and at one of them it is zero",
            system([*at.equations, side], variables, nonnegative=[*sides[:k], *sides[k + 1 :], *stable]),
            ranges,
            np.array(weights),
        )
    graph = at.equations[0].graph
    unknowns = [graph.variable(k) for k in problem.variables]
    for found in boundaries(problem.excesses, unknowns):
        yield Curve(
            f"{found.name}{problem.where}",
            found.reason,
            system(
                [*at.equations, found.zero],
                variables,
                (found.others, ()),
                [*found.not_negative, *sides, at.determinant()],
            ),
            ranges,
            np.array(weights),
        )
    for s, (cone, short) in enumerate(zip(problem.cones, shorts, strict=True)):
        turned = loop_chart(problem, s)
        aligned, along, *_ = turned.turning
        yield Curve(
            f"fold{problem.where} with spring {cone.name} short",
            f"{_REASON}; spring {cone.name} is at most {short} long",
            system(
                [aligned, *turned.equations, turned.extended_determinant()],
                (*variables, FIRST + len(problem.unknowns)),
                ((), ()),
                [along, short - turned.lengths[s], *_sides(problem, turned)],
            ),
            (*ranges, TURN),
            np.array([*weights, TURNING_WEIGHT]),
        )
    for cone in problem.cones:
        # configurations are a curve: two equations d = 0 leave curves in the window and need no direction
        vanishing = [f for f in (d.formula(graph, unknowns) for d in cone.difference) if f.value != 0]
        yield Curve(
            f"point where spring {cone.name} has no length{problem.where}",
            f"an equilibrium is swallowed where spring {cone.name} has no length",
            system(
                [*at.equations[: problem.closing], *vanishing], variables, ((), at.equations[problem.closing :]), sides
            ),
            ranges,
            np.array(weights),
        )


def _sides(problem: Problem, at: LoopChart) -> list[Formula]:
    """What is not negative on the side of each spring's kink that the problem is about."""
    graph = at.equations[0].graph
    unknowns = [graph.variable(k) for k in problem.variables]
    return [condition.value.formula(graph, unknowns) for condition in problem.inequalities]
