"""Every wall of a stack as one polyline from critical value to critical value, with a proved
distance.

Guarantee: over the whole open interval of its stack the wall stays within `WallPolyline.distance`
of the polyline, measured along the fibre and as a share of the window.

Inside, chords are those of `ptmcad.exact.cad.polyline`. Towards an end, where the wall may turn
upright, a last piece is level: two heights without a root of p(., v) from there to the end, the end
included, shut the wall in, and the piece is so short that they are near enough. At the window's
edge there is none where the curve's roots over it are simple and as many as over the stack, none of
them a corner: then each wall runs on to its own.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq

from ptmcad.algebra.numbers import root_of
from ptmcad.algebra.real_roots import RealRoot, halve, isolate, order, refine, sign_at
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.answer.regionmap import CriticalValue, RegionMap
from ptmcad.exact.cad.curves import by_component, curves_of
from ptmcad.exact.cad.polyline import (
    ROUNDING,
    UNPROVED,
    Span,
    WallBranch,
    chords,
    shut_in,
    to_share,
)
from ptmcad.text.flint_numbers import from_fraction, interval_of

_NARROWEST = Fraction(1, 2**40)
_END = fmpq(1, 2**60)
"""Width to which a critical value is known, as a share of its distance from the samples beside it.
"""
_FIRST, _QUARTERS = Fraction(1, 8), 40
"""Share of its stack that the level piece at an end has at first, and how often it is made four
times shorter.
"""


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
    p = wall.curve.fibre(wall.base[int(end[0])])
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


def _enclosed(value: CriticalValue, before: fmpq, after: fmpq) -> RealRoot:
    """A critical value in an interval that is short against its distance from the samples beside
    it.

    Raises
    ------
    ValueError
        When it is not between them, as in a damaged result: halving would never part it from them.
    """
    root = root_of(value)
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
    parts = chords(
        wall, (start, end), tolerance, _NARROWEST * width, check, (tolerance, Fraction(1))
    )
    points = [(start, parts[0].at_left), *((c.right, c.at_right) for c in parts)]
    if not left[2]:
        points.insert(0, ((left[0] + left[1]) / 2, parts[0].at_left))
    if not right[2]:
        points.append(((right[0] + right[1]) / 2, parts[-1].at_right))
    return WallPolyline(tuple(points), max(first, last, *(c.distance for c in parts)))


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
