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
from functools import lru_cache
from itertools import pairwise

from flint import arb, ctx, fmpq

from ptmcad.algebra.arcs import arc_integral
from ptmcad.algebra.branches import PrecisionTooLow, avoids, branch_integral
from ptmcad.algebra.polynomials import from_fraction, to_fraction
from ptmcad.algebra.real_roots import RealRoot, isolate, refine, simplest_between
from ptmcad.algebra.window import Interval
from ptmcad.exact.cad.curves import Curve
from ptmcad.exact.cad.stacks import StackData
from ptmcad.text.balls import exact


@dataclass(frozen=True, slots=True)
class _Effort:
    """Degree of the polynomial on a panel, what is worth trying on panels of which width, and what is known already.

    Attributes
    ----------
    width : of the base.
    broad : on panels broader than this horizontals would be too coarse to be worth their time.
    narrowest : narrower panels would need a higher precision.
    roots : of a component over an abscissa within the window; isolated once for all of a stack's walls.
    """

    order: int
    width: fmpq
    broad: fmpq
    narrowest: fmpq
    roots: Callable[[int, fmpq], tuple[RealRoot, ...]]


@dataclass(frozen=True, slots=True)
class _Panel:
    """A part of a wall that separates region ``below`` from region ``above``, with the enclosure of its integral.

    ``smooth`` shows whether the branch was enclosed by its Taylor series or by arcs; ``singular`` is not zero when that
    is not even tried because the branch seems to turn at the left (negative) or right (positive) end, and counts how
    often it seemed so. Neither affects the guarantee.
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
        return 2 * exact(self.integral.rad())


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
    strip = fmpq(1, 10 ** (digits + 3) * 4)
    # at first not much more for long coefficients: where they cancel, `branch_integral` says so, and arcs may do
    bits = (
        64
        + 6 * digits
        + min(max((int(q.height_bits()) for c in curves for q in c.in_v), default=0) // 2, _LONG_COEFFICIENT_BITS)
    )
    bits += _bits_lost(base) + _bits_lost(fibre)
    narrowest = min(map(_isolated, stacks))
    finer, even = 20, True
    by_component = {c.component: c for c in curves}

    @lru_cache(maxsize=_CACHED_FIBRES)
    def roots(component: int, u: fmpq) -> tuple[RealRoot, ...]:
        # walls over the same stack are cut at the same places, and again when an attempt is repeated
        return isolate(by_component[component].fibre(u), *fibre)

    while True:
        broad = width * fmpq(1, 2 ** (3 * digits // 2))
        effort = _Effort(digits + 2, width, broad, narrowest / 2 ** (bits // 2), roots)
        try:
            with ctx.workprec(bits):
                bounds = _areas(stacks, regions, curves, (strip, even), fibre, tolerance * 3 / 4, count, effort, check)
                return tuple(_with_room(b, tolerance, whole) for b in bounds), bits
        except PrecisionTooLow:
            bits = 3 * bits // 2
        except _Unreachable as obstacle:
            # a region is tiny, or the precision is too low for it: the effort grows fast, so this ends soon
            if obstacle.strips and even:
                even = False
            elif obstacle.strips:
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
_HALVING_CUTS = 5
"""Cuts by half towards a turning point before they come faster."""
_MAX_CUTS = 10
"""The fastest cut is to the part 2^-32 of a panel."""
_LONG_COEFFICIENT_BITS = 128
"""Bits granted at first to long coefficients."""
_HOPELESS_RATIO = 2**8
"""So much larger than allowed are strips against rough areas, when it is pointless to find out about the exact ones."""
_CACHED_FIBRES = 1024
"""Fibres whose roots are remembered."""
_ROUGH_HEIGHT_BITS = 20
"""Bits to which the height of a branch is asked for before the regions' areas are known roughly."""


class _Unreachable(ArithmeticError):
    """The tolerance cannot be reached at this precision, or with strips of this width left out."""

    def __init__(self, strips: bool) -> None:
        super().__init__()
        self.strips = strips


def _areas(
    stacks: Sequence[StackData],
    regions: Sequence[Sequence[int]],
    curves: Sequence[Curve],
    strips: tuple[fmpq, bool],
    fibre: Interval,
    tolerance: Fraction,
    count: int,
    effort: _Effort,
    check: Callable[[], None],
) -> tuple[tuple[Fraction, Fraction], ...]:
    """One attempt: around each critical abscissa a strip is left to any region.

    Parameters
    ----------
    strips : their share of a stack's width, and whether it is that of the stack itself. Otherwise it is of the narrower
        of the two stacks there: in a vast window some are narrower than others by many orders of magnitude.
    """
    by_component = {c.component: c for c in curves}
    widths = [_isolated(stack) for stack in stacks]
    narrower = [min(a, b) for a, b in pairwise(widths)]
    sides = (
        zip(widths, widths, strict=True)
        if strips[1]
        else zip((widths[0], *narrower), (*narrower, widths[-1]), strict=True)
    )
    spans = [_span(s, a * strips[0], b * strips[0]) for s, (a, b) in zip(stacks, sides, strict=True)]
    gaps = sum((b[0] - a[1] for a, b in pairwise(spans)), fmpq(0))
    lost = gaps * (fibre[1] - fibre[0])
    if strips[1]:
        rough = _rough(spans, stacks, regions, fibre, count, effort)
        if lost * 4 > from_fraction(tolerance) * min(rough) * _HOPELESS_RATIO:
            raise _Unreachable(strips=True)
    fixed = _edges(spans, regions, fibre, count)
    wanted = (fibre[1] - fibre[0]) / 2**_ROUGH_HEIGHT_BITS
    panels = []
    for (low, high), stack, row in zip(spans, stacks, regions, strict=True):
        for j, wall in enumerate(stack.walls):
            if row[j] != row[j + 1]:
                check()
                source = by_component[wall.component]
                panels.append(_panel(source, wall.root, low, high, row[j], row[j + 1], fibre, effort, wanted))
    return _refine(panels, fixed, lost, fibre, tolerance, effort, check)


def _isolated(stack: StackData) -> fmpq:
    """About the stack's width."""
    low = stack.left.root.high if stack.left.root else stack.left.value
    high = stack.right.root.low if stack.right.root else stack.right.value
    return high - low


def _span(stack: StackData, left_strip: fmpq, right_strip: fmpq) -> Interval:
    """The stack's base interval shortened to rational ends, of small height as all arithmetic starts from them."""
    left, right = stack.left.value, stack.right.value
    if stack.left.root is not None:
        root = refine(stack.left.root, left_strip / 2)
        left = root.high
        if not root.is_rational:
            left = simplest_between(left, min(left + left_strip / 2, stack.sample))
    if stack.right.root is not None:
        root = refine(stack.right.root, right_strip / 2)
        right = root.low
        if not root.is_rational:
            right = simplest_between(max(right - right_strip / 2, stack.sample), right)
    return left, right


def _rough(
    spans: Sequence[Interval],
    stacks: Sequence[StackData],
    regions: Sequence[Sequence[int]],
    fibre: Interval,
    count: int,
    effort: _Effort,
) -> list[fmpq]:
    """Each region's area as if its cells were as high everywhere as in the middle; it proves nothing."""
    total = [fmpq(0)] * count
    for (low, high), stack, row in zip(spans, stacks, regions, strict=True):
        bottom = fibre[0]
        for j, wall in enumerate(stack.walls):
            if row[j] != row[j + 1]:
                at_middle = effort.roots(wall.component, (low + high) / 2)[wall.root]
                total[row[j]] += (at_middle.high - bottom) * (high - low)
                bottom = at_middle.low
        total[row[-1]] += (fibre[1] - bottom) * (high - low)
    return total


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
            allowed = min((target[i] for i in poor & {p.below, p.above}), default=p.width)
            if p.width > allowed:
                check()
                if p.high - p.low < effort.narrowest:
                    raise _Unreachable(strips=False)
                refined += _halves(p, fibre, effort, _wanted(from_fraction(allowed) / (p.high - p.low), fibre))
            else:
                refined.append(p)
        panels = refined


def _wanted(allowed: fmpq, fibre: Interval) -> fmpq:
    """The error of a branch's height to ask for where this much is allowed now: with twice as many right digits.

    What is allowed falls as the areas get known better, and panels that miss it then would have to be halved.
    """
    return min(allowed, allowed * allowed / (fibre[1] - fibre[0])) / 2


def _bounds(panels: Sequence[_Panel], fixed: Sequence[fmpq], lost: fmpq) -> tuple[tuple[Fraction, Fraction], ...]:
    totals = [arb(f) for f in fixed]
    for p in panels:
        totals[p.below] += p.integral
        totals[p.above] -= p.integral
    result = []
    for total in totals:
        low, high = exact(total.lower()), exact(total.upper())
        result.append((max(low, Fraction(0)), high + to_fraction(lost)))
    return tuple(result)


def _halves(p: _Panel, fibre: Interval, effort: _Effort, wanted: fmpq) -> tuple[_Panel, _Panel]:
    """The two parts of a panel; if only one of them is smooth, the other one's far end is taken to be singular.

    A branch that turns at an end is cut nearer and nearer to that end. When this has gone well for some times, the cuts
    come so fast that a turn which is many orders of magnitude smaller than the panel is reached in a few steps.
    """
    share = fmpq(1, 2**2 ** max(0, abs(p.singular) - _HALVING_CUTS))
    if p.singular > 0:
        share = 1 - share
    margin = (p.high - p.low) * min(share, 1 - share) / 8
    cut = p.low + (p.high - p.low) * share
    middle = simplest_between(cut - margin, cut + margin)
    left = _panel(p.curve, p.root, p.low, middle, p.below, p.above, fibre, effort, wanted, min(p.singular, 0))
    right = _panel(p.curve, p.root, middle, p.high, p.below, p.above, fibre, effort, wanted, max(p.singular, 0))
    if left.smooth and not right.smooth:
        right = replace(right, singular=min(max(p.singular, 0) + 1, _MAX_CUTS))
    elif right.smooth and not left.smooth:
        left = replace(left, singular=max(min(p.singular, 0) - 1, -_MAX_CUTS))
    elif abs(p.singular) > _HALVING_CUTS:
        left, right = (replace(q, singular=(q.singular > 0) - (q.singular < 0)) for q in (left, right))
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
    wanted: fmpq,
    singular: int = 0,
) -> _Panel:
    """A panel with the first enclosure that works: Taylor series, arcs, horizontals, the window's edges.

    ``wanted`` is an error of the branch's height that would do.
    """
    middle = (low + high) / 2
    at_middle = effort.roots(curve.component, middle)[root]
    integral = None
    if singular == 0:
        integral = _smooth(curve, root, at_middle, low, high, fibre, effort, wanted)
    smooth = integral is not None
    if integral is None:
        bottom, top = fibre
        if high - low < effort.broad:
            bottom, top = _horizontals(curve, low, high, effort.width, at_middle, fibre)
        integral = arb(bottom).union(arb(top)) * arb(high - low)
    return _Panel(curve, root, low, high, below, above, integral, smooth, singular)


def _smooth(
    curve: Curve, root: int, at_middle: RealRoot, low: fmpq, high: fmpq, fibre: Interval, effort: _Effort, wanted: fmpq
) -> arb | None:
    """The integral of a branch that does not turn, by its Taylor series or between arcs; None if neither is proved.

    Raises
    ------
    PrecisionTooLow
        When a higher precision may help and arcs do not.
    """
    middle, radius = (low + high) / 2, (high - low) / 2
    series, obstacle = None, False
    try:
        series = branch_integral(curve.in_v, at_middle, middle, radius, fibre, effort.order)
    except PrecisionTooLow:
        obstacle = True
    if series is not None and series.rad() < arb(2 * radius * wanted):
        return series

    def branch(u: fmpq) -> RealRoot:
        return at_middle if u == middle else effort.roots(curve.component, u)[root]

    between = arc_integral(curve.in_v, branch, middle, radius, fibre, wanted)
    if between is None and obstacle:
        return _finer_series(curve, at_middle, middle, radius, fibre, effort)
    if series is None or between is None:
        return series if between is None else between
    return series if series.rad() < between.rad() else between


def _finer_series(
    curve: Curve, at_middle: RealRoot, middle: fmpq, radius: fmpq, fibre: Interval, effort: _Effort
) -> arb | None:
    """The integral by the Taylor series at twice to eight times the precision."""
    bits, most = 2 * ctx.prec, 8 * ctx.prec
    while True:
        try:
            with ctx.workprec(bits):
                return branch_integral(curve.in_v, at_middle, middle, radius, fibre, effort.order)
        except PrecisionTooLow:
            if bits >= most:
                raise
        bits *= 2


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
