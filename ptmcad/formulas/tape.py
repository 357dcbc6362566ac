"""Tapes: formulas written out as straight-line programs, in stages, for the compiled and the exact
evaluators.

Guarantee: after the first k stages of a tape have been run, the outputs of these stages have their
values; a node that no output needs is not on the tape; every operand stands before its use.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, nextafter

import numpy as np
from numpy.typing import NDArray

from ptmcad.formulas.graph import Formula


@dataclass(frozen=True, slots=True, eq=False)
class Tape:
    """A straight-line program.

    Attributes
    ----------
    operations : int64 (n,): of `ptmcad.formulas.graph.Operation`.
    first, second : int64 (n,): the operands' places on the tape, or a variable's number, or -1.
    low, high : float64 (n,): enclosures of the constants, 0 elsewhere.
    constants : exact value of each constant by its place.
    stages : int64: the tape's length up to the end of each stage.
    outputs : for each stage, the places of its outputs in the order given.
    """

    operations: NDArray[np.int64]
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    constants: dict[int, Fraction]
    stages: NDArray[np.int64]
    outputs: tuple[NDArray[np.int64], ...]

    def __len__(self) -> int:
        return len(self.operations)


def enclosing_floats(value: Fraction) -> tuple[float, float]:
    """The nearest floats at or below and at or above a rational number; infinite beyond the floats'
    range.
    """
    try:
        nearest = float(value)
    except OverflowError:
        largest = float(np.finfo(float).max)
        return (largest, inf) if value > 0 else (-inf, -largest)
    low = nearest if Fraction(nearest) <= value else nextafter(nearest, -inf)
    high = nearest if Fraction(nearest) >= value else nextafter(nearest, inf)
    return low, high


def record(stages: Sequence[Sequence[Formula]]) -> Tape:
    """Write formulas of one graph out, stage by stage."""
    order: list[Formula] = []
    place: dict[int, int] = {}
    ends, outputs = [], []
    for stage in stages:
        for formula in stage:
            _append(formula, order, place)
        ends.append(len(order))
        outputs.append(np.array([place[formula.number] for formula in stage], np.int64))
    count = len(order)
    low, high = np.zeros(count), np.zeros(count)
    constants = {}
    for k, formula in enumerate(order):
        if formula.value is not None:
            low[k], high[k] = enclosing_floats(formula.value)
            constants[k] = formula.value
    return Tape(
        np.array([formula.operation for formula in order], np.int64),
        np.array(
            [
                formula.variable if formula.a is None else place[formula.a.number]
                for formula in order
            ],
            np.int64,
        ),
        np.array(
            [-1 if formula.b is None else place[formula.b.number] for formula in order], np.int64
        ),
        low,
        high,
        constants,
        np.array(ends, np.int64),
        tuple(outputs),
    )


def _append(formula: Formula, order: list[Formula], place: dict[int, int]) -> None:
    """Append what the formula needs and does not have yet; without recursion, formulas may be deep."""
    waiting = [formula]
    while waiting:
        node = waiting[-1]
        if node.number in place:
            waiting.pop()
            continue
        missing = [n for n in (node.a, node.b) if n is not None and n.number not in place]
        if missing:
            waiting.extend(reversed(missing))
            continue
        place[node.number] = len(order)
        order.append(node)
        waiting.pop()
