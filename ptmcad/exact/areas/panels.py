"""Panels: parts of the walls that separate two regions, each with an enclosure of the branch's
integral.

Guarantee: the integral lies in the enclosure, whichever way it was found: exactly, where the curve
is a polynomial's graph, by the branch's Taylor series (`algebra.curve_branches`), by its Puiseux series
beside a singular point (`algebra.puiseux`), between arcs (`algebra.chords`), between horizontals, or
between the window's edges.
"""

from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.algebra.chords import arc_integral, graph_integral
from ptmcad.algebra.curve_branches import Integral, TooFewBits, branch_integral
from ptmcad.algebra.real_roots import Interval, RealRoot, avoids, order, refine
from ptmcad.exact.cad.projection import FibredCurve
from ptmcad.text.balls import exact
from ptmcad.text.flint_numbers import simplest_between

_REGULAR = 1.5
"""A branch seems to be regular at the ends of an interval if its series converges so much farther.
"""
_MAX_PANELS = 64
"""Panels that an interval is cut into before it is known whether its rest matters."""
_MIN_BITS = 6
"""At least so many bits of a branch's height are wanted."""
_HALVING_CUTS = 5
"""Cuts by half towards a turning point before they come faster."""
_BITS_BY_HALVES = 12
"""What is worse than wanted by more bits is enclosed at a higher precision: that is sooner done
than halving panels.
"""
_MAX_RAISE = 8
"""The highest precision that is tried, in units of the context's."""
_MAX_CUTS = 10
"""The fastest cut is to the part 2^-32 of a panel."""


class PanelEffort(NamedTuple):
    """Degree of the polynomial on a panel, what is worth trying on panels of which width, and what
    is known already.

    Attributes
    ----------
    width : of the base.
    fibre : the window's other side.
    broad : on panels broader than this horizontals would be too coarse to be worth their time.
    narrowest : narrower panels would need a higher precision.
    roots : of a component over an abscissa within the window; isolated once for all of a stack's
        walls.
    """

    order: int
    width: fmpq
    fibre: Interval
    broad: fmpq
    narrowest: fmpq
    roots: Callable[[int, fmpq], tuple[RealRoot, ...]]


class Border(NamedTuple):
    """A wall, the ``root``-th real root of a curve over a stack, that separates region ``below``
    from region ``above``.

    Attributes
    ----------
    span : the stack's base interval without strips at its ends.
    ends : the stack's true ends.
    """

    curve: FibredCurve
    root: int
    below: int
    above: int
    span: Interval
    ends: tuple[RealRoot, RealRoot]

    def over(self, u: fmpq, effort: PanelEffort) -> RealRoot:
        """Its height over an abscissa of its stack, isolated."""
        return effort.roots(self.curve.component, u)[self.root]


class WallPanel(NamedTuple):
    """The part of a border over [low, high], with the enclosure of its integral.

    ``smooth`` shows whether the branch was enclosed by a series or by arcs; ``singular`` is not
    zero when that is not even tried because the branch seems to turn at the left (negative) or
    right (positive) end, and counts how often it seemed so. Neither affects the guarantee.
    """

    border: Border
    low: fmpq
    high: fmpq
    integral: arb
    smooth: bool
    singular: int

    @property
    def width(self) -> Fraction:
        """Twice the enclosure's radius."""
        return 2 * exact(self.integral.rad())


def panels(
    border: Border, over: Interval, effort: PanelEffort, allowed: fmpq, singular: int = 0
) -> list[WallPanel]:
    """Panels over an interval, from the left, each with the first enclosure that works: a
    polynomial's antiderivative, Taylor series, arcs, horizontals, the window's edges.

    Where the series is near enough to the branch in the middle of the interval only, what remains
    is covered likewise, or by a series about the singular point at the stack's end.

    Parameters
    ----------
    allowed : an error of each panel's integral that would do.
    """
    if singular:
        return [_rough_panel(border, over, effort, singular)]
    if (integral := graph_integral(border.curve.in_v, *over)) is not None:
        return [WallPanel(border, *over, arb(integral), True, 0)]
    done: list[WallPanel] = []
    left = [over]
    while left:
        low, high = left.pop()
        hopeless = len(done) > _MAX_PANELS or high - low < effort.narrowest
        middle, radius = (low + high) / 2, (high - low) / 2
        found = None if hopeless else _smooth(border, (low, high), effort, allowed)
        if found is None:
            done.append(_rough_panel(border, (low, high), effort, 0))
            continue
        start, stop = middle - radius * found.share, middle + radius * found.share
        done.append(WallPanel(border, start, stop, found.value, True, 0))
        if start < stop < high and found.radius < _REGULAR:
            if low == border.span[0]:
                done.append(_at_end(border, (low, start), 0, effort, allowed))
                low = done[-1].high
            if high == border.span[1]:
                done.append(_at_end(border, (stop, high), 1, effort, allowed))
                high = done[-1].low
        left += [rest for rest in ((low, start), (stop, high)) if rest[0] < rest[1]]
    return sorted(done, key=lambda p: p.low)


def _rough_panel(border: Border, over: Interval, effort: PanelEffort, singular: int) -> WallPanel:
    """A panel between horizontals, or the window's edges."""
    width = over[1] - over[0]
    bottom, top = effort.fibre
    if width < effort.broad:
        at_middle = border.over((over[0] + over[1]) / 2, effort)
        bottom, top = horizontals(border.curve, at_middle, over, width / effort.width, effort.fibre)
    return WallPanel(border, *over, arb(bottom).union(arb(top)) * arb(width), False, singular)


def _at_end(
    border: Border, over: Interval, side: int, effort: PanelEffort, allowed: fmpq
) -> WallPanel:
    """A panel from an end of the stack as far as a series about that end reaches; a rough one when
    that fails.
    """
    end, near, far = border.ends[side], over[side], over[1 - side]
    width = far - near
    # a rational root may become known as such only when it is refined
    critical, strip = near if order(near, end) == 0 else end.middle, arb(0)
    if critical == near:
        # what is not exactly zero cannot be divided by a power of zero
        bottom, top = effort.fibre
        left_out = min(abs(width) / 2**_MIN_BITS, allowed / (top - bottom) / 2) * (
            1 if width > 0 else -1
        )
        near = simplest_between(*sorted((near + left_out / 2, near + left_out)))
        strip = arb(bottom).union(arb(top)) * arb(abs(near - critical))
    bits = ctx.prec + 3 * int(abs(width / (near - critical)).ceil()).bit_length()
    found = _about_end(border, end, (near, far), effort, allowed, bits)
    if found is None:
        return _rough_panel(border, over, effort, 2 * side - 1)
    value, cut = found
    ends = (over[0], cut) if side == 0 else (cut, over[1])
    return WallPanel(border, *ends, value + strip, True, 0)


def _about_end(
    border: Border, end: RealRoot, ends: Interval, effort: PanelEffort, allowed: fmpq, bits: int
) -> tuple[arb, fmpq] | None:
    """The integral from beside an end of the stack as far as a series about it reaches, and how
    far; None when that fails.

    It is tried with so many bits, then with twice as many where they do not suffice: a cusp's
    series is divided by high powers of the distance from it, and panels cut nearer and nearer to it
    in place of a series would be many.

    Parameters
    ----------
    ends : the place beside the end, then the other one.
    """
    # most curves have no such end: a map of lines needs no series
    from ptmcad.algebra.puiseux import Beside, puiseux_integral

    near, far = ends

    def enclosed() -> tuple[arb, fmpq] | None:
        fine = abs(far - near) / fmpq(2) ** ctx.prec
        beside = Beside(refine(end, fine).ball, near, far)
        return puiseux_integral(
            border.curve.in_v, beside, lambda u: border.over(u, effort), 2 * effort.order, allowed
        )

    for precision in (bits, 2 * bits):
        try:
            with ctx.workprec(precision):
                found = enclosed()
        except TooFewBits:
            continue
        if found is not None:
            return found
    return None


def halves(p: WallPanel, effort: PanelEffort, allowed: fmpq) -> list[WallPanel]:
    """The parts of a panel; if only one half is smooth, the other one's far end is taken to be
    singular.

    A branch that turns at an end is cut nearer and nearer to that end. When this has gone well for
    some times, the cuts come so fast that a turn which is many orders of magnitude smaller than the
    panel is reached in a few steps.
    """
    share = fmpq(1, 2**2 ** max(0, abs(p.singular) - _HALVING_CUTS))
    if p.singular > 0:
        share = 1 - share
    margin = (p.high - p.low) * min(share, 1 - share) / 8
    cut = p.low + (p.high - p.low) * share
    middle = simplest_between(cut - margin, cut + margin)
    left = panels(p.border, (p.low, middle), effort, allowed, min(p.singular, 0))
    right = panels(p.border, (middle, p.high), effort, allowed, max(p.singular, 0))
    first, last = left[0], right[-1]
    if left[-1].smooth and first.smooth and not last.smooth:
        right[-1] = last._replace(singular=min(max(p.singular, 0) + 1, _MAX_CUTS))
    elif right[0].smooth and last.smooth and not first.smooth:
        left[0] = first._replace(singular=max(min(p.singular, 0) - 1, -_MAX_CUTS))
    elif abs(p.singular) > _HALVING_CUTS:
        left[0], right[-1] = (
            q._replace(singular=(q.singular > 0) - (q.singular < 0)) for q in (first, last)
        )
    return left + right


def _smooth(border: Border, over: Interval, effort: PanelEffort, allowed: fmpq) -> Integral | None:
    """The integral of a branch that does not turn, by its Taylor series or between arcs; None if
    neither is proved.

    Raises
    ------
    TooFewBits
        When a higher precision may help and arcs do not.
    """
    in_v = border.curve.in_v
    middle, radius = (over[0] + over[1]) / 2, (over[1] - over[0]) / 2
    at_middle = border.over(middle, effort)
    wanted = min(allowed / (2 * radius), (effort.fibre[1] - effort.fibre[0]) / 2**_MIN_BITS)

    def by_series() -> Integral | None:
        return branch_integral(
            in_v, at_middle, (middle, radius), effort.fibre, effort.order, wanted
        )

    def branch(u: fmpq) -> RealRoot:
        return at_middle if u == middle else border.over(u, effort)

    series, obstacle = None, False
    try:
        series = _sharper(by_series, allowed)
    except TooFewBits:
        obstacle = True
    if series is not None and not series.crowded:
        return series
    # arcs do not mind other branches; they are better, and found sooner, if they start from more
    # digits
    fine = min(wanted, wanted * wanted / (effort.fibre[1] - effort.fibre[0])) / 2
    between = arc_integral(in_v, branch, middle, radius, effort.fibre, fine)
    if between is None:
        return _more_precisely(by_series) if obstacle else series
    arcs = Integral(between, fmpq(1), 1.0, False)
    if obstacle and between.rad() > arb(allowed) * 2**_BITS_BY_HALVES:
        try:
            return _more_precisely(by_series) or arcs
        except TooFewBits:
            return arcs
    return arcs if series is None or between.rad() < arb(allowed) else series


def _sharper(enclose: Callable[[], Integral | None], allowed: fmpq) -> Integral | None:
    """An enclosure, at a higher precision where it is much wider than what would do and that makes
    it narrower.

    A stack may be narrower than its distance from the origin by more orders of magnitude than the
    precision has digits.
    """
    found, bits = enclose(), 2 * ctx.prec
    while (
        found is not None
        and found.value.rad() > arb(allowed) * 2**_BITS_BY_HALVES
        and bits <= _MAX_RAISE * ctx.prec
    ):
        with ctx.workprec(bits):
            finer = enclose()
        if finer is None or finer.value.rad() * 2**_BITS_BY_HALVES > found.value.rad():
            return found
        found, bits = finer, 2 * bits
    return found


def _more_precisely(enclose: Callable[[], Integral | None]) -> Integral | None:
    """An enclosure at twice to eight times the precision."""
    bits, most = 2 * ctx.prec, _MAX_RAISE * ctx.prec
    while True:
        try:
            with ctx.workprec(bits):
                return enclose()
        except TooFewBits:
            if bits >= most:
                raise
        bits *= 2


def horizontals(
    curve: FibredCurve, at_middle: RealRoot, over: Interval, share: fmpq, fibre: Interval
) -> Interval:
    """Two heights between which the branch stays, as the curve meets neither over the panel; the
    window's edge serves where none is found.

    Parameters
    ----------
    at_middle : the branch's value at the panel's middle, isolated.
    over : the panel.
    share : the panel's part of the base.
    """
    height = fibre[1] - fibre[0]
    start = height * min(fmpq(1, 8), share) / 4
    near = refine(at_middle, start / 4)
    bounds = []
    for edge, end, direction in ((fibre[0], near.low, -1), (fibre[1], near.high, 1)):

        def horizontal(k: int, end: fmpq = end, direction: int = direction) -> fmpq | None:
            """A horizontal about 2^k start from the branch, unless the curve may meet it."""
            # of small height, because the test's cost grows with it
            inner, outer = sorted(
                end + direction * start * 2**k * part for part in (fmpq(3, 4), fmpq(1))
            )
            candidate = simplest_between(inner, outer)
            return candidate if avoids(curve.trace(candidate), *over) else None

        found = _nearest(horizontal, direction * (edge - end) / start)
        bounds.append(edge if found is None else found)
    return bounds[0], bounds[1]


def _nearest(horizontal: Callable[[int], fmpq | None], room: fmpq) -> fmpq | None:
    """The first horizontal found free at distance 2^k < room; k grows by leaps, then the leap is
    bisected.
    """
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
