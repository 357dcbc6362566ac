"""Checks of the areas: another enclosure of each region's area, which has to lie within the stored bounds.

Each wall between two regions is integrated over panels. On a panel of half width h around u0 the branch is
v0 + a s + b s^2 + t(s), s = u - u0, with a and b near its first two Taylor coefficients. If for some R > h and r

    sum of |d_ij| R^i r^j over all (i, j) other than (0, 1)  <  |d_01| r,
    p(u0 + s, v0 + a s + b s^2 + t) = sum of d_ij s^i t^j,

then by Rouche's theorem p has for every complex |s| <= R exactly one root |t| < r; so t is analytic there, its
coefficients are at most r / R^n (Cauchy), and what lies beyond the term of order N contributes at most
2 h r (h/R)^N / ((N+1) (1 - (h/R)^2)) to the integral. (Without a and b, two branches that run close together along a
slope would need panels as short as they are close.) Where no R does, as at turning points, the panel is halved or
the branch is shut in between two heights at which the curve does not meet the panel.

Guarantee: the enclosures are proved (ball arithmetic of Arb, rational panels). They are refined until each is within
its stored bounds or outside of them; bounds that are too narrow for that are rejected as not confirmed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb, arb_poly, arb_series, ctx, fmpq

from ptmcad.numerals import approximate_text
from ptmcad.regionmap import Region
from ptmcad.verification.claims import Claims, PlaneCurve, bracket, fraction
from ptmcad.verification.fibre import rational
from ptmcad.verification.report import Violation

ATTEMPTS = 6
"""Times that precision is raised, and strips are narrowed, before bounds count as not confirmed."""


@dataclass(frozen=True)
class _Branch:
    """A wall: the curve, the number of its root, and the curve's coefficients, in Z[u] and in Z[v], for balls."""

    curve: PlaneCurve
    root: int
    value: list[arb_poly]
    columns: list[arb_poly]

    @classmethod
    def of(cls, curve: PlaneCurve, root: int) -> _Branch:
        return cls(curve, root, [arb_poly(c) for c in curve.in_v], [arb_poly(c) for c in curve.in_u])

    def height(self, u: fmpq, low: fmpq, high: fmpq) -> arb | None:
        """The branch over u; None when the balls do not tell which root it is."""
        inside = []
        squares = (
            self.curve.exponent_gcd(1) % 2 == 0 and low >= 0
        )  # then positive roots of the deflated polynomial have roots of their own
        p = self.curve.over(u)
        roots: Any = (p.deflate(2) if squares else p).complex_roots()  # pairs; FLINT's stub says otherwise
        for root, _ in roots:
            if root.imag != 0 or (squares and root.real <= 0):
                continue
            real = root.real.sqrt() if squares else root.real
            if real > low and real < high:
                inside.append(real)
            elif not (real < low or real > high):
                return None
        inside.sort(key=lambda ball: ball.mid())
        return inside[self.root] if self.root < len(inside) else None


@dataclass(frozen=True)
class _Panel:
    """A part of a wall from region ``below`` to region ``above`` with its integral over the window's lower edge."""

    branch: _Branch
    left: fmpq
    right: fmpq
    below: int
    above: int
    integral: arb


@dataclass(frozen=True)
class _Effort:
    """What one attempt spends.

    Attributes
    ----------
    share : error that a panel may have.
    shut : panels narrower than this are shut in between heights.
    narrowest : panels narrower than this are not halved at this precision.
    """

    share: arb
    shut: fmpq
    narrowest: fmpq
    heights: tuple[fmpq, fmpq] = field(default=(fmpq(0), fmpq(1)))


def _panel(branch: _Branch, left: fmpq, right: fmpq, below: int, above: int, effort: _Effort) -> _Panel:
    """A panel with the best enclosure at hand."""
    low, high = effort.heights
    integral = None
    middle, half = (left + right) / 2, (right - left) / 2
    height = branch.height(middle, low, high)
    if height is not None:
        integral = _by_series(branch, middle, half, height, effort)
        if integral is not None:
            integral -= low * (2 * half)
        elif 2 * half < effort.shut:
            bottom, top = _shut_in(branch, middle, half, height, effort)
            integral = arb(bottom - low).union(arb(top - low)) * (2 * half)
    if integral is None:
        integral = arb(0).union(arb(2 * half * (high - low)))
    return _Panel(branch, left, right, below, above, integral)


class _PrecisionTooLow(Exception):
    """Rounding alone keeps a panel from being enclosed."""


def _by_series(branch: _Branch, middle: fmpq, half: fmpq, height: arb, effort: _Effort) -> arb | None:
    """The integral of the branch over a panel, by its power series; None when no disk of convergence is proved.

    Raises
    ------
    _PrecisionTooLow
    """
    center = height.mid()
    rows = [c(arb_poly([middle, 1])) for c in branch.value]
    near = _shifted([row.truncate(3) for row in rows], arb_poly([center]))
    if near[1][0].contains(0):
        raise _PrecisionTooLow  # the root is simple
    start = arb_series([height - center], prec=3)
    first = [c.mid() for c in _series(near, start, 3)]
    parabola = arb_poly([center, *first[1:]])
    d = _shifted(rows, parabola)
    steepness = abs(d[1][0])
    # the parabola follows the branch to second order, so but for rounding the first three coefficients are zero
    blur = _size(d[0].truncate(3), arb(half)) + sum((c.rad() * half**i for i, c in enumerate(d[0].coeffs())), arb(0))
    if len(d) > 2 and not blur * _size(d[2], arb(half)) * 2**20 < steepness * steepness:
        raise _PrecisionTooLow  # rounding blurs the branch nearly as far as the next one
    for factor in (4, 2):
        radius = arb(half * factor)
        reach = _reach([_size(row, radius) for row in d], steepness)
        if reach is not None:
            break
    else:
        return None
    # order until the tail is negligible
    ratio, order, tail = fmpq(1, factor), 4, arb(0)
    while True:
        tail = 2 * arb(half) * reach * arb(ratio) ** order / ((order + 1) * (1 - arb(ratio) ** 2))
        if tail < effort.share or order >= ctx.prec:
            break
        order += 4
    total, power = arb(0), arb(half)
    for k, c in enumerate(_series(d, start, order)):
        if k % 2 == 0:
            total += (c + parabola[k]) * power * fmpq(2, k + 1)
        power = power * half
    return total + arb(0).union(2 * tail) - tail


def _shifted(rows: Sequence[arb_poly], by: arb_poly) -> list[arb_poly]:
    """Coefficients of the powers of t in p(s, by(s) + t), given those of the powers of v in p(s, v)."""
    shifted = list(rows)
    for start in range(len(shifted) - 1):
        for j in range(len(shifted) - 2, start - 1, -1):
            shifted[j] = shifted[j] + shifted[j + 1] * by
    return shifted


def _size(row: arb_poly, radius: arb) -> arb:
    """A bound for the polynomial on the disk of a radius."""
    return arb_poly([abs(c) for c in row.coeffs()])(radius)


def _reach(sizes: list[arb], steepness: arb) -> arb | None:
    """An r for which Rouche's condition holds, given the sums over i of |d_ij| R^i for each j; None when none is found.

    ``sizes[1]`` contains |d_01| itself, which belongs on the other side.
    """
    others = [sizes[0], sizes[1] - steepness, *sizes[2:]]
    first = (sizes[0] / steepness).mid()
    for multiple in (fmpq(5, 4), fmpq(2), fmpq(4)):
        reach = (first * multiple).mid() if first > 0 else arb(1) / 2**64
        if arb_poly(others)(reach) < steepness * reach:
            return reach
    return None


def _series(d: Sequence[arb_poly], start: arb_series, order: int) -> list[arb]:
    """Enclosures of the first coefficients of t(s), whose constant one ``start`` encloses, by Newton's method.

    Raises
    ------
    _PrecisionTooLow
    """
    cap = ctx.cap
    t, length = start, 1
    try:
        while length < order:
            length = min(2 * length, order)
            ctx.cap = length
            known = t.coeffs()[:length]
            t = arb_series(known + [arb(0)] * (length - len(known)), prec=length)
            value, slope = arb_series([arb(0)], prec=length), arb_series([arb(0)], prec=length)
            for row in reversed(d):
                slope = slope * t + value
                value = value * t + arb_series(row.coeffs()[:length], prec=length)
            if slope.coeffs() == [] or slope.coeffs()[0].contains(0):
                raise _PrecisionTooLow
            t = t - value / slope
        found = t.coeffs()
    finally:
        ctx.cap = cap
    return found + [arb(0)] * (order - len(found))


def _shut_in(branch: _Branch, middle: fmpq, half: fmpq, height: arb, effort: _Effort) -> tuple[fmpq, fmpq]:
    """Heights below and above the branch at which the curve does not meet the panel."""
    low, high = effort.heights
    mantissa, exponent = (int(n) for n in height.mid().man_exp())
    center = fmpq(mantissa) * (fmpq(2) ** exponent)
    start = (high - low) * min(fmpq(1, 16), half / effort.shut / 2**8)
    bounds = []
    for edge, direction in ((low, -1), (high, 1)):
        margin, bound = start, edge
        while margin < direction * (edge - center):
            candidate = _simple(center + direction * margin, margin / 8)
            # the height over the middle tells on which side of the candidate the branch is
            clear = arb(candidate) < height if direction < 0 else arb(candidate) > height
            if clear and _misses(branch, middle, half, candidate):
                bound = candidate
                break
            margin = margin * 2
        bounds.append(bound)
    return bounds[0], bounds[1]


def _misses(branch: _Branch, middle: fmpq, half: fmpq, v: fmpq) -> bool:
    """Whether the curve is proved not to meet the panel at a height."""
    along = arb_poly([row(v) for row in branch.columns])(arb_poly([middle, 1])).coeffs()
    total, power = arb(0), arb(half)
    for c in along[1:]:
        total += abs(c) * power
        power = power * half
    return bool(along) and total < abs(along[0])


def _simple(value: fmpq, error: fmpq) -> fmpq:
    """A dyadic number near a value."""
    scale = 1
    while fmpq(1, scale) > error:
        scale *= 2
    return fmpq((value * scale).floor(), scale)


def check_areas(claims: Claims) -> str:
    """Bounds of each region's area: ordered, within the window, and around a proved enclosure."""
    result = claims.result
    (start, stop), (low, high) = claims.base, claims.height
    window = fraction((stop - start) * (high - low))
    for n, region in enumerate(result.regions):
        if not (0 <= region.area[0] <= region.area[1] and region.area[0] <= window):
            raise Violation(f"region {n}: no area in the window is {_between(region)}")
    if len(result.regions) == 1:
        if not result.regions[0].area[0] <= window <= result.regions[0].area[1]:
            raise Violation(f"the only region's area is the window's, {approximate_text(window)}, not "
                            f"{_between(result.regions[0])}")  # fmt: skip
        return "1 region, the window"
    narrowest = min(region.area[1] - region.area[0] for region in result.regions)
    scale = (narrowest or window / 10**18) / window
    bits = 96 + 2 * _doublings(scale)
    for ends in (claims.base, claims.height):
        bits += _doublings(fraction((ends[1] - ends[0]) / max(abs(ends[0]), abs(ends[1]))))
    strip = rational(scale) / (16 * len(result.stacks))
    unconfirmed: str | None = "the precision did not suffice to confirm the areas"
    for _ in range(ATTEMPTS):
        with ctx.workprec(bits):
            try:
                unconfirmed = _attempt(claims, strip, bits)
            except _PrecisionTooLow:
                bits = 2 * bits
                continue
        if unconfirmed is None:
            return f"{len(result.regions)} enclosures within the stored bounds, {bits} bits"
        bits, strip = 2 * bits, strip / 2**16
    raise Violation(unconfirmed)


def _doublings(scale: Fraction) -> int:
    """The number of bits before the first of a number below one."""
    return max(0, scale.denominator.bit_length() - scale.numerator.bit_length())


def _attempt(claims: Claims, strip: fmpq, bits: int) -> str | None:
    """None when every enclosure is within its bounds; else which one could not be made narrow enough."""
    result = claims.result
    (start, stop), (low, high) = claims.base, claims.height
    width = stop - start
    window = fraction(width * (high - low))
    curves = {c.number: c for c in claims.curves}
    brackets = [bracket(v, strip * width) for v in result.critical_values]
    lost = sum((b - a for a, b in brackets), fmpq(0)) * (high - low)
    bounds = [(arb(rational(r.area[0])), arb(rational(r.area[1]))) for r in result.regions]
    share = min((b - a).mid() for a, b in bounds) / (64 * max(1, sum(len(s.walls) for s in result.stacks)))
    effort = _Effort(share, width / 2**8, width / 2 ** (bits // 3), (low, high))
    whole = [arb(0) for _ in result.regions]
    panels: list[_Panel] = []
    for s, stack in enumerate(result.stacks):
        left = start if s == 0 else brackets[s - 1][1]
        right = stop if s == len(brackets) else brackets[s][0]
        whole[result.cells[stack.cells[-1]].region] += arb((right - left) * (high - low))
        for level, wall in enumerate(stack.walls):
            below, above = (result.cells[stack.cells[level + k]].region for k in (0, 1))
            if below != above:
                branch = _Branch.of(curves[wall.component], wall.root)
                panels.append(_panel(branch, left, right, below, above, effort))
    while True:
        areas = list(whole)
        for p in panels:
            areas[p.below] += p.integral
            areas[p.above] -= p.integral
        open_regions = set()
        for n, (area, (a, b)) in enumerate(zip(areas, bounds, strict=True)):
            enclosure = area + arb(0).union(arb(lost))
            if enclosure < a or enclosure > b:
                raise Violation(f"region {n}: its area is {enclosure.str(15)}, not {_between(result.regions[n])}")
            # a region's area is less than the window's and more than nothing, whatever rounding adds
            reaches = result.regions[n].area
            if not ((enclosure >= a or reaches[0] == 0) and (enclosure <= b or reaches[1] >= window)):
                open_regions.add(n)
        if not open_regions:
            return None
        halved = _halved(panels, open_regions, bounds, effort)
        if halved is None:
            n = min(open_regions)
            return (f"region {n}: its area is in {areas[n].str(20)}; that it is {_between(result.regions[n])} "
                    f"could not be confirmed with {bits} bits")  # fmt: skip
        panels = halved


def _between(region: Region) -> str:
    return f"between {approximate_text(region.area[0])} and {approximate_text(region.area[1])}"


def _halved(
    panels: Sequence[_Panel], regions: set[int], bounds: Sequence[tuple[arb, arb]], effort: _Effort
) -> list[_Panel] | None:
    """The panels of the given regions with the worst ones halved; None when they are too narrow already."""
    concerned = [p for p in panels if regions & {p.below, p.above}]
    worst = max((p.integral.rad() for p in concerned), default=arb(0))
    if not worst > effort.share:
        return None
    refined: list[_Panel] = []
    for p in panels:
        if (p.below in regions or p.above in regions) and p.integral.rad() * 8 > worst:
            if p.right - p.left < effort.narrowest:
                return None
            middle = (p.left + p.right) / 2
            refined += [
                _panel(p.branch, p.left, middle, p.below, p.above, effort),
                _panel(p.branch, middle, p.right, p.below, p.above, effort),
            ]
        else:
            refined.append(p)
    return refined
