"""Curves of the variety seen from a base axis, and their projection to it: the abscissae over which
their order can change. ``u`` is the coordinate on the base axis, ``v`` the one on the fibre axis.

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

from collections.abc import Iterable, Sequence
from math import gcd
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.polynomials import (
    Coefficient,
    Restrictions,
    UnivariatePolynomial,
    coefficients_in,
    from_plane,
)
from ptmcad.algebra.real_roots import Interval, RealRoot, disjoint, inside, isolate, refine
from ptmcad.algebra.reflections import Reflection, isolate_reflected, reflection_of
from ptmcad.algebra.resultants import Check, balanced, discriminant, nothing, resultant
from ptmcad.answer.regionmap import Component

_LONG_FIBRE = 16
"""Coefficients up to which a polynomial's roots are found as fast as those of one of half its
degree, and their square roots."""


class FibredCurve(NamedTuple):
    """An irreducible polynomial that involves v.

    Attributes
    ----------
    component : its number in the variety.
    in_v : coefficients as a polynomial in v, each in Z[u].
    in_u : coefficients as a polynomial in u, each in Z[v].
    on_fibres, on_horizontals : the polynomial over given u, and for given v.
    reflection : the reflection along the fibres that maps it to itself, if there is one.
    """

    component: int
    in_v: tuple[UnivariatePolynomial, ...]
    in_u: tuple[UnivariatePolynomial, ...]
    on_fibres: Restrictions
    on_horizontals: Restrictions
    reflection: Reflection | None

    def polynomial_over(self, u: fmpq) -> UnivariatePolynomial:
        """A positive multiple of p(u, v) in Z[v]."""
        return self.on_fibres.at(u)

    def roots_over(self, u: fmpq, fibre: Interval) -> tuple[RealRoot, ...]:
        """The roots of p(u, v) in the open interval, in increasing order.

        Raises
        ------
        ValueError
            When one of them is multiple, as it is over critical abscissae only.
        """
        if self.reflection is None or len(self.in_v) <= _LONG_FIBRE:
            return isolate(self.polynomial_over(u), *fibre)
        axis, squares = self.reflection
        return isolate_reflected(
            self.polynomial_over(u), squares.at(u), axis(u), int(axis.denom()), *fibre
        )

    def trace(self, v: fmpq) -> UnivariatePolynomial:
        """A positive multiple of p(u, v) in Z[u]."""
        return self.on_horizontals.at(v)


def curve(component: int, p: Coefficient, base: int) -> FibredCurve:
    """The curve of a component, for the base axis 0 or 1."""
    in_v, in_u = coefficients_in(p, 1 - base), coefficients_in(p, base)
    return FibredCurve(
        component, in_v, in_u, Restrictions(in_v), Restrictions(in_u), reflection_of(in_v)
    )


def curves_of(components: Sequence[Component], base: int, reason: str = "") -> list[FibredCurve]:
    """The components that are used, or left out for a reason, as curves over the base; lines across
    it are none.
    """
    return [
        curve(n, from_plane(c.polynomial), base)
        for n, c in enumerate(components)
        if c.left_out == reason and c.polynomial.degrees[1 - base] > 0
    ]


def by_component(curves: Iterable[FibredCurve]) -> dict[int, FibredCurve]:
    """The curve of each component's number."""
    return {c.component: c for c in curves}


def lines_of(
    components: Sequence[Component], base: int, reason: str = ""
) -> dict[int, UnivariatePolynomial]:
    """Components that are lines across the base, as polynomials in u by the components' numbers."""
    return {
        n: coefficients_in(from_plane(c.polynomial), 1 - base)[0]
        for n, c in enumerate(components)
        if c.left_out == reason and c.polynomial.degrees[1 - base] == 0
    }


def max_height_bits(curves: Sequence[FibredCurve]) -> int:
    """The bits of the longest coefficient."""
    return max((int(q.height_bits()) for c in curves for q in c.in_v), default=0)


def stretched(p: UnivariatePolynomial, unit: int, inflation: int) -> UnivariatePolynomial:
    """p(unit u^inflation)."""
    return UnivariatePolynomial([c * unit**j for j, c in enumerate(p.coeffs())]).inflate(inflation)


def deflation(coefficients: Sequence[UnivariatePolynomial | Coefficient]) -> int:
    """The largest k for which only powers of v^k occur."""
    return max(1, gcd(*(i for i, c in enumerate(coefficients) if c)))


def base_deflation(coefficients: Sequence[UnivariatePolynomial]) -> int:
    """The largest k for which only powers of u^k occur."""
    return max(1, gcd(*(i for c in coefficients for i, d in enumerate(c.coeffs()) if d)))


Coefficients = tuple[UnivariatePolynomial, ...]
_LONG_COEFFICIENT_BITS = 1000
"""Bits of coefficients from which on other units for u and v are looked for."""


def shortened(
    polynomials: list[Coefficients], deflate: bool = True
) -> tuple[list[Coefficients], int, int]:
    """The polynomials with u in place of unit u^inflation, unit, and inflation."""
    deflated, inflation = _deflated(polynomials, deflate)
    if max(c.height_bits() for p in deflated for c in p) < _LONG_COEFFICIENT_BITS:
        return deflated, 1, inflation
    shorter, unit = balanced(deflated)
    return shorter, unit, inflation


def short_discriminant(
    c: FibredCurve, check: Check, deflate: bool = True
) -> tuple[UnivariatePolynomial, int, int]:
    """The discriminant of p(u, v^(1/k)) in the units of `shortened`, unit, and inflation; k as
    large as it may be.
    """
    (shorter,), unit, inflation = shortened(
        [c.in_v[:: deflation(c.in_v) if deflate else 1]], deflate
    )
    return discriminant(shorter, check), unit, inflation


def short_resultant(
    c: FibredCurve, d: FibredCurve, check: Check, deflate: bool = True
) -> tuple[UnivariatePolynomial, int, int]:
    """The resultant of two curves in the same way."""
    power = gcd(deflation(c.in_v), deflation(d.in_v)) if deflate else 1
    (first, second), unit, inflation = shortened([c.in_v[::power], d.in_v[::power]], deflate)
    return resultant(first, second, check), unit, inflation


def _deflated(polynomials: list[Coefficients], deflate: bool) -> tuple[list[Coefficients], int]:
    """The polynomials with u in place of u^k, and the largest k for which that can be done in all
    of them; or k = 1.
    """
    if not deflate:
        return polynomials, 1
    varying = [base_deflation(p) for p in polynomials if any(q.degree() > 0 for q in p)]
    k = gcd(*varying) if varying else 1
    return [tuple(q.deflate(k) if q else q for q in p) for p in polynomials], k


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
