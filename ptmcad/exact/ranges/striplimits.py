"""The limits of an operation range at an end of a strip, and a neighbourhood in which it is
narrower than there.

Guarantee: `limit` is the branch's limit, and over `narrowing_length` the range's two ends draw
nearer to one another, seen from a line of some slope, all the way from the limits. None means that
this was not proved.
"""

from __future__ import annotations

from flint import fmpq

from ptmcad.algebra.algebraic_numbers import fibre_roots, refined
from ptmcad.algebra.polynomials import PLANE, UnivariatePolynomial
from ptmcad.algebra.real_roots import Interval, RealRoot, isolate, refine, sign
from ptmcad.algebra.resultants import resultant
from ptmcad.algebra.slopes import tangent_resultant
from ptmcad.answer.intervals import End
from ptmcad.exact.cad.stacks import BaseEnd
from ptmcad.exact.ranges.rangestrips import (
    RangeEnd,
    RangeStrip,
    at_abscissa,
    bound_over,
    end_interval,
)
from ptmcad.text.flint_numbers import simplest_between, to_fraction


def limit(branch: RangeEnd, strip: RangeStrip, end: BaseEnd, width: fmpq) -> End | None:
    """The limit of a branch at an end of its strip; None when it could not be separated from other
    points.
    """
    if branch.curve is None:
        return to_fraction(branch.edge)
    margin = strip.fibre[1] - strip.fibre[0]
    wide = (strip.fibre[0] - margin, strip.fibre[1] + margin)
    at = end_interval(end, width)
    distance = strip.sample - at[0]
    if at[0] == at[1]:
        fibre = branch.curve.fibre(at[0])
    else:
        assert end.root is not None
        fibre = resultant(
            branch.curve.in_u, [UnivariatePolynomial([c]) for c in end.root.polynomial.coeffs()]
        )
    for _ in range(50):
        u = at[0] + distance
        over = (min(u, at[0]), max(u, at[1]))
        found = at_abscissa(branch, u, strip.fibre, abs(distance) / 2**10)
        top = bound_over(branch, found.high, 1, over, wide)
        bottom = bound_over(branch, found.low, -1, over, wide)
        if top is not None and bottom is not None:
            roots = fibre_roots(fibre, bottom, top)
            if len(roots) == 1:
                return refined(roots[0], to_fraction(width))
        distance = distance / 4
    return None


def narrowing_length(strip: RangeStrip, end: BaseEnd, width: fmpq) -> fmpq | None:
    """A length from an end within which the range gets narrower away from it; None if not proved.

    For some slope s, v - s u of the lower branch does not fall away from the end, that of the upper
    one does not rise, and one of them moves: no point of either has a tangent of this slope, but
    over the end itself.
    """
    at = end_interval(end, width)
    slopes = [fmpq(0)]
    for bits in (6, 20):
        run = (strip.sample - at[0]) / 2**bits
        low, high = sorted(
            _growth(b, strip, (at[0] + run / 2**bits, at[0] + run), fmpq(0))[0]
            for b in strip.branches
        )
        if low != high:
            third = (high - low) / 3
            steps = run - run / 2**bits
            slopes.append(
                simplest_between(*sorted(((low + third) / steps, (high - third) / steps)))
            )
    for slope in slopes:
        (short, lower), (long, upper) = (
            _course(branch, strip, end, slope) for branch in strip.branches
        )
        length = min(short, long)
        if lower is None or upper is None or (at[1] - at[0]) * 4 >= length:
            continue
        if lower >= 0 >= upper and lower != upper:
            return length
    return None


def _course(
    branch: RangeEnd, strip: RangeStrip, end: BaseEnd, slope: fmpq
) -> tuple[fmpq, int | None]:
    """A length from an end within which v - s u of a branch is monotone, and the sign of its
    growth; None: not seen.
    """
    at = end_interval(end, fmpq(1, 2**80))
    run = strip.sample - at[0]
    if branch.curve is not None:
        rows = enumerate(branch.curve.in_v)
        p = PLANE.from_dict(
            {(v, u): int(c) for v, row in rows for u, c in enumerate(row.coeffs()) if c}
        )
        try:
            turns = tangent_resultant(p, (int(slope.p), int(slope.q)))
        except ArithmeticError:  # the curve is a line of this slope
            return abs(run), 0
        own = (end.root or RealRoot.of(end.value)).polynomial
        if not divmod(turns, own)[1]:
            turns = turns // own
        around = (at[0], strip.sample) if run > 0 else (strip.sample, at[1])
        roots = (refine(root, abs(run) / 2**20) for root in isolate(turns, *around))
        bounds = (root.low if run > 0 else root.high for root in roots)
        length = min((abs(run), *(abs(u - at[0]) / 2 for u in bounds)))
        run = length if run > 0 else -length
    low, high = _growth(branch, strip, (at[0] + run / 2, at[0] + run), slope)
    return abs(run), None if low < 0 < high else sign(low + high)


def _growth(branch: RangeEnd, strip: RangeStrip, over: Interval, slope: fmpq) -> Interval:
    """Bounds of what v - s u of a branch grows by from one abscissa to another."""
    near, far = (at_abscissa(branch, u, strip.fibre, abs(over[1] - over[0]) / 2**200) for u in over)
    difference = -slope * (over[1] - over[0])
    return difference + far.low - near.high, difference + far.high - near.low
