"""Solutions along a parameter, enclosed and followed by Krawczyk's operator in balls, in any number
of unknowns.

Guarantee: a `BranchTube` that `enclose` returns holds, for every value of the parameter in its
range, exactly one solution, which is nondegenerate and depends smoothly on the parameter. Two tubes
are taken to hold the same branch only where a third one, for a value that both cover, lies inside
both. So `follow` never jumps to another branch.

Reference: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations, 5.1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat, ctx, fmpq

from ptmcad.formulas.ballarithmetic import evaluated, run_arb
from ptmcad.formulas.graph import Formula
from ptmcad.formulas.tape import Tape, record
from ptmcad.text.balls import ball_of, ball_over
from ptmcad.text.flint_numbers import simplest_fraction

BITS = 160
_MIN_STEP = Fraction(1, 2**60)
"""Steps shorter than this, against the distance to be gone, are not tried."""
_MAX_STEPS = 3000
"""Where a branch comes ever nearer to others, steps shrink with the distance and their number has
no bound.
"""
_MAX_PASSES = 8
"""Of Krawczyk's operator over one range of values."""
_MAX_NEAR = 1000
"""Of which the way to a fold takes some hundred; to a pitchfork, of which fewer digits are known,
it takes them all.
"""

_WHOLE = arb(1)

Vector = tuple[arb, ...]
"""One ball for each unknown: the angles, then those on the line."""


@dataclass(frozen=True, slots=True)
class BranchEquations:
    """Equations along a parameter, as many as unknowns; variable 0 is the parameter, the next ones
    are the unknowns.

    Attributes
    ----------
    size : the number of equations.
    angles : how many of the unknowns are on the circle: the first ones.
    tape : of four stages: the equations; their derivatives by the unknowns, row by row; those by
        the parameter; the derivatives of the second stage by the parameter and by each unknown,
        then the third stage's by the parameter.
    """

    size: int
    angles: int
    tape: Tape

    def residuals(self, value: arb, point: arb_mat) -> arb_mat:
        return arb_mat(self.size, 1, self._outputs(0, value, point))

    def jacobian(self, value: arb, point: arb_mat) -> arb_mat:
        return arb_mat(self.size, self.size, self._outputs(1, value, point))

    def slope(self, value: arb, point: arb_mat) -> arb_mat:
        """The derivative of the equations by the parameter."""
        return arb_mat(self.size, 1, self._outputs(2, value, point))

    def second(self, value: arb, point: arb_mat) -> tuple[arb_mat, list[arb_mat], arb_mat]:
        """The Jacobian's derivative by the parameter, that by each unknown, and the slope's by the
        parameter.
        """
        n, outputs = self.size, self._outputs(3, value, point)
        square = n * n
        mixed, *by = (arb_mat(n, n, outputs[k * square : (k + 1) * square]) for k in range(n + 1))
        return mixed, by, arb_mat(n, 1, outputs[(n + 1) * square :])

    def bend(self, value: arb, point: arb_mat, velocity: arb_mat) -> arb_mat:
        """The second derivative of the equations by the parameter along a straight line of
        unknowns.
        """
        mixed, by, total = self.second(value, point)
        total = total + mixed * velocity * 2
        for derivative, speed in zip(by, velocity.entries(), strict=True):
            total = total + derivative * velocity * speed
        return total

    def _outputs(self, stage: int, value: arb, point: arb_mat) -> list[arb]:
        values = run_arb(self.tape, (value, *point.entries()), ctx.prec, stage + 1)
        return [values[int(place)] for place in self.tape.outputs[stage]]


def branch_equations(
    equations: Sequence[Formula],
    angles: int,
    jacobian: Sequence[Formula] = (),
    gradients: Sequence[Sequence[Formula]] = (),
) -> BranchEquations:
    """The formulas of some equations in the parameter and the unknowns, of which so many are
    angles.

    Parameters
    ----------
    jacobian : their derivatives by the unknowns, row by row, where there are better formulas than
        those of the graph.
    gradients : and of each of these the derivatives by the unknowns.
    """
    derivative, unknowns = equations[0].graph.derivative, range(1, len(equations) + 1)
    rows = jacobian or [derivative(f, k) for f in equations for k in unknowns]
    by = gradients or [[derivative(entry, k) for k in unknowns] for entry in rows]
    rises = [derivative(f, 0) for f in equations]
    mixed, bends = ([derivative(f, 0) for f in formulas] for formulas in (rows, rises))
    second = [*mixed, *(f for column in zip(*by, strict=True) for f in column), *bends]
    return BranchEquations(len(equations), angles, record([equations, rows, rises, second]))


@dataclass(frozen=True, slots=True)
class BranchTube:
    """A box of unknowns that moves with the parameter x: center + velocity (x - middle) + (a box
    around 0).

    For every x from low to high there is one solution in the box ``unique``, and it lies in the box
    ``tight``; all are columns.
    """

    low: Fraction
    high: Fraction
    center: arb_mat
    velocity: arb_mat
    unique: arb_mat
    tight: arb_mat

    def at(self, value: Fraction) -> Vector:
        """An enclosure of the unknowns at one value."""
        return self._moved(value - self._middle, self.tight)

    def hull(self) -> Vector:
        """An enclosure of the unknowns at all values."""
        return self._moved((self.high - self.low) / 2, self.tight, arb(0, 1))

    def alone(self, value: Fraction) -> Vector:
        """Where the solution at one value is the only one."""
        return self._moved(value - self._middle, self.unique)

    def holds(self, other: BranchTube, value: Fraction) -> bool:
        """Whether the other tube's solution at a value lies where this one's is the only one."""
        return all(a.contains(b) for a, b in zip(self.alone(value), other.at(value), strict=True))

    @property
    def _middle(self) -> Fraction:
        return (self.low + self.high) / 2

    def _moved(self, offset: Fraction, box: arb_mat, shares: arb = _WHOLE) -> Vector:
        with ctx.workprec(BITS):
            along = self.velocity * (ball_of(offset) * shares)
            return tuple((self.center + along + box).entries())


def enclose(
    equations: BranchEquations,
    low: Fraction,
    high: Fraction,
    guess: Vector,
    room: Fraction = Fraction(0),
) -> BranchTube | None:
    """A tube around the branch near a guess for the middle of the range; None when not proved.

    Parameters
    ----------
    room : how far the box reaches at least that holds no other solution.

    Notes
    -----
    With the tube's center c(x) and w the distance from it, Krawczyk's operator is applied to g(x,
    w) = f(c(x) + w, x) for all x at once; g(x, 0) comes from the mean value theorem in x,
    multiplied by the approximate inverse first. Where that fails the Jacobian comes from the mean
    value theorem too. Near a place where branches merge, at a distance d, it is nearly singular: as
    balls of a step h make it, it would be off by h, and steps could be no longer than its
    determinant, which is d^(3/2) times a constant at a pitchfork, d^2 where branches cross. Its
    derivative along the branch is known far better, so that steps are in proportion to d.
    """
    with ctx.workprec(BITS):
        middle, over = ball_of((low + high) / 2), ball_over(low, high)
        center = _polished(equations, middle, arb_mat(equations.size, 1, guess))
        jacobian = equations.jacobian(middle, center)
        inverse = _inverse(jacobian)
        if inverse is None:
            return None
        slope = equations.slope(middle, center)
        velocity = (-(inverse * slope)).mid()
        ahead = ball_of((high - low) / 2) * arb(0, 1)
        swept, start = center + velocity * ahead, inverse * equations.residuals(middle, center)
        least = [e + ball_of(room) for e in _least(center, equations.angles)]

        def slopes(spread: arb_mat) -> arb_mat:
            return inverse * equations.jacobian(over, swept + spread)

        def centered_slopes(spread: arb_mat) -> arb_mat:
            """From the Jacobian at the center and its derivatives in the whole box."""
            mixed, by, _ = equations.second(over, swept + spread)
            by = [inverse * derivative for derivative in by]
            along, beside = inverse * mixed, inverse * jacobian
            for derivative, speed, reach in zip(
                by, velocity.entries(), spread.entries(), strict=True
            ):
                along, beside = along + derivative * speed, beside + derivative * reach
            return beside + along * ahead

        drift = (
            inverse * equations.slope(over, swept)
            + inverse * equations.jacobian(over, swept) * velocity
        )
        found = _krawczyk(equations.angles, start + drift * ahead, least, slopes)
        if found is None and low < high:
            drift = (
                inverse * (slope + jacobian * velocity)
                + inverse * equations.bend(over, swept, velocity) * ahead
            )
            found = _krawczyk(equations.angles, start + drift * ahead, least, centered_slopes)
        return None if found is None else BranchTube(low, high, center, velocity, *found)


def _krawczyk(
    angles: int, move: arb_mat, least: Sequence[arb], slopes: Callable[[arb_mat], arb_mat]
) -> tuple[arb_mat, arb_mat] | None:
    """Boxes around a moving center: one that holds a single solution at each value, and one in
    which it lies.

    Parameters
    ----------
    move : what Newton's method takes off the center.
    least : how far the boxes reach at least.
    slopes : the approximate inverse times the Jacobian in such a box.
    """
    size, moves = len(least), move.entries()
    identity = arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
    reach = [2 * abs(m).upper() + e for m, e in zip(moves, least, strict=True)]
    for _ in range(_MAX_PASSES):
        spread = arb_mat(size, 1, [r * arb(0, 1) for r in reach])
        image = (identity - slopes(spread)) * spread - move
        images = [abs(k) for k in image.entries()]
        if all(k < r for k, r in zip(images, reach, strict=True)):
            return spread, image
        reach = [(k.upper() * 3 / 2 + e).upper() for k, e in zip(images, least, strict=True)]
        if not all(r < 2 for r in reach[:angles]) or not all(r.is_finite() for r in reach):
            return None
    return None


def _least(center: arb_mat, angles: int) -> list[arb]:
    """The least reach of a tube in each unknown, a little more than what rounding does to it."""
    least = arb(fmpq(1, 2 ** (BITS - 20)))
    return [
        least if k < angles else (least * (1 + abs(c))).upper()
        for k, c in enumerate(center.entries())
    ]


def _inverse(matrix: arb_mat) -> arb_mat | None:
    """An approximate inverse with exact entries."""
    try:
        found = matrix.mid().inv().mid()
    except ZeroDivisionError:
        return None
    return found if all(x.is_finite() for x in found.entries()) else None


def _polished(equations: BranchEquations, value: arb, guess: arb_mat) -> arb_mat:
    """A few steps of Newton's method, without guarantee."""
    point = guess.mid()
    for _ in range(5):
        inverse = _inverse(equations.jacobian(value, point))
        if inverse is None:
            break
        move = inverse * equations.residuals(value, point)
        if not all(abs(m) < 1 for m in move.entries()[: equations.angles]):
            break
        point = (point - move).mid()
    return point


@dataclass(frozen=True, slots=True)
class Reached:
    """A value of the parameter with the branch's place there; ``over`` covers the branch since the
    last one.
    """

    value: Fraction
    place: BranchTube
    over: BranchTube

    @property
    def point(self) -> Vector:
        """The unknowns."""
        return self.place.at(self.value)


def at_value(
    equations: BranchEquations, value: Fraction, guess: Vector, room: Fraction = Fraction(0)
) -> BranchTube | None:
    """The place of the solution near a guess, at one value of the parameter."""
    return enclose(equations, value, value, guess, room)


def follow(
    equations: BranchEquations,
    start: Reached,
    end: Fraction,
    longest: Fraction,
    most: int | None = None,
) -> tuple[list[Reached], bool]:
    """Follow a branch from one value of the parameter to another, in steps no longer than
    ``longest``.

    Parameters
    ----------
    most : steps; `_MAX_STEPS` when None.

    Returns
    -------
    What was reached, step by step without the start, and whether the end was.
    """
    found: list[Reached] = []
    current, step = start, max(-longest, min(longest, (end - start.value) / 8))
    least = abs(end - start.value) * _MIN_STEP
    while current.value != end:
        if len(found) == (_MAX_STEPS if most is None else most):
            return found, False
        # a rational of few digits about a step away: otherwise each step would make the value's
        # digits more
        last = abs(step) >= abs(end - current.value)
        goal = (
            end if last else simplest_fraction(current.value + step * 15 / 16, current.value + step)
        )
        reached = bridge(equations, current, goal)
        if reached is not None:
            found.append(reached)
            current, step = reached, max(-longest, min(longest, step * 3 / 2))
        else:
            step = step / 2
            if abs(step) < least:
                return found, False
    return found, True


def nearer(equations: BranchEquations, place: Reached, value: Fraction) -> Reached:
    """The branch at a value, or as near to it as it can be followed."""
    steps, _ = follow(equations, place, value, abs(value - place.value), _MAX_NEAR)
    return steps[-1] if steps else place


def bridge(equations: BranchEquations, start: Reached, value: Fraction) -> Reached | None:
    """The same branch at another value, if one tube proves it for all values between; else None."""
    with ctx.workprec(BITS):
        half = ball_of((value - start.value) / 2)
        guess = tuple(
            a + v * half for a, v in zip(start.point, start.place.velocity.entries(), strict=True)
        )
    over = enclose(equations, min(start.value, value), max(start.value, value), guess)
    if over is None or not over.holds(start.place, start.value):
        return None
    place = at_value(equations, value, over.at(value))
    return Reached(value, place, over) if place is not None and over.holds(place, value) else None


def over_range(
    equations: BranchEquations, start: Reached, low: Fraction, high: Fraction
) -> BranchTube | None:
    """The branch at all values of a range at one side of its place; None where that is not proved."""
    end = low if start.value > high else high
    across = bridge(equations, start, end)
    tube = None if across is None else enclose(equations, low, high, across.point)
    return (
        tube if across is not None and tube is not None and across.over.holds(tube, end) else None
    )


def in_the_limit(
    potential: Formula, place: Reached, low: Fraction, high: Fraction, angles: int
) -> arb:
    """The value of a function to which it tends along a branch of its critical points, at any value
    in a range.

    It changes with the parameter alone, which is bounded as all unknowns are angles.
    """
    low, high = min(place.value, low), max(place.value, high)
    with ctx.workprec(BITS):
        (value,) = evaluated([potential], (ball_of(place.value), *place.point))
        anywhere = (arb(0, 4),) * angles
        (slope,) = evaluated(
            [potential.graph.derivative(potential, 0)], (ball_over(low, high), *anywhere)
        )
        return value + ball_of(high - low) * slope * arb(0, 1)
