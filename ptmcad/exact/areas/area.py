"""Certified areas of regions: every branch that separates two regions is integrated with a proved
error.

Guarantee: each area is an interval that contains the true value; its relative width is at most the
tolerance asked for.

Walls are integrated on panels (`panels`), as long as their Taylor series are good for, and by a
Puiseux series beside a turning point or cusp. Panels where that fails are halved, and there the
branch is shut in between two horizontals that the curve does not meet.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import chain, pairwise
from typing import NamedTuple, TypeVar

from flint import arb, ctx, fmpq

from ptmcad.algebra.curve_branches import TooFewBits
from ptmcad.algebra.polynomials import RationalUnivariate
from ptmcad.algebra.real_roots import Interval, RealRoot, refine
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.exact.areas.panels import Border, PanelEffort, WallPanel, halves, panels
from ptmcad.exact.cad.projection import FibredCurve, by_component, max_height_bits
from ptmcad.exact.cad.stacks import StackData
from ptmcad.text.balls import exact
from ptmcad.text.flint_numbers import from_fraction, simplest_between, to_fraction

_Sum = TypeVar("_Sum", fmpq, arb)
Bounds = tuple[tuple[Fraction, Fraction], ...]
"""Of each region's area, in the product of the axes' units."""

_NEGLIGIBLE = Fraction(1, 10**15)
_LONG_COEFFICIENT_BITS = 128
"""Bits granted at first to long coefficients."""
_ROUGH_BITS = 8
"""Bits by which heights are refined to know areas roughly."""
_PANELS = 16
"""Twice the number of panels that a border may take, about."""
_HOPELESS_RATIO = 2**8
"""Strips that are wider than rough areas allow by more than this are made narrower at once: it is
pointless to compute the exact areas first.
"""
_MIN_ORDER = 6
"""Of series, in addition to the tolerance's digits."""
_LONG_FIBRE, _FIBRE_PER_ORDER = 16, 3
"""Of higher degrees in v fibres and local coefficients cost more than series, so longer ones on
fewer panels pay.
"""
_SPARE_BITS = 16
"""Beyond the tolerance's digits: where walls that nearly cancel leave fewer, panels would be cut
without end.
"""
_CACHED_FIBRES = 1024
"""Fibres whose roots are remembered."""


class RegionStacks(NamedTuple):
    """A window cut into stacks whose cells belong to regions, or one half of it.

    Attributes
    ----------
    regions : for each stack the region of each of its cells, from below.
    curves : whose branches are the walls.
    base, fibre : of the whole window.
    images : of a half, the regions of which each one's other part is the mirror image.
    ceiling : the line, over the base, up to which the last cells reach if that is not the window's
        edge.
    """

    stacks: Sequence[StackData]
    regions: Sequence[Sequence[int]]
    curves: Sequence[FibredCurve]
    base: Interval
    fibre: Interval
    images: Sequence[int] = ()
    ceiling: RationalUnivariate | None = None

    @property
    def number(self) -> int:
        """The number of regions."""
        return len(self.images) or 1 + max(max(row) for row in self.regions)

    @property
    def top(self) -> RationalUnivariate:
        """Up to which the last cells reach."""
        return RationalUnivariate([self.fibre[1]]) if self.ceiling is None else self.ceiling

    def whole(self, parts: Sequence[_Sum]) -> list[_Sum]:
        """What belongs to each region, from what belongs to it in the half."""
        return (
            [a + parts[j] for a, j in zip(parts, self.images, strict=True)]
            if self.images
            else list(parts)
        )

    def beside(self, border: Border) -> set[int]:
        """The regions that a wall, or its image, is a wall of."""
        own = {border.below, border.above}
        return own | {self.images[i] for i in own} if self.images else own

    @property
    def height(self) -> fmpq:
        """Of the window."""
        return self.fibre[1] - self.fibre[0]

    def borders(self, spans: Sequence[Interval]) -> Iterator[list[Border]]:
        """For each stack the walls between different regions, from below."""
        curve_of = by_component(self.curves)
        for stack, row, span in zip(self.stacks, self.regions, spans, strict=True):
            ends = stack.left.root, stack.right.root
            yield [
                Border(curve_of[wall.component], wall.root, below, above, span, ends)
                for wall, (below, above) in zip(stack.walls, pairwise(row), strict=True)
                if below != above
            ]


class _Frame(NamedTuple):
    """What the areas are without walls: the exact contributions of the window's edges, and the area
    in the strips.

    Attributes
    ----------
    fixed : of the half, where the window is cut into halves.
    allowed : for each region, the error of a panel's integral that would probably do.
    """

    parts: RegionStacks
    fixed: Sequence[fmpq]
    lost: fmpq
    allowed: Sequence[fmpq]

    def bounds(self, wall_panels: Sequence[WallPanel]) -> Bounds:
        totals = [arb(f) for f in self.fixed]
        for p in wall_panels:
            totals[p.border.below] += p.integral
            totals[p.border.above] -= p.integral
        totals = self.parts.whole(totals)
        lost = to_fraction(self.lost)
        return tuple((max(exact(t.lower()), Fraction(0)), exact(t.upper()) + lost) for t in totals)


class _StripsTooWide(ArithmeticError):
    """The tolerance cannot be reached with strips of this width left out."""


def region_areas(
    parts: RegionStacks, tolerance: Fraction, check: Check = nothing
) -> tuple[Bounds, int]:
    """Bounds for the area of each region, and the bits of precision they needed.

    Parameters
    ----------
    tolerance : largest relative width of each interval.
    check : called between panels; may raise to stop.
    """
    width = parts.base[1] - parts.base[0]
    whole = to_fraction(width * parts.height)
    if parts.number == 1:
        return ((whole, whole),), 0
    digits = len(str(tolerance.denominator // tolerance.numerator))
    # at first not much more for long coefficients: where they cancel, `branch_integral` says so,
    # and arcs may do
    bits = 64 + 6 * digits + min(max_height_bits(parts.curves) // 2, _LONG_COEFFICIENT_BITS)
    bits += _bits_lost(parts.base) + _bits_lost(parts.fibre)
    broad, narrowest = width * fmpq(1, 2 ** (3 * digits // 2)), min(map(_isolated, parts.stacks))
    more = (
        _MIN_ORDER
        + max(0, max((len(c.in_v) for c in parts.curves), default=0) - _LONG_FIBRE)
        // _FIBRE_PER_ORDER
    )
    share, own, finer = fmpq(1, 10 ** (digits + 3) * 4), True, 20
    curve_of = by_component(parts.curves)

    @lru_cache(maxsize=_CACHED_FIBRES)
    def roots(component: int, u: fmpq) -> tuple[RealRoot, ...]:
        # walls over the same stack are cut at the same places, and again when an attempt is
        # repeated
        return curve_of[component].roots_over(u, parts.fibre)

    while True:
        effort = PanelEffort(
            digits + more, width, parts.fibre, broad, narrowest / 2 ** (bits // 2), roots
        )
        try:
            with ctx.workprec(bits):
                bounds = _areas(
                    parts, _spans(parts.stacks, share, own=own), tolerance * 3 / 4, effort, check
                )
                return tuple(_with_room(b, tolerance, whole) for b in bounds), bits
        except TooFewBits:
            bits = 3 * bits // 2
        except _StripsTooWide:
            # a region is tiny: the effort grows fast, so this ends soon
            if own:
                own = False
            else:
                bits, share, finer = bits + finer, share / 2**finer, 2 * finer


def _bits_lost(interval: Interval) -> int:
    """Bits that cancel when the interval's ends are subtracted."""
    ratio = max(abs(interval[0]), abs(interval[1])) / (interval[1] - interval[0])
    return max(0, int(ratio.floor()).bit_length())


def _with_room(
    bounds: tuple[Fraction, Fraction], tolerance: Fraction, whole: Fraction
) -> tuple[Fraction, Fraction]:
    """Bounds a little wider, so that a checker who encloses the area less tightly can still confirm
    them.
    """
    low, high = bounds
    known = (
        high - low <= low * _NEGLIGIBLE
    )  # walls on which the Taylor polynomials are exact, such as straight lines
    # bounds that are narrower than asked for would cost the checker time for nothing
    spare = max(low * tolerance / 16, (low * tolerance / 8 - (high - low)) / 2)
    room = low * _NEGLIGIBLE / 100 if known else spare
    return max(low - room, Fraction(0)), min(high + room, whole)


def _areas(
    parts: RegionStacks,
    spans: Sequence[Interval],
    tolerance: Fraction,
    effort: PanelEffort,
    check: Check,
) -> Bounds:
    """One attempt, at the context's precision."""
    lost = (
        sum((b[0] - a[1] for a, b in pairwise(spans)), fmpq(0))
        * parts.height
        * (2 if parts.images else 1)
    )
    borders = list(parts.borders(spans))
    rough, sizes = _rough(spans, parts, borders, effort)
    if lost * 4 > from_fraction(tolerance) * min(rough) * _HOPELESS_RATIO:
        raise _StripsTooWide
    right = fmpq(2) ** (ctx.prec - _SPARE_BITS) * from_fraction(tolerance)
    if any(size > area * right for size, area in zip(sizes, rough, strict=True)):
        raise TooFewBits
    load = Counter(i for row in borders for b in row for i in parts.beside(b))
    # of a panel's integral: what would do if all were about as bad, with some more panels than
    # borders
    allowed = [
        from_fraction(tolerance) * rough[i] / (_PANELS * max(load[i], 1))
        for i in range(parts.number)
    ]
    covered: list[WallPanel] = []
    for border in chain.from_iterable(borders):
        check()
        covered += panels(
            border, border.span, effort, min(allowed[border.below], allowed[border.above])
        )
    return _refine(
        covered, _Frame(parts, _edges(spans, parts), lost, allowed), tolerance, effort, check
    )


def _isolated(stack: StackData) -> fmpq:
    """About the stack's width."""
    return stack.right.root.low - stack.left.root.high


def _spans(stacks: Sequence[StackData], share: fmpq, *, own: bool) -> list[Interval]:
    """The stacks' base intervals without the strips at their ends, which are left to any region.

    Parameters
    ----------
    share : of a stack's width, for a strip.
    own : whether the stack is the strip's own one. Otherwise it is the narrower of the two stacks
        there: in a vast window some are narrower than others by many orders of magnitude.
    """
    widths = [_isolated(stack) for stack in stacks]
    left = right = widths
    if not own:
        narrower = [min(a, b) for a, b in pairwise(widths)]
        left, right = [widths[0], *narrower], [*narrower, widths[-1]]
    return [_span(s, a * share, b * share) for s, a, b in zip(stacks, left, right, strict=True)]


def _span(stack: StackData, left_strip: fmpq, right_strip: fmpq) -> Interval:
    """The stack's base interval shortened to rational ends, of small height as all arithmetic
    starts from them.
    """
    first, last = refine(stack.left.root, left_strip / 2), refine(stack.right.root, right_strip / 2)
    left, right = first.high, last.low
    if not first.is_rational:
        left = simplest_between(left, min(left + left_strip / 2, stack.sample))
    if not last.is_rational:
        right = simplest_between(max(right - right_strip / 2, stack.sample), right)
    return left, right


def _rough(
    spans: Sequence[Interval],
    parts: RegionStacks,
    borders: Sequence[Sequence[Border]],
    effort: PanelEffort,
) -> tuple[list[fmpq], list[fmpq]]:
    """Each region's area as if its cells were as high everywhere as in the middle, and how large
    the integrals of its walls are, which cancel but for that; both prove nothing."""
    total, sizes = [fmpq(0)] * parts.number, [fmpq(0)] * parts.number
    for (low, high), over, row in zip(spans, borders, parts.regions, strict=True):
        walls = _separated([b.over((low + high) / 2, effort) for b in over], parts.height)
        bottom = parts.fibre[0]
        for border, wall in zip(over, walls, strict=True):
            total[border.below] += (wall.high - bottom) * (high - low)
            size = abs(wall.high) * (high - low)
            sizes[border.below] += size
            sizes[border.above] += size
            bottom = wall.low
        total[row[-1]] += (parts.top((low + high) / 2) - bottom) * (high - low)
    return parts.whole(total), parts.whole(sizes)


def _separated(roots: Sequence[RealRoot], height: fmpq) -> list[RealRoot]:
    """Roots of a fibre known well enough to tell about how far they are from each other."""
    width = height / 2**_ROUGH_BITS
    near = [refine(r, width) for r in roots]
    while any(b.high - a.low > 2 * (b.low - a.high) for a, b in pairwise(near)):
        width = width / 2**_ROUGH_BITS
        near = [refine(r, width) for r in near]
    return near


def _edges(spans: Sequence[Interval], parts: RegionStacks) -> list[fmpq]:
    """The exact contributions of the window's edges to each region's area."""
    total, top = [fmpq(0)] * parts.number, parts.top.integral()
    for (low, high), row in zip(spans, parts.regions, strict=True):
        total[row[0]] -= parts.fibre[0] * (high - low)
        total[row[-1]] += top(high) - top(low)
    return total


def _refine(
    wall_panels: list[WallPanel],
    frame: _Frame,
    tolerance: Fraction,
    effort: PanelEffort,
    check: Check,
) -> Bounds:
    """Halve panels until every region is known well enough."""
    while True:
        bounds = frame.bounds(wall_panels)
        poor = {i for i, (low, high) in enumerate(bounds) if high - low > tolerance * low}
        if not poor:
            return bounds
        if any(to_fraction(frame.lost) * 4 > tolerance * bounds[i][1] for i in poor):
            raise _StripsTooWide
        load = Counter(i for p in wall_panels for i in frame.parts.beside(p.border))
        target = {
            i: tolerance * max(bounds[i][0], bounds[i][1] / 8) / (2 * max(load[i], 1)) for i in poor
        }
        refined: list[WallPanel] = []
        for p in wall_panels:
            allowed = min((target[i] for i in poor & frame.parts.beside(p.border)), default=p.width)
            if p.width > allowed:
                check()
                if p.high - p.low < effort.narrowest:
                    raise TooFewBits
                least = min(frame.allowed[p.border.below], frame.allowed[p.border.above])
                refined += halves(p, effort, min(least, from_fraction(allowed) / 4))
            else:
                refined.append(p)
        wall_panels = refined
