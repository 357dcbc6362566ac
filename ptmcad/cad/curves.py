"""Curves of the variety seen from a base axis: fibres over rational abscissae and traces on rational horizontals.

Guarantee: exact. ``u`` is the coordinate on the base axis, ``v`` the one on the fibre axis.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import fmpq, fmpz_poly

from ptmcad.algebra.polynomials import Coefficient, coefficients_in, univariate


@dataclass(frozen=True, slots=True)
class Curve:
    """An irreducible polynomial that involves v.

    Attributes
    ----------
    component : its number in the variety.
    in_v : coefficients as a polynomial in v, each in Z[u].
    in_u : coefficients as a polynomial in u, each in Z[v].
    """

    component: int
    in_v: tuple[fmpz_poly, ...]
    in_u: tuple[fmpz_poly, ...]

    def fibre(self, u: fmpq) -> fmpz_poly:
        """A positive multiple of p(u, v) in Z[v]."""
        return univariate(self.in_v, u)

    def trace(self, v: fmpq) -> fmpz_poly:
        """A positive multiple of p(u, v) in Z[u]."""
        return univariate(self.in_u, v)


def curve(component: int, p: Coefficient, base: int) -> Curve:
    """The curve of a component, for the base axis 0 or 1."""
    return Curve(component, coefficients_in(p, 1 - base), coefficients_in(p, base))


def deflation(coefficients: tuple[fmpz_poly, ...]) -> int:
    """The largest k for which only powers of v^k occur."""
    k = 0
    for i, c in enumerate(coefficients):
        if c and i:
            k = _gcd(k, i)
    return max(k, 1)


def base_deflation(coefficients: tuple[fmpz_poly, ...]) -> int:
    """The largest k for which only powers of u^k occur."""
    k = 0
    for c in coefficients:
        for i, d in enumerate(c.coeffs()):
            if d and i:
                k = _gcd(k, i)
    return max(k, 1)


def _gcd(a: int, b: int) -> int:
    while b:
        a, b = b, a % b
    return a
