"""Panels: parts of the walls that separate two regions, each with an enclosure of the branch's integral.

Guarantee: the integral lies in the enclosure, whichever way it was found: by the branch's Taylor series
(`algebra.branches`), between arcs (`algebra.arcs`), between horizontals, or between the window's edges.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.algebra.arcs import arc_integral
from ptmcad.algebra.branches import PrecisionTooLow, branch_integral
from ptmcad.algebra.real_roots import RealRoot, simplest_between
from ptmcad.algebra.window import Interval
from ptmcad.exact.cad.curves import Curve
from ptmcad.exact.cad.horizontals import horizontals
from ptmcad.text.balls import exact

_HALVING_CUTS = 5
"""Cuts by half towards a turning point before they come faster."""
_MAX_CUTS = 10
"""The fastest cut is to the part 2^-32 of a panel."""


class Effort(NamedTuple):
    """Degree of the polynomial on a panel, what is worth trying on panels of which width, and what is known already.

    Attributes
    ----------
    width : of the base.
    fibre : the window's other side.
    broad : on panels broader than this horizontals would be too coarse to be worth their time.
    narrowest : narrower panels would need a higher precision.
    roots : of a component over an abscissa within the window; isolated once for all of a stack's walls.
    """

    order: int
    width: fmpq
    fibre: Interval
    broad: fmpq
    narrowest: fmpq
    roots: Callable[[int, fmpq], tuple[RealRoot, ...]]


class Border(NamedTuple):
    """A wall, the ``root``-th real root of a curve, that separates region ``below`` from region ``above``."""

    curve: Curve
    root: int
    below: int
    above: int

    def over(self, u: fmpq, effort: Effort) -> RealRoot:
        """Its height over an abscissa of its stack, isolated."""
        return effort.roots(self.curve.component, u)[self.root]


class Panel(NamedTuple):
    """The part of a border over [low, high], with the enclosure of its integral.

    ``smooth`` shows whether the branch was enclosed by its Taylor series or by arcs; ``singular`` is not zero when that
    is not even tried because the branch seems to turn at the left (negative) or right (positive) end, and counts how
    often it seemed so. Neither affects the guarantee.
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


def panel(border: Border, low: fmpq, high: fmpq, effort: Effort, wanted: fmpq, singular: int = 0) -> Panel:
    """A panel with the first enclosure that works: Taylor series, arcs, horizontals, the window's edges.

    Parameters
    ----------
    wanted : an error of the branch's height that would do.
    """
    at_middle = border.over((low + high) / 2, effort)
    integral = _smooth(border, at_middle, (low, high), effort, wanted) if singular == 0 else None
    smooth = integral is not None
    if integral is None:
        bottom, top = effort.fibre
        if high - low < effort.broad:
            share = (high - low) / effort.width
            bottom, top = horizontals(border.curve, at_middle, (low, high), share, effort.fibre)
        integral = arb(bottom).union(arb(top)) * arb(high - low)
    return Panel(border, low, high, integral, smooth, singular)


def halves(p: Panel, effort: Effort, wanted: fmpq) -> tuple[Panel, Panel]:
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
    left = panel(p.border, p.low, middle, effort, wanted, min(p.singular, 0))
    right = panel(p.border, middle, p.high, effort, wanted, max(p.singular, 0))
    if left.smooth and not right.smooth:
        right = right._replace(singular=min(max(p.singular, 0) + 1, _MAX_CUTS))
    elif right.smooth and not left.smooth:
        left = left._replace(singular=max(min(p.singular, 0) - 1, -_MAX_CUTS))
    elif abs(p.singular) > _HALVING_CUTS:
        left, right = (q._replace(singular=(q.singular > 0) - (q.singular < 0)) for q in (left, right))
    return left, right


def _smooth(border: Border, at_middle: RealRoot, over: Interval, effort: Effort, wanted: fmpq) -> arb | None:
    """The integral of a branch that does not turn, by its Taylor series or between arcs; None if neither is proved.

    Raises
    ------
    PrecisionTooLow
        When a higher precision may help and arcs do not.
    """
    in_v = border.curve.in_v
    middle, radius = (over[0] + over[1]) / 2, (over[1] - over[0]) / 2

    def by_series() -> arb | None:
        return branch_integral(in_v, at_middle, middle, radius, effort.fibre, effort.order)

    def branch(u: fmpq) -> RealRoot:
        return at_middle if u == middle else border.over(u, effort)

    series, obstacle = None, False
    try:
        series = by_series()
    except PrecisionTooLow:
        obstacle = True
    if series is not None:
        return series
    between = arc_integral(in_v, branch, middle, radius, effort.fibre, wanted)
    return _more_precisely(by_series) if between is None and obstacle else between


def _more_precisely(enclose: Callable[[], arb | None]) -> arb | None:
    """An enclosure at twice to eight times the precision."""
    bits, most = 2 * ctx.prec, 8 * ctx.prec
    while True:
        try:
            with ctx.workprec(bits):
                return enclose()
        except PrecisionTooLow:
            if bits >= most:
                raise
        bits *= 2
