"""Real roots of a polynomial in v that a reflection v to 2 m - v maps to itself, from those of one
of half the degree.

Guarantee: as that of `real_roots.isolate`. With w = d (v - m), the polynomial is a multiple of
q(w^2), so its roots are m +- sqrt(W)/d for the roots W >= 0 of q. Isolating intervals of these have
rational square roots beyond their ends that are nearer than the next one: between them lies one
root, and nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isqrt

from flint import fmpq, fmpz_poly

from ptmcad.algebra.real_roots import RealRoot, disjoint, isolate, sign_at

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
