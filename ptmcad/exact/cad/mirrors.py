"""Walls that are mirror images of others, where a curve has only even powers of u, or a reflection (u, v) to
(u, 2 m(u) - v) maps it to itself, m linear: their panels are known.

Guarantee: exact. The image of a branch is a branch of the same curve; that it is the one asked for is decided by
isolated roots over one abscissa. The integral of the image is that of 2 m less the branch's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb, fmpq

from ptmcad.algebra.polynomials import RationalPolynomial
from ptmcad.algebra.real_roots import RealRoot, refine
from ptmcad.algebra.window import Interval
from ptmcad.exact.cad.curves import base_deflation
from ptmcad.exact.cad.panels import Border, Effort, Panel

_TIMES = 8
"""That a root is refined to see where its image is; by as many bits each time."""

Wall = tuple[int, int, Interval]
"""A curve's component, the number of the root, and the interval."""


def wall_of(border: Border, over: Interval) -> Wall:
    return border.curve.component, border.root, over


def mirrored(
    border: Border, over: Interval, known: Mapping[Wall, Sequence[Panel]], effort: Effort
) -> list[Panel] | None:
    """The panels of a border over a part of its span, from those of its image in an axis or a point.

    None when no image is known.
    """
    curve, (low, high) = border.curve, over
    turned = (-high, -low)
    over_image = base_deflation(curve.in_v) % 2 == 0
    if over_image and (curve.component, border.root, turned) in known:
        return [_turned(p, border) for p in reversed(known[curve.component, border.root, turned])]
    axis = effort.axes[curve.component]
    if axis is not None:
        middle = (border.span[0] + border.span[1]) / 2  # the image has the same number over all of the span
        number = _opposite(effort.roots(curve.component, middle), border.root, effort.fibre, 2 * axis(middle))
        if number is not None:
            if (curve.component, number, over) in known:
                return [_reflected(p, border, axis) for p in known[curve.component, number, over]]
            if over_image and (curve.component, number, turned) in known:
                panels = reversed(known[curve.component, number, turned])
                return [_reflected(_turned(p, border), border, axis) for p in panels]
    return None


def _turned(p: Panel, border: Border) -> Panel:
    """The image over -u of a panel."""
    return Panel(border, -p.high, -p.low, p.integral, p.smooth, -p.singular)


def _reflected(p: Panel, border: Border, axis: RationalPolynomial) -> Panel:
    """The image over the same abscissae of a panel."""
    twice = 2 * axis.integral()
    return p._replace(border=border, integral=arb(twice(p.high) - twice(p.low)) - p.integral)


def _opposite(roots: Sequence[RealRoot], number: int, fibre: Interval, total: fmpq) -> int | None:
    """Which of a fibre's roots in the window is ``total`` less one of them, as one in or beyond the window is; None
    when it is none in the window."""
    root = roots[number]
    for _ in range(_TIMES):
        low, high = total - root.high, total - root.low
        if high <= fibre[0] or low >= fibre[1]:
            return None
        if low > fibre[0] and high < fibre[1]:
            near = [k for k, r in enumerate(roots) if r.low <= high and r.high >= low]
            if len(near) == 1:
                return near[0]
        root = refine(root, (root.high - root.low) / 2**_TIMES)
    return None
