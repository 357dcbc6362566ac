"""Systems of equations in a box: what a search looks for, as a tape with named outputs.

Guarantee: an `EquationSystem` says which points are solutions: those at which the equations vanish
and the nonnegative formulas are at least zero. Everything else in it holds at each solution and
serves to discard boxes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ptmcad.formulas.evaluation import nodes_of, substituted
from ptmcad.formulas.graph import Formula, Operation, gradient
from ptmcad.formulas.tape import Indices, Program, Tape, record


class Arguments(NamedTuple):
    """What compiled code takes of equations f = 0 (m of them) in n unknowns, n = m (points) or m + 1
    (curves).

    Attributes
    ----------
    unknowns : int64 (n,): the numbers of the variables that are searched; others are fixed (narrow)
        intervals.
    equations : int64 (m,): places on the tape.
    jacobian : int64 (m, n): places of df_i/dx_j.
    cheap, rest, costly : what vanishes at solutions, and is known after stage 0, 1 and 2 in turn.
    solved : int64 (k, 3): a variable and the places of two formulas, rest and slope, with
        rest + slope v = 0 for the variable's value v at each solution. They stand before
        ``solved_end``, at the beginning of the tape.
    """

    program: Program
    stages: Indices
    unknowns: Indices
    equations: Indices
    jacobian: Indices
    cheap: Indices
    rest: Indices
    costly: Indices
    nonnegative: Indices
    solved: Indices
    solved_end: int


@dataclass(frozen=True, slots=True, eq=False)
class EquationSystem:
    """Equations with what discards boxes.

    Attributes
    ----------
    tape : stage 0 has the first two equations and cheap formulas that vanish with them, stage 1 the
        other equations, stage 2 the formulas that discard boxes, stage 3 the Jacobian, row by row.
    """

    tape: Tape
    arguments: Arguments


def system(
    equations: Sequence[Formula],
    unknowns: Sequence[int],
    vanishing: tuple[Sequence[Formula], Sequence[Formula]] = ((), ()),
    nonnegative: Sequence[Formula] = (),
    jacobian: Sequence[Sequence[Formula]] | None = None,
    solved: Sequence[Quotient] = (),
) -> EquationSystem:
    """Write a system out.

    Parameters
    ----------
    equations : differentiable formulas, without a `meet` that may be empty; the two cheapest first.
    unknowns : numbers of the variables to search; for a curve the two axes come first.
    vanishing : formulas that vanish at every solution, in addition to the equations: cheap ones without a
        `meet`, then others.
    nonnegative : formulas that are at least zero at every solution looked for.
    jacobian : the equations' derivatives by the unknowns, where there are better formulas than
        those of the graph.
    solved : of formulas that vanish at solutions; their variables are among the unknowns.
    """
    if jacobian is None:
        jacobian = [gradient(f, unknowns) for f in equations]
    cheap, costly = vanishing
    first, rest = list(equations[:2]), list(equations[2:])
    tape = record([
        [formula for quotient in solved for formula in quotient[1:]],
        [*first, *cheap],
        rest,
        [*costly, *nonnegative],
        [entry for row in jacobian for entry in row],
    ])  # fmt: skip
    places, solved_end = tape.outputs[0].reshape(-1, 2), int(tape.stages[0])
    tape = replace(tape, stages=tape.stages[1:], outputs=tape.outputs[1:])
    arguments = Arguments(
        tape.program,
        tape.stages,
        np.array(unknowns, np.int64),
        np.concatenate([tape.outputs[0][: len(first)], tape.outputs[1]]),
        tape.outputs[3].reshape(len(equations), len(unknowns)),
        tape.outputs[0],
        tape.outputs[1],
        tape.outputs[2][: len(costly)],
        tape.outputs[2][len(costly) :],
        np.column_stack([np.array([variable for variable, *_ in solved], np.int64), places]),
        solved_end,
    )
    return EquationSystem(tape, arguments)


Quotient = tuple[int, Formula, Formula]
"""A variable that is -rest/slope at solutions, where the slope is not zero; the rest, the slope."""


def quotients(vanishing: Iterable[Formula], axes: Iterable[int]) -> tuple[Quotient, ...]:
    """For each axis the formulas, of those that vanish at solutions, that are linear in it.

    Parameters
    ----------
    vanishing : formulas without a `meet` that may be empty.
    axes : unknowns that follow from the configuration, as loads, stiffnesses and free lengths do.
        To solve for an axis that springs' directions depend on is sound, and no use: the direction
        of a short one may be anything.
    """
    formulas = list(dict.fromkeys(vanishing))
    return tuple(q for axis in axes for formula in formulas for q in _quotient(formula, axis))


def occurs(variable: int, formula: Formula) -> bool:
    """Whether the formula has the variable in it."""
    return any(
        n.operation is Operation.VARIABLE and n.variable == variable for n in nodes_of([formula])
    )


def _quotient(formula: Formula, axis: int) -> Iterator[Quotient]:
    graph = formula.graph
    slope = graph.derivative(formula, axis)
    # a slope that is zero nowhere for the graph's rules may be so: it is left to the search
    if slope.value != 0 and not occurs(axis, slope):
        rest = _without(axis, formula)
        if rest is not None:
            yield axis, rest, slope


def _without(variable: int, formula: Formula) -> Formula | None:
    """The formula with zero in place of the variable; None where that would be a division by zero."""
    try:
        return substituted(formula, {variable: formula.graph.constant(0)})
    except ZeroDivisionError:
        return None
