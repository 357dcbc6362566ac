"""What holds at a critical value at which a branch ends, for springs with free lengths: a pose
there, and energies.

Guarantee: every enclosure holds the number at the critical value, wherever that lies in its own
enclosure. The pose that is reached is proved to be the branch of the one beyond. The energy of the
branch that ends differs from that at a place beside by no more than the distance times the largest
slope: along a branch of critical points the energy changes with the parameter alone, which is
bounded on the torus.

Not guaranteed: that the branch ends in the degenerate pose that Newton's method finds from its last
place. That pose is proved, it lies at the critical value, and its energy is one that the branch may
have there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx

from ptmcad.answer.paths import Landing, PathPoint, Target
from ptmcad.formulas.ballarithmetic import evaluated, signs_of
from ptmcad.formulas.continuation import (
    BranchEquations,
    Reached,
    at_value,
    branch_equations,
    in_the_limit,
    nearer,
    over_range,
)
from ptmcad.formulas.evaluation import substituted
from ptmcad.formulas.graph import Formula, determinant, gradient
from ptmcad.model import Mechanism
from ptmcad.question.line import compiled_on
from ptmcad.text.balls import ball_of, ball_over, enclosure_of
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.expressions import Expression

BITS = 192
_NEAREST = Fraction(1, 2**60)
"""How near to a critical value a branch is carried, against its distance."""


class LineFormulas(NamedTuple):
    """A mechanism on unknown angles, on a line: variable 0 is the axis, the next ones are the
    angles.

    Attributes
    ----------
    equations : of equilibrium.
    folds : the same and the Hessian's determinant, with the axis as a further unknown, the last
        one, and no parameter.
    numbers : the energy, and the heights of the rising points.
    """

    equations: BranchEquations
    folds: BranchEquations
    numbers: Sequence[Formula]


def line_formulas(mechanism: Mechanism, parameters: Mapping[str, Expression]) -> LineFormulas:
    """The formulas of a mechanism on a line, from its parameters there."""
    at = compiled_on(mechanism, parameters)
    energy = at.energy()
    assert energy is not None
    slopes = gradient(energy, at.unknowns)
    hessian = [gradient(f, at.unknowns) for f in slopes]
    heights = (at.points[name][1] for name in mechanism.rising)
    axis = {0: at.graph.variable(len(slopes) + 1)}
    folds = [substituted(f, axis) for f in (*slopes, determinant(hessian))]
    return LineFormulas(
        branch_equations(slopes, len(slopes)),
        branch_equations(folds, len(slopes)),
        [energy, *heights],
    )


def landing(
    line: LineFormulas, at: Enclosure, last: PathPoint, beyond: PathPoint
) -> Landing | None:
    """What holds at a critical value; None where that is not proved.

    Parameters
    ----------
    at : of the only critical value between the two places.
    last : the branch that ends there.
    beyond : the pose that is reached, which is simple there.
    """
    with ctx.workprec(BITS):
        after, energy = _located(line, beyond), _energy_at(line, at, last)
        if after is None or energy is None:
            return None
        end = at.low if after.value < at.low else at.high
        near = nearer(line.equations, after, end + (after.value - end) * _NEAREST)
        tube = over_range(line.equations, near, at.low, at.high)
        if tube is None:
            return None
        there = tube.hull()
        reached, *heights = evaluated(line.numbers, (ball_over(at.low, at.high), *there))
        return Landing(
            Target(tuple(map(enclosure_of, there)), (), signs_of(heights)),
            energy,
            enclosure_of(reached),
        )


def merger(line: LineFormulas, at: Enclosure, last: PathPoint, beyond: PathPoint) -> Landing | None:
    """The same where the pose beyond is what several become, of which ``last`` is one; None where
    that is not proved.

    The pose in which they merge is told, without proof, to lie about where those on both sides are,
    no farther off than these are from each other; an angle beyond that is not told from half turns,
    as that of a flat pose, is one of them.
    """
    energy = _energy_at(line, at, last)
    if energy is None:
        return None
    angles = tuple(
        b
        if (ball_of(b.low).union(ball_of(b.high)) / arb.pi()).contains_integer()
        else _around(a, b)
        for a, b in zip(last.angles, beyond.angles, strict=True)
    )
    return Landing(Target(angles, (), beyond.sides), energy, energy)


def _around(first: Enclosure, second: Enclosure) -> Enclosure:
    """The hull of two enclosures, three times as wide."""
    low, high = min(first.low, second.low), max(first.high, second.high)
    return Enclosure(2 * low - high, 2 * high - low)


def _energy_at(line: LineFormulas, at: Enclosure, last: PathPoint) -> Enclosure | None:
    """The energy of a branch at the critical value at which it ends; None where the branch is not
    proved.
    """
    with ctx.workprec(BITS):
        place = _located(line, last)
        if place is None:
            return None
        limit = in_the_limit(line.numbers[0], place, at.low, at.high, line.equations.angles)
        fold = _fold(line, at, place)
        if fold is None:
            return enclosure_of(limit)
        (energy,) = evaluated(line.numbers[:1], fold)
        return enclosure_of(energy if limit.contains(energy) else limit)


def _located(line: LineFormulas, point: PathPoint) -> Reached | None:
    """A pose's branch: the solution that is proved to be the only one about its enclosures; None
    without proof.
    """
    guess = tuple(ball_of(angle.center) for angle in point.angles)
    place = at_value(
        line.equations, point.value, guess, 2 * max(angle.radius for angle in point.angles)
    )
    if place is None or not all(
        a.contains(ball_over(b.low, b.high))
        for a, b in zip(place.alone(point.value), point.angles, strict=True)
    ):
        return None
    return Reached(point.value, place, place)


def _fold(line: LineFormulas, at: Enclosure, place: Reached) -> tuple[arb, ...] | None:
    """The degenerate pose at a critical value that Newton's method finds from a place beside; None
    without proof.
    """
    tube = at_value(line.folds, Fraction(0), (*place.point, ball_of(at.center)))
    if tube is None:
        return None
    *angles, value = tube.hull()
    return (value, *angles) if value.overlaps(ball_over(at.low, at.high)) else None
