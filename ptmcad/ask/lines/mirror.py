"""A reflection of all angles at once, whose line may turn with the parameter, and that a system on
a line keeps.

Guarantee: a `Mirror` that `mirror_of` returns leaves the equations alone, each up to its sign, for
every value of the line at which its direction is not zero: identities of polynomials, computed
exactly.

With z = exp(i t) for each angle t an equation is a sum of e_m z^m over integer vectors m, and e_-m
is the conjugate of e_m. The reflection at the line of a complex number w takes z to (w / conj w)
conj z. It takes the equation to itself where e_m w^|m| is real for every m, with |m| the sum of the
entries, and to its negative where all of these are imaginary. So any e_m with |m| = 1 fixes the
line of w, up to a right angle.

Source: elementary (the Fourier coefficients of a real function under a reflection).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from flint import arb

from ptmcad.algebra.polynomials import (
    PLANE,
    Coefficient,
    Monomial,
    UnknownPolynomial,
    constant_like,
)
from ptmcad.text.balls import ball_over

Gaussian = tuple[Coefficient, Coefficient]
"""Real and imaginary part, polynomials in the axes."""
Waves = dict[Monomial, Gaussian]
"""A sum of e_m z^m: m -> e_m."""


class Mirror(NamedTuple):
    """The direction of a mirror line, two polynomials of which the first axis alone occurs."""

    x: Coefficient
    y: Coefficient

    def angle(self, low: Fraction, high: Fraction) -> arb | None:
        """The line's angle, up to half a turn, for all values of the axis from low to high.

        None where its direction may be zero there.
        """
        value = ball_over(low, high)
        x, y = _at(self.x, value), _at(self.y, value)
        if x.contains(0) and y.contains(0):
            return None
        # of its two directions one away from the cut of the arc tangent
        return arb.atan2(-y, -x) if x < 0 else arb.atan2(y, x)


QUARTERS = (
    Mirror(PLANE.constant(1), PLANE.constant(0)),
    Mirror(PLANE.constant(0), PLANE.constant(1)),
)
"""The lines at which an angle is reflected that becomes its negative, or half a turn less it."""


def mirror_of(equations: Sequence[UnknownPolynomial], angles: int) -> Mirror | None:
    """The mirror line of equations in cosine and sine of each angle; None where no reflection is
    found.

    Parameters
    ----------
    equations : as of `ptmcad.exact.models.system.SliceSystem`, without unknowns on the line.
    """
    sums = [_fourier(p, angles) for p in equations if p]
    first = next((e for s in sums for m, e in s.items() if sum(m) == 1), None)
    if first is None:
        return None
    common = first[0].gcd(first[1])
    x, y = first[0] / common, first[1] / common
    for w in ((x, -y), (y, x)):
        if all(_is_kept(s, w) for s in sums):
            return Mirror(*w)
    return None


def _fourier(p: UnknownPolynomial, angles: int) -> Waves:
    """The coefficients e_m of a polynomial in cosines and sines, all times a power of two."""
    degree = max(map(sum, p))
    total: Waves = {}
    for powers, coefficient in p.items():
        zero = constant_like(coefficient, 0)
        part = {(0,) * angles: (coefficient * 2 ** (degree - sum(powers)), zero)}
        for k, e in enumerate(powers):
            for _ in range(e):
                part = _times_wave(part, k // 2, k % 2 == 1)
        for m, (a, b) in part.items():
            c, d = total.get(m, (zero, zero))
            total[m] = (a + c, b + d)
    return {m: (a, b) for m, (a, b) in total.items() if not (a.is_zero() and b.is_zero())}


def _times_wave(p: Waves, angle: int, sine: bool) -> Waves:
    """A sum times 2 cos or 2 sin of an angle: z + 1/z, or -i z + i / z."""
    result: Waves = {}
    for m, (a, b) in p.items():
        for step in (1, -1):
            to = (*m[:angle], m[angle] + step, *m[angle + 1 :])
            x, y = (b * step, -a * step) if sine else (a, b)
            if to in result:
                x, y = x + result[to][0], y + result[to][1]
            result[to] = (x, y)
    return result


def _is_kept(waves: Waves, w: Gaussian) -> bool:
    """Whether a reflection takes a sum to itself or to its negative."""
    turned = []
    for m, e in waves.items():
        if sum(m) >= 0:  # the others are the conjugates
            for _ in range(sum(m)):
                e = (e[0] * w[0] - e[1] * w[1], e[0] * w[1] + e[1] * w[0])  # noqa: PLW2901
            turned.append(e)
    return all(b.is_zero() for _, b in turned) or all(a.is_zero() for a, _ in turned)


def _at(p: Coefficient, value: arb) -> arb:
    total = arb(0)
    for (i, *_), c in p.to_dict().items():
        total += arb(c) * value**i
    return total
