"""Balls around isolated real roots, by the interval Newton operator.

Guarantee: a ball contains the root. How narrow it is depends on the working precision and on the
root; nothing is concluded from it that a wide one would not prove as well.

Reference: Moore, Interval Analysis (1966); with a root in X and 0 not in p'(X), it lies in
m - p(m) / p'(X) for any m in X, by the mean value theorem.
"""

from __future__ import annotations

from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.algebra.real_roots import RealRoot, refine, sign_at

_HALVINGS = 12
"""How often an interval is halved before it is refined as fast as a cluster of roots needs."""


class Newton(NamedTuple):
    """A squarefree polynomial and its derivative in balls of the precision at which this was made."""

    value: arb_poly
    slope: arb_poly

    @classmethod
    def of(cls, p: fmpz_poly) -> Newton:
        """Of a polynomial over Z, at the working precision."""
        return cls(arb_poly(p), arb_poly(p.derivative()))

    def ball(self, root: RealRoot) -> arb:
        """A ball around a root of the polynomial, about as narrow as the working precision allows."""
        low, high = root.low, root.high
        if low == high:
            return arb(low)
        rising = sign_at(root.polynomial, high) > 0
        for _ in range(_HALVINGS):
            found = self._narrowed(arb(low).union(arb(high)))
            if found is not None:
                return found
            middle = (low + high) / 2
            value = self.value(arb(middle))
            if value > 0 if rising else value < 0:
                high = middle
            elif value < 0 if rising else value > 0:
                low = middle
            else:  # the root, or too near to it to tell
                break
        # by its own means as far as the ball is to be narrow, where Newton's would not be at this
        # precision
        return refine(root, fmpq(1, 2 ** (ctx.prec - 8)) * (abs(root.middle) + 1)).ball

    def _narrowed(self, ball: arb) -> arb | None:
        """The root of a ball in one of at most the square root of the precision's unit; None when
        that fails.
        """
        while True:
            slope = self.slope(ball)
            if slope.contains(0):
                return None
            middle = ball.mid()
            found = middle - self.value(middle) / slope
            if not 2 * found.rad() < ball.rad():
                small = ball.rad() * 2 ** (ctx.prec // 2) < abs(middle) + 1
                return ball if small else None
            ball = found
