"""Certified areas of regions: every branch that separates two regions is integrated with a proved error.

Guarantee: each area is an interval that contains the true value; its relative width is at most the tolerance asked for.

The branch of a wall is integrated on panels by `algebra.branches`; panels where that fails, as it must at turning
points, are halved, and there the branch is shut in between two horizontals that the curve does not meet. The number of
panels grows with the logarithm of 1/tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import arb, ctx, fmpq

from ptmcad.algebra.branches import branch_integral
from ptmcad.algebra.polynomials import to_fraction
from ptmcad.algebra.real_roots import RealRoot, has_root_between, isolate, refine
from ptmcad.algebra.window import Interval
from ptmcad.cad.curves import Curve
from ptmcad.cad.stacks import StackData


@dataclass(frozen=True, slots=True)
class _Effort:
    """Degree of the polynomial on a panel, working precision, and the narrowest panel this precision is good for."""

    order: int
    bits: int
    narrowest: fmpq


@dataclass(frozen=True, slots=True)
class _Panel:
    """A part of a wall that separates region ``below`` from region ``above``, with the enclosure of its integral."""

    curve: Curve
    root: int
    low: fmpq
    high: fmpq
    below: int
    above: int
    integral: arb

    @property
    def width(self) -> float:
        """Twice the enclosure's radius, rounded up: used to choose what to refine, and checked exactly at the end."""
        return 2 * float(self.integral.rad())


def region_areas(
    stacks: Sequence[StackData],
    regions: Sequence[Sequence[int]],
    curves: Sequence[Curve],
    base: Interval,
    fibre: Interval,
    tolerance: Fraction,
    check: Callable[[], None] = lambda: None,
) -> tuple[tuple[Fraction, Fraction], ...]:
    """Bounds for the area of each region, in the product of the axes' units.

    Parameters
    ----------
    regions : for each stack the region of each of its cells, from below.
    tolerance : largest relative width of each interval.
    check : called between panels; may raise to stop.
    """
    count = 1 + max(max(row) for row in regions)
    digits = len(str(tolerance.denominator // tolerance.numerator))
    width = base[1] - base[0]
    strip = width * fmpq(1, 10 ** (digits + 3) * 4 * (len(stacks) + 1))
    bits = 64 + 6 * digits + max((int(q.height_bits()) for c in curves for q in c.in_v), default=0) // 2
    while True:
        effort = _Effort(digits + 2, bits, width / 2 ** (bits // 4))
        try:
            with ctx.workprec(bits):
                return _areas(stacks, regions, curves, strip, fibre, tolerance, count, effort, check)
        except _Unreachable as obstacle:
            # a region is tiny, or the precision is too low for it: both are raised, so this ends
            bits, strip = bits * 3 // 2, strip / 2**20 if obstacle.strips else strip


class _Unreachable(ArithmeticError):
    """The tolerance can not be reached at this precision, or with strips of this width left out."""

    def __init__(self, strips: bool) -> None:
        super().__init__()
        self.strips = strips


def _areas(
    stacks: Sequence[StackData],
    regions: Sequence[Sequence[int]],
    curves: Sequence[Curve],
    strip: fmpq,
    fibre: Interval,
    tolerance: Fraction,
    count: int,
    effort: _Effort,
    check: Callable[[], None],
) -> tuple[tuple[Fraction, Fraction], ...]:
    """One attempt: strips of at most the given width around the critical abscissae are left to any region."""
    by_component = {c.component: c for c in curves}
    spans = [_span(stack, strip) for stack in stacks]
    gaps = sum((b[0] - a[1] for a, b in pairwise(spans)), fmpq(0))
    fixed = _edges(spans, regions, fibre, count)
    panels = []
    for (low, high), stack, row in zip(spans, stacks, regions, strict=True):
        for j, wall in enumerate(stack.walls):
            if row[j] != row[j + 1]:
                check()
                source = by_component[wall.component]
                panels.append(_panel(source, wall.root, low, high, row[j], row[j + 1], fibre, effort))
    return _refine(panels, fixed, gaps * (fibre[1] - fibre[0]), fibre, tolerance, effort, check)


def _span(stack: StackData, strip: fmpq) -> Interval:
    """The stack's base interval shortened to rational ends."""
    left = stack.left.value if stack.left.root is None else refine(stack.left.root, strip).high
    right = stack.right.value if stack.right.root is None else refine(stack.right.root, strip).low
    return left, right


def _edges(spans: Sequence[Interval], regions: Sequence[Sequence[int]], fibre: Interval, count: int) -> list[fmpq]:
    """The exact contributions of the window's edges to each region's area."""
    total = [fmpq(0)] * count
    for (low, high), row in zip(spans, regions, strict=True):
        total[row[0]] -= fibre[0] * (high - low)
        total[row[-1]] += fibre[1] * (high - low)
    return total


def _refine(
    panels: list[_Panel],
    fixed: Sequence[fmpq],
    lost: fmpq,
    fibre: Interval,
    tolerance: Fraction,
    effort: _Effort,
    check: Callable[[], None],
) -> tuple[tuple[Fraction, Fraction], ...]:
    """Halve panels until every region is known well enough."""
    while True:
        bounds = _bounds(panels, fixed, lost)
        poor = {i for i, (low, high) in enumerate(bounds) if high - low > tolerance * low}
        if not poor:
            return bounds
        if any(to_fraction(lost) * 4 > tolerance * bounds[i][1] for i in poor):
            raise _Unreachable(strips=True)
        load = {i: sum(i in (p.below, p.above) for p in panels) for i in poor}
        target = {i: float(tolerance * max(bounds[i][0], bounds[i][1] / 8)) / (2 * max(load[i], 1)) for i in poor}
        refined: list[_Panel] = []
        for p in panels:
            if any(p.width > target[i] for i in poor & {p.below, p.above}):
                check()
                if p.high - p.low < effort.narrowest:
                    raise _Unreachable(strips=False)
                middle = (p.low + p.high) / 2
                refined.append(_panel(p.curve, p.root, p.low, middle, p.below, p.above, fibre, effort))
                refined.append(_panel(p.curve, p.root, middle, p.high, p.below, p.above, fibre, effort))
            else:
                refined.append(p)
        panels = refined


def _bounds(panels: Sequence[_Panel], fixed: Sequence[fmpq], lost: fmpq) -> tuple[tuple[Fraction, Fraction], ...]:
    totals = [arb(f) for f in fixed]
    for p in panels:
        totals[p.below] += p.integral
        totals[p.above] -= p.integral
    result = []
    for total in totals:
        low, high = _exact(total.lower()), _exact(total.upper())
        result.append((max(low, Fraction(0)), high + to_fraction(lost)))
    return tuple(result)


def _exact(value: arb) -> Fraction:
    """An exact ball's midpoint as a fraction."""
    mantissa, exponent = value.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def _panel(
    curve: Curve, root: int, low: fmpq, high: fmpq, below: int, above: int, fibre: Interval, effort: _Effort
) -> _Panel:
    """A panel with the better of two enclosures."""
    middle = (low + high) / 2
    at_middle = isolate(curve.fibre(middle), *fibre)[root]
    integral = branch_integral(curve.in_v, at_middle, middle, (high - low) / 2, fibre, effort.order)
    if integral is None:
        bottom, top = _horizontals(curve, root, low, high, at_middle, fibre)
        integral = arb(bottom).union(arb(top)) * arb(high - low)
    return _Panel(curve, root, low, high, below, above, integral)


def _horizontals(
    curve: Curve, root: int, low: fmpq, high: fmpq, at_middle: RealRoot, fibre: Interval
) -> tuple[fmpq, fmpq]:
    """Two heights between which the branch stays over [low, high]: horizontals that the curve does not meet there."""
    step = (fibre[1] - fibre[0]) / 2**12 * min(fmpq(1), (high - low) * 16)
    seen = [refine(at_middle, step)]
    inset = (high - low) / 1024  # the ends themselves may be critical
    for u in (low + inset, high - inset):
        over = isolate(curve.fibre(u), *fibre)
        seen.append(refine(over[root], step))
    bottom, top = min(r.low for r in seen), max(r.high for r in seen)
    margin = (top - bottom) / 2 + step
    lower, upper = fibre
    for _ in range(6):
        if (
            bottom - margin > fibre[0]
            and lower == fibre[0]
            and not has_root_between(curve.trace(bottom - margin), low, high)
        ):
            lower = bottom - margin
        if top + margin < fibre[1] and upper == fibre[1] and not has_root_between(curve.trace(top + margin), low, high):
            upper = top + margin
        margin = margin * 4
    return lower, upper
