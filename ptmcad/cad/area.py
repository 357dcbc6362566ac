"""Certified areas of regions: every branch that separates two regions is integrated with a proved error.

Guarantee: each area is an interval that contains the true value; its relative width is at most the tolerance asked for.

The branch of a wall is integrated on panels by `algebra.branches`; panels where that fails, as it must at turning
points, are halved, and there the branch is shut in between two horizontals that the curve does not meet. The number of
panels grows with the logarithm of 1/tolerance.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

from flint import arb, ctx, fmpq

from ptmcad.algebra.branches import PrecisionTooLow, avoids, branch_integral
from ptmcad.algebra.polynomials import to_fraction
from ptmcad.algebra.real_roots import RealRoot, isolate, refine, simplest_between
from ptmcad.algebra.window import Interval
from ptmcad.cad.curves import Curve
from ptmcad.cad.stacks import StackData


@dataclass(frozen=True, slots=True)
class _Effort:
    """Degree of the polynomial on a panel, and what is worth trying on panels of which width.

    Attributes
    ----------
    width : of the base.
    broad : on panels broader than this horizontals would be too coarse to be worth their time.
    narrowest : narrower panels would need a higher precision.
    """

    order: int
    width: fmpq
    broad: fmpq
    narrowest: fmpq


@dataclass(frozen=True, slots=True)
class _Panel:
    """A part of a wall that separates region ``below`` from region ``above``, with the enclosure of its integral.

    ``smooth`` tells whether the branch was enclosed by its Taylor series; ``singular`` is -1 or 1 when that is not
    even tried because the branch seems to turn at the left or right end, else 0. Neither affects the guarantee.
    """

    curve: Curve
    root: int
    low: fmpq
    high: fmpq
    below: int
    above: int
    integral: arb
    smooth: bool
    singular: int

    @property
    def width(self) -> Fraction:
        """Twice the enclosure's radius."""
        return 2 * _exact(self.integral.rad())


def region_areas(
    stacks: Sequence[StackData],
    regions: Sequence[Sequence[int]],
    curves: Sequence[Curve],
    base: Interval,
    fibre: Interval,
    tolerance: Fraction,
    check: Callable[[], None] = lambda: None,
) -> tuple[tuple[tuple[Fraction, Fraction], ...], int]:
    """Bounds for the area of each region, in the product of the axes' units, and the bits of precision they needed.

    Parameters
    ----------
    regions : for each stack the region of each of its cells, from below.
    tolerance : largest relative width of each interval.
    check : called between panels; may raise to stop.
    """
    count = 1 + max(max(row) for row in regions)
    whole = to_fraction((base[1] - base[0]) * (fibre[1] - fibre[0]))
    if count == 1:
        return ((whole, whole),), 0
    digits = len(str(tolerance.denominator // tolerance.numerator))
    width = base[1] - base[0]
    strip = width * fmpq(1, 10 ** (digits + 3) * 4 * (len(stacks) + 1))
    bits = 64 + 6 * digits + max((int(q.height_bits()) for c in curves for q in c.in_v), default=0) // 2
    bits += _bits_lost(base) + _bits_lost(fibre)
    finer = 20
    while True:
        effort = _Effort(digits + 2, width, width * fmpq(1, 2 ** (3 * digits // 2)), width / 2 ** (bits // 2))
        try:
            with ctx.workprec(bits):
                bounds = _areas(stacks, regions, curves, strip, fibre, tolerance * 3 / 4, count, effort, check)
                return tuple(_with_room(b, tolerance, whole) for b in bounds), bits
        except PrecisionTooLow:
            bits = 3 * bits // 2
        except _Unreachable as obstacle:
            # a region is tiny, or the precision is too low for it: the effort grows fast, so this ends soon
            if obstacle.strips:
                bits, strip, finer = bits + finer, strip / 2**finer, 2 * finer
            else:
                bits = 3 * bits // 2


def _bits_lost(interval: Interval) -> int:
    """Bits that cancel when the interval's ends are subtracted."""
    ratio = max(abs(interval[0]), abs(interval[1])) / (interval[1] - interval[0])
    return max(0, int(ratio.floor()).bit_length())


def _with_room(bounds: tuple[Fraction, Fraction], tolerance: Fraction, whole: Fraction) -> tuple[Fraction, Fraction]:
    """Bounds a little wider, so that a checker who encloses the area less tightly can still confirm them."""
    low, high = bounds
    known = high - low <= low * _NEGLIGIBLE  # walls on which the Taylor polynomials are exact, such as straight lines
    room = low * (_NEGLIGIBLE / 100 if known else tolerance / 16)
    return max(low - room, Fraction(0)), min(high + room, whole)


_NEGLIGIBLE = Fraction(1, 10**15)


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
    """The stack's base interval shortened to rational ends, of small height as all arithmetic starts from them."""
    left, right = stack.left.value, stack.right.value
    if stack.left.root is not None:
        root = refine(stack.left.root, strip / 2)
        left = root.high
        if not root.is_rational:
            left = simplest_between(left, min(left + strip / 2, stack.sample))
    if stack.right.root is not None:
        root = refine(stack.right.root, strip / 2)
        right = root.low
        if not root.is_rational:
            right = simplest_between(max(right - strip / 2, stack.sample), right)
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
        load = Counter(i for p in panels for i in (p.below, p.above))
        target = {i: tolerance * max(bounds[i][0], bounds[i][1] / 8) / (2 * max(load[i], 1)) for i in poor}
        refined: list[_Panel] = []
        for p in panels:
            if any(p.width > target[i] for i in poor & {p.below, p.above}):
                check()
                if p.high - p.low < effort.narrowest:
                    raise _Unreachable(strips=False)
                refined += _halves(p, fibre, effort)
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


def _halves(p: _Panel, fibre: Interval, effort: _Effort) -> tuple[_Panel, _Panel]:
    """The two parts of a panel; if only one of them is smooth, the other one's far end is taken to be singular."""
    margin = (p.high - p.low) * fmpq(7, 16)
    middle = simplest_between(p.low + margin, p.high - margin)
    left = _panel(p.curve, p.root, p.low, middle, p.below, p.above, fibre, effort, min(p.singular, 0))
    right = _panel(p.curve, p.root, middle, p.high, p.below, p.above, fibre, effort, max(p.singular, 0))
    if left.smooth and not right.smooth:
        right = replace(right, singular=1)
    elif right.smooth and not left.smooth:
        left = replace(left, singular=-1)
    return left, right


def _panel(
    curve: Curve,
    root: int,
    low: fmpq,
    high: fmpq,
    below: int,
    above: int,
    fibre: Interval,
    effort: _Effort,
    singular: int = 0,
) -> _Panel:
    """A panel with the first enclosure that works: Taylor series, horizontals, the window's edges."""
    middle = (low + high) / 2
    at_middle = isolate(curve.fibre(middle), *fibre)[root]
    integral = None
    if singular == 0:
        integral = branch_integral(curve.in_v, at_middle, middle, (high - low) / 2, fibre, effort.order)
    smooth = integral is not None
    if integral is None:
        bottom, top = fibre
        if high - low < effort.broad:
            bottom, top = _horizontals(curve, low, high, effort.width, at_middle, fibre)
        integral = arb(bottom).union(arb(top)) * arb(high - low)
    return _Panel(curve, root, low, high, below, above, integral, smooth, singular)


def _horizontals(
    curve: Curve, low: fmpq, high: fmpq, width: fmpq, at_middle: RealRoot, fibre: Interval
) -> tuple[fmpq, fmpq]:
    """Two heights between which the branch stays over [low, high]: horizontals that the curve does not meet there."""
    height = fibre[1] - fibre[0]
    start = height * min(fmpq(1, 8), (high - low) / width) / 4
    near = refine(at_middle, start / 4)
    bounds = []
    for edge, end, direction in ((fibre[0], near.low, -1), (fibre[1], near.high, 1)):

        def horizontal(k: int, end: fmpq = end, direction: int = direction) -> fmpq | None:
            """A horizontal about 2^k start from the branch, unless the curve may meet it."""
            # of small height, because the test's cost grows with it
            inner, outer = sorted(end + direction * start * 2**k * part for part in (fmpq(3, 4), fmpq(1)))
            candidate = simplest_between(inner, outer)
            return candidate if avoids(curve.trace(candidate), low, high) else None

        found = _nearest(horizontal, direction * (edge - end) / start)
        bounds.append(edge if found is None else found)
    return bounds[0], bounds[1]


def _nearest(horizontal: Callable[[int], fmpq | None], room: fmpq) -> fmpq | None:
    """The first horizontal found free at distance 2^k < room; k grows by leaps, then the leap is bisected."""
    most = max(0, int(room.ceil()) - 1).bit_length() - 1
    failed, k = -1, 0
    found = None
    while k <= most and found is None:
        found = horizontal(k)
        if found is None:
            failed, k = k, (2 * k if k > 8 else k + 1)
    while found is not None and k - failed > 1:
        between = (failed + k) // 2
        nearer = horizontal(between)
        if nearer is None:
            failed = between
        else:
            found, k = nearer, between
    return found
