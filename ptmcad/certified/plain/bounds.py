"""Ranges of the unknowns that hold all solutions over a window: a full turn of each angle, proved bounds of the others.

Guarantee: over the closed window no solution has a real unknown outside of its range, nor one that comes to infinity.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from ptmcad.certified.evaluation import Floats, program, run
from ptmcad.certified.formula import Operation
from ptmcad.certified.plain.chart import chart
from ptmcad.certified.plain.problem import FIRST, Problem
from ptmcad.certified.tape import Tape, enclosing_floats, record
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Axis

TURN = (-3.0, -3.0 + 6.2832)
"""A little more than a full turn, cut where no symmetric solution lies."""
DOUBLINGS = range(-10, 41)
"""Powers of two that are tried as bounds."""
MAX_BOXES = 400
"""For one bound; each is halved along an axis or an angle where the equations do not exclude it."""

Range = tuple[float, float]


def ranges(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Range, ...]:
    """The range of each unknown.

    Raises
    ------
    ConfigError
        With the unknown, when no bound of it could be proved.
    """
    window = [(enclosing_floats(axis.low)[0], enclosing_floats(axis.high)[1]) for axis in axes]
    everywhere = [(-inf, inf) if name in problem.reals else TURN for name in problem.unknowns]
    at = chart(problem)
    tape = _without_squares(record([at.equations]))
    found = list(everywhere)
    for k, name in enumerate(problem.unknowns):
        if name in problem.reals:
            # the ranges that are known serve to bound the others
            bound = _bound(tape, np.array([*window, *found]), FIRST + k, name)
            found[k] = (-bound, bound)
    return tuple(found)


def _without_squares(tape: Tape) -> Tape:
    """Products in place of squares, of which the evaluator encloses unbounded ones by [0, inf]."""
    squares = tape.operations == Operation.SQUARE
    return replace(
        tape,
        operations=np.where(squares, Operation.MULTIPLY, tape.operations),
        second=np.where(squares, tape.first, tape.second),
    )


def _bound(tape: Tape, box: Floats, variable: int, name: str) -> float:
    """The least power of two beyond which the unknown has no solution."""
    for power in DOUBLINGS:
        bound = 2.0**power
        above, below = box.copy(), box.copy()
        above[variable] = bound, inf
        below[variable] = -inf, -bound
        if _empty(tape, above) and _empty(tape, below):
            return bound
    raise ConfigError(
        f"no bound of the unknown {name} could be proved over the window, and the certified engine searches a bounded "
        "box: choose exact, or narrow the window",
        key="engine",
    )


def _empty(tape: Tape, box: Floats) -> bool:
    """Whether it is proved that the equations have no zero in a box; shape (variables, 2), infinite ends included."""
    low, high = np.empty((2, len(tape)))
    finite = np.isfinite(box).all(axis=1)
    waiting, treated = [box], 0
    while waiting:
        part = waiting.pop()
        treated += 1
        run(program(tape), part[:, 0].copy(), part[:, 1].copy(), low, high, 0, len(tape))
        if any(low[k] > 0 or high[k] < 0 for k in tape.outputs[0]):
            continue
        widths = np.zeros(len(box))
        widths[finite] = (part[finite, 1] - part[finite, 0]) / (box[finite, 1] - box[finite, 0])
        widest = int(np.argmax(widths))
        if treated >= MAX_BOXES or widths[widest] < 1e-3:
            return False
        middle = part[widest].mean()
        for side in (0, 1):
            half = part.copy()
            half[widest, side] = middle
            waiting.append(half)
    return True
