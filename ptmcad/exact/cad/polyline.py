"""Walls as chains of chords, each with a proved distance that the wall keeps to it.

Guarantee: over its part of the base each wall stays within `Chord.distance` of its chord, measured along the fibre;
what lies over no chord is a part of the base of at most the width that was asked for.

On a panel that holds no critical value a wall is the graph of a function with two derivatives. If its second derivative
is at most K in modulus there, a panel of width w has the graph within K w^2 / 8 of the chord between its ends;
`algebra.chords.slope_over` encloses the derivative. Where that proves nothing, near singular points and where walls run
close together, a wall that no root of p(., v) lets pass two heights v stays between them. Panels on which the distance
is not proved, or too large, are halved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, ctx, fmpq

from ptmcad.algebra.branches import local_coefficients
from ptmcad.algebra.chords import slope_over
from ptmcad.algebra.polynomials import from_fraction, to_fraction
from ptmcad.algebra.real_roots import isolate, refine
from ptmcad.algebra.window import Interval
from ptmcad.exact.cad.curves import Curve
from ptmcad.text.balls import exact

_BITS = 128
_GRID_STEPS = 2**60
"""Ends of chords are rounded to this part of the fibre."""
ROUNDING = Fraction(2, _GRID_STEPS)
"""By which distances are made larger for that."""
SHORT, FLAT, LITTLE = Fraction(1, 2**12), Fraction(1, 2**12), Fraction(1, 2**34)
"""Between two heights a wall is shut in on panels of at most the first width; that does when they are the second apart,
and the third is the largest area between them."""
UNPROVED = Fraction(1)
"""The distance where nothing is proved: two points of a fibre are no further apart."""


@dataclass(frozen=True, slots=True)
class Chord:
    """A segment from (left, at_left) to (right, at_right); coordinates are shares of the window, from 0 to 1.

    Attributes
    ----------
    left, right : along the base.
    at_left, at_right : along the fibre.
    distance : the wall's largest distance, along the fibre.
    """

    left: Fraction
    right: Fraction
    at_left: Fraction
    at_right: Fraction
    distance: Fraction


def chords(
    curve: Curve,
    root: int,
    span: tuple[Fraction, Fraction],
    base: Interval,
    fibre: Interval,
    max_distance: Fraction,
    narrowest: Fraction,
    check: Callable[[], None] = lambda: None,
) -> tuple[Chord, ...]:
    """The wall that is the ``root``-th real root of a curve, from left to right without gaps.

    Parameters
    ----------
    span : where, as shares of the base; no critical value lies in it, its ends included.
    max_distance : the largest distance wanted, as a share of the fibre; exceeded perhaps where the wall is enclosed
        between two heights, see `FLAT` and `LITTLE`.
    narrowest : panels of at most this share of the base are not halved. Where nothing is proved on one, the distance to
        its chord is `UNPROVED`, which always holds.
    check : called between panels; may raise to stop.
    """
    found: list[Chord] = []
    width, height = base[1] - base[0], fibre[1] - fibre[0]
    heights: dict[Fraction, Fraction] = {}

    def place(share: Fraction) -> Fraction:
        if share not in heights:
            u = base[0] + width * from_fraction(share)
            at = refine(isolate(curve.fibre(u), *fibre)[root], height / _GRID_STEPS)
            rounded = ((at.middle - fibre[0]) / height * _GRID_STEPS + fmpq(1, 2)).floor()
            heights[share] = Fraction(int(rounded), _GRID_STEPS)
        return heights[share]

    waiting = [span]
    while waiting:
        check()
        left, right = waiting.pop()
        middle = (left + right) / 2
        distance = _distance(curve, root, left, right, base, fibre)
        enough = distance is not None and distance <= max_distance
        if distance is None and right - left <= SHORT:
            distance = _between_heights(curve, (left, right), (place(left), place(right)), base, fibre)
            enough = distance is not None and distance <= FLAT and distance * (right - left) <= LITTLE
        if right - left > narrowest and not enough:
            waiting += [(middle, right), (left, middle)]
        else:
            known = UNPROVED if distance is None else min(distance + ROUNDING, UNPROVED)
            found.append(Chord(left, right, place(left), place(right), known))
    return tuple(found)


def _distance(
    curve: Curve, root: int, left: Fraction, right: Fraction, base: Interval, fibre: Interval
) -> Fraction | None:
    """A bound for the distance between the wall and its chord over a panel, as a share of the fibre; None: unproved."""
    width, height = base[1] - base[0], fibre[1] - fibre[0]
    middle, half = (left + right) / 2, (right - left) / 2
    u = base[0] + width * from_fraction(middle)
    radius = width * from_fraction(half)
    slope = slope_over(curve.in_v, isolate(curve.fibre(u), *fibre)[root], u, radius)
    if slope is None:
        return None
    distance = exact((abs(slope.second) * arb(radius * radius / 2 / height)).upper())
    return -((-distance * _GRID_STEPS).__floor__()) * Fraction(1, _GRID_STEPS)


def _between_heights(
    curve: Curve, panel: tuple[Fraction, Fraction], ends: tuple[Fraction, Fraction], base: Interval, fibre: Interval
) -> Fraction | None:
    """How far apart two heights are between which a wall with these ends is shut in over a panel; None: not proved.

    The wall does not leave the window, and it cannot cross a height at which p has no zero over the panel.
    """
    width, height = base[1] - base[0], fibre[1] - fibre[0]
    u = base[0] + width * from_fraction(panel[0] + panel[1]) / 2
    radius = width * from_fraction(panel[1] - panel[0]) / 2
    found = []
    for end, side in ((min(ends), -1), (max(ends), 1)):
        margin = max(abs(ends[1] - ends[0]), ROUNDING)
        while True:
            at = end + side * margin
            if not 0 < at < 1:
                found.append(min(max(at, Fraction(0)), Fraction(1)))
                break
            if _absent(curve, u, radius, fibre[0] + height * from_fraction(at), fmpq(0)):
                found.append(at)
                break
            margin *= 4
            if margin > FLAT:
                return None
    return found[1] - found[0]


def reaching(
    curve: Curve, span: tuple[Fraction, Fraction], base: Interval, fibre: Interval, depth: int
) -> Iterator[tuple[Fraction, Fraction]]:
    """The parts of the fibre that the curve may reach over a part of the base, as shares from below.

    Parameters
    ----------
    span : where, as shares of the base.
    depth : how often the fibre is halved where the curve is not proved to be absent.
    """
    width, height = base[1] - base[0], fibre[1] - fibre[0]
    middle, half = (span[0] + span[1]) / 2, (span[1] - span[0]) / 2
    u = base[0] + width * from_fraction(middle)
    radius = width * from_fraction(half)
    waiting = [(Fraction(0), Fraction(1), depth)]
    while waiting:
        low, high, left = waiting.pop()
        centre = fibre[0] + height * from_fraction(low + high) / 2
        tall = height * from_fraction(high - low) / 2
        if _absent(curve, u, radius, centre, tall):
            continue
        if left == 0:
            yield low, high
        else:
            between = (low + high) / 2
            waiting += [(between, high, left - 1), (low, between, left - 1)]


def _absent(curve: Curve, u: fmpq, radius: fmpq, v: fmpq, tall: fmpq) -> bool:
    """Whether the curve is proved not to meet a closed box: at its centre p outweighs the rest of its Taylor sum."""
    with ctx.workprec(_BITS):
        rest, power = arb(0), arb(1)
        local = local_coefficients(curve.in_v, u, radius, v)
        for row in local:
            rest += sum((abs(c) for c in row.coeffs()), arb(0)) * power
            power = power * arb(tall)
        value = local[0][0]
        return bool(rest - abs(value) < abs(value))


def to_share(value: fmpq, interval: Interval) -> Fraction:
    """Where a number lies in an interval: 0 at its lower end, 1 at its upper."""
    return to_fraction((value - interval[0]) / (interval[1] - interval[0]))
