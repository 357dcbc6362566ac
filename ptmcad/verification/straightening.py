"""Coordinates in which one branch beside a point, or towards infinity, is the only one through its point.

Near x = 0 let p(x, v) = 0 have several branches. Newton's polygon of the terms that do not vanish says with which power
v ~ c x^(a/b) the wanted one begins: the one that is compared with the branch's height at a place beside x = 0. With
x = s^b and v = s^a w its equation is divided by a power of s; where c is a multiple root, the same is done with w - c
and s, again and again, until the branch is the only one through its point. So turning points, nodes, cusps, branches
that touch, those that run beside one another to infinity and their like are all one case.

Guarantee: none is needed. The coordinates are an exact change of variables whatever has been chosen; terms that should
vanish are kept (`Chart.low`), and `ptmcad.verification.turning` counts them as error.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import takewhile
from typing import NamedTuple

from flint import arb, arb_poly, ctx

from ptmcad.verification.disks import recentered

_STAGES = 6
"""Newton polygons for one branch."""
_MAX_POWER = 12
"""The greatest power of s for x."""
_STEPS = 64
"""Of Newton's method towards a multiple root."""
_TOGETHER = 6
"""Branches that may begin with the same term."""


class Chart(NamedTuple):
    """x = s^power and v = sum of c s^k over (k, c) in along + s^exponent w; p = s^m sum of rows_j w^j for some m.

    Attributes
    ----------
    rows : coefficients in s of the powers of w, those of lower order than ``lowered`` small.
    there : w at the place beside x = 0.
    """

    power: int
    exponent: int
    along: tuple[tuple[int, arb], ...]
    lowered: int
    rows: list[arb_poly]
    there: arb

    @property
    def low(self) -> list[list[arb]]:
        """Coefficients in s of the powers of w, those that are not divided by s^lowered."""
        return [row.coeffs()[: self.lowered] for row in self.rows]

    @property
    def regular(self) -> list[arb_poly]:
        """The others, divided by it."""
        return [row.right_shift(self.lowered) for row in self.rows]

    def within(self, s: arb, v: arb) -> arb:
        """w for a height over s."""
        return (v - sum((c * s**k for k, c in self.along), arb(0))) / s**self.exponent


class _Edge(NamedTuple):
    """An edge of Newton's polygon: from s^first w^start on, w ~ c s^slope, c a root of ``along``, not zero."""

    start: int
    first: int
    slope: Fraction
    along: arb_poly


def straightened(rows: Sequence[arb_poly], x: arb, height: arb) -> Chart | None:
    """The chart of the branch that has a height over a small x > 0; None where none is found.

    Parameters
    ----------
    rows : coefficients in x of the powers of v; x and v are of size 1 where the chart is to be used.
    """
    chart, branches = Chart(1, 0, (), 0, list(rows), height), len(rows) - 1
    for stage in range(_STAGES):
        found = _stage(chart, x, branches, stage == 0)
        if found is None:
            return None
        chart, branches = found
        if branches == 1:
            return chart
    return None


def _stage(chart: Chart, x: arb, branches: int, first: bool) -> tuple[Chart, int] | None:
    """The chart after one more Newton polygon, and how many branches begin like the wanted one up to there."""
    s = x.root(chart.power)
    for edge in _edges(chart, branches):
        if not (first or edge.slope > 0) or chart.power * edge.slope.denominator > _MAX_POWER:
            continue
        a, b = edge.slope.numerator, edge.slope.denominator
        finer = s.root(b)
        scaled = chart.there / finer**a
        found = _root_near(edge.along, scaled)
        if found is None:
            continue
        root, multiplicity = found
        lift = max(0, -a * (len(chart.rows) - 1))
        inflated = [_inflated(row, b).left_shift(a * j + lift) for j, row in enumerate(chart.rows)]
        lowered = b * edge.first + a * edge.start + lift
        # what all rows have as a factor exactly
        spare = min(lowered, *(_order(row) for row in inflated if row.coeffs()))
        rows = [row.right_shift(spare) for row in inflated]
        exponent = b * chart.exponent + a
        along = tuple((b * k, c) for k, c in chart.along)
        if multiplicity > 1:
            rows, scaled = recentered(rows, root), scaled - root
            along = (*along, (exponent, root))
        return Chart(chart.power * b, exponent, along, lowered - spare, rows, scaled), multiplicity
    return None


def _order(row: arb_poly) -> int:
    """The number of coefficients before the first that is not exactly zero."""
    return sum(1 for _ in takewhile(lambda c: c == 0, row.coeffs()))


def _inflated(row: arb_poly, power: int) -> arb_poly:
    coefficients = [arb(0)] * (power * len(row.coeffs()))
    coefficients[::power] = row.coeffs()
    return arb_poly(coefficients)


def _edges(chart: Chart, branches: int) -> Iterator[_Edge]:
    """The edges of the polygon of the terms that do not vanish, of orders in w up to the number of branches."""
    rows = [row.coeffs() for row in chart.rows[: branches + 1]]
    sizes = [[abs(c).upper() for c in row[chart.lowered :]] for row in rows]
    small = max((size for row in sizes for size in row), default=arb(0)) * arb(2) ** (-ctx.prec // 2)
    first: dict[int, int] = {}
    for j, row in enumerate(sizes):
        order = next((i for i, size in enumerate(row) if size > small), None)
        if order is not None:
            first[j] = order + chart.lowered
    start = min(first, default=branches)
    while any(j > start for j in first):
        # the steepest descent; the farthest point on it
        slope = max(Fraction(first[start] - first[j], j - start) for j in first if j > start)
        end = max(j for j in first if j > start and Fraction(first[start] - first[j], j - start) == slope)
        coefficients = [arb(0)] * (end - start + 1)
        for j in range(start, end + 1):
            i = first[start] - slope * (j - start)
            if first.get(j) == i:
                coefficients[j - start] = rows[j][int(i)]
        yield _Edge(start, first[start], slope, arb_poly(coefficients))
        start = end


def _root_near(p: arb_poly, start: arb) -> tuple[arb, int] | None:
    """An exact number near a root of p next to a number, and the root's multiplicity; None where none is found."""
    if start.contains(0):
        return None
    derivatives = [p]
    for _ in range(min(_TOGETHER, len(p.coeffs()) - 1)):
        derivatives.append(derivatives[-1].derivative())
    for multiplicity in range(1, len(derivatives)):
        root = _limit(derivatives[multiplicity - 1], start.mid())
        if root is None or not abs(root - start) * 4 < abs(root):
            continue
        # Taylor's terms over a distance of the root's own size
        terms, factor = [], arb(1)
        for k, derivative in enumerate(derivatives[: multiplicity + 1]):
            terms.append(abs(derivative(root)).upper() * abs(root) ** k / factor)
            factor *= k + 1
        if all(term < terms[-1] * arb(2) ** (-ctx.prec // 2) for term in terms[:-1]):
            return root, multiplicity
    return None


def _limit(p: arb_poly, start: arb) -> arb | None:
    """Where Newton's method comes to."""
    slope, at = p.derivative(), start
    for _ in range(_STEPS):
        steepness = slope(at)
        if steepness.contains(0):
            return None
        step = (p(at) / steepness).mid()
        at = (at - step).mid()
        if not abs(step) > abs(at) * arb(2) ** (8 - ctx.prec):
            break
    return at
