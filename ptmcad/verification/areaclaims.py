"""Checks of the areas: another enclosure of each region's area, which has to lie within the stored
bounds.

Each wall between two regions is integrated over panels by `ptmcad.verification.wallintegrals`, which are
halved towards critical values, where branches are not analytic; narrow strips around critical
values that are not rational count as error.

Guarantee: the enclosures are proved (ball arithmetic of Arb, rational panels). They are refined
until each is within its stored bounds or outside of them; where bounds are too narrow for that,
they are listed as not checked.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.answer.regionmap import CriticalValue, Region
from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.numerals import approximate_text
from ptmcad.verification.claims import Claims, bracket
from ptmcad.verification.disks import BallsTooWide
from ptmcad.verification.report import Unchecked, Violation
from ptmcad.verification.wallintegrals import IntegralEffort, PanelPart, WallSeries, integrals_over

NARROWEST = 10**60
"""Of bounds that are relatively narrower than the inverse of this, it is tried whether they are off
by so much.
"""
ATTEMPTS = 7
"""Times that precision is raised, and strips are narrowed, before bounds count as not checked."""


class _WallPanel(NamedTuple):
    """A part of a wall from region ``below`` to region ``above``, and the error that it may have."""

    branch: WallSeries
    below: int
    above: int
    effort: IntegralEffort
    part: PanelPart


def check_areas(claims: Claims) -> str:
    """Bounds of each region's area: ordered, within the window, and around a proved enclosure."""
    result = claims.result
    (start, stop), (low, high) = claims.base, claims.height
    window = to_fraction((stop - start) * (high - low))
    for n, region in enumerate(result.regions):
        # bounds are written as decimals, rounded outwards
        if not (0 <= region.area[0] <= region.area[1] <= window * (1 + Fraction(1, 10**15))):
            raise Violation(f"region {n}: no area in the window is {_between(region)}")
    if len(result.regions) == 1:
        if not result.regions[0].area[0] <= window <= result.regions[0].area[1]:
            raise Violation(
                f"the only region's area is the window's, {approximate_text(window)}, not {_between(result.regions[0])}"
            )
        return "1 region, the window"
    narrowest = min(map(_width, result.regions))
    scale = (narrowest or window / 10**18) / window
    bits = 96 + 2 * _doublings(scale)
    for ends in (claims.base, claims.height):
        bits += _doublings(to_fraction((ends[1] - ends[0]) / max(abs(ends[0]), abs(ends[1]))))
    strip = from_fraction(scale) / (16 * len(result.stacks))
    unconfirmed = "the precision did not suffice to confirm the areas"
    # of the narrowest bounds' width: how far inside of them an area can be proved to be
    margin = fmpq(1, 64)
    for _ in range(ATTEMPTS):
        with ctx.workprec(bits):
            try:
                open_region = _attempt(claims, strip, margin, bits)
            except BallsTooWide:
                bits = 2 * bits
                continue
        if open_region is None:
            return f"{len(result.regions)} enclosures within the stored bounds, {bits} bits"
        unconfirmed = open_region
        bits, strip, margin = 2 * bits, strip / 2**16, margin / 2**16
    return Unchecked(unconfirmed)


def _width(region: Region) -> Fraction:
    """How far apart the bounds of an area are, or the least distance that is looked at."""
    low, high = region.area
    return max(high - low, high / NARROWEST)


def _doublings(scale: Fraction) -> int:
    """The number of bits before the first of a number below one."""
    return max(0, scale.denominator.bit_length() - scale.numerator.bit_length())


def _attempt(claims: Claims, strip: fmpq, margin: fmpq, bits: int) -> str | None:
    """None when every enclosure is within its bounds; else which one could not be made narrow
    enough.
    """
    result = claims.result
    (start, stop), (low, high) = claims.base, claims.height
    width = stop - start
    window = to_fraction(width * (high - low))
    brackets = [bracket(v, strip * width) for v in result.critical_values]
    points = [start, *(_middle(v, strip * width / 2**bits) for v in result.critical_values), stop]
    lost = sum((b - a for a, b in brackets), fmpq(0)) * (high - low)
    bounds = [(ball_of(r.area[0]), ball_of(r.area[1])) for r in result.regions]
    number = max(1, sum(len(s.walls) for s in result.stacks))
    shares = [ball_of(_width(r)).mid() * margin / number for r in result.regions]
    effort = IntegralEffort(min(shares), width / 2 ** (bits // 3), (low, high), (start, stop))
    whole = [arb(0) for _ in result.regions]
    panels: list[_WallPanel] = []
    for s, stack in enumerate(result.stacks):
        left = start if s == 0 else brackets[s - 1][1]
        right = stop if s == len(brackets) else brackets[s][0]
        whole[result.cells[stack.cells[-1]].region] += arb((right - left) * (high - low))
        for below, above, branch in _borders(claims, s):
            there = replace(
                effort, share=min(shares[below], shares[above]), points=(points[s], points[s + 1])
            )
            panels += [
                _WallPanel(branch, below, above, there, p)
                for p in integrals_over(branch, left, right, there)
            ]
    while True:
        areas = list(whole)
        for p in panels:
            areas[p.below] += p.part.integral
            areas[p.above] -= p.part.integral
        open_regions = set()
        for n, (area, (a, b)) in enumerate(zip(areas, bounds, strict=True)):
            enclosure = area + arb(0).union(arb(lost))
            if enclosure < a or enclosure > b:
                raise Violation(
                    f"region {n}: its area is {enclosure.str(15)}, not {_between(result.regions[n])}"
                )
            # a region's area is less than the window's and more than nothing, whatever rounding
            # adds
            reaches = result.regions[n].area
            if not (
                (enclosure >= a or reaches[0] == 0) and (enclosure <= b or reaches[1] >= window)
            ):
                open_regions.add(n)
        if not open_regions:
            return None
        halved = _halved(panels, open_regions, effort)
        if halved is None:
            n = min(open_regions)
            return (
                f"region {n}: its area is in {areas[n].str(20)}; that it is {_between(result.regions[n])} "
                f"could not be confirmed with {bits} bits"
            )
        panels = halved


def _middle(value: CriticalValue, width: fmpq) -> fmpq:
    """A number within this distance of a critical value."""
    low, high = bracket(value, width)
    return (low + high) / 2


def _borders(claims: Claims, s: int) -> Iterator[tuple[int, int, WallSeries]]:
    """The walls of a stack between different regions, with the region below and that above."""
    stack = claims.result.stacks[s]
    curves = {c.number: c for c in claims.curves}
    for level, wall in enumerate(stack.walls):
        below, above = (claims.result.cells[stack.cells[level + k]].region for k in (0, 1))
        if below != above:
            yield below, above, WallSeries.of(curves[wall.component], wall.root)


def _between(region: Region) -> str:
    return f"between {approximate_text(region.area[0])} and {approximate_text(region.area[1])}"


def _halved(
    panels: Sequence[_WallPanel], regions: set[int], effort: IntegralEffort
) -> list[_WallPanel] | None:
    """The panels of the given regions, the worst ones halved or tried for the first time; None when
    too narrow.
    """
    concerned = [p for p in panels if regions & {p.below, p.above}]
    worst = max((p.part.integral.rad() for p in concerned), default=arb(0))
    if not worst > effort.share:
        return None
    refined: list[_WallPanel] = []
    for p in panels:
        left, right, integral, tried, run = p.part
        if not (regions & {p.below, p.above} and integral.rad() * 8 > worst):
            refined.append(p)
            continue
        if right - left < effort.narrowest:
            return None
        middle = (left + right) / 2
        for ends in ((left, middle), (middle, right)) if tried else ((left, right),):
            parts = integrals_over(p.branch, *ends, p.effort, run)
            refined += [p._replace(part=part) for part in parts]
    return refined
