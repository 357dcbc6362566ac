"""Where the operation range of fig. 4's slice is widest: a proof that its width has its only maximum at L2 = 1.

Guarantee: `Widest.proved` is True only if every step was shown in exact arithmetic or by balls.

The range's ends low(L2) < high(L2) lie on the curve p(rho, L2) = 0 of the variety, in the strip 1/10 <= rho <= 2. No
branch enters or leaves the strip, so over an interval of L2 without a fold the number of branches is constant. Then:
(1) below 49/250 there is none, and from there to 1/5 those that are there stay between 9/20 and 11/20;
(2) from 199/1000 to 1 there are two without a point of slope 0, and low falls while high rises;
(3) at L2 = 1 the curve has two points in the strip, so both ends are continuous;
(4) from 1 to 3/2 no slope is 1/2, that of low is more and that of high is less, so the width falls;
(5) from 3/2 to 2 both ends rise, so the width over [a, b] is at most high(b) - low(a), which is less than that at 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

from ptmcad.algebra.polynomials import Coefficient, UnivariatePolynomial, coefficients_in, from_plane, univariate
from ptmcad.algebra.real_roots import isolate, squarefree_part
from ptmcad.algebra.slopes import Direction, may_be_tangent, tangent_resultant
from ptmcad.studies.paper.slices import curves, operation_range
from ptmcad.text.flint_numbers import from_fraction

FIGURE = "fig4"
STRIP = (Fraction(1, 10), Fraction(2))
NECK = (Fraction(9, 20), Fraction(11, 20))
"""Where the two ends are just after the range begins, at L2 = 0.19899..."""
BEFORE, BRACKET, AFTER = Fraction(49, 250), Fraction(199, 1000), Fraction(1, 5)
ONE, MIDDLE, END = Fraction(1), Fraction(3, 2), Fraction(2)
STEP = Fraction(1, 20)
FOLD: Direction = (1, 0)
UPRIGHT: Direction = (0, 1)
HALF: Direction = (1, 2)

Ends = tuple[Fraction, Fraction, Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class Widest:
    """The proof's steps, each True when it was shown, and the widths at some L2 as (lower, upper) bounds."""

    steps: Mapping[str, bool]
    widths: Mapping[Fraction, tuple[Fraction, Fraction]]

    @property
    def proved(self) -> bool:
        return all(self.steps.values())


@lru_cache(maxsize=1)
def widest() -> Widest:
    """Prove, for 0 < L2 <= 2, that the width at L2 = 1 exceeds all others.

    Raises
    ------
    ArithmeticError
        When the variety is not one curve, or the range is missing where it is needed.
    """
    components = curves(FIGURE)
    if len(components) != 1:
        raise ArithmeticError(f"the variety of {FIGURE} has {len(components)} curves")
    p = from_plane(components[0].polynomial)
    never = Tangents(p, {d: tangent_resultant(p, d) for d in (FOLD, UPRIGHT, HALF)}).never
    near = [ONE - Fraction(1, 100), ONE, ONE + Fraction(1, 100), ONE + Fraction(1, 50)]
    later = [MIDDLE + n * STEP for n in range(int((END - MIDDLE) / STEP) + 1)]
    grid = [Fraction(1, 2), Fraction(3, 4), Fraction(9, 10), *near, Fraction(11, 10), *later]
    ends = {x: _ends(x) for x in grid}
    widths = {x: (c - b, d - a) for x, (a, b, c, d) in ends.items()}
    best = widths[ONE][0]
    sides = ((STRIP[0], NECK[0]), (NECK[1], STRIP[1]))
    steps = {
        "no branch enters or leaves the strip": all(not _crossings(p, r, Fraction(0), END + STEP) for r in STRIP),
        "(1) no fold below 49/250": never(FOLD, Fraction(0), BEFORE, STRIP),
        "(1) no branch below 49/250": _number(p, Fraction(1, 10), STRIP) == 0,
        "(1) from 49/250 to 1/5 no fold off the neck": all(never(FOLD, BEFORE, AFTER, side) for side in sides),
        "(1) from 49/250 to 1/5 no branch leaves the neck": all(not _crossings(p, r, BEFORE, AFTER) for r in NECK),
        "(1) no branch off the neck": all(_number(p, x, side) == 0 for x in (BEFORE, AFTER) for side in sides),
        "(1) the neck is narrow": NECK[1] - NECK[0] < best,
        "(2) no fold and no slope 0": never(FOLD, BRACKET, ONE, STRIP) and never(UPRIGHT, BRACKET, ONE, STRIP),
        "(2) two branches, moving apart": _number(p, Fraction(1, 2), STRIP) == 2
        and _disjoint(ends[Fraction(9, 10)], ends[near[0]]),
        "(3) two points at L2 = 1": _number(p, ONE, STRIP) == 2,
        "(3) the ends lie on the same side of 1/2": all(ends[x][1] < Fraction(1, 2) < ends[x][2] for x in near),
        "(4) no fold and no slope 1/2": never(FOLD, ONE, MIDDLE, STRIP) and never(HALF, ONE, MIDDLE, STRIP),
        "(4) two branches, low steeper than 1/2, high not": _number(p, MIDDLE, STRIP) == 2
        and _steeper(ends[near[2]], ends[near[3]], near[3] - near[2]),
        "(5) no fold and no slope 0": never(FOLD, MIDDLE - STEP, END + STEP, STRIP)
        and never(UPRIGHT, MIDDLE - STEP, END + STEP, STRIP),
        "(5) both ends rise": all(ends[a][1] < ends[b][0] and ends[a][3] < ends[b][2] for a, b in pairwise(later)),
        "(5) bounds below the width at 1": all(ends[b][3] - ends[a][0] < best for a, b in pairwise(later)),
    }
    return Widest(steps, widths)


def _ends(length2: Fraction) -> Ends:
    interval = operation_range(FIGURE, "rho", length2)
    if interval is None:
        raise ArithmeticError(f"there is no range at L2 = {length2}")
    return interval.bounds()


@dataclass(frozen=True, slots=True)
class Tangents:
    """The heights at which the curve may have a tangent in a direction, for every direction that the proof needs."""

    curve: Coefficient
    heights: Mapping[Direction, UnivariatePolynomial]

    def never(self, direction: Direction, low: Fraction, high: Fraction, within: Sequence[Fraction]) -> bool:
        """Whether for L2 in the open interval no point with rho ``within`` has a tangent in the direction."""
        found = isolate(self.heights[direction], from_fraction(low), from_fraction(high))
        left, right = (from_fraction(r) for r in within)
        return not any(may_be_tangent(self.curve, direction, y, left, right) for y in found)


def _crossings(p: Coefficient, rho: Fraction, low: Fraction, high: Fraction) -> int:
    """The number of L2 in the open interval at which the curve meets the given rho."""
    trace = squarefree_part(univariate(coefficients_in(p, 1), from_fraction(rho)))
    return len(isolate(trace, from_fraction(low), from_fraction(high)))


def _number(p: Coefficient, length2: Fraction, within: Sequence[Fraction]) -> int:
    """The number of points of the curve at an L2 with rho in the open interval."""
    trace = squarefree_part(univariate(coefficients_in(p, 0), from_fraction(length2)))
    return len(isolate(trace, from_fraction(within[0]), from_fraction(within[1])))


def _disjoint(first: Ends, second: Ends) -> bool:
    """Whether the low end falls and the high end rises."""
    return second[1] < first[0] and second[2] > first[3]


def _steeper(first: Ends, second: Ends, step: Fraction) -> bool:
    """Whether the low end moves by more than half the step and the high end by less."""
    return second[0] - first[1] > step / 2 > second[3] - first[2]
