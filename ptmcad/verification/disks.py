"""Disks on which a branch of a curve is analytic.

Beside u0 the branch is z(s) + t(s), s = u - u0, with a polynomial z that has nearly its first
Taylor coefficients. If for some R and r

    sum of |d_ij| R^i r^j over all (i, j) other than (0, 1)  <  |d_01| r,
    p(u0 + s, z(s) + t) = sum of d_ij s^i t^j,

then by Rouche's theorem p has for every complex |s| <= R exactly one root |t| < r; so t is analytic
there and its coefficients are at most r / R^n (Cauchy). (Without z, two branches that run close
together along a slope or a bend would need disks as small as they are close.)

What is compared is p times a polynomial g(s) that makes the coefficient of t nearly constant.
Whatever g is, the condition for g p says that g is not zero there, and that p has one root: with it
R may be several times as large.

Guarantee: a disk that is returned is proved, in ball arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from flint import arb, arb_poly, arb_series, ctx, fmpq


class BallsTooWide(Exception):
    """Rounding alone keeps a panel from being enclosed."""


_FAR, _NEAR = fmpq(4), fmpq(3, 2)
"""Radii of disks that prove a part of a panel, in halves of it: the larger, the fewer terms of the
series.
"""
_PROVED = (
    fmpq(1),
    fmpq(3, 4),
    fmpq(1, 2),
    fmpq(3, 8),
    fmpq(1, 4),
    fmpq(3, 16),
    fmpq(1, 8),
    fmpq(1, 16),
)
"""Shares of a panel that are proved where no disk reaches beyond all of it: longest first."""


class Disk(NamedTuple):
    """A disk on which a branch is analytic, as the module's text says: center + z(s) + t(s),
    |t| < reach.

    Attributes
    ----------
    rows : the polynomial's coefficients in s of the powers of v - center.
    start : encloses v - center over s = 0.
    along : z, less its constant coefficient.
    proved, factor : the branch is analytic for |s| <= proved * factor, where factor > 1.
    slack : a bound for |z| there.
    """

    rows: list[arb_poly]
    center: arb
    start: arb_series
    along: arb_poly
    proved: fmpq
    factor: fmpq
    slack: arb
    reach: arb

    def coefficients(self, order: int) -> list[arb]:
        """The branch's power series, so many coefficients or more: beyond them they are those of t."""
        found = _series(self.rows, self.start, max(order, len(self.along.coeffs()) + 1))
        found[0] += self.center
        return found


def disk(rows: Sequence[arb_poly], half: fmpq, root: arb, degree: int) -> Disk | None:
    """A disk about s = 0 that is larger than the longest part of (-half, half) for which one is
    proved.

    Parameters
    ----------
    rows : coefficients in s of the powers of v in a polynomial.
    root : its root over s = 0.
    degree : of z.

    Raises
    ------
    BallsTooWide
    """
    center, length = root.mid(), degree + 1
    rows = recentered(rows, center)
    start = arb_series([root - center], prec=length)
    polynomial = arb_poly(
        [
            arb(0),
            *(c.mid() for c in _series([row.truncate(length) for row in rows], start, length)[1:]),
        ]
    )
    d = shifted(rows, polynomial, _SHIFTED)
    even = _evening(d[1])
    d = [row * even for row in d]
    steepness = abs(d[1][0])
    # the polynomial follows the branch to its degree, so but for rounding the first coefficients
    # are zero
    rounded = sum((c.rad() * half**i for i, c in enumerate(d[0].coeffs())), arb(0))
    blur = size(d[0].truncate(length), arb(half)) + rounded
    if len(d) > 2 and not blur * size(d[2], arb(half)) * 2**20 < steepness * steepness:
        raise BallsTooWide  # rounding blurs the branch nearly as far as the next one
    absolute, slope = [_absolute(row) for row in d], _absolute(polynomial)
    for proved, factor in (
        (half, _FAR),
        (half, fmpq(2)),
        *((half * share, _NEAR) for share in _PROVED),
    ):
        radius = arb(proved * factor)
        slack = slope(radius)
        reach = _reach([row(radius) for row in absolute], steepness, slack)
        if reach is not None:
            return Disk(rows, center, start, polynomial, proved, factor, slack, reach)
    return None


def recentered(rows: Sequence[arb_poly], center: arb) -> list[arb_poly]:
    """Coefficients in s of the powers of t in p(s, center + t), given those of the powers of v in
    p(s, v).
    """
    columns = [
        arb_poly([row[i] for row in rows])(arb_poly([center, 1]))
        for i in range(max(len(row.coeffs()) for row in rows))
    ]
    return [arb_poly([column[j] for column in columns]) for j in range(len(rows))]


_SHIFTED = 3


def shifted(rows: Sequence[arb_poly], by: arb_poly, number: int) -> list[arb_poly]:
    """Coefficients of the powers of t in p(s, by(s) + t), so many, given those of the powers of v
    in p(s, v).

    The others that are returned are those of powers of v in q, where t^number q(s, by(s) + t) is
    the rest of the sum.
    """
    found = list(rows)
    for start in range(min(number, len(found) - 1)):
        for j in range(len(found) - 2, start - 1, -1):
            found[j] = found[j] + found[j + 1] * by
    return found


_EVENED = 12
"""Terms of the polynomial by which `_evening` evens the steepness out."""


def _evening(steepness: arb_poly) -> arb_poly:
    """A polynomial g in s, 1 at s = 0, whose product with a given one is nearly constant on a
    larger disk.

    Whatever g is: by Rouche's condition g p has one root over each s, so g is not zero there, and
    the root is p's.
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


def size(row: arb_poly, radius: arb) -> arb:
    """A bound for the polynomial on the disk of a radius."""
    return _absolute(row)(radius)


def _absolute(row: arb_poly) -> arb_poly:
    return arb_poly([abs(c) for c in row.coeffs()])


def _reach(sizes: list[arb], steepness: arb, slack: arb) -> arb | None:
    """An r for which Rouche's condition holds; None if none is found.

    Parameters
    ----------
    sizes : bounds on the disk |s| <= R for the rows that `shifted` returns. The second one
        contains |d_01| itself, which belongs on the other side.
    slack : a bound there for the polynomial by which they were shifted, so that |v| <= slack + r in
        the others.
    """
    low, high = (
        arb_poly([sizes[0], sizes[1] - steepness, *sizes[2:_SHIFTED]]),
        arb_poly(sizes[_SHIFTED:]),
    )
    first = (sizes[0] / steepness).upper()
    for multiple in (fmpq(5, 4), fmpq(2), fmpq(4)):
        reach = (first * multiple).upper() if first > 0 else arb(1) / 2**64
        if low(reach) + high(slack + reach) * reach**_SHIFTED < steepness * reach:
            return reach
    return None


def _series(d: Sequence[arb_poly], start: arb_series, order: int) -> list[arb]:
    """Enclosures of the first coefficients of t(s), whose constant one ``start`` encloses, by
    Newton's method.

    Raises
    ------
    BallsTooWide
    """
    lengths = [order]
    while lengths[-1] > 1:
        lengths.append((lengths[-1] + 1) // 2)
    cap = ctx.cap
    t, rows = start, [_lengthened(row.coeffs()[:order], order) for row in reversed(d)]
    try:
        for known, length in pairwise(reversed(lengths)):
            t = _lengthened(t.coeffs()[:known], length)
            ctx.cap = length - known
            slope, value = _lengthened([], ctx.cap), _lengthened([], ctx.cap)
            for row in rows:
                slope = slope * t + value
                value = value * t + row
            if slope.coeffs() == [] or slope.coeffs()[0].contains(0):
                raise BallsTooWide  # the root is simple
            ctx.cap = length
            value = _lengthened([], length)
            for row in rows:
                value = value * t + row
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
