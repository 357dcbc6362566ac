"""Horizontals between which a branch of a plane curve runs over a panel.

Guarantee: over the panel the branch stays between the two heights, because the curve does not meet
the horizontals there; the window's edge serves where none is found.
"""

from __future__ import annotations

from collections.abc import Callable

from flint import fmpq

from ptmcad.algebra.real_roots import Interval, RealRoot, avoids, refine
from ptmcad.exact.cad.projection import FibredCurve
from ptmcad.text.flint_numbers import simplest_between


def horizontals(
    curve: FibredCurve, at_middle: RealRoot, over: Interval, share: fmpq, fibre: Interval
) -> Interval:
    """Two heights between which the branch stays.

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
