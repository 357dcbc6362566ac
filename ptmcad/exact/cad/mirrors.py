"""Walls that are mirror images of others, where a curve has only even powers of a coordinate: their panels are known.

Guarantee: exact. The image of a branch is a branch of the same curve; that it is the one asked for is decided by
isolated roots over one abscissa.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ptmcad.algebra.real_roots import RealRoot, refine
from ptmcad.algebra.window import Interval
from ptmcad.exact.cad.curves import base_deflation, deflation
from ptmcad.exact.cad.panels import Border, Effort, Panel

_TIMES = 8
"""That a root is refined to see where its image is; by as many bits each time."""

Wall = tuple[int, int, Interval]
"""A curve's component, the number of the root, and the interval."""


def wall_of(border: Border) -> Wall:
    return border.curve.component, border.root, border.span


def mirrored(border: Border, known: Mapping[Wall, Sequence[Panel]], effort: Effort) -> list[Panel] | None:
    """The panels of a border from those of its image in an axis or the origin; None when no image is known."""
    curve, (low, high) = border.curve, border.span
    turned = (-high, -low)
    over_image = base_deflation(curve.in_v) % 2 == 0
    if over_image and (curve.component, border.root, turned) in known:
        return [_image(p, border, True, False) for p in reversed(known[curve.component, border.root, turned])]
    if deflation(curve.in_v) % 2 == 0:
        roots = effort.roots(curve.component, (low + high) / 2)
        number = _opposite(roots, border.root, effort.fibre)
        if number is not None:
            for over in (border.span, turned) if over_image else (border.span,):
                if (curve.component, number, over) in known:
                    panels = known[curve.component, number, over]
                    return [_image(p, border, over != border.span, True) for p in panels]
    return None


def _image(p: Panel, border: Border, across: bool, below: bool) -> Panel:
    integral = -p.integral if below else p.integral
    if across:
        return Panel(border, -p.high, -p.low, integral, p.smooth, -p.singular)
    return p._replace(border=border, integral=integral)


def _opposite(roots: Sequence[RealRoot], number: int, fibre: Interval) -> int | None:
    """Which of the roots in the window, of an even polynomial, is the negative of one of them; None when none is."""
    root = roots[number]
    for _ in range(_TIMES):
        low, high = -root.high, -root.low
        if high <= fibre[0] or low >= fibre[1]:
            return None
        if low > fibre[0] and high < fibre[1]:
            near = [k for k, r in enumerate(roots) if r.low <= high and r.high >= low]
            if len(near) == 1:
                return near[0]
        root = refine(root, (root.high - root.low) / 2**_TIMES)
    return None
