"""Branches of curves over panels: enclosures of their integrals.

On a panel of half width h around u0 the branch is z(s) + t(s), s = u - u0, with a polynomial z that has nearly its
first Taylor coefficients. If for some R > h and r

    sum of |d_ij| R^i r^j over all (i, j) other than (0, 1)  <  |d_01| r,
    p(u0 + s, z(s) + t) = sum of d_ij s^i t^j,

then by Rouche's theorem p has for every complex |s| <= R exactly one root |t| < r; so t is analytic there, its
coefficients are at most r / R^n (Cauchy), and what lies beyond the term of order N contributes at most
2 h r (h/R)^N / ((N+1) (1 - (h/R)^2)) to the integral. (Without z, two branches that run close together along a slope
or a bend would need panels as short as they are close.) Where no R does, as at turning points, the panel is halved or
the branch is shut in between two heights at which the curve does not meet the panel.

Guarantee: what is returned contains the integral of the branch that was asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_poly, arb_series, ctx, fmpq, fmpz_poly

from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.sturm import changes_of


@dataclass(frozen=True)
class Branch:
    """A wall: the curve, the number of its root, and the curve's coefficients, in Z[u] and in Z[v], for balls."""

    curve: PlaneCurve
    root: int
    value: list[arb_poly]
    columns: list[arb_poly]

    @classmethod
    def of(cls, curve: PlaneCurve, root: int) -> Branch:
        return cls(curve, root, [arb_poly(c) for c in curve.in_v], [arb_poly(c) for c in curve.in_u])

    def height(self, u: fmpq, low: fmpq, high: fmpq) -> arb | None:
        """The branch over u; None when there are not so many roots between the heights."""
        # positive roots of the deflated polynomial have roots of their own
        squares = self.curve.exponent_gcd(1) % 2 == 0 and low >= 0
        p = self.curve.over(u)
        if squares:
            p, low, high = p.deflate(2), low * low, high * high
        changes = changes_of(p)
        first, last = changes(low), changes(high) + (p(high) == 0)
        wanted = first - self.root  # changes below the root, one less above it
        if wanted <= last:
            return None
        while True:
            if first == wanted == last + 1 and (height := _refined(p, arb(low).union(arb(high)))) is not None:
                return height.sqrt() if squares else height
            middle = (low + high) / 2
            beyond = changes(middle)
            if beyond >= wanted:
                low, first = middle, beyond
            elif beyond == wanted - 1 and p(middle) == 0:
                return arb(middle).sqrt() if squares else arb(middle)
            else:
                high, last = middle, beyond + (p(middle) == 0)


def _refined(p: fmpz_poly, root: arb) -> arb | None:
    """A ball for the only root of p in a given one, narrowed by interval Newton steps as far as precision allows.

    None where the given one is so wide that the first step does not narrow it much.
    """
    value, slope = arb_poly(p), arb_poly(p.derivative())
    first = True
    while True:
        middle = root.mid()
        steepness = slope(root)
        if steepness.contains(0):
            return None if first and root.rel_accuracy_bits() < ctx.prec // 2 else root
        closer = (middle - value(middle) / steepness).intersection(root)
        if not closer.rad() * 4 < root.rad():
            return None if first and root.rel_accuracy_bits() < ctx.prec // 2 else closer
        root, first = closer, False


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


def integral_over(branch: Branch, left: fmpq, right: fmpq, effort: Effort) -> arb:
    """The integral of the branch over a panel, from the window's lower edge: the best enclosure at hand.

    Raises
    ------
    PrecisionTooLow
    """
    low, high = effort.heights
    integral = None
    middle, half = (left + right) / 2, (right - left) / 2
    height = branch.height(middle, low, high)
    if height is not None:
        integral = _by_series(branch, middle, half, height, effort)
        if integral is not None:
            integral -= low * (2 * half)
        elif 2 * half < effort.shut:
            bottom, top = _enclosed(branch, middle, half, height, effort)
            integral = arb(bottom - low).union(arb(top - low)) * (2 * half)
    if integral is None:
        integral = arb(0).union(arb(2 * half * (high - low)))
    return integral


def _by_series(branch: Branch, middle: fmpq, half: fmpq, height: arb, effort: Effort) -> arb | None:
    """The integral of the branch over a panel, by its power series; None when no disk of convergence is proved.

    Raises
    ------
    PrecisionTooLow
    """
    rows = [c(arb_poly([middle, 1])) for c in branch.value]
    for degree in effort.degrees:
        integral = _along(rows, half, height, degree, effort)
        if integral is not None:
            return integral
    return None


def _along(rows: Sequence[arb_poly], half: fmpq, height: arb, degree: int, effort: Effort) -> arb | None:
    center, length = height.mid(), degree + 1
    rows = _recentered(rows, center)
    start = arb_series([height - center], prec=length)
    # z, less its constant coefficient
    polynomial = arb_poly(
        [arb(0), *(c.mid() for c in _series([row.truncate(length) for row in rows], start, length)[1:])]
    )
    d = _shifted(rows, polynomial)
    steepness = abs(d[1][0])
    # the polynomial follows the branch to its degree, so but for rounding the first coefficients are zero
    rounded = sum((c.rad() * half**i for i, c in enumerate(d[0].coeffs())), arb(0))
    blur = _size(d[0].truncate(length), arb(half)) + rounded
    if len(d) > 2 and not blur * _size(d[2], arb(half)) * 2**20 < steepness * steepness:
        raise PrecisionTooLow  # rounding blurs the branch nearly as far as the next one
    absolute, slope = [_absolute(row) for row in d], _absolute(polynomial)
    for factor in (4, 2):
        radius = arb(half * factor)
        reach = _reach([row(radius) for row in absolute], steepness, slope(radius))
        if reach is not None:
            break
    else:
        return None
    # order until the tail is negligible
    ratio, order, tail = fmpq(1, factor), 4, arb(0)
    while True:
        tail = 2 * arb(half) * reach * arb(ratio) ** order / ((order + 1) * (1 - arb(ratio) ** 2))
        if tail < effort.share or order >= ctx.prec:
            break
        order += 4
    # beyond its degree z has no coefficients, and those of the branch are t's
    total, power = 2 * arb(half) * center, arb(half)
    series = _series(rows, start, max(order, length))
    for k in range(0, max(order, length), 2):
        total += (series[k] if k < order else polynomial[k]) * power * fmpq(2, k + 1)
        power = power * half * half
    return total + arb(0).union(2 * tail) - tail


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


def _size(row: arb_poly, radius: arb) -> arb:
    """A bound for the polynomial on the disk of a radius."""
    return _absolute(row)(radius)


def _absolute(row: arb_poly) -> arb_poly:
    return arb_poly([abs(c) for c in row.coeffs()])


def _reach(sizes: list[arb], steepness: arb, slack: arb) -> arb | None:
    """An r for which Rouche's condition holds; None when none is found.

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
        if low(reach) + high(slack + reach) * reach**_SHIFTED < steepness * reach:
            return reach
    return None


def _series(d: Sequence[arb_poly], start: arb_series, order: int) -> list[arb]:
    """Enclosures of the first coefficients of t(s), whose constant one ``start`` encloses, by Newton's method.

    Raises
    ------
    PrecisionTooLow
    """
    cap = ctx.cap
    t, length = start, 1
    try:
        while length < order:
            length = min(2 * length, order)
            ctx.cap = length
            known = t.coeffs()[:length]
            t = arb_series(known + [arb(0)] * (length - len(known)), prec=length)
            value, slope = arb_series([arb(0)], prec=length), arb_series([arb(0)], prec=length)
            for row in reversed(d):
                slope = slope * t + value
                value = value * t + arb_series(row.coeffs()[:length], prec=length)
            if slope.coeffs() == [] or slope.coeffs()[0].contains(0):
                raise PrecisionTooLow  # the root is simple
            t = t - value / slope
        found = t.coeffs()
    finally:
        ctx.cap = cap
    return found + [arb(0)] * (order - len(found))


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
