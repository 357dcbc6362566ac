"""A proved solution carried along one axis of a slice, by Krawczyk's operator with a ball for the parameter.

Guarantee: from one value to the next a box is proved to hold exactly one solution for every value between, and the
solution that one comes from lies in it: so what is reached is the same branch.

Reference: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations, 5.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat, ctx, fmpq

from ptmcad.formulas.balls import ball, run_arb
from ptmcad.formulas.graph import Formula
from ptmcad.formulas.tape import Tape, record
from ptmcad.text.balls import ball_of
from ptmcad.text.enclosure import Enclosure

Unknowns = tuple[arb, ...]
_MAX_STEPS = 2000
"""Of a continuation: their number grows with the logarithm of the distance from the fold at which it ends."""
_MAX_HALVINGS = 80
"""Of a step, before it is given up."""
_MAX_PASSES = 8
"""Of Krawczyk's operator over one range of values."""


@dataclass(frozen=True, slots=True)
class BranchEquations:
    """Equations along an axis, as many as unknowns.

    Attributes
    ----------
    size : the number of equations.
    tape : of one stage: the equations, their derivatives by the unknowns row by row, and those by the axis. Variables
        0 and 1 are the two axes, the others the unknowns.
    varying : the number of the axis.
    fixed : the value of the other one.
    """

    size: int
    tape: Tape
    varying: int
    fixed: Fraction

    def box(self, value: arb, unknowns: Sequence[arb]) -> tuple[arb, ...]:
        """All variables, at a ball of values."""
        fixed = ball_of(self.fixed)
        return (*((value, fixed) if self.varying == 0 else (fixed, value)), *unknowns)

    def run(self, value: arb, unknowns: Sequence[arb]) -> tuple[arb_mat, arb_mat, arb_mat]:
        """The equations as a column, their Jacobian, and their derivatives by the axis as a column."""
        n = self.size
        values = run_arb(self.tape, self.box(value, unknowns), ctx.prec)
        outputs = [values[int(place)] for place in self.tape.outputs[0]]
        return (
            arb_mat(n, 1, outputs[:n]),
            arb_mat(n, n, outputs[n : n * (n + 1)]),
            arb_mat(n, 1, outputs[n * (n + 1) :]),
        )


@dataclass(frozen=True, slots=True)
class ProvedPoint:
    """A branch at one value, in narrow balls."""

    value: Fraction
    unknowns: Unknowns


def branches(equations: Sequence[Formula], varying: int, fixed: Fraction) -> BranchEquations:
    """The formulas of some equations in the two axes and the unknowns, variables from 2 on."""
    graph, size = equations[0].graph, len(equations)
    rows = [graph.derivative(f, k + 2) for f in equations for k in range(size)]
    rises = [graph.derivative(f, varying) for f in equations]
    return BranchEquations(size, record([[*equations, *rows, *rises]]), varying, fixed)


def located(at: BranchEquations, value: Fraction, near: Sequence[Enclosure]) -> ProvedPoint | None:
    """The solution that is proved to be the only one about some enclosures; None where that is not proved."""
    radius = max(x.radius for x in near)
    center = tuple(ball_of(x.center).mid() for x in near)
    here = ball_of(value)
    found = _enclosed(at, here, center, [ball_of(2 * radius).upper()] * at.size)
    return None if found is None else ProvedPoint(value, _narrowed(at, here, found))


def carried(at: BranchEquations, start: ProvedPoint, end: Fraction) -> ProvedPoint:
    """The branch at another value, or as near to it as it can be carried, at the context's precision."""
    place, step = start, end - start.value
    for _ in range(_MAX_STEPS):
        if place.value == end:
            break
        for _ in range(_MAX_HALVINGS):
            goal = end if abs(step) >= abs(end - place.value) else place.value + _short(step)
            found = over(at, place, Enclosure(goal, goal))
            if found is not None:
                break
            step = step / 2
        else:
            break
        place, step = ProvedPoint(goal, found), 2 * step
    return place


def over(at: BranchEquations, start: ProvedPoint, goal: Enclosure) -> Unknowns | None:
    """The branch at all values of an enclosure, in one box; None where that is not proved."""
    values = ball(min(start.value, goal.low), max(start.value, goal.high))
    center = tuple(x.mid() for x in start.unknowns)
    least = arb(fmpq(1, 2 ** (ctx.prec // 2)))
    found = _enclosed(at, values, center, [least] * at.size)
    if found is None or not all(a.contains(b) for a, b in zip(found, start.unknowns, strict=True)):
        return None
    return _narrowed(at, ball(goal.low, goal.high), found)


def _short(step: Fraction) -> Fraction:
    """About a step, with few digits."""
    exponent = step.numerator.bit_length() - step.denominator.bit_length() - 8
    unit = Fraction(2) ** exponent
    return round(step / unit) * unit


def _enclosed(at: BranchEquations, values: arb, center: Unknowns, least: Sequence[arb]) -> Unknowns | None:
    """A box around a center that holds exactly one solution for each of some values; None where that is not proved."""
    middle, unit = values.mid(), arb(0, 1)
    residual, jacobian, _ = at.run(middle, center)
    inverse = _inverse(jacobian)
    if inverse is None:
        return None
    rise = at.run(values, center)[2]
    move = inverse * (residual + rise * arb_mat(1, 1, [values - middle]))
    if not all(move[k, 0].is_finite() for k in range(at.size)):
        return None
    reach = [(2 * abs(move[k, 0]).upper() + least[k]).upper() for k in range(at.size)]
    for _ in range(_MAX_PASSES):
        spread = arb_mat(at.size, 1, [r * unit for r in reach])
        box = tuple(c + spread[k, 0] for k, c in enumerate(center))
        image = _image(at, values, box, inverse, spread) - move
        if not all(image[k, 0].is_finite() for k in range(at.size)):
            return None
        if all(abs(image[k, 0]) < reach[k] for k in range(at.size)):
            return box
        reach = [(abs(image[k, 0]).upper() * 3 / 2 + least[k]).upper() for k in range(at.size)]
    return None


def _image(at: BranchEquations, values: arb, box: Unknowns, inverse: arb_mat, spread: arb_mat) -> arb_mat:
    identity = arb_mat(at.size, at.size, [int(i == j) for i in range(at.size) for j in range(at.size)])
    return (identity - inverse * at.run(values, box)[1]) * spread


def _narrowed(at: BranchEquations, values: arb, box: Unknowns) -> Unknowns:
    """The solution that a box holds at each of some values, as narrow as the operator makes it."""
    while True:
        center = tuple(x.mid() for x in box)
        residual, jacobian, _ = at.run(values.mid(), center)
        inverse = _inverse(jacobian)
        if inverse is None:
            return box
        rise = at.run(values, center)[2]
        spread = arb_mat(at.size, 1, [x - x.mid() for x in box])
        image = _image(at, values, box, inverse, spread) - inverse * (
            residual + rise * arb_mat(1, 1, [values - values.mid()])
        )
        smaller = tuple((c + image[k, 0]) for k, c in enumerate(center))
        if not all(a.is_finite() and a.overlaps(b) for a, b in zip(smaller, box, strict=True)):
            return box
        smaller = tuple(a.intersection(b) for a, b in zip(smaller, box, strict=True))
        if not all(2 * a.rad() < b.rad() for a, b in zip(smaller, box, strict=True)):
            return smaller
        box = smaller


def _inverse(matrix: arb_mat) -> arb_mat | None:
    """An approximate inverse with exact entries."""
    size = matrix.nrows()
    try:
        found = arb_mat(size, size, [x.mid() for x in matrix.entries()]).inv()
    except ZeroDivisionError:
        return None
    entries = [x.mid() for x in found.entries()]
    return arb_mat(size, size, entries) if all(x.is_finite() for x in entries) else None
