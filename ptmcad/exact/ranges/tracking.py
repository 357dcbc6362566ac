"""Following a solution along a line of parameters, by Krawczyk's operator in balls, in any number of unknowns.

Guarantee: a `BranchTube` that `enclose` returns holds, for every value of the parameter in its range, exactly one
solution, which is nondegenerate and depends smoothly on the parameter. Two tubes are taken to hold the same branch
only where a third one, for a value that both cover, lies inside both. So `follow` never jumps to another branch.

Reference: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations, 5.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb, ctx, fmpq

from ptmcad.algebra.numbers import simplest_fraction
from ptmcad.exact.ranges.equations import Instance, LineSystem
from ptmcad.exact.ranges.matrices import (
    Matrix,
    Vector,
    added,
    from_identity,
    inverse_of,
    plus,
    product,
    scaled,
    scaled_rows,
    times,
)
from ptmcad.text.balls import ball_of

BITS = 160
_MIN_STEP = Fraction(1, 2**60)
"""Steps shorter than this, against the distance to be gone, are not tried."""
_MAX_STEPS = 3000
"""Where a branch comes ever nearer to others, steps shrink with the distance and their number has no bound."""


@dataclass(frozen=True, slots=True)
class BranchTube:
    """A box of unknowns that moves with the parameter x: center + velocity (x - middle) + (a box around 0).

    For every x from low to high there is one solution in the box ``unique``, and it lies in the box ``tight``.
    """

    low: Fraction
    high: Fraction
    center: Vector
    velocity: Vector
    unique: Vector
    tight: Vector

    def at(self, value: Fraction) -> Vector:
        """An enclosure of the unknowns at one value."""
        with ctx.workprec(BITS):
            return self._moved(ball_of(value - self._middle), self.tight)

    def hull(self) -> Vector:
        """An enclosure of the unknowns at all values."""
        with ctx.workprec(BITS):
            return self._moved(ball_of((self.high - self.low) / 2) * arb(0, 1), self.tight)

    def holds(self, other: BranchTube, value: Fraction) -> bool:
        """Whether the other tube's solution at a value lies where this one's is the only one."""
        with ctx.workprec(BITS):
            mine = self._moved(ball_of(value - self._middle), self.unique)
            return all(a.contains(b) for a, b in zip(mine, other.at(value), strict=True))

    @property
    def _middle(self) -> Fraction:
        return (self.low + self.high) / 2

    def _moved(self, offset: arb, box: Vector) -> Vector:
        return tuple(c + v * offset + w for c, v, w in zip(self.center, self.velocity, box, strict=True))


def enclose(family: LineSystem, low: Fraction, high: Fraction, guess: Vector) -> BranchTube | None:
    """A tube around the branch near a guess for the middle of the range; None when not proved.

    Notes
    -----
    With the tube's center c(x) and w the distance from it, Krawczyk's operator is applied to g(x, w) = f(c(x) + w, x)
    for all x at once; g(x, 0) comes from the mean value theorem in x, multiplied by the approximate inverse first.
    Where that fails the Jacobian comes from the mean value theorem too. Near a place where branches merge, at a
    distance d, it is nearly singular: as balls of a step h make it, it would be off by h, and steps could be no longer
    than its determinant, which is d^(3/2) times a constant at a pitchfork, d^2 where branches cross. Its derivative
    along the branch is known far better, so that steps are in proportion to d.
    """
    with ctx.workprec(BITS):
        middle = family.at((low + high) / 2, (low + high) / 2)
        over = (middle, family.at(low, high), (high - low) / 2)
        center = polish(middle, guess)
        inverse = inverse_of(middle.jacobian(center))
        if inverse is None:
            return None
        velocity = tuple((-fall).mid() for fall in times(inverse, middle.slope(center)))
        for centered in (False, True) if low < high else (False,):
            found = _krawczyk(family.angles, over, center, inverse, velocity, centered)
            if found is not None:
                return BranchTube(low, high, center, velocity, *found)
        return None


def _krawczyk(
    angles: int, over: tuple[Instance, Instance, Fraction], center: Vector, inverse: Matrix, velocity: Vector,
    centered: bool,
) -> tuple[Vector, Vector] | None:  # fmt: skip
    """Boxes around a moving center: one that holds a single solution at each value, and one in which it lies.

    Parameters
    ----------
    over : the equations at the middle of a range of the parameter and in the whole of it, and half its length.
    """
    (middle, along, half), unit = over, arb(0, 1)
    ahead = ball_of(half) * unit
    swept = plus(center, scaled(velocity, ahead))
    start = times(inverse, middle.equations(center))
    if centered:
        here = plus(middle.slope(center), times(middle.jacobian(center), velocity))
        drift = plus(times(inverse, here), scaled(times(inverse, along.bend(swept, velocity)), ahead))
        known = product(inverse, middle.jacobian(center))
    else:
        drift = plus(times(inverse, along.slope(swept)), times(product(inverse, along.jacobian(swept)), velocity))
    move = plus(start, scaled(drift, ahead))
    least = _least(center, angles)
    reach = [2 * abs(m).upper() + e for m, e in zip(move, least, strict=True)]
    for _ in range(8):
        spread = tuple(r * unit for r in reach)
        whole = plus(swept, spread)
        if centered:
            slopes = _changed(known, inverse, along.jacobian_slopes(whole), velocity, ahead, spread)
        else:
            slopes = product(inverse, along.jacobian(whole))
        image = plus(tuple(-m for m in move), times(from_identity(slopes), spread))
        if all(abs(k) < r for k, r in zip(image, reach, strict=True)):
            return spread, image
        reach = [(abs(k).upper() * 3 / 2 + e).upper() for k, e in zip(image, least, strict=True)]
        if not all(r < 2 for r in reach[:angles]) or not all(r.is_finite() for r in reach):
            return None
    return None


def _changed(
    known: Matrix, inverse: Matrix, slopes: tuple[Matrix, ...], velocity: Vector, ahead: arb, spread: Vector
) -> Matrix:
    """The Jacobian times the inverse, from that at the center and the Jacobian's derivatives in the whole box."""
    first, *by = (product(inverse, d) for d in slopes)
    along = [first, *(scaled_rows(d, v) for d, v in zip(by, velocity, strict=True))]
    parts = [scaled_rows(added(along), ahead), *(scaled_rows(d, w) for d, w in zip(by, spread, strict=True))]
    return added([known, *parts])


def _least(center: Vector, angles: int) -> list[arb]:
    """The least reach of a tube in each unknown, a little more than what rounding does to it."""
    least = arb(fmpq(1, 2 ** (BITS - 20)))
    return [least if k < angles else (least * (1 + abs(c))).upper() for k, c in enumerate(center)]


def polish(at: Instance, guess: Vector) -> Vector:
    """A few steps of Newton's method, without guarantee."""
    point = tuple(x.mid() for x in guess)
    for _ in range(5):
        inverse = inverse_of(at.jacobian(point))
        if inverse is None:
            break
        move = times(inverse, at.equations(point))
        if not all(abs(m) < 1 for m in move[: at.angles]):
            break
        point = tuple((x - m).mid() for x, m in zip(point, move, strict=True))
    return point


@dataclass(frozen=True, slots=True)
class Reached:
    """A value of the parameter with the branch's place there; ``over`` covers the branch since the last one."""

    value: Fraction
    place: BranchTube
    over: BranchTube

    @property
    def point(self) -> Vector:
        """The unknowns."""
        return self.place.at(self.value)


def at_value(family: LineSystem, value: Fraction, guess: Vector) -> BranchTube | None:
    """The place of the solution near a guess, at one value of the parameter."""
    return enclose(family, value, value, guess)


def follow(
    family: LineSystem, start: Reached, end: Fraction, longest: Fraction, most: int | None = None
) -> tuple[list[Reached], bool]:
    """Follow a branch from one value of the parameter to another, in steps no longer than ``longest``.

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
        goal = end if abs(step) >= abs(end - current.value) else _short(current.value, step)
        reached = bridge(family, current, goal)
        if reached is not None:
            found.append(reached)
            current, step = reached, max(-longest, min(longest, step * 3 / 2))
        else:
            step = step / 2
            if abs(step) < least:
                return found, False
    return found, True


def _short(value: Fraction, step: Fraction) -> Fraction:
    """A rational of few digits about a step away: without this each step would make the value's digits more."""
    return simplest_fraction(value + step * 15 / 16, value + step)


def bridge(family: LineSystem, start: Reached, value: Fraction) -> Reached | None:
    """The same branch at another value, if one tube proves it for all values between; else None."""
    ahead = start.place.velocity
    with ctx.workprec(BITS):
        half = ball_of((value - start.value) / 2)
        guess = tuple(a + v * half for a, v in zip(start.point, ahead, strict=True))
    over = enclose(family, min(start.value, value), max(start.value, value), guess)
    if over is None or not over.holds(start.place, start.value):
        return None
    place = at_value(family, value, over.at(value))
    return Reached(value, place, over) if place is not None and over.holds(place, value) else None
