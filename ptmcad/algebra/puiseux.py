"""Branches of a plane curve beside an abscissa where they turn, meet or have a cusp: proved
enclosures.

Guarantee: an enclosure that is returned contains the integral of the branch that was asked for;
None means not proved.

Beside a critical abscissa c a branch is a power series in s, u = c + X s^q (Puiseux). Newton's
polygon shows q and the first exponents: again and again v is replaced by a constant plus s^e w, and
the equation divided by the power of s that all its terms then have, until the branch is the only
one through its point over s = 0. There w(s) is analytic, and its series proves a tube as anywhere
else (`curve_branches.tube_around`), now with the singular point at its middle instead of at its end.
Taylor series in u would need panels that get narrower and narrower towards c.

Nothing of this has to be known exactly. The point is known in balls, so what ought to vanish is
known to be small only, and counts as error where it is divided by powers of s; that is why the
panel ends a little beside c. Nor has the choice of q and e to be proved: a tube that contains the
branch at one place contains it everywhere.
"""

from collections.abc import Callable, Iterator, Sequence
from math import gcd
from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.algebra.curve_branches import (
    SeriesTube,
    TooFewBits,
    tube_around,
)
from ptmcad.algebra.polynomials import local_coefficients, translated
from ptmcad.algebra.real_roots import RealRoot, refine
from ptmcad.text.flint_numbers import simplest_between

_STAGES = 4
"""Newton polygons for one branch."""
_MAX_POWER = 6
"""The greatest power of s for u - c; a cusp's is 2 or 3."""
_NEWTON_RATIO = 8
"""Of the lengths of Newton's steps, at least, from a start near a root of the multiplicity that is
supposed.
"""
_ROOM_BITS = 8
"""A tube may be narrower by so many bits than is wanted, and roots are known better by so many to
be found in it.
"""
_ROOM = fmpq(65, 64)
"""What is counted from c is a little more than the width of a panel that begins beside c."""


class Beside(NamedTuple):
    """The interval from ``near`` to ``far`` on one side of the abscissa c, which is a number in the
    ball.
    """

    abscissa: arb
    near: fmpq
    far: fmpq

    @property
    def width(self) -> fmpq:
        """X; negative on the left."""
        return (self.far - self.near) * _ROOM

    def root(self, u: fmpq | arb, power: int) -> arb:
        """s, the root of so high a power of (u - c) / X."""
        return ((arb(u) - self.abscissa) / arb(self.width)).root(power)


class _PuiseuxChart(NamedTuple):
    """u = c + X s^power and v = along(s) + s^exponent w, where sum_j s^-lowered rows_j(s) w^j = 0.

    Attributes
    ----------
    branches : through w = 0 over s = 0.
    there : w on the branch at a place near c.
    """

    power: int
    along: arb_poly
    exponent: int
    rows: list[arb_poly]
    lowered: int
    branches: int
    there: arb


def puiseux_integral(
    in_v: Sequence[fmpz_poly],
    beside: Beside,
    branch: Callable[[fmpq], RealRoot],
    order: int,
    allowed: fmpq,
) -> tuple[arb, fmpq] | None:
    """An enclosure of the integral of a branch from ``near`` as far towards ``far`` as one series
    reaches, and how far that is; None when none is proved.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    branch : the branch's value at a rational abscissa, isolated.
    order : degree of the polynomial approximation.
    allowed : an error that would do; positive.

    Raises
    ------
    TooFewBits
        When too few bits are left to say whether there is one.
    """
    chart = _straightened(in_v, beside, branch)
    if chart is None:
        return None
    q, n = chart.power, chart.power + chart.exponent
    size = abs(beside.width) * fmpq(q, n)  # of the integral of s^exponent
    wanted = arb(allowed / size)
    tube = tube_around(_regular(chart, beside), order, wanted / 2**_ROOM_BITS, wanted)
    if tube is None:
        return None
    cut = beside.far
    if tube.share < 1:
        reach = beside.width * tube.share**q
        start = beside.abscissa.mid().fmpq()
        cut = simplest_between(
            *sorted((start + reach * fmpq(15, 16), start + reach * fmpq(63, 64)))
        )
    begin, end = beside.root(beside.near, q), beside.root(cut, q)
    if not (end <= tube.share and _is_branch(chart, tube, end, branch(cut))):
        return None
    along = chart.along + _scaled(tube).left_shift(chart.exponent)
    whole = along.left_shift(q - 1).integral()
    value = (whole(end) - whole(begin)) * q * arb(abs(beside.width))
    return value + tube.error * end**n * arb(size) * arb(0, 1), cut


def _straightened(
    in_v: Sequence[fmpz_poly], beside: Beside, branch: Callable[[fmpq], RealRoot]
) -> _PuiseuxChart | None:
    """Coordinates in which the branch is the only one through its point over c."""
    place = beside.near
    fine = abs(beside.width) / 2**ctx.prec
    root = refine(branch(place), fine)
    height = arb(root.middle)
    fibre = arb_poly([arb_poly(c)(beside.abscissa) for c in in_v])
    origin = _root_near(fibre, height)
    if origin is None:
        return None
    start, branches = origin
    rows = local_coefficients(in_v, beside.abscissa, arb(beside.width), start)
    chart: _PuiseuxChart | None = _PuiseuxChart(
        1, arb_poly([start]), 0, rows, 0, branches, height - start
    )
    for _ in range(_STAGES):
        if chart is None or chart.branches == 1:
            break
        chart = _blown_up(chart, beside.root(place, chart.power))
    return chart if chart is not None and chart.branches == 1 else None


def _blown_up(chart: _PuiseuxChart, s: arb) -> _PuiseuxChart | None:
    """The coordinates after one more step; s is that of the place where the branch is known."""
    first = _support(chart)
    for upper, lower in _edges(first):
        drop, run = first[lower] - first[upper], upper - lower
        e, q = drop // gcd(drop, run), run // gcd(drop, run)
        if chart.power * q > _MAX_POWER:
            continue
        edge = [arb(0)] * (run + 1)
        for j in range(lower, upper + 1):
            if (first[upper] - first.get(j, -1)) * run + (upper - j) * drop == 0:
                edge[j - lower] = chart.rows[j][chart.lowered + first[j]]
        there = chart.there / s.root(q) ** e
        found = _root_near(arb_poly(edge), there)
        if found is None or not abs(found[0] - there) * 2 < abs(there):
            continue
        value, branches = found
        rows = [_spread(row, q).left_shift(e * j) for j, row in enumerate(chart.rows)]
        lowered = (chart.lowered + first[upper]) * q + upper * e
        exponent = chart.exponent * q + e
        along = _spread(chart.along, q) + arb_poly([value]).left_shift(exponent)
        return _PuiseuxChart(
            chart.power * q,
            along,
            exponent,
            translated(rows, value),
            lowered,
            branches,
            there - value,
        )
    return None


def _support(chart: _PuiseuxChart) -> dict[int, int]:
    """For each power of w that matters and has one, the first power of s that its coefficient is
    known to have.
    """
    first = {}
    for j, row in enumerate(chart.rows[: chart.branches + 1]):
        for i, c in enumerate(row.coeffs()[chart.lowered :]):
            if not c.contains(0):
                first[j] = i
                break
    return first


def _edges(first: dict[int, int]) -> Iterator[tuple[int, int]]:
    """The edges of Newton's polygon over these points, as pairs of powers of w, the least steep one
    first.
    """
    upper = max(first, default=0)
    while upper > min(first, default=0):
        lower = min(
            (j for j in first if j < upper),
            key=lambda j: (fmpq(first[j] - first[upper], upper - j), j),
        )
        yield upper, lower
        upper = lower


def _root_near(p: arb_poly, start: arb) -> tuple[arb, int] | None:
    """A root, as a ball, to which Newton's iteration leads, and its multiplicity: both as they seem
    to be.
    """
    derivatives = [p]
    while derivatives[-1].degree() > 0:
        derivatives.append(derivatives[-1].derivative())
    for multiplicity in range(1, len(derivatives)):
        value, slope = derivatives[multiplicity - 1], derivatives[multiplicity]
        x, previous, fine = start.mid(), None, abs(start).upper() / 2 ** (ctx.prec // 2)
        while previous is None or previous > fine:
            step = (value(x) / slope(x)).mid()
            # near a simple root the iteration converges quadratically, near a multiple one by a
            # constant factor
            if not step.is_finite() or not (
                previous is None or abs(step) * _NEWTON_RATIO < previous
            ):
                break
            x, previous = (x - step).mid(), abs(step)
        else:
            ball = x - value(x) / slope(x)
            single = ball.is_finite() and not slope(ball).contains(0)
            if single and all(d(ball).contains(0) for d in derivatives[: multiplicity - 1]):
                return ball, multiplicity
    return None


def _regular(chart: _PuiseuxChart, beside: Beside) -> list[arb_poly]:
    """The equation's coefficients as polynomials in s; what has negative powers of s is small, and
    a ball.
    """
    least = beside.root(beside.near, chart.power).lower()
    regular = []
    for row in chart.rows:
        noise = arb(0)
        for k in range(
            chart.lowered
        ):  # so the k-th coefficient is divided as often as the power of s says
            noise = (noise + abs(row[k])) / least
        if not noise.is_finite():
            raise TooFewBits
        regular.append(row.right_shift(chart.lowered) + arb(0, noise.upper()))
    return regular


def _is_branch(chart: _PuiseuxChart, tube: SeriesTube, s: arb, root: RealRoot) -> bool:
    """Whether the root over an abscissa is in the tube, which is there the only one in it."""
    height = refine(root, (tube.reach * s**chart.exponent / 2**_ROOM_BITS).mid().fmpq()).ball
    w = (height - chart.along(s)) / s**chart.exponent
    return bool(abs(w - tube.series(s / arb(tube.share))) < tube.reach)


def _scaled(tube: SeriesTube) -> arb_poly:
    """The tube's series in s."""
    return tube.series(arb_poly([0, 1 / arb(tube.share)]))


def _spread(p: arb_poly, q: int) -> arb_poly:
    """p(s^q)."""
    if q == 1:
        return p
    coefficients = [arb(0)] * (q * p.degree() + 1) if p.degree() >= 0 else []
    coefficients[::q] = p.coeffs()
    return arb_poly(coefficients)
