"""Checks of the areas: another enclosure of each region's area, which every stored bound must be compatible with.

Each wall between two regions is integrated by the midpoint rule. On a panel of half width h a box that the branch can
not leave is proved (the curve's polynomial has no zero on its lower and upper side, its v-derivative none inside); with
the slopes in the box within s +- r the rule's error is at most r h^2. Panels are halved until that is small; the
narrowest ones, near turning points, count as error, and so do narrow strips around the critical values.

Guarantee: the enclosure is proved (ball arithmetic of Arb, rational panels). The engine integrates Taylor polynomials.

Not guaranteed: that a stored bound which is wrong by less than the enclosure's width is noticed; the width is reported.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flint import arb, arb_poly, ctx, fmpq

from ptmcad.regionmap import CriticalValue
from ptmcad.verification.claims import Claims, PlaneCurve, fraction, polynomial, side
from ptmcad.verification.fibre import rational
from ptmcad.verification.report import Violation

BITS = 192
TOLERANCE = fmpq(1, 50_000)
"""Error that is aimed at for each wall, as a fraction of the window."""
_NARROWEST = fmpq(1, 2**19)
"""Half widths of panels below this fraction of the window are not halved again."""


@dataclass(frozen=True)
class _Branch:
    """A wall: the curve, the number of its root, and the curve's coefficients for balls."""

    curve: PlaneCurve
    root: int
    value: list[arb_poly]

    @classmethod
    def of(cls, curve: PlaneCurve, root: int) -> _Branch:
        return cls(curve, root, [arb_poly(c) for c in curve.in_v])

    def around(self, u: arb, v: arb) -> list[list[arb]]:
        """Coefficients d[i][j] of p(u + s, v + t) = sum of d[i][j] s^i t^j."""
        rows = [c(arb_poly([u, 1])).coeffs() for c in self.value]
        width = self.curve.degrees[0] + 1
        padded = [row + [arb(0)] * (width - len(row)) for row in rows]
        columns = (arb_poly([row[i] for row in padded])(arb_poly([v, 1])).coeffs() for i in range(width))
        height = len(self.value)
        return [column + [arb(0)] * (height - len(column)) for column in columns]

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


def _integral(branch: _Branch, a: fmpq, b: fmpq, claims: Claims) -> arb:
    """The integral over [a, b] of the branch's height above the window's lower edge."""
    low, high = claims.height
    window = claims.base[1] - claims.base[0]
    total, waiting = arb(0), [(a, b)]
    while waiting:
        left, right = waiting.pop()
        half = (right - left) / 2
        panel = _panel(branch, left, right, claims)
        if panel is not None:
            total += panel
        elif half <= window * _NARROWEST:
            total += arb(0).union(arb(2 * half * (high - low)))
        else:
            waiting += [(left, left + half), (left + half, right)]
    return total


def _panel(branch: _Branch, left: fmpq, right: fmpq, claims: Claims) -> arb | None:
    """The midpoint rule on a panel with its proved error; None when that fails or is too coarse."""
    low, high = claims.height
    middle, half = (left + right) / 2, (right - left) / 2
    window = claims.base[1] - claims.base[0]
    if half * 8 > window:
        return None
    height = branch.height(middle, low, high)
    if height is None:
        return None
    center = height.mid()
    d = branch.around(arb(middle), center)
    if d[0][1].contains(0):
        return None
    slope = abs(d[1][0] / d[0][1]).mid() if len(d) > 1 else arb(0)
    reach = ((slope * fmpq(3, 2) + (high - low) / window / 20) * half + height.rad()).mid()
    h, plus_minus = arb(half), arb(-1).union(arb(1))
    power_h, power_r = [arb(1)], [arb(1)]
    for _ in d[1:]:
        power_h.append(power_h[-1] * h)
    for _ in d[0][1:]:
        power_r.append(power_r[-1] * reach)
    # over the box |s| <= half, |t| <= reach: how far p is from p(u, v + t), and its derivatives from the centre's
    far = by_u = by_v = arb(0)
    for i, row in enumerate(d):
        for j, c in enumerate(row):
            size = abs(c)
            if i > 0:
                far += size * power_h[i] * power_r[j]
                if i + j > 1:
                    by_u += i * size * power_h[i - 1] * power_r[j]
            if j > 0 and i + j > 1:
                by_v += j * size * power_h[i] * power_r[j - 1]
    ends = [sum((c * r * (-sign if j % 2 else 1) for j, (c, r) in enumerate(zip(d[0], power_r, strict=True))), arb(0))
            + far * plus_minus for sign in (1, -1)]  # fmt: skip
    if not ((ends[0] < 0 and ends[1] > 0) or (ends[0] > 0 and ends[1] < 0)):
        return None
    steepness = d[0][1] + by_v * plus_minus
    if steepness.contains(0):
        return None
    spread = (((d[1][0] if len(d) > 1 else arb(0)) + by_u * plus_minus) / steepness).rad()
    error = spread * half * half
    # panels that are short against the window may have more than their share
    if error > arb(TOLERANCE * (high - low) * max(2 * half, window / 64)):
        return None
    return (height - low) * (2 * half) + arb(0).union(2 * error) - error


def _narrow(value: CriticalValue, width: fmpq) -> tuple[fmpq, fmpq]:
    """A narrow bracket of a critical value."""
    low, high = rational(value.low), rational(value.high)
    p = polynomial(value)
    below = p(low)
    while high - low > width:
        middle = (low + high) / 2
        here = p(middle)
        if here == 0:
            return middle, middle
        # the only root may have even multiplicity; then the ends do not tell on which side it lies
        right = (here > 0) == (below > 0) if below * p(high) < 0 else side(middle, value) < 0
        low, high = (middle, high) if right else (low, middle)
    return low, high


def check_areas(claims: Claims) -> str:
    """Bounds of each region's area: ordered, within the window, compatible with the enclosure, and with their sum."""
    result = claims.result
    (start, stop), (low, high) = claims.base, claims.height
    window = fraction((stop - start) * (high - low))
    for n, region in enumerate(result.regions):
        if not 0 <= region.area[0] <= region.area[1] <= window:
            raise Violation(f"region {n}: {region.area[0]} to {region.area[1]} are not bounds of an area in the window")
    lower, upper = (sum(region.area[k] for region in result.regions) for k in (0, 1))
    if not lower <= window <= upper:
        raise Violation(f"the regions' areas add up to between {float(lower)} and {float(upper)}; the window's is "
                        f"{float(window)}")  # fmt: skip
    curves = {c.number: c for c in claims.curves}
    with ctx.workprec(BITS):
        areas = [arb(0) for _ in result.regions]
        brackets = [_narrow(v, (stop - start) / 2**20) for v in result.critical_values]
        strips = sum((b - a for a, b in brackets), fmpq(0)) * (high - low)
        for s, stack in enumerate(result.stacks):
            left = start if s == 0 else brackets[s - 1][1]
            right = stop if s == len(brackets) else brackets[s][0]
            areas[result.cells[stack.cells[-1]].region] += arb((right - left) * (high - low))
            for level, wall in enumerate(stack.walls):
                below, above = (result.cells[stack.cells[level + k]].region for k in (0, 1))
                if below != above:
                    integral = _integral(_Branch.of(curves[wall.component], wall.root), left, right, claims)
                    areas[below] += integral
                    areas[above] -= integral
        widest = arb(0)
        for n, (region, area) in enumerate(zip(result.regions, areas, strict=True)):
            enclosure = area + arb(0).union(arb(strips))
            widest = enclosure.rad().max(widest)
            if arb(rational(region.area[0])) > enclosure or arb(rational(region.area[1])) < enclosure:
                raise Violation(f"region {n}: its area is in {enclosure.str(12)}, not between "
                                f"{float(region.area[0])} and {float(region.area[1])}")  # fmt: skip
        relative = float((2 * widest / arb(rational(window))).mid())
    return f"{len(areas)} areas, enclosures at most {relative:.1e} of the window wide"
