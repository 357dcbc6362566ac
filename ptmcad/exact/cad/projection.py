"""Projection of the window's curves to the base axis: the abscissae over which their order can
change.

Guarantee: over each interval between consecutive critical abscissae the number of real roots of
every curve in the window, and the order of all these roots, are constant.

Why these polynomials: within a bounded window the roots of p(u, .) change in number only at a
multiple root (a zero of the discriminant) or through the window's edge (a zero of p(u, edge));
roots of two curves meet at zeros of the resultant. Leading coefficients are left out: where one
vanishes a root leaves through infinity, not through the window. Powers are deflated: for p(u, v^k)
the discriminant's zeros are those of disc_V p(u, V) and, if the window contains v = 0, of p(u, 0).
References: McCallum, J. Symb. Comp. 5 (1988); Strzebonski, J. Symb. Comp. 29 (2000) for open cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ptmcad.algebra.polynomials import UnivariatePolynomial
from ptmcad.algebra.real_roots import Interval, RealRoot, disjoint, inside, isolate, refine
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.exact.cad.curves import (
    FibredCurve,
    base_deflation,
    deflation,
    short_discriminant,
    short_resultant,
    stretched,
)


class Projection(NamedTuple):
    """Irreducible polynomials in Z[u], each with its origin, and their roots in the base interval."""

    polynomials: tuple[tuple[UnivariatePolynomial, str], ...]
    abscissae: tuple[RealRoot, ...]

    def origin(self, polynomial: UnivariatePolynomial) -> str:
        """Why a polynomial belongs to the projection."""
        return next(origin for p, origin in self.polynomials if p == polynomial)


def predicted_cost(curves: Sequence[FibredCurve]) -> int:
    """A figure for the cost of the projection: evaluation points times the cost of one evaluation,
    summed.
    """
    sizes = []
    for c in curves:
        n = (len(c.in_v) - 1) // deflation(c.in_v)
        d = max(q.degree() for q in c.in_v) // base_deflation(c.in_v)
        sizes.append((n, d))
    cost = sum(max(d, 1) * 2 * n * n**3 for n, d in sizes)
    for i, (n, d) in enumerate(sizes):
        for m, e in sizes[i + 1 :]:
            cost += (n * e + m * d + 1) * (n + m) ** 3
    return cost


def project(
    curves: Sequence[FibredCurve],
    verticals: Sequence[UnivariatePolynomial],
    base: Interval,
    fibre: Interval,
    check: Check = nothing,
    without: frozenset[str] = frozenset(),
) -> Projection:
    """The projection of the curves (and of vertical lines, given by their polynomials in u) and its
    real roots.

    Parameters
    ----------
    check : called now and then; may raise to stop.
    without : names of savings to switch off: ``"even-powers"``.
    """
    deflate = "even-powers" not in without
    found: dict[tuple[int, ...], tuple[UnivariatePolynomial, str]] = {}

    def adopt(factors: list[UnivariatePolynomial], origin: str) -> None:
        for factor in factors:
            found.setdefault(tuple(int(c) for c in factor.coeffs()), (factor, origin))

    for line in verticals:
        adopt(_factors(line), "vertical line")
    for c in curves:
        for factors, origin in _of_one(c, fibre, check, deflate):
            adopt(factors, origin)
    for i, c in enumerate(curves):
        for d in curves[i + 1 :]:
            adopt(
                _factors(*short_resultant(c, d, check, deflate)),
                f"components {c.component} and {d.component} meet",
            )
    roots = [r for p, _ in found.values() for r in isolate(p, *base)]
    # intervals that are short against the window leave room for simple samples between them
    width = (base[1] - base[0]) / 2**16
    short = [refine(r, width) for r in roots]
    return Projection(tuple(found.values()), inside(disjoint(short), base))


def _factors(
    p: UnivariatePolynomial, unit: int = 1, inflation: int = 1
) -> list[UnivariatePolynomial]:
    """The irreducible factors of p(unit u^inflation) that are not constant."""
    if p.degree() < 1:
        return []
    if unit == 1:
        return [factor for factor, _ in p.inflate(inflation).factor()[1]]
    result = []
    for factor, _ in p.factor()[1]:
        longer = stretched(factor, unit, 1)
        result += _factors(longer // longer.content(), 1, inflation)
    return result


def _of_one(
    c: FibredCurve, fibre: Interval, check: Check, deflate: bool
) -> list[tuple[list[UnivariatePolynomial], str]]:
    name = f"component {c.component}"
    result = [
        (_factors(*short_discriminant(c, check, deflate)), f"{name}: turning or singular point")
    ]
    if deflate and deflation(c.in_v) > 1 and fibre[0] < 0 < fibre[1]:
        result.append((_factors(c.in_v[0]), f"{name}: turning point on the axis"))
    for edge in fibre:
        result.append((_factors(c.trace(edge)), f"{name}: crosses the window's edge"))
    return result
