"""The heights of the curves' points over a critical value: counted, and parted by rational heights.

Guarantee: counts are exact, every point counted once.

Let P(u, v) be the product of the curves' polynomials and a the critical value. Where deg_v P is the
same at a, the Sturm sequence of P(a, v) is computed with balls for the coefficients: remainder by
remainder, each of the degree before less one, until a linear one is left whose leading coefficient
is certainly not zero. The next remainder would be a constant. It is zero exactly when P(a, v) has a
multiple root, which is when a is a root of a curve's discriminant or of the resultant of two: that
is decided in integers. Either way the sequence is known to its end, and its changes of sign count
the different real roots (Sturm; for the multiple root all terms are divided by their last one).

Otherwise, where several roots are multiple, roots are counted of the polynomials in v among whose
roots all points are (`structure.points_over`), but for those that balls show to be on no curve;
this takes long for values of high degree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from math import prod

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.answer.regionmap import CriticalValue
from ptmcad.verification.claims import PlaneCurve, ball, is_root
from ptmcad.verification.elimination import discriminant, resultant
from ptmcad.verification.structure import points_over
from ptmcad.verification.sturm import ball_chain, ends_of, isolated, parting, real_roots

_BITS = (256, 1024, 4096)
_FINEST = 512
"""Bits of candidates that are compared with the curves, besides twice those of their polynomial's
coefficients.
"""


class _Undecided(ArithmeticError):
    """Balls are too large, or several roots are multiple."""


@dataclass(frozen=True)
class Heights:
    """The points over one critical value."""

    curves: Sequence[PlaneCurve]
    value: CriticalValue

    def between(self, low: fmpq, high: fmpq) -> int:
        """The number of points, or of what may be points, with heights in the open interval (low,
        high).
        """
        if low >= high or not self.curves:
            return 0
        for bits in _BITS:
            try:
                with ctx.workprec(bits):
                    return (
                        self._changes(low, bits) - self._changes(high, bits) - self._is_point(high)
                    )
            except _Undecided:
                continue
        return self._candidates_between(low, high)

    def _candidates_between(self, low: fmpq, high: fmpq) -> int:
        """The number of roots of the polynomial in v at which balls do not tell that no curve is
        there.

        It has the points over the conjugates of the critical value among its roots as well.
        """
        number, finest = 0, _FINEST + 2 * self._polynomial.height_bits()
        with ctx.workprec(2 * finest):
            value = ball(self.value, fmpq(1, 1 << finest))
            ends = [end for end in (low, high) if self._is_point(end)]
            for v in real_roots(tuple(int(c) for c in self._polynomial.coeffs()), finest):
                first, last = ends_of(v)
                if last < low or high < first or any(first <= end <= last for end in ends):
                    continue
                number += any(
                    arb_poly([c(value) for c in curve.in_v])(v).contains(0) for curve in self.curves
                )
        return number

    def separated(self, low: fmpq, high: fmpq) -> list[fmpq]:
        """A rational height in each open interval that the points leave of (low, high)."""
        return parting(isolated(self.between, self._is_point, low, high), low, high)

    def _is_point(self, v: fmpq) -> bool:
        return any(is_root(c.along(v), self.value) for c in self.curves)

    def _changes(self, v: fmpq, bits: int) -> int:
        """Changes of sign in the Sturm sequence at a height.

        Raises
        ------
        _Undecided
        """
        values = [q(arb(v)) for q in self._sequence(bits)]
        if self._is_point(v):
            # at a simple root the first term alone is zero; at a multiple one all are
            values = values[1:]
        if any(x.contains(0) for x in values):
            raise _Undecided
        return sum((x > 0) != (y > 0) for x, y in pairwise(values))

    @cached_property
    def _sequences(self) -> dict[int, list[arb_poly] | None]:
        return {}

    def _sequence(self, bits: int) -> list[arb_poly]:
        if bits not in self._sequences:
            self._sequences[bits] = self._made(bits)
        found = self._sequences[bits]
        if found is None:
            raise _Undecided
        return found

    def _made(self, bits: int) -> list[arb_poly] | None:
        """The Sturm sequence, without its last term where that is zero; None where the precision is
        too low.
        """
        value = ball(self.value, fmpq(1, 1 << bits))
        product = prod(
            (arb_poly([c(value) for c in curve.in_v]) for curve in self.curves), start=arb_poly([1])
        )
        return ball_chain(
            product, sum(curve.degrees[1] for curve in self.curves), int(self._has_multiple_root)
        )

    @cached_property
    def _has_multiple_root(self) -> bool:
        """Whether one of the curves has a multiple root over the value, or two have one in common."""
        return any(is_root(discriminant(c.terms), self.value) for c in self.curves) or any(
            is_root(resultant(c.terms, d.terms), self.value)
            for c, d in combinations(self.curves, 2)
        )

    @cached_property
    def _polynomial(self) -> fmpz_poly:
        """A polynomial in v among whose roots are all points."""
        return prod((points_over(c, self.value) for c in self.curves), start=fmpz_poly([1]))
