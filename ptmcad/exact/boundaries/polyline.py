"""Walls as polylines, each with a proved distance that the wall keeps to it.

Guarantee: over the whole open interval of its stack each wall stays within `WallPolyline.distance`
of its polyline, measured along the fibre.

On a panel that holds no critical value a wall is the graph of a function with two derivatives. If
its second derivative is at most K in modulus there, a panel of width w has the graph within K
w^2 / 8 of the chord between its ends; `algebra.chords.slope_over` encloses the derivative. Where
that proves nothing, near singular points and where walls run close together, a wall that no root of
p(., v) lets pass two heights v stays between them. Panels on which the distance is not proved, or
too large, are halved.

Towards an end of its stack, where the wall may turn upright, a last piece is level: two heights
without a root of p(., v) from there to the end, the end included, shut the wall in, and the piece is
so short that they are near enough. At the window's edge there is none where the curve's roots over it
are simple and as many as over the stack, none of them a corner: then each wall runs on to its own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, ctx, fmpq

from ptmcad.algebra.chords import slope_over
from ptmcad.algebra.polynomials import local_coefficients
from ptmcad.algebra.real_roots import (
    Interval,
    RealRoot,
    halve,
    isolate,
    order,
    refine,
    root_of,
    sign_at,
)
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.answer.regionmap import CriticalValue, RegionMap
from ptmcad.exact.cad.projection import FibredCurve, by_component, curves_of, lines_of
from ptmcad.text.balls import exact
from ptmcad.text.flint_numbers import from_fraction, interval_of, to_fraction

Span = tuple[Fraction, Fraction]
"""A part of a window's side: shares of it, from 0 to 1."""

_BITS = 128
_GRID_STEPS = 2**60
"""Ends of chords are rounded to this part of the fibre."""
ROUNDING = Fraction(2, _GRID_STEPS)
"""By which distances are made larger for that."""
SHORT = Fraction(1, 2**12)
"""The width of the widest panels on which a wall is shut in between two heights."""
UNPROVED = Fraction(1)
"""The distance where nothing is proved: two points of a fibre are no further apart."""


@dataclass(frozen=True, slots=True)
class WallPolyline:
    """A wall as a polyline; coordinates are shares of the window along the base and along the
    fibre.

    Attributes
    ----------
    points : from left to right.
    distance : the wall's largest distance, along the fibre.
    """

    points: tuple[tuple[Fraction, Fraction], ...]
    distance: Fraction


@dataclass(frozen=True, slots=True)
class WallBranch:
    """A wall, the ``root``-th real root of a curve, in the window base x fibre."""

    curve: FibredCurve
    root: int
    base: Interval
    fibre: Interval

    def at(self, u: fmpq) -> RealRoot:
        """Its height over an abscissa, isolated."""
        return self.curve.roots_over(u, self.fibre)[self.root]

    def share_at(self, share: Fraction) -> Fraction:
        """Its height over an abscissa, both as shares of the window, rounded by at most a half of `ROUNDING`."""
        bottom, height = self.fibre[0], self.fibre[1] - self.fibre[0]
        at = refine(self.at(from_share(share, self.base)), height / _GRID_STEPS)
        return Fraction(
            int(((at.middle - bottom) / height * _GRID_STEPS + fmpq(1, 2)).floor()), _GRID_STEPS
        )


def chords(
    wall: WallBranch,
    span: Span,
    max_distance: Fraction,
    narrowest: Fraction,
    check: Check = nothing,
) -> WallPolyline:
    """A part of a wall, by its chords over panels.

    Parameters
    ----------
    span : where, as shares of the base; no critical value lies in it, its ends included.
    max_distance : the largest distance wanted, as a share of the fibre; exceeded only on panels
        that are not halved.
    narrowest : panels of at most this share of the base are not halved. Where nothing is proved on
        one, the distance to its chord is `UNPROVED`, which always holds.
    check : called between panels; may raise to stop.
    """
    heights: dict[Fraction, Fraction] = {}

    def place(share: Fraction) -> Fraction:
        if share not in heights:
            heights[share] = wall.share_at(share)
        return heights[share]

    points, reached = [(span[0], place(span[0]))], Fraction(0)
    waiting = [span]
    while waiting:
        check()
        left, right = waiting.pop()
        middle = (left + right) / 2
        distance = _distance(wall, (left, right))
        if distance is None and right - left <= SHORT:
            distance = shut_in(wall, (left, right), (place(left), place(right)), max_distance)
        enough = distance is not None and distance <= max_distance
        if right - left > narrowest and not enough:
            waiting += [(middle, right), (left, middle)]
        else:
            known = UNPROVED if distance is None else min(distance + ROUNDING, UNPROVED)
            reached = max(reached, known)
            points.append((right, place(right)))
    return WallPolyline(tuple(points), reached)


def _distance(wall: WallBranch, panel: Span) -> Fraction | None:
    """A bound for the distance between the wall and its chord over a panel, as a share of the
    fibre; None: unproved.
    """
    u, radius = _part(panel, wall.base)
    slope = slope_over(wall.curve.in_v, wall.at(u), u, radius)
    if slope is None:
        return None
    distance = exact(
        (abs(slope[1]) * arb(radius * radius / 2 / (wall.fibre[1] - wall.fibre[0]))).upper()
    )
    return -((-distance * _GRID_STEPS).__floor__()) * Fraction(1, _GRID_STEPS)


def shut_in(wall: WallBranch, panel: Span, ends: Span, most: Fraction) -> Fraction | None:
    """How far apart two heights are between which a wall with these ends is shut in over a panel;
    None: not proved.

    None is more than ``most`` away from an end.

    The wall does not leave the window, and it cannot cross a height at which p has no zero over the
    panel.
    """
    found = []
    for end, side in ((min(ends), -1), (max(ends), 1)):
        margin = max(abs(ends[1] - ends[0]), ROUNDING)
        while True:
            at = end + side * margin
            if not 0 < at < 1:
                found.append(min(max(at, Fraction(0)), Fraction(1)))
                break
            if _absent(wall.curve, _part(panel, wall.base), from_share(at, wall.fibre)):
                found.append(at)
                break
            margin *= 4
            if margin > most:
                return None
    return found[1] - found[0]


def _absent(curve: FibredCurve, across: Interval, height: fmpq) -> bool:
    """Whether the curve is proved to miss a closed level segment: p in the middle outweighs the
    rest of its Taylor sum.

    Parameters
    ----------
    across : the segment's middle, and half its length, along the base.
    """
    with ctx.workprec(_BITS):
        (local,) = local_coefficients(curve.in_v, *across, height, 1)
        total, value = sum((abs(c) for c in local.coeffs()), arb(0)), abs(local[0])
        return bool(total - value < value)


def to_share(value: fmpq, interval: Interval) -> Fraction:
    """Where a number lies in an interval: 0 at its lower end, 1 at its upper."""
    return to_fraction((value - interval[0]) / (interval[1] - interval[0]))


def from_share(share: Fraction, interval: Interval) -> fmpq:
    """The number that lies at a share of an interval."""
    return interval[0] + (interval[1] - interval[0]) * from_fraction(share)


def _part(span: Span, interval: Interval) -> Interval:
    """Middle and half the length of a part of an interval that is given in shares."""
    low, high = (from_share(share, interval) for share in span)
    return (low + high) / 2, (high - low) / 2


_NARROWEST = Fraction(1, 2**40)
_END = fmpq(1, 2**60)
"""Width to which a critical value is known, as a share of its distance from the samples beside it.
"""
_FIRST, _QUARTERS = Fraction(1, 8), 40
"""Share of its stack that the level piece at an end has at first, and how often it is made four
times shorter.
"""


def chains(
    result: RegionMap, tolerance: Fraction, check: Check = nothing
) -> tuple[tuple[WallPolyline, ...], ...]:
    """The walls of every stack, from below.

    Parameters
    ----------
    tolerance : the largest distance wanted, as a share of the window. `WallPolyline.distance` says
        what was reached.
    check : called between pieces; may raise to stop.
    """
    axes = result.slice.axes
    base, fibre = (
        (from_fraction(axes[k].low), from_fraction(axes[k].high))
        for k in (result.base, 1 - result.base)
    )
    curves = by_component(curves_of(result.components, result.base))
    ends = [(Fraction(0), Fraction(0)), *critical_shares(result), (Fraction(1), Fraction(1))]
    found = []
    for k, stack in enumerate(result.stacks):
        branches = [WallBranch(curves[w.component], w.root, base, fibre) for w in stack.walls]
        number = Counter(w.component for w in stack.walls)
        walls = []
        for b in branches:
            left, right = (
                (*e, _goes_on(b, e, number[b.curve.component])) for e in (ends[k], ends[k + 1])
            )
            walls.append(_chain(b, left, right, tolerance, check))
        found.append(tuple(walls))
    return tuple(found)


_End = tuple[Fraction, Fraction, bool]
"""An end of a stack, between two shares of the base; and whether the wall runs on into it, as where
it is regular.
"""


def _goes_on(wall: WallBranch, end: Span, number: int) -> bool:
    """Whether so many walls of a curve run to its so many roots over the window's edge, each to its
    own.
    """
    if end[0] != end[1] or end[0] not in (0, 1):
        return False
    p = wall.curve.polynomial_over(wall.base[int(end[0])])
    if any(sign_at(p, v) == 0 for v in wall.fibre) or p.gcd(p.derivative()).degree() > 0:
        return False
    return len(isolate(p, *wall.fibre)) == number


def critical_shares(result: RegionMap) -> list[Span]:
    """Every critical value between two shares of the base, near together against the stacks beside
    it.
    """
    base = interval_of(result.slice.axes[result.base])
    samples = [from_fraction(s.sample) for s in result.stacks]
    ends = [_enclosed(v, samples[k], samples[k + 1]) for k, v in enumerate(result.critical_values)]
    return [(to_share(root.low, base), to_share(root.high, base)) for root in ends]


def lines_across(result: RegionMap) -> Iterator[tuple[int, int]]:
    """The components that are lines across the base, each with the critical values that it is at."""
    for component, polynomial in lines_of(result.components, result.base).items():
        own = [int(c) for c in polynomial.coeffs()]
        for k, value in enumerate(result.critical_values):
            if list(value.polynomial) in (own, [-c for c in own]):
                yield component, k


def _enclosed(value: CriticalValue, before: fmpq, after: fmpq) -> RealRoot:
    """A critical value in an interval that is short against its distance from the samples beside
    it.

    Raises
    ------
    ValueError
        When it is not between them, as in a damaged result: halving would never part it from them.
    """
    root = root_of(value.number)
    signs = {sign_at(root.polynomial, end) for end in (root.low, root.high)}
    is_one = root.is_rational or (root.low < root.high and signs == {-1, 1})
    if not is_one or not order(before, root) < 0 < order(after, root):
        raise ValueError("a critical value is not between the samples of its stacks")
    while root.low <= before or root.high >= after:
        root = halve(root)
    return refine(root, min(root.low - before, after - root.high) * _END)


def _chain(
    wall: WallBranch, left: _End, right: _End, tolerance: Fraction, check: Check
) -> WallPolyline:
    width = right[0] - left[1]
    start, first = _level(wall, left, width, tolerance)
    end, last = _level(wall, right, -width, tolerance)
    inner = chords(wall, (start, end), tolerance, _NARROWEST * width, check)
    points = inner.points
    if not left[2]:
        points = (((left[0] + left[1]) / 2, points[0][1]), *points)
    if not right[2]:
        points = (*points, ((right[0] + right[1]) / 2, points[-1][1]))
    return WallPolyline(points, max(first, last, inner.distance))


def _level(
    wall: WallBranch, end: _End, width: Fraction, tolerance: Fraction
) -> tuple[Fraction, Fraction]:
    """Where the level piece at an end of a wall stops, and how far the wall is from it at most."""
    low, high, regular = end
    if regular:
        return low, Fraction(0)
    away, far = (high, low) if width > 0 else (low, high)
    share, best = _FIRST, (away + width * _FIRST, UNPROVED)
    for _ in range(_QUARTERS):
        at = away + width * share
        height = wall.share_at(at)
        distance = shut_in(wall, (min(far, at), max(far, at)), (height, height), tolerance)
        if distance is not None and distance + ROUNDING < best[1]:
            best = at, distance + ROUNDING
        if best[1] <= tolerance:
            break
        share /= 4
    return best
