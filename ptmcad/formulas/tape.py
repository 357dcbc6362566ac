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
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ptmcad.formulas.evaluation import nodes_of
from ptmcad.formulas.graph import Formula

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Places = NDArray[np.uint64]
"""Without a sign: of each signed index compiled code asks whether it is negative, which costs a
tenth of the time.
"""
NO_OPERAND = 2**64 - 1
"""Of what has fewer than two; never an index."""


class Program(NamedTuple):
    """The operations of a tape, as compiled code takes them.

    Attributes
    ----------
    operations : of `ptmcad.formulas.graph.Operation`.
    first, second : the operands' places on the tape, or a variable's number, or `NO_OPERAND`.
    constant_low, constant_high : enclosures of the constants, 0 elsewhere.
    """

    operations: Indices
    first: Places
    second: Places
    constant_low: Floats
    constant_high: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Tape:
    """A straight-line program.

    Attributes
    ----------
    constants : exact value of each constant by its place.
    stages : int64: the tape's length up to the end of each stage.
    outputs : for each stage, the places of its outputs in the order given.
    """

    program: Program
    constants: dict[int, Fraction]
    stages: Indices
    outputs: tuple[Indices, ...]

    def __len__(self) -> int:
        return len(self.program.operations)


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
        for formula in nodes_of(stage):
            if formula.number not in place:
                place[formula.number] = len(order)
                order.append(formula)
        ends.append(len(order))
        outputs.append(np.array([place[formula.number] for formula in stage], np.int64))
    count = len(order)
    low, high = np.zeros(count), np.zeros(count)
    constants = {}
    for k, formula in enumerate(order):
        if formula.value is not None:
            low[k], high[k] = enclosing_floats(formula.value)
            constants[k] = formula.value
    first = [f.variable if f.a is None else place[f.a.number] for f in order]
    second = [NO_OPERAND if f.b is None else place[f.b.number] for f in order]
    program = Program(
        np.array([formula.operation for formula in order], np.int64),
        np.array([NO_OPERAND if k < 0 else k for k in first], np.uint64),
        np.array(second, np.uint64),
        low,
        high,
    )
    return Tape(program, constants, np.array(ends, np.int64), tuple(outputs))
