"""Systems of equations in a box: what a search looks for, as a tape with named outputs.

Guarantee: a `System` says which points are solutions: those at which the equations vanish and the nonnegative formulas
are at least zero. Everything else in it holds at each solution and serves to discard boxes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.solved import Quotient
from ptmcad.formulas.graph import Formula, Operation
from ptmcad.formulas.intervals import Indices, Program, program
from ptmcad.formulas.tape import Tape, record


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """Equations f = 0 (m of them) in n unknowns, n = m (points) or m + 1 (curves).

    Attributes
    ----------
    tape : stage 0 has the first two equations and cheap formulas that vanish with them, stage 1 the other equations,
        stage 2 the formulas that discard boxes, stage 3 the Jacobian, row by row.
    unknowns : int64 (n,): the numbers of the variables that are searched; others are fixed (narrow) intervals.
    equations : int64 (m,): places on the tape.
    jacobian : int64 (m, n): places of df_i/dx_j.
    solved : int64 (k, 3): a variable and the places of two formulas, rest and slope, with rest + slope v = 0 for the
        variable's value v at each solution. They stand before ``solved_end``, at the beginning of the tape.
    """

    tape: Tape
    unknowns: Indices
    equations: Indices
    jacobian: Indices
    vanishing: tuple[Indices, Indices, Indices]
    nonnegative: Indices
    solved: Indices
    solved_end: int

    def arguments(self) -> Arguments:
        """The system as the compiled code takes it."""
        return Arguments(
            program(self.tape), self.tape.stages, self.unknowns, self.equations, self.jacobian,
            *self.vanishing, self.nonnegative, self.solved, self.solved_end,
        )  # fmt: skip


class Arguments(NamedTuple):
    """A `System` for compiled code; what vanishes at solutions is known after stage 0, 1 and 2 in turn."""

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


def system(
    equations: Sequence[Formula],
    unknowns: Sequence[int],
    vanishing: tuple[Sequence[Formula], Sequence[Formula]] = ((), ()),
    nonnegative: Sequence[Formula] = (),
    jacobian: Sequence[Sequence[Formula]] | None = None,
    solved: Sequence[Quotient] = (),
) -> System:
    """Write a system out.

    Parameters
    ----------
    equations : differentiable formulas, without a `meet` that may be empty; the two cheapest first.
    unknowns : numbers of the variables to search; for a curve the two axes come first.
    vanishing : formulas that vanish at every solution, beside the equations: cheap ones without a `meet`, then others.
    nonnegative : formulas that are at least zero at every solution looked for.
    jacobian : the equations' derivatives by the unknowns, where there are better formulas than those of the graph.
    solved : of formulas that vanish at solutions; their variables are among the unknowns.
    """
    graph = equations[0].graph
    if jacobian is None:
        jacobian = [[graph.derivative(f, x) for x in unknowns] for f in equations]
    cheap, costly = vanishing
    first, rest = list(equations[:2]), list(equations[2:])
    tape = record([
        [formula for quotient in solved for formula in (quotient.rest, quotient.slope)],
        [*first, *cheap],
        rest,
        [*costly, *nonnegative],
        [entry for row in jacobian for entry in row],
    ])  # fmt: skip
    places, solved_end = tape.outputs[0].reshape(-1, 2), int(tape.stages[0])
    tape = replace(tape, stages=tape.stages[1:], outputs=tape.outputs[1:])
    return System(
        tape,
        np.array(unknowns, np.int64),
        np.concatenate([tape.outputs[0][: len(first)], tape.outputs[1]]),
        tape.outputs[3].reshape(len(equations), len(unknowns)),
        (tape.outputs[0], tape.outputs[1], tape.outputs[2][: len(costly)]),
        tape.outputs[2][len(costly) :],
        np.column_stack([np.array([quotient.variable for quotient in solved], np.int64), places]),
        solved_end,
    )


def equations_alone(whole: System) -> System:
    """The same equations and derivatives, on a tape without anything else: at points that are no solutions, formulas
    that are equal at solutions only may exclude each other."""
    tape = whole.tape
    first = _needed(tape, whole.equations)
    rest = _needed(tape, whole.jacobian.ravel()) & ~first
    order = np.concatenate([np.flatnonzero(first), np.flatnonzero(rest)])
    place = np.full(len(tape) + 1, -1, np.int64)  # the last one stands for no operand
    place[order] = np.arange(len(order))
    plain = np.isin(tape.operations[order], _WITHOUT_OPERANDS)
    equations = int(first.sum())
    shorter = Tape(
        tape.operations[order],
        np.where(plain, tape.first[order], place[tape.first[order]]),
        np.where(plain, tape.second[order], place[tape.second[order]]),
        tape.low[order],
        tape.high[order],
        {int(place[k]): value for k, value in tape.constants.items() if place[k] >= 0},
        np.array([equations, equations, equations, len(order)], np.int64),
        (),
    )
    none = np.empty(0, np.int64)
    return System(
        shorter, whole.unknowns, place[whole.equations], place[whole.jacobian], (none, none, none), none,
        np.empty((0, 3), np.int64), 0,
    )  # fmt: skip


_WITHOUT_OPERANDS = (int(Operation.CONSTANT), int(Operation.VARIABLE))


def _needed(tape: Tape, outputs: Indices) -> NDArray[np.bool_]:
    """Which nodes of a tape some outputs need."""
    needed = np.zeros(len(tape), dtype=np.bool_)
    needed[outputs] = True
    for k in range(len(tape) - 1, -1, -1):
        if needed[k] and tape.operations[k] not in _WITHOUT_OPERANDS:
            for operand in (tape.first[k], tape.second[k]):
                if operand >= 0:
                    needed[operand] = True
    return needed
