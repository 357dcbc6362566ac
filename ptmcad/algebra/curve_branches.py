"""Branches of a plane curve: proved enclosures of their integrals.

Guarantee: an enclosure that is returned contains the branch that was asked for, or its integral;
None means not proved.

On a panel [m - r, m + r] a branch v = y(u) of p(u, v) = 0 is approximated by a polynomial z(h),
u = m + r h, from the branch's Taylor series. Let q = s p with a polynomial s(h) close to 1/p_v(u,
z). Suppose |q(u, z)| <= e and q_v(u, z) >= b > 0 on the panel, and |q_vv| <= K in the tube
|v - z| <= t, with t >= 2 e / b and K t <= b / 2. Then q_v has no zero in the tube and q changes
sign across it (mean value theorem), so the tube contains exactly one root of p for each u (s has no
zero, as s p_v >= b / 2). If the isolated root at u = m lies in it, this root is the branch. It also
lies within 2 e / b of z, since q changes sign there already, so t may be wide enough to find the
root without blurring the integral.

How far from the middle the series is close enough to the branch is read from its coefficients; so
the panel may be made narrower before anything is proved, instead of after a proof has failed.
Products are cut off where a majorant shows that the rest is negligible: if M(h) has the moduli of a
polynomial's coefficients, those beyond h^k add up to at most M(R) / R^(k + 1), R > 1.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import log, perm
from typing import NamedTuple

from flint import arb, arb_poly, arb_series, ctx, fmpq, fmpz_poly

from ptmcad.algebra.polynomials import local_coefficients
from ptmcad.algebra.real_roots import Interval, RealRoot, refine

DERIVATIVE_BITS = 24
"""Bits of the curve's derivative at the panel's middle that have to be right for the rest to make
sense.
"""
SEPARATION_BITS = 40
"""Bits by which rounding has to be smaller than the distance to the next branch at the panel's
middle.
"""
PANEL_SEPARATION_BITS = 10
"""The same along the panel."""
MIN_SHARE = fmpq(1, 32)
"""A series that is good on a smaller part of the panel is not tried: the branch is nearly singular
beside it.
"""
_SHORT_SHARE = fmpq(1, 4)
"""A series that is good on a smaller part only, as it is wanted to very many digits, is tried with
a higher degree.
"""
_BITS_PER_ORDER = 2
"""By each degree more the error is smaller by so many bits on about that part."""
_GAP_BITS = 6
"""Bits of the distance to the next branch to which the branch is known at the panel's middle."""
_CLOSE = 0.8
"""How near to the estimated radius of convergence a series is tried."""
_DIGITS = 50
"""Bits of ratios that are looked at."""
_GAP = 2.0**-10
"""Of the growth: coefficients with smaller ratios belong to a series in which only some powers
occur.
"""
_ALGEBRAIC = 1.5
"""What an algebraic singularity's coefficients grow less than a pole's, about."""
_OUTER = (2, 4)
"""Radii for majorants."""


class TooFewBits(ArithmeticError):
    """The context's precision does not suffice for this curve at this place."""


class SeriesTube(NamedTuple):
    """A polynomial with the only root of the curve near it, for each -1 <= h <= 1.

    Attributes
    ----------
    share : of the panel that was asked for: what is h here was ``share * h`` there.
    series : w(h); its coefficients are exact.
    error : bounds the root's distance from the series.
    reach : within it there is no other root.
    radius : of convergence, in units of the panel that was asked for; an estimate.
    crowded : whether other branches are so near that the proof failed where the series seemed to
        converge.
    """

    share: fmpq
    series: arb_poly
    error: arb
    reach: arb
    radius: float
    crowded: bool


class Integral(NamedTuple):
    """The integral of a branch over the middle part of a panel, which is ``share`` of it.

    ``radius`` is that of the series' convergence in units of half the panel, as it seems to be, and
    ``crowded`` whether other branches are near.
    """

    value: arb
    share: fmpq
    radius: float
    crowded: bool


def branch_integral(
    in_v: Sequence[fmpz_poly],
    at_middle: RealRoot,
    panel: Interval,
    fibre: Interval,
    order: int,
    wanted: fmpq,
) -> Integral | None:
    """An enclosure of the integral of a branch over a panel, or over the middle part of it.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    at_middle : the branch's value at the middle of the panel, isolated among the roots of p(middle,
        v).
    panel : its middle and half its width; over its interior no branches of the curve meet.
    order : degree of the polynomial approximation.
    wanted : an error of the branch's height that would do; positive.

    Returns
    -------
    The enclosure at the context's precision, or None when the tube could not be proved.

    Raises
    ------
    TooFewBits
        When cancellation leaves too few bits.
    """
    root = refine(at_middle, min((fibre[1] - fibre[0]) / 2 ** (ctx.prec // 3), wanted))
    local = local_coefficients(in_v, *panel, root.low)
    if (fine := _near_others(local, root)) is not None:
        root = refine(root, fine)
        local = local_coefficients(in_v, *panel, root.low)
    origin = root.low
    tube = tube_around(local, order, arb(root.high - root.low), arb(wanted))
    if tube is None:
        return None
    # w(h) is integrated over -1 <= h <= 1: odd powers cancel
    mean = arb(origin)
    for k, c in enumerate(tube.series.coeffs()):
        if k % 2 == 0:
            mean += c / (k + 1)
    return Integral(
        (mean + tube.error * arb(0, 1)) * arb(2 * panel[1] * tube.share),
        tube.share,
        tube.radius,
        tube.crowded,
    )


def _near_others(local: Sequence[arb_poly], root: RealRoot) -> fmpq | None:
    """How much better the branch at the middle has to be known, as the next one seems to be that
    near; None where it is known well enough."""
    if len(local) < 3:
        return None
    gap = (abs(local[1][0]) / abs(local[2][0]) / 2**_GAP_BITS).lower()
    return gap.fmpq() if gap.is_finite() and 0 < gap < arb(root.high - root.low) else None


def tube_around(
    local: Sequence[arb_poly], order: int, start: arb, wanted: arb
) -> SeriesTube | None:
    """The tube around the root w(h) of sum_i b_i(h) w^i that starts near zero at h = 0, on as much
    of |h| <= 1 as seems to be within the error that is wanted; None when it is not proved.

    Parameters
    ----------
    order : degree of the series, or more where very many digits are wanted.
    start : the tube reaches at least so far from w = 0 at h = 0.

    Raises
    ------
    TooFewBits
        When cancellation leaves too few bits.
    """
    if local[1][0].rel_accuracy_bits() < DERIVATIVE_BITS:
        raise TooFewBits  # the root is simple, so the derivative is not zero
    steepness = abs(local[1][0])
    if (
        len(local) > 2
        and not _noise(local[0]) * _norm(local[2]) * 2**SEPARATION_BITS < steepness * steepness
    ):
        raise TooFewBits  # rounding blurs the branch nearly as far as the next one
    series = _series(local, order)
    part, radius = _usable(series, order, wanted)
    if part < _SHORT_SHARE and (longer := _bits_wanted(series, wanted) // _BITS_PER_ORDER) > order:
        series = _series(local, longer)
        part, radius = _usable(series, longer, wanted)
    share, crowded = fmpq(1), False
    while share * part >= MIN_SHARE:
        if part < 1:
            shrunk = arb_poly([0, arb(part)])
            series, local = _exact(series(shrunk)), [b(shrunk) for b in local]
        share = share * part
        proved = _proved(local, series, start, wanted)
        if proved is not None:
            return SeriesTube(share, series, *proved, radius, crowded)
        part, crowded = fmpq(1, 2), True
    return None


def _usable(series: arb_poly, order: int, wanted: arb) -> tuple[fmpq, float]:
    """The part of |h| <= 1 where the series seems to be near enough to its limit, and its radius of
    convergence.
    """
    sizes = [abs(series[k]) for k in range(1, order + 1)]
    largest = max((s.upper() for s in sizes), default=arb(0))
    if not largest > 0:
        return fmpq(1), 2.0**_DIGITS
    relative = [float((s / largest).mid()) for s in sizes]
    third = len(relative) // 3
    last, before = (
        max(relative[-third:], default=0.0),
        max(relative[-2 * third : -third], default=0.0),
    )
    if last == 0.0:
        return fmpq(1), 2.0**_DIGITS
    growth = (last / before) ** (1 / third) if before > 0 else 1.0
    growth = max(growth, last ** (1 / len(relative)), 2.0**-_DIGITS)
    allowed = max(float((wanted / largest).mid()), 2.0**-200)
    # one after the other: the product of two tiny numbers may be none
    part = min((allowed / last / (4 * growth)) ** (1 / (len(relative) + 1)), _CLOSE / growth)
    # of few bits, as all arithmetic starts from it
    return (fmpq(1) if part >= 1 else fmpq(int(part * 64), 64)), _radius(relative, growth)


def _bits_wanted(series: arb_poly, wanted: arb) -> int:
    """How many bits of the branch's way over the panel are wanted, about."""
    ratio = (max((abs(c).upper() for c in series.coeffs()[1:]), default=arb(0)) / wanted).mid()
    return (
        int(ratio.man_exp()[1]) + int(ratio.man_exp()[0]).bit_length() if ratio.is_finite() else 0
    )


def _radius(sizes: Sequence[float], growth: float) -> float:
    """Of convergence, by how the ratios of the last coefficients go on (Domb and Sykes); an
    estimate.
    """
    ratios = [(k + 2) * b / a if a > 0 else 0.0 for k, (a, b) in enumerate(pairwise(sizes))][-4:]
    if min(ratios, default=0.0) < _GAP * growth:
        return 1 / (_ALGEBRAIC * growth)
    return 1 / max([2.0**-_DIGITS, *(b - a for a, b in pairwise(ratios))])


def _proved(
    local: Sequence[arb_poly], series: arb_poly, start: arb, wanted: arb
) -> tuple[arb, arb] | None:
    """The tube's error and reach where |h| <= 1."""
    order = max(series.degree(), 0)
    steepness = abs(local[1][0])
    length, beyond = _length(local, series, steepness, wanted)
    residual, slope = _along(local, series, length, length)
    # the series solves the equation to its order, so but for rounding the residual starts there
    if (
        len(local) > 2
        and not _norm(residual.truncate(order + 1)) * _norm(local[2]) * 2**PANEL_SEPARATION_BITS
        < steepness * steepness
    ):
        raise TooFewBits
    scale = _inverse(slope, order)
    size = _norm(scale)
    error = _norm(scale * residual) + size * beyond[0]
    least = (1 - _norm(scale * slope - 1) - size * beyond[1]).lower()
    if not least > 0:
        return None
    begin = abs(series[0]) + start
    near = (2 * error / least).upper()
    tube = 2 * near if 2 * near > begin.upper() else begin.upper()
    reach = _norm(series) + tube
    if not 2 * size * _derivative_bound(local, 2, reach) * tube < least:
        # a finer bound: the second derivative along z itself, and the third in the tube
        second = (
            _norm(scale * _second_along(local, series))
            + size * _derivative_bound(local, 3, reach) * tube
        )
        if not 2 * second * tube < least:
            return None
    return near, tube


def _length(
    local: Sequence[arb_poly], series: arb_poly, steepness: arb, wanted: arb
) -> tuple[int, tuple[arb, arb]]:
    """How many coefficients of p and its derivative by v along a series matter, and bounds for the
    other ones' sums.
    """
    length = 1 + max(b.degree() + i * series.degree() for i, b in enumerate(local))
    beyond = arb(0), arb(0)
    for radius in _OUTER:
        sizes = arb_poly([_norm(b, radius) for b in local])
        far = _norm(series, radius)
        value, slope = sizes(far), sizes.derivative()(far)
        excess = (value / (wanted * steepness / 16)).union(slope / (steepness / 16)).upper()
        if excess.is_finite():
            number = 1 + int(max(0.0, float(excess.log().upper()) / log(radius)))
            if number < length:
                length, beyond = (
                    number,
                    (value / arb(radius) ** number, slope / arb(radius) ** number),
                )
    return length, beyond


def _series(local: Sequence[arb_poly], order: int) -> arb_poly:
    """The first coefficients of the solution w(h) of sum_i b_i(h) w^i = 0 near w = 0, each an exact
    midpoint.

    Newton's iteration on power series; each step doubles the number of right coefficients.
    """
    w = arb_poly([0])
    known = 1
    while True:
        length = min(2 * known, order + 1)
        # the value begins where the known coefficients end, so the slope needs only as many as are
        # new
        new = max(1, length - known)
        value, slope = _along(local, w, length, new)
        step = (value * _inverse(slope, new - 1)).truncate(length)
        w = _exact(w - step)
        if known == order + 1:
            return w
        known = length


def _inverse(p: arb_poly, order: int) -> arb_poly:
    """The first coefficients of 1/p, each an exact midpoint.

    Raises
    ------
    TooFewBits
        When the constant coefficient is not known to differ from zero.
    """
    length = order + 1
    if not abs(p[0]) > 0:
        raise TooFewBits
    previous = ctx.cap
    ctx.cap = length
    try:
        inverse = arb_series([1], prec=length) / arb_series(p.coeffs()[:length], prec=length)
    finally:
        ctx.cap = previous
    return _exact(arb_poly(inverse.coeffs()))


def _along(
    local: Sequence[arb_poly], w: arb_poly, length: int, of_slope: int
) -> tuple[arb_poly, arb_poly]:
    """The first coefficients of p and of its derivative by v along the approximation."""
    value, slope = local[-1].truncate(length), arb_poly([0])
    for b in reversed(local[:-1]):
        slope = (slope * w).truncate(of_slope) + value.truncate(of_slope)
        value = (value * w).truncate(length) + b.truncate(length)
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


def _norm(p: arb_poly, radius: int = 1) -> arb:
    """The sum of the coefficients' moduli where h = radius: a bound for |p(h)|, |h| <= radius.

    In Horner's scheme a ball around zero adds up just these.
    """
    return abs(p(arb(0, radius))).upper()


def _exact(p: arb_poly) -> arb_poly:
    """With the coefficients' midpoints."""
    return arb_poly([c.mid() for c in p.coeffs()])
