"""Plane curves that a reflection along the fibres maps to themselves: (u, v) to (u, 2 m(u) - v), m
linear.

Guarantee: exact. An axis that is found is one, proved by an identity of polynomials; no other line
is one. Roots are those of `real_roots.isolate`.

If p = c_n v^n + c_(n-1) v^(n-1) + ... is the same after the reflection, with n even, then so is its
set of n roots over each u, whose mean is m = -c_(n-1) / (n c_n). So there is one candidate, and it
is an axis if p(u, m + w) has only even powers of w. Four oscillators have such a curve: the frame
of one of them hides that it may be exchanged with another.

With w = d (v - m), such a polynomial over one u is a multiple of q(w^2), so its roots are
m +- sqrt(W)/d for the roots W >= 0 of q, of half the degree. Isolating intervals of these have
rational square roots beyond their ends that are nearer than the next one: between them lies one
root, and nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isqrt

from flint import fmpq, fmpq_poly, fmpz_poly

from ptmcad.algebra.polynomials import Restrictions, translated
from ptmcad.algebra.real_roots import RealRoot, disjoint, isolate, sign_at

Coefficients = Sequence[fmpz_poly]


Reflection = tuple[fmpq_poly, Restrictions]
"""A reflection along the fibres that maps a curve to itself: the axis m(u), of degree 1 at most, with
the common denominator d, and coefficients in Z[u] of powers of W = d^2 (v - m)^2, as `squared` says.
"""


def reflection_of(p: Coefficients) -> Reflection | None:
    """The reflection that maps the curve to itself; None where there is none."""
    axis = axis_of(p)
    return None if axis is None else (axis, Restrictions(tuple(squared(p, axis))))


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
    return axis if not any(_translated(p, axis)[1::2]) else None


def squared(p: Coefficients, axis: fmpq_poly) -> list[fmpz_poly]:
    """The coefficients in Z[u] of powers of W, with p(u, v) d^n = q(u, W), W = d^2 (v - m)^2.

    Parameters
    ----------
    axis : m, as `axis_of` says, with the common denominator d.
    """
    n, d = len(p) - 1, axis.denom()
    rows = _translated(p, axis)[::2]
    return [(row * d ** (n - 2 * k)).numer() for k, row in enumerate(rows)]


def _translated(p: Coefficients, by: fmpq_poly) -> list[fmpq_poly]:
    """The coefficients of p(u, by + w)."""
    return translated([fmpq_poly(c) for c in p], by)


_BITS = 16
"""Of a square root, beyond those that its interval's width asks for, at first."""


def isolate_reflected(
    p: fmpz_poly, squares: fmpz_poly, middle: fmpq, d: int, low: fmpq, high: fmpq
) -> tuple[RealRoot, ...]:
    """The roots of a squarefree polynomial in the open interval (low, high), in increasing order.

    Parameters
    ----------
    squares : q in Z[W], of which p is a multiple with W = d^2 (v - middle)^2.

    Raises
    ------
    ValueError
        When p has a multiple root in the interval.
    """
    if squares[0] == 0:  # a double root at the middle, if that is in the interval
        return isolate(p, low, high)
    reach = d * max(high - middle, middle - low)
    try:
        found = isolate(squares, fmpq(0), reach * reach)
    except ValueError:  # a multiple root within that reach, of which one image or both may be outside of the interval
        return isolate(p, low, high)
    distances = _square_roots(disjoint(found))
    above = [(middle + near / d, middle + far / d) for near, far in distances]
    below = [(middle - far / d, middle - near / d) for near, far in reversed(distances)]
    return tuple(
        root for ends in (*below, *above) if (root := _within(p, *ends, low, high)) is not None
    )


def _square_roots(roots: Sequence[RealRoot]) -> list[tuple[fmpq, fmpq]]:
    """Intervals around the positive square roots of distinct positive numbers, disjoint, and the
    roots' own only.

    The roots' intervals are pairwise disjoint, ends included.
    """
    width = min((r.high - r.low for r in roots if not r.is_rational), default=fmpq(1))
    gap = min((b.low - a.high for a, b in pairwise(roots)), default=fmpq(1))
    bits = _BITS + max(0, int((1 / min(width, gap)).ceil()).bit_length())
    while True:
        found = [(_root_below(r.low, bits), _root_above(r.high, bits)) for r in roots]
        if all(a[1] < b[0] for a, b in pairwise(found)):
            return found
        bits *= 2


def _root_below(square: fmpq, bits: int) -> fmpq:
    """The square root of a number, not negative, rounded down to so many bits behind the point;
    exact if it can be.
    """
    p, q = int(square.p), int(square.q)
    if isqrt(p) ** 2 == p and isqrt(q) ** 2 == q:
        return fmpq(isqrt(p), isqrt(q))
    return fmpq(isqrt((p << 2 * bits) // q), 1 << bits)


def _root_above(square: fmpq, bits: int) -> fmpq:
    below = _root_below(square, bits)
    return below if below * below == square else below + fmpq(1, 1 << bits)


def _within(p: fmpz_poly, left: fmpq, right: fmpq, low: fmpq, high: fmpq) -> RealRoot | None:
    """The only root of p in [left, right], if it lies in (low, high); the ends are none unless they
    are the same.
    """
    if right <= low or left >= high:
        return None
    if left == right:
        return RealRoot(p, left, right)
    if left < low:
        at_low = sign_at(p, low)
        if at_low == 0 or at_low == sign_at(p, right):
            return None
        left = low
    if right > high:
        at_high = sign_at(p, high)
        if at_high == 0 or at_high == sign_at(p, left):
            return None
        right = high
    return RealRoot(p, left, right)
