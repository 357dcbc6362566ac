"""The heights of the curves' points over a critical value: counted, and parted by rational heights.

Roots are counted of the polynomials in v among whose roots all points are (`structure.points_over`), but for those that
balls show to be on no curve over the value: they lie over its conjugates.

Guarantee: every point is counted once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.answer.regionmap import CriticalValue
from ptmcad.verification.claims import PlaneCurve, ball, is_root
from ptmcad.verification.structure import points_over
from ptmcad.verification.sturm import ends_of, isolated, parting, real_roots

_FINEST = 512
"""Bits of candidates that are compared with the curves, besides twice those of their polynomial's coefficients."""


@dataclass(frozen=True)
class Heights:
    """The points over one critical value."""

    curves: Sequence[PlaneCurve]
    value: CriticalValue

    def between(self, low: fmpq, high: fmpq) -> int:
        """The number of points, or of what may be points, with heights in the open interval (low, high)."""
        if low >= high or not self.curves:
            return 0
        ends, number = [end for end in (low, high) if self._is_point(end)], 0
        for v in self._candidates:
            first, last = ends_of(v)
            number += not (last < low or high < first or any(first <= end <= last for end in ends))
        return number

    def separated(self, low: fmpq, high: fmpq) -> list[fmpq]:
        """A rational height in each open interval that the points leave of (low, high)."""
        return parting(isolated(self.between, self._is_point, low, high), low, high)

    def _is_point(self, v: fmpq) -> bool:
        return any(is_root(c.along(v), self.value) for c in self.curves)

    @cached_property
    def _candidates(self) -> list[arb]:
        """The roots of the polynomials in v at which balls do not tell that no curve is there."""
        whole = prod((points_over(c, self.value) for c in self.curves), start=fmpz_poly([1]))
        finest = _FINEST + 2 * whole.height_bits()
        with ctx.workprec(2 * finest):
            value = ball(self.value, fmpq(1, 1 << finest))
            rows = [arb_poly([c(value) for c in curve.in_v]) for curve in self.curves]
            roots = real_roots(tuple(int(c) for c in whole.coeffs()), finest)
            return [v for v in roots if any(row(v).contains(0) for row in rows)]
