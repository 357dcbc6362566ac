"""Plane curves that a reflection along the fibres maps to themselves: (u, v) to (u, 2 m(u) - v), m
linear.

Guarantee: exact. An axis that is found is one, proved by an identity of polynomials; no other line
is one.

If p = c_n v^n + c_(n-1) v^(n-1) + ... is the same after the reflection, with n even, then so is its
set of n roots over each u, whose mean is m = -c_(n-1) / (n c_n). So there is one candidate, and it
is an axis if p(u, m + w) has only even powers of w. Four oscillators have such a curve: the frame
of one of them hides that it may be exchanged with another.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from flint import fmpq_poly, fmpz_poly

from ptmcad.algebra.branches import shifted
from ptmcad.algebra.restrictions import Restrictions

Coefficients = Sequence[fmpz_poly]


class Reflection(NamedTuple):
    """A reflection along the fibres that maps a curve to itself.

    Attributes
    ----------
    axis : m(u), of degree 1 at most, with the common denominator d.
    squares : coefficients in Z[u] of powers of W = d^2 (v - m)^2, as `squared` says.
    """

    axis: fmpq_poly
    squares: Restrictions


def reflection_of(p: Coefficients) -> Reflection | None:
    """The reflection that maps the curve to itself; None where there is none."""
    axis = axis_of(p)
    return None if axis is None else Reflection(axis, Restrictions(tuple(squared(p, axis))))


def axis_of(p: Coefficients) -> fmpq_poly | None:
    """m(u), of degree 1 at most, with p(u, 2 m - v) = p(u, v); None where there is none.

    Parameters
    ----------
    p : coefficients in Z[u] of powers of v, the last one not zero.
    """
    n = len(p) - 1
    if n < 2 or n % 2:
        return None
    axis, rest = divmod(fmpq_poly(-p[-2]), n * fmpq_poly(p[-1]))
    if rest or axis.degree() > 1:
        return None
    return axis if not any(_shifted(p, axis)[1::2]) else None


def squared(p: Coefficients, axis: fmpq_poly) -> list[fmpz_poly]:
    """The coefficients in Z[u] of powers of W, with p(u, v) d^n = q(u, W), W = d^2 (v - m)^2.

    Parameters
    ----------
    axis : m, as `axis_of` says, with the common denominator d.
    """
    n, d = len(p) - 1, axis.denom()
    rows = _shifted(p, axis)[::2]
    return [(row * d ** (n - 2 * k)).numer() for k, row in enumerate(rows)]


def _shifted(p: Coefficients, by: fmpq_poly) -> list[fmpq_poly]:
    """The coefficients of p(u, by + w)."""
    return shifted([fmpq_poly(c) for c in p], by)
