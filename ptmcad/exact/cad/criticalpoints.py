"""The points of the curves over a critical abscissa, each in a rational interval of its own.

Guarantee: the intervals are disjoint, each contains one point at most, and all points in the window
lie in them.

Two ways lead there. The short one encloses all complex roots of every p(a, v) in discs, a being
known to many digits. A disc with two roots, or discs of two curves that meet, need not hold one
point only. But where a is a root of the curve's discriminant, two of the roots are one; where it is
a root of the resultant of two curves, these have one in common. If there is no other disc in which
that can be, it is so in this one.

The other one needs nothing but time: all real roots of res_u(q, p), q being a's polynomial, are
isolated.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations

from flint import ctx, fmpq

from ptmcad.algebra.clusters import RootDisc, clusters_over
from ptmcad.algebra.polynomials import UnivariatePolynomial
from ptmcad.algebra.real_roots import (
    Interval,
    RealRoot,
    disjoint,
    inside,
    isolate,
    refine,
    squarefree_part,
    vanishes_at,
)
from ptmcad.algebra.resultants import Check, nothing, resultant
from ptmcad.exact.cad.projection import (
    FibredCurve,
    deflation,
    short_discriminant,
    short_resultant,
    stretched,
)

_BITS = (128, 512)
"""Of the critical abscissa, until all discs are separate; with more of them the other way is the
shorter one.
"""


class PointsOver:
    """The points of curves on the line over a root."""

    def __init__(
        self, curves: tuple[FibredCurve, ...], root: RealRoot, check: Check = nothing
    ) -> None:
        self.curves, self.root, self.check = curves, root, check
        self._enclosures: dict[int, list[Interval] | None] = {}

    def between(self, bottom: fmpq, top: fmpq, edges: Sequence[fmpq]) -> list[Interval]:
        """Intervals that hold the points in the open interval (bottom, top), from below.

        Parameters
        ----------
        bottom, top : heights that are points of the curves only if they are among ``edges``.
        edges : the ends of the interval that are points of the curves.
        """
        for bits in _BITS:
            self.check()
            if bits not in self._enclosures:
                self._enclosures[bits] = self._enclosed(bits)
            found = self._enclosures[bits]
            if found is None:
                continue
            ends = [e for e in (bottom, top) if e not in edges]
            at_edges = [
                sum(low <= e <= high for low, high in found) for e in (bottom, top) if e in edges
            ]
            if any(low <= e <= high for e in ends for low, high in found) or any(
                n != 1 for n in at_edges
            ):
                continue
            return [i for i in found if bottom < i[0] and i[1] < top]
        roots = inside(disjoint(isolate(self._polynomial, bottom, top)), (bottom, top))
        return [(r.low, r.high) for r in roots]

    def _enclosed(self, bits: int) -> list[Interval] | None:
        """Disjoint intervals with one point of the curves each, that hold all of them; None where
        that is not known.
        """
        with ctx.workprec(2 * bits + 64):
            abscissa = refine(self.root, fmpq(1, 1 << bits)).ball
            discs: list[RootDisc] = []
            groups: list[range] = []
            for k, c in enumerate(self.curves):
                group = clusters_over(c.in_v, abscissa)
                if group is None or not self._are_points(k, group):
                    return None
                groups.append(range(len(discs), len(discs) + len(group)))
                discs += group
            same: set[tuple[int, int]] = set()
            for (k, one), (m, other) in combinations(enumerate(groups), 2):
                meeting = {(i, j) for i in one for j in other if discs[i].meets(discs[j])}
                # where they have a root in common, it is in the only place where it can be
                if len(meeting) > 1 or (meeting and not self._meet(k, m)):
                    return None
                same |= meeting
            return _merged(discs, same)

    def _are_points(self, k: int, group: Sequence[RootDisc]) -> bool:
        """Whether each disc of a curve is known to hold one root only, as often as it counts."""
        multiple = [c.number for c in group if c.number > 1]
        return not multiple or (multiple == [2] and vanishes_at(self._discriminants[k], self.root))

    def _meet(self, k: int, m: int) -> bool:
        """Whether two curves have a complex point over the root in common."""
        # of polynomials in v^k it is the k-th power of that in v
        return vanishes_at(
            stretched(*short_resultant(self.curves[k], self.curves[m], self.check)), self.root
        )

    @cached_property
    def _discriminants(self) -> list[UnivariatePolynomial]:
        return [_discriminant(c, self.check) for c in self.curves]

    @cached_property
    def _polynomial(self) -> UnivariatePolynomial:
        """A squarefree polynomial in v among whose roots are all points."""
        root = RealRoot.of(self.root.low) if self.root.is_rational else self.root
        constant = [UnivariatePolynomial([c]) for c in root.polynomial.coeffs()]
        product = UnivariatePolynomial([1])
        for c in self.curves:
            points = squarefree_part(resultant(c.in_u, constant, self.check))
            product = product * (points // points.gcd(product))
        return product


def _discriminant(c: FibredCurve, check: Check) -> UnivariatePolynomial:
    """A polynomial with the roots of the curve's discriminant, from that of least degree.

    The discriminant of p(u, v^k) is, but for a constant, a power of that of p(u, v) times powers of
    p(u, 0) and of the leading coefficient.
    """
    found = stretched(*short_discriminant(c, check))
    return found if deflation(c.in_v) == 1 else found * c.in_v[0] * c.in_v[-1]


def _merged(discs: Sequence[RootDisc], same: set[tuple[int, int]]) -> list[Interval] | None:
    """The intervals of real discs, those of discs with the same point as one; None where others
    meet, by their rounding.

    Parameters
    ----------
    same : the numbers of two discs with one point, the smaller one first.
    """
    extents = {n: disc.extent for n, disc in enumerate(discs) if disc.is_real}
    merged: list[tuple[Interval, list[int]]] = []
    for n, (low, high) in sorted(extents.items(), key=lambda numbered: numbered[1][0]):
        if not merged or low > merged[-1][0][1]:
            merged.append(((low, high), [n]))
            continue
        (start, end), members = merged.pop()
        if not any((min(n, m), max(n, m)) in same for m in members):
            return None
        merged.append(((start, max(high, end)), [*members, n]))
    return [interval for interval, _ in merged]
