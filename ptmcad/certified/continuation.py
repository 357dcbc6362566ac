"""A proved solution carried along one axis of a slice, by Newton's operator with a ball for the parameter.

Guarantee: from one value to the next a box is proved to hold exactly one solution for every value between, and the
solution that one comes from lies in it: so what is reached is the same branch. (As of `arb_isolation`, for each of the
values: what is fixed there may be a ball.)

Reference: Neumaier, Interval Methods for Systems of Equations, 5.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, ctx, fmpq

from ptmcad.certified.arb_isolation import Box, approached, newton, refined
from ptmcad.certified.system import EquationSystem
from ptmcad.formulas.balls import ball
from ptmcad.text.balls import ball_of
from ptmcad.text.enclosure import Enclosure

Unknowns = tuple[arb, ...]
_MAX_STEPS = 2000
"""Of a continuation: their number grows with the logarithm of the distance from the fold at which it ends."""
_MAX_HALVINGS = 80
"""Of a step, before it is given up."""
_MAX_PASSES = 8
"""Of the operator over one range of values, in ever larger boxes."""


@dataclass(frozen=True, slots=True)
class BranchEquations:
    """Equations along an axis, as many as unknowns.

    Attributes
    ----------
    system : in the unknowns, variables from 2 on; variables 0 and 1 are the two axes.
    varying : the number of the axis.
    fixed : the value of the other one.
    """

    system: EquationSystem
    varying: int
    fixed: Fraction

    def box(self, value: arb, unknowns: Sequence[arb]) -> Box:
        """All variables, at a ball of values."""
        fixed = ball_of(self.fixed)
        return (*((value, fixed) if self.varying == 0 else (fixed, value)), *unknowns)


@dataclass(frozen=True, slots=True)
class ProvedPoint:
    """A branch at one value, in narrow balls."""

    value: Fraction
    unknowns: Unknowns


def located(at: BranchEquations, value: Fraction, near: Sequence[Enclosure]) -> ProvedPoint | None:
    """The solution that is proved to be the only one about some enclosures; None where that is not proved."""
    least = ball_of(2 * max(x.radius for x in near)).upper()
    found = _enclosed(at, ball_of(value), tuple(ball_of(x.center).mid() for x in near), least)
    return None if found is None else ProvedPoint(value, _narrowed(at, ball_of(value), found))


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
    least = arb(fmpq(1, 2 ** (ctx.prec // 2)))
    found = _enclosed(at, values, tuple(x.mid() for x in start.unknowns), least)
    if found is None or not all(a.contains(b) for a, b in zip(found, start.unknowns, strict=True)):
        return None
    return _narrowed(at, ball(goal.low, goal.high), found)


def _short(step: Fraction) -> Fraction:
    """About a step, with few digits."""
    exponent = step.numerator.bit_length() - step.denominator.bit_length() - 8
    unit = Fraction(2) ** exponent
    return round(step / unit) * unit


def _enclosed(at: BranchEquations, values: arb, center: Unknowns, least: arb) -> Unknowns | None:
    """A box around a center that holds exactly one solution for each of some values; None where that is not proved."""
    there = approached(at.system, at.box(values.mid(), center), 1)
    if there is None:
        return None
    # from one end of the values to their middle a solution goes half of its way
    reach = [(4 * abs(x - c) + least).upper() for x, c in zip(there[2:], center, strict=True)]
    for _ in range(_MAX_PASSES):
        box = tuple(arb(c, r) for c, r in zip(center, reach, strict=True))
        step = newton(at.system, at.box(values, box), ctx.prec) if all(x.is_finite() for x in box) else None
        if step is not None and step[1]:
            return box
        reach = [2 * r for r in reach]
    return None


def _narrowed(at: BranchEquations, values: arb, box: Unknowns) -> Unknowns:
    """The solution that a box holds at each of some values, as narrow as the operator makes it."""
    return refined(at.system, at.box(values, box), ctx.prec)[2:]
