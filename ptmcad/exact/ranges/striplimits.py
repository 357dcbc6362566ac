"""The limits of an operation range at an end of a strip, a neighbourhood in which it is narrower than
there, and the derivatives of its width.

Guarantee: `limit` is the branch's limit, and over `chord_length` the range stays between two
parallel chords from its limits; over `narrowing_length` its two ends draw nearer to one another,
seen from a line of some slope, all the way from the limits. None means that this was not proved.
"""

from __future__ import annotations

from fractions import Fraction

from flint import arb, fmpq

from ptmcad.algebra.chords import side_of_chord, slope_over, tangent_resultant
from ptmcad.algebra.polynomials import PLANE, UnivariatePolynomial
from ptmcad.algebra.real_roots import Interval, fibre_roots, isolate, refine, refined, root_of, sign
from ptmcad.algebra.resultants import resultant
from ptmcad.answer.intervals import End
from ptmcad.exact.cad.stacks import BaseEnd
from ptmcad.exact.ranges.rangestrips import (
    RANGE_END_WIDTH,
    RangeEnd,
    RangeStrip,
    at_abscissa,
    bound_over,
    end_interval,
)
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.flint_numbers import interval_of, simplest_between, to_fraction

Ends = tuple[End, End]
"""Of an interval of the parameter."""


def ends_of(end: End) -> Interval:
    """An interval that holds a limit: of length zero when it is rational."""
    return interval_of(AlgebraicNumber.of(end))


def limit(branch: RangeEnd, strip: RangeStrip, end: BaseEnd) -> End | None:
    """The limit of a branch at an end of its strip; None when it could not be separated from other
    points.
    """
    if branch.curve is None:
        return to_fraction(branch.edge)
    margin = strip.fibre[1] - strip.fibre[0]
    wide = (strip.fibre[0] - margin, strip.fibre[1] + margin)
    at = end_interval(end)
    distance = strip.sample - at[0]
    if at[0] == at[1]:
        fibre = branch.curve.polynomial_over(at[0])
    else:
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
                return refined(roots[0], to_fraction(RANGE_END_WIDTH))
        distance = distance / 4
    return None


def limits(strip: RangeStrip, end: BaseEnd) -> Ends | None:
    """Those of both branches."""
    low, high = (limit(branch, strip, end) for branch in strip.branches)
    return None if low is None or high is None else (low, high)


def narrowing_length(strip: RangeStrip, end: BaseEnd) -> fmpq | None:
    """A length from an end within which the range gets narrower away from it; None if not proved.

    For some slope s, v - s u of the lower branch does not fall away from the end, that of the upper
    one does not rise, and one of them moves: no point of either has a tangent of this slope, but
    over the end itself.
    """
    at = end_interval(end)
    slopes = [fmpq(0)]
    for bits in (6, 20):
        run = (strip.sample - at[0]) / 2**bits
        low, high = sorted(
            _growth(b, strip, (at[0] + run / 2**bits, at[0] + run), fmpq(0))[0]
            for b in strip.branches
        )
        if low != high:
            steps = run - run / 2**bits
            slopes.append(
                simplest_between(*sorted(((2 * low - high) / steps, (2 * high - low) / steps)))
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
        own = end.root.polynomial
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


def chord_length(strip: RangeStrip, end: fmpq, direction: int, own: Ends) -> fmpq | None:
    """A length within which the range keeps between parallel chords from its limits at an end; None
    if not proved.
    """
    length = abs(strip.sample - end)
    branches, starts = (strip.low, strip.high), [ends_of(e) for e in own]
    for _ in range(40):
        run = direction * length
        tips = [at_abscissa(b, end + run, strip.fibre, length / 2**40) for b in branches]
        rises = [
            ((tip.low + tip.high) / 2 - (start[0] + start[1]) / 2) / run
            for tip, start in zip(tips, starts, strict=True)
        ]
        # the lower end rises more than the upper one where the range gets narrower
        if (rises[0] - rises[1]) * direction > 0:
            third = (rises[0] - rises[1]) / 3
            slope = simplest_between(*sorted((rises[1] + third, rises[0] - third)))
            if all(
                _keeps_to(side, branch, strip.fibre, (end, limit), slope, run)
                for side, branch, limit in zip((1, -1), branches, own, strict=True)
            ):
                return length
        length = length / 4
    return None


def _keeps_to(
    side: int, branch: RangeEnd, fibre: Interval, start: tuple[fmpq, End], slope: fmpq, run: fmpq
) -> bool:
    """Whether a branch is proved to stay above (side 1) or below (side -1) a chord.

    It starts at a branch's limit at the end of a strip, and goes as far as ``run``, which is
    negative towards the left.
    """
    end, limit = start
    low, high = (value + slope * run for value in ends_of(limit))
    tip = at_abscissa(branch, end + run, fibre, abs(run) / 2**60)
    if not (tip.low > high if side > 0 else tip.high < low):
        return False
    if branch.curve is None:
        return (
            True  # the edge is level and, as the tip shows, the chord leaves it to the right side
        )
    if isinstance(limit, Fraction):
        return False
    return side_of_chord(branch.curve.in_v, end, root_of(limit), slope, run)


def width_slopes(strip: RangeStrip, low: fmpq, high: fmpq) -> tuple[arb, arb] | None:
    """Enclosures of the width's first and second derivative over a piece."""
    middle, radius = (low + high) / 2, (high - low) / 2
    total = (arb(0), arb(0))
    for branch, side in ((strip.low, -1), (strip.high, 1)):
        if branch.curve is None:
            continue
        at = at_abscissa(branch, middle, strip.fibre, radius / 2**40)
        slope = slope_over(branch.curve.in_v, at, middle, radius)
        if slope is None:
            return None
        total = (total[0] + side * slope[0], total[1] + side * slope[1])
    return total


def slope_sign(strip: RangeStrip, u: fmpq, width: fmpq) -> int | None:
    """The sign of the width's derivative at an abscissa; None when it is too near to zero."""
    for bits in (10, 40, 80):
        slopes = width_slopes(strip, u - width / 2**bits, u + width / 2**bits)
        if slopes is not None and (slopes[0] > 0 or slopes[0] < 0):
            return 1 if slopes[0] > 0 else -1
    return None
