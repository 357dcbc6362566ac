"""Branches of a plane curve: proved enclosures of their integrals.

Guarantee: an enclosure that is returned contains the integral of the branch that was asked for; None means not proved.
`avoids` answers True only with proof.

On a panel [m - r, m + r] a branch v = y(u) of p(u, v) = 0 is approximated by a polynomial z(h), u = m + r h, from the
branch's Taylor series. Let q = s p with a polynomial s(h) close to 1/p_v(u, z). Suppose |q(u, z)| <= e and
q_v(u, z) >= b > 0 on the panel, and |q_vv| <= K in the tube |v - z| <= t, with t >= 2 e / b and K t <= b / 2. Then q_v
has no zero in the tube and q changes sign across it (mean value theorem), so the tube contains exactly one root of p
for each u (s has no zero, as s p_v >= b / 2). If the isolated root at u = m lies in it, this root is the branch. It
also lies within 2 e / b of z, since q changes sign there already, so t may be wide enough to find the root without
blurring the integral.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import perm

from flint import arb, arb_poly, arb_series, ctx, fmpq, fmpz_poly

from ptmcad.algebra.real_roots import RealRoot, refine
from ptmcad.algebra.window import Interval

DERIVATIVE_BITS = 24
"""Bits of the curve's derivative at the panel's middle that have to be right for the rest to make sense."""
SEPARATION_BITS = 40
"""Bits by which rounding has to be smaller than the distance to the next branch at the panel's middle."""
PANEL_SEPARATION_BITS = 10
"""The same along the panel."""


class PrecisionTooLow(ArithmeticError):
    """The context's precision does not suffice for this curve at this place."""


def branch_integral(
    in_v: Sequence[fmpz_poly], at_middle: RealRoot, middle: fmpq, radius: fmpq, fibre: Interval, order: int
) -> arb | None:
    """An enclosure of the integral of a branch over a panel.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    at_middle : the branch's value at the middle of the panel, isolated among the roots of p(middle, v).
    middle, radius : of the panel, over whose interior no branches of the curve meet.
    order : degree of the polynomial approximation.

    Returns
    -------
    The enclosure at the context's precision, or None when the tube could not be proved.

    Raises
    ------
    PrecisionTooLow
        When cancellation leaves too few bits.
    """
    root = refine(at_middle, (fibre[1] - fibre[0]) / 2 ** (ctx.prec // 3))
    origin = root.low
    local = local_coefficients(in_v, middle, radius, origin)
    if local[1][0].rel_accuracy_bits() < DERIVATIVE_BITS:
        raise PrecisionTooLow  # the root is simple, so the derivative is not zero
    steepness = abs(local[1][0])
    if len(local) > 2 and not _noise(local[0]) * _norm(local[2]) * 2**SEPARATION_BITS < steepness * steepness:
        raise PrecisionTooLow  # rounding blurs the branch nearly as far as the next one
    series = _series(local, order)
    last, first = abs(series[order]).upper(), max((abs(c).upper() for c in series.coeffs()[1:]), default=arb(0))
    if not 8 * last < first and not last < arb((fibre[1] - fibre[0]) / 2**20):
        return None  # the series does not converge on this panel; trying on would only take time
    residual, slope = _along(local, series)
    # the series solves the equation to its order, so but for rounding the residual starts there
    if (
        len(local) > 2
        and not _norm(residual.truncate(order + 1)) * _norm(local[2]) * 2**PANEL_SEPARATION_BITS < steepness * steepness
    ):
        raise PrecisionTooLow
    scale = _inverse(slope, order)
    error = _norm(scale * residual).upper()
    least = (1 - _norm(scale * slope - 1)).lower()
    if not least > 0:
        return None
    start = abs(series[0]) + arb(root.high - root.low)
    near = (2 * error / least).upper()
    tube = near if near > start.upper() else start.upper()
    size, reach = _norm(scale), _norm(series) + tube
    if not 2 * size * _derivative_bound(local, 2, reach) * tube < least:
        # a finer bound: the second derivative along z itself, and the third in the tube
        bend = _norm(scale * _second_along(local, series)) + size * _derivative_bound(local, 3, reach) * tube
        if not 2 * bend * tube < least:
            return None
    # w(h) is integrated over -1 <= h <= 1: odd powers cancel
    mean = arb(origin)
    for k, c in enumerate(series.coeffs()):
        if k % 2 == 0:
            mean += c / (k + 1)
    return (mean + near * arb(0, 1)) * arb(2 * radius)


def avoids(p: fmpz_poly, low: fmpq, high: fmpq) -> bool:
    """Whether p is proved to have no zero in [low, high]: its value in the middle outweighs the rest of its Taylor sum.

    False may mean undecided.
    """
    return avoids_zero(arb_poly(p), low, high)


def avoids_zero(p: arb_poly, low: fmpq, high: fmpq) -> bool:
    """The same for a polynomial whose coefficients are known in balls."""
    radius = arb((high - low) / 2)
    value, *rest = p(arb_poly([arb((low + high) / 2), radius])).coeffs() or [arb(0)]
    return bool(sum((abs(c) for c in rest), arb(0)) < abs(value))


def local_coefficients(
    in_v: Sequence[fmpz_poly], middle: fmpq, radius: fmpq, origin: fmpq, number: int | None = None
) -> list[arb_poly]:
    """Coefficients b_i(h) of p(middle + radius h, origin + w) = sum_i b_i(h) w^i: all, or so many first ones."""
    line = arb_poly([arb(middle), arb(radius)])
    rows = [arb_poly(c)(line) for c in in_v]
    shift = arb(origin)
    number = len(rows) if number is None else number
    for start in range(min(len(rows) - 1, number)):
        for i in range(len(rows) - 2, start - 1, -1):
            rows[i] = rows[i] + rows[i + 1] * shift
    return rows[:number]


def _series(local: Sequence[arb_poly], order: int) -> arb_poly:
    """The first coefficients of the solution w(h) of sum_i b_i(h) w^i = 0 near w = 0, each an exact midpoint.

    Newton's iteration on power series; each step doubles the number of right coefficients.
    """
    w = arb_poly([0])
    known = 1
    while True:
        length = min(2 * known, order + 1)
        value, slope = local[-1].truncate(length), arb_poly([0])
        for b in reversed(local[:-1]):
            slope = (slope * w).truncate(length) + value
            value = (value * w).truncate(length) + b.truncate(length)
        step = (value * _inverse(slope, length - 1)).truncate(length)
        w = arb_poly([c.mid() for c in (w - step).coeffs()])
        if known == order + 1:
            return w
        known = length


def _inverse(p: arb_poly, order: int) -> arb_poly:
    """The first coefficients of 1/p, each an exact midpoint.

    Raises
    ------
    PrecisionTooLow
        When the constant coefficient is not known to differ from zero.
    """
    length = order + 1
    if not abs(p[0]) > 0:
        raise PrecisionTooLow
    previous = ctx.cap
    ctx.cap = length
    try:
        inverse = arb_series([1], prec=length) / arb_series(p.coeffs()[:length], prec=length)
    finally:
        ctx.cap = previous
    return arb_poly([c.mid() for c in inverse.coeffs()])


def _along(local: Sequence[arb_poly], w: arb_poly) -> tuple[arb_poly, arb_poly]:
    """p and its derivative by v along the approximation."""
    value, slope = local[-1], arb_poly([0])
    for b in reversed(local[:-1]):
        slope = slope * w + value
        value = value * w + b
    return value, slope


def _second_along(local: Sequence[arb_poly], w: arb_poly) -> arb_poly:
    """The second derivative of p by v along the approximation."""
    total = arb_poly([0])
    for i in range(len(local) - 1, 1, -1):
        total = total * w + i * (i - 1) * local[i]
    return total


def _derivative_bound(local: Sequence[arb_poly], k: int, reach: arb) -> arb:
    """A bound for the k-th derivative by w of sum_i b_i(h) w^i where |h| <= 1 and |w| <= reach."""
    total, power = arb(0), arb(1)
    for i in range(k, len(local)):
        total += perm(i, k) * _norm(local[i]) * power
        power = power * reach
    return total


def _noise(p: arb_poly) -> arb:
    """How much of `_norm` is rounding."""
    return sum((c.rad() for c in p.coeffs()), arb(0))


def _norm(p: arb_poly) -> arb:
    """The sum of the coefficients' moduli: a bound for |p(h)|, |h| <= 1."""
    return sum((abs(c) for c in p.coeffs()), arb(0))
