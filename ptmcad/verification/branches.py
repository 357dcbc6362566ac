"""Branches of curves over panels: enclosures of their integrals.

On a panel of half width h around u0 the branch is z(s) + t(s), s = u - u0, with a polynomial z that has nearly its
first Taylor coefficients. If for some R > h and r

    sum of |d_ij| R^i r^j over all (i, j) other than (0, 1)  <  |d_01| r,
    p(u0 + s, z(s) + t) = sum of d_ij s^i t^j,

then by Rouche's theorem p has for every complex |s| <= R exactly one root |t| < r; so t is analytic there, its
coefficients are at most r / R^n (Cauchy), and what lies beyond the term of order N contributes at most
2 h r (h/R)^N / ((N+1) (1 - (h/R)^2)) to the integral. (Without z, two branches that run close together along a slope
or a bend would need panels as short as they are close.) Where R is too small for the panel, its middle part is proved
for which it is large enough. Where no R does, as at turning points, the panel is halved or the branch is shut in
between two heights at which the curve does not meet the panel.

What is compared is p times a polynomial g(s) that makes the coefficient of t nearly constant. Whatever g is, the
condition for g p says that g is not zero there, and that p has one root: with it R may be several times as large.

Of a polynomial in v^2 the same is done with w = v^2, of half the degree, where the disk proves that |w| <= M and that w
is not zero: v is analytic there then and |v| <= sqrt(M), which takes the place of r.

Guarantee: what is returned contains the integral of the branch that was asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from flint import arb, arb_poly, arb_series, ctx, fmpq

from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.roots import numbered_root
from ptmcad.verification.sturm import changes_of


@dataclass(frozen=True)
class Branch:
    """A wall: the curve, the number of its root, and the curve's coefficients, in Z[u] and in Z[v], for balls.

    Attributes
    ----------
    squares : where the polynomial is one in v^2, its coefficients in Z[u] as such.
    """

    curve: PlaneCurve
    root: int
    value: list[arb_poly]
    columns: list[arb_poly]
    squares: list[arb_poly] | None

    @classmethod
    def of(cls, curve: PlaneCurve, root: int) -> Branch:
        value = [arb_poly(c) for c in curve.in_v]
        even = curve.exponent_gcd(1) % 2 == 0
        return cls(curve, root, value, [arb_poly(c) for c in curve.in_u], value[::2] if even else None)

    def height(self, u: fmpq, low: fmpq, high: fmpq) -> arb | None:
        """The branch over u; None when there are not so many roots between the heights."""
        p = self.curve.over(u)
        if self.squares is None or high <= 0:
            return numbered_root(p, low, high, self.root)
        # as many roots below zero as above it, each the other one's negative
        p = p.deflate(2)
        if low >= 0:
            found = numbered_root(p, low * low, high * high, self.root)
            return None if found is None else found.sqrt()
        changes = changes_of(p)
        below = changes(fmpq(0)) - changes(low * low) - (p(low * low) == 0)
        if self.root < below:
            found = numbered_root(p, fmpq(0), low * low, below - 1 - self.root)
            return None if found is None else -found.sqrt()
        zero = int(p[0] == 0)
        if zero and self.root == below:
            return arb(0)
        found = numbered_root(p, fmpq(0), high * high, self.root - below - zero)
        return None if found is None else found.sqrt()


@dataclass(frozen=True)
class Effort:
    """What one attempt spends.

    Attributes
    ----------
    share : error that a panel may have.
    shut : panels narrower than this are shut in between heights.
    narrowest : panels narrower than this are not halved at this precision.
    heights : the window's edges.
    degrees : of the polynomials that a branch is compared with; the closer the next branch, the better it has to be.
    """

    share: arb
    shut: fmpq
    narrowest: fmpq
    heights: tuple[fmpq, fmpq]
    degrees: tuple[int, ...]


class PrecisionTooLow(Exception):
    """Rounding alone keeps a panel from being enclosed."""


class Part(NamedTuple):
    """A part of a panel with the branch's integral over it, from the window's lower edge.

    Attributes
    ----------
    tried : whether this part has been the whole of what was tried; else it is what was left of something longer, and
        its integral is known by the window's edges only.
    """

    left: fmpq
    right: fmpq
    integral: arb
    tried: bool


def integrals_over(branch: Branch, left: fmpq, right: fmpq, effort: Effort) -> list[Part]:
    """The integral of the branch over a panel, in parts: the best enclosures at hand.

    Raises
    ------
    PrecisionTooLow
    """
    low, high = effort.heights
    middle, half = (left + right) / 2, (right - left) / 2
    height = branch.height(middle, low, high)
    if height is not None:
        found = _more_precisely(branch, middle, half, height, effort)
        if found is not None:
            integral, proved = found
            ends = (left, middle - proved, middle + proved, right)
            sides = [known_by_edges(a, b, effort, False) for a, b in (ends[:2], ends[2:]) if a < b]
            return [Part(ends[1], ends[2], integral - low * (2 * proved), True), *sides]
        if 2 * half < effort.shut:
            bottom, top = _enclosed(branch, middle, half, height, effort)
            return [Part(left, right, arb(bottom - low).union(arb(top - low)) * (2 * half), True)]
    return [known_by_edges(left, right, effort, True)]


def _more_precisely(branch: Branch, middle: fmpq, half: fmpq, height: arb, effort: Effort) -> tuple[arb, fmpq] | None:
    """`_by_series` at the working precision, or at more, which few panels ask for.

    Raises
    ------
    PrecisionTooLow
    """
    bits = ctx.prec
    for times in (1, 2, 4):
        with ctx.workprec(times * bits):
            finer = height if times == 1 else branch.height(middle, *effort.heights)
            assert finer is not None  # there is a root, as there was with fewer bits
            try:
                return _by_series(branch, middle, half, finer, effort)
            except PrecisionTooLow:
                continue
    raise PrecisionTooLow


def known_by_edges(left: fmpq, right: fmpq, effort: Effort, tried: bool) -> Part:
    low, high = effort.heights
    return Part(left, right, arb(0).union(arb((right - left) * (high - low))), tried)


_FAR, _NEAR = fmpq(4), fmpq(3, 2)
"""Radii of disks that prove a part of a panel, in halves of it: the larger, the fewer terms of the series."""
_PROVED = (fmpq(1), fmpq(3, 4), fmpq(1, 2), fmpq(3, 8), fmpq(1, 4), fmpq(3, 16), fmpq(1, 8), fmpq(1, 16))
"""Shares of a panel that are proved where no disk reaches beyond all of it: longest first."""


_POOR = 4
"""A polynomial of higher degree is worth its cost where so small a share of a panel is proved, or none."""


def _by_series(branch: Branch, middle: fmpq, half: fmpq, height: arb, effort: Effort) -> tuple[arb, fmpq] | None:
    """The integral of the branch over a panel's middle part, by its power series, and half that part's width.

    None when no disk of convergence is proved.

    Raises
    ------
    PrecisionTooLow
    """
    best: tuple[arb, fmpq] | None = None
    for rows in (branch.squares, branch.value):
        if rows is None or best is not None:
            continue
        shifted = [c(arb_poly([middle, 1])) for c in rows]
        for degree in effort.degrees:
            if best is not None and best[1] * _POOR > half:
                break
            found = _along(shifted, half, height, degree, effort, rows is branch.squares)
            if found is not None and (best is None or found[1] > best[1]):
                best = found
    return best


def _along(
    rows: Sequence[arb_poly], half: fmpq, height: arb, degree: int, effort: Effort, squares: bool = False
) -> tuple[arb, fmpq] | None:
    """As `_by_series`, of the polynomial with these coefficients of the powers of v, or of v^2."""
    found = disk(rows, half, height * height if squares else height, degree)
    if found is None or (squares and not found.center > found.slack + found.reach):
        return None
    bound = (found.center + found.slack + found.reach).sqrt() if squares else found.reach
    # order until the tail is negligible
    proved, ratio, order, tail = found.proved, 1 / found.factor, 4, arb(0)
    while True:
        tail = 2 * arb(proved) * bound * arb(ratio) ** order / ((order + 1) * (1 - arb(ratio) ** 2))
        if tail < effort.share or order >= ctx.prec:
            break
        order += 4
    coefficients = found.coefficients(order)
    if squares:
        coefficients = _root(coefficients, height)
    total, power = arb(0), arb(proved)
    for k in range(0, len(coefficients), 2):
        total += coefficients[k] * power * fmpq(2, k + 1)
        power = power * proved * proved
    if total.rad() > effort.share and total.rad() * 2**_ROUNDED_BITS > arb(proved) * bound:
        raise PrecisionTooLow  # the disk alone says nearly as much as the series
    return total + arb(0).union(2 * tail) - tail, proved


_ROUNDED_BITS = 20
"""By so many bits is a series to be better known than by the disk's size."""


class Disk(NamedTuple):
    """A disk on which a branch is analytic, as the module's text says: center + z(s) + t(s), |t| < reach.

    Attributes
    ----------
    rows : the polynomial's coefficients in s of the powers of v - center.
    start : encloses v - center over s = 0.
    along : z, less its constant coefficient.
    proved, factor : the branch is analytic for |s| <= proved * factor, where factor > 1.
    slack : a bound for |z| there.
    spread : reach sup |g| / (least difference of the condition's sides), g as in `_evening`: twice that is what a
        change of the polynomial by 1 moves the root at most.
    """

    rows: list[arb_poly]
    center: arb
    start: arb_series
    along: arb_poly
    proved: fmpq
    factor: fmpq
    slack: arb
    reach: arb
    spread: arb

    def coefficients(self, order: int) -> list[arb]:
        """The branch's power series, so many coefficients or more: beyond them they are those of t."""
        found = _series(self.rows, self.start, max(order, len(self.along.coeffs()) + 1))
        found[0] += self.center
        return found


def disk(
    rows: Sequence[arb_poly], half: fmpq, root: arb, degree: int, beside: tuple[arb, arb] | None = None
) -> Disk | None:
    """A disk about s = 0 that is larger than the longest part of (-half, half) for which one is proved.

    Parameters
    ----------
    rows : coefficients in s of the powers of v in a polynomial.
    root : its root over s = 0.
    degree : of z.
    beside : a bound for what is to be added to the polynomial where |v| is at most the second number: the condition
        holds with it, too.

    Raises
    ------
    PrecisionTooLow
    """
    center, length = root.mid(), degree + 1
    rows = _recentered(rows, center)
    start = arb_series([root - center], prec=length)
    polynomial = arb_poly(
        [arb(0), *(c.mid() for c in _series([row.truncate(length) for row in rows], start, length)[1:])]
    )
    d = _shifted(rows, polynomial)
    factor_at_most = _absolute(even := _evening(d[1]))
    d = [row * even for row in d]
    steepness = abs(d[1][0])
    # the polynomial follows the branch to its degree, so but for rounding the first coefficients are zero
    rounded = sum((c.rad() * half**i for i, c in enumerate(d[0].coeffs())), arb(0))
    blur = _size(d[0].truncate(length), arb(half)) + rounded
    if len(d) > 2 and not blur * _size(d[2], arb(half)) * 2**20 < steepness * steepness:
        raise PrecisionTooLow  # rounding blurs the branch nearly as far as the next one
    absolute, slope = [_absolute(row) for row in d], _absolute(polynomial)
    for proved, factor in ((half, _FAR), (half, fmpq(2)), *((half * share, _NEAR) for share in _PROVED)):
        radius = arb(proved * factor)
        slack = slope(radius)
        sizes = [row(radius) for row in absolute]
        if beside is not None:
            sizes[0] += beside[0] * factor_at_most(radius)
        found = _reach(sizes, steepness, slack)
        if found is not None and (beside is None or abs(center) + slack + found[0] < beside[1]):
            spread = found[0] * factor_at_most(radius) / found[1]
            return Disk(rows, center, start, polynomial, proved, factor, slack, found[0], spread)
    return None


def _root(coefficients: Sequence[arb], constant: arb) -> list[arb]:
    """The square root of a power series, of which the constant coefficient, not zero, is known."""
    found = [constant]
    for k in range(1, len(coefficients)):
        products = sum((found[i] * found[k - i] for i in range(1, k)), arb(0))
        found.append((coefficients[k] - products) / (2 * constant))
    return found


def _recentered(rows: Sequence[arb_poly], center: arb) -> list[arb_poly]:
    """Coefficients in s of the powers of t in p(s, center + t), given those of the powers of v in p(s, v)."""
    columns = [
        arb_poly([row[i] for row in rows])(arb_poly([center, 1])) for i in range(max(len(row.coeffs()) for row in rows))
    ]
    return [arb_poly([column[j] for column in columns]) for j in range(len(rows))]


_SHIFTED = 3


def _shifted(rows: Sequence[arb_poly], by: arb_poly) -> list[arb_poly]:
    """Coefficients of the powers of t in p(s, by(s) + t), the first three, given those of the powers of v in p(s, v).

    The others that are returned are those of powers of v in q, where t^3 q(s, by(s) + t) is the rest of the sum.
    """
    shifted = list(rows)
    for start in range(min(_SHIFTED, len(shifted) - 1)):
        for j in range(len(shifted) - 2, start - 1, -1):
            shifted[j] = shifted[j] + shifted[j + 1] * by
    return shifted


_EVENED = 8
"""Terms of the polynomial by which `_evening` evens the steepness out."""


def _evening(steepness: arb_poly) -> arb_poly:
    """A polynomial g in s, 1 at s = 0, whose product with a given one is nearly constant on a larger disk.

    Whatever g is: by Rouche's condition g p has one root over each s, so g is not zero there, and the root is p's.
    """
    cap = ctx.cap
    ctx.cap = _EVENED
    try:
        start = arb_series(steepness.truncate(_EVENED).coeffs(), prec=_EVENED)
        if start.coeffs() == [] or start.coeffs()[0].contains(0):
            return arb_poly([1])
        found = steepness[0] / start
        return arb_poly([arb(1), *(c.mid() for c in found.coeffs()[1:])])
    finally:
        ctx.cap = cap


def _size(row: arb_poly, radius: arb) -> arb:
    """A bound for the polynomial on the disk of a radius."""
    return _absolute(row)(radius)


def _absolute(row: arb_poly) -> arb_poly:
    return arb_poly([abs(c) for c in row.coeffs()])


def _reach(sizes: list[arb], steepness: arb, slack: arb) -> tuple[arb, arb] | None:
    """An r for which Rouche's condition holds, and a bound below for its sides' difference; None if none is found.

    Parameters
    ----------
    sizes : bounds on the disk |s| <= R for the rows that `_shifted` returns. The second one
        contains |d_01| itself, which belongs on the other side.
    slack : a bound there for the polynomial by which they were shifted, so that |v| <= slack + r in the others.
    """
    low, high = arb_poly([sizes[0], sizes[1] - steepness, *sizes[2:_SHIFTED]]), arb_poly(sizes[_SHIFTED:])
    first = (sizes[0] / steepness).upper()
    for multiple in (fmpq(5, 4), fmpq(2), fmpq(4)):
        reach = (first * multiple).upper() if first > 0 else arb(1) / 2**64
        spare = steepness * reach - low(reach) - high(slack + reach) * reach**_SHIFTED
        if spare > 0:
            return reach, spare.lower()
    return None


def _series(d: Sequence[arb_poly], start: arb_series, order: int) -> list[arb]:
    """Enclosures of the first coefficients of t(s), whose constant one ``start`` encloses, by Newton's method.

    Raises
    ------
    PrecisionTooLow
    """
    lengths = [order]
    while lengths[-1] > 1:
        lengths.append((lengths[-1] + 1) // 2)
    cap = ctx.cap
    t = start
    try:
        for known, length in pairwise(reversed(lengths)):
            t = _lengthened(t.coeffs()[:known], length)
            ctx.cap = length - known
            slope, value = _lengthened([], ctx.cap), _lengthened([], ctx.cap)
            for row in reversed(d):
                slope = slope * t + value
                value = value * t + arb_series(row.coeffs()[: ctx.cap], prec=ctx.cap)
            if slope.coeffs() == [] or slope.coeffs()[0].contains(0):
                raise PrecisionTooLow  # the root is simple
            ctx.cap = length
            value = _lengthened([], length)
            for row in reversed(d):
                value = value * t + arb_series(row.coeffs()[:length], prec=length)
            # the first ones are zero, but for rounding: t has been a root to this order
            step = arb_series(value.coeffs()[known:], prec=length - known) / slope
            t = t - arb_series([arb(0)] * known + step.coeffs(), prec=length)
        found = t.coeffs()
    finally:
        ctx.cap = cap
    return found + [arb(0)] * (order - len(found))


def _lengthened(known: list[arb], length: int) -> arb_series:
    """A series of so many coefficients; those that are not known are zero."""
    return arb_series(known + [arb(0)] * (length - len(known)), prec=length)


def _enclosed(branch: Branch, middle: fmpq, half: fmpq, height: arb, effort: Effort) -> tuple[fmpq, fmpq]:
    """Heights below and above the branch at which the curve does not meet the panel."""
    low, high = effort.heights
    center = height.mid().fmpq()
    start = (high - low) * min(fmpq(1, 16), half / effort.shut / 2**8)
    bounds = []
    for edge, direction in ((low, -1), (high, 1)):
        best, tried, leap = edge, 0, 1
        # doublings of the margin; longer and longer leaps, as nobody knows the branch's extent in a large window,
        # and shorter ones back when a height was found
        while leap and start * 2**tried < direction * (edge - center):
            margin = start * 2**tried
            candidate = _simple(center + direction * margin, margin / 8)
            # the height over the middle shows on which side of the candidate the branch is
            clear = arb(candidate) < height if direction < 0 else arb(candidate) > height
            if clear and _misses(branch, middle, half, candidate):
                best, leap = candidate, leap // 2
                tried -= leap
            else:
                leap = leap // 2 if best != edge else leap + (leap if tried > 8 else 0)
                tried += leap
        bounds.append(best)
    return bounds[0], bounds[1]


def _misses(branch: Branch, middle: fmpq, half: fmpq, v: fmpq) -> bool:
    """Whether the curve is proved not to meet the panel at a height."""
    along = arb_poly([row(v) for row in branch.columns])(arb_poly([middle, 1])).coeffs()
    total, power = arb(0), arb(half)
    for c in along[1:]:
        total += abs(c) * power
        power = power * half
    return bool(along) and total < abs(along[0])


def _simple(value: fmpq, error: fmpq) -> fmpq:
    """A dyadic number near a value."""
    scale = 1 << max(0, int(1 / error).bit_length())
    return fmpq((value * scale).floor(), scale)
