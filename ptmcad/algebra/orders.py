"""Orders of discriminants and resultants at a place of Q(u), from the orders of the coefficients: Newton's polygons.

Guarantee: proved bounds, of the degree in u (the order at infinity is its negative) from above, of the multiplicity
of an irreducible factor from below.

Let o be the order at a place, with o(0) infinite. It extends to the roots of p = sum_i c_i v^i over an algebraic
closure, and the slopes of the lower convex hull of the points (i, o(c_i)) are the orders of the roots, with a change
of sign. Now disc p = c_n^(2n-2) prod_{i<j} (r_i - r_j)^2 and res(p, q) = c_n^m d_m^n prod (r_i - s_j), and o(r - s)
is at least the smaller one of o(r) and o(s). The bound is sharp where roots of the same order have different leading
terms.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise

from flint import fmpz_poly

Coefficients = Sequence[fmpz_poly]
Factors = tuple[tuple[fmpz_poly, int], ...]
"""Irreducible polynomials in Z[u] with exponents."""
_SHIFTS = (0, -1, 1)


def discriminant_degree(p: Coefficients) -> int:
    """A bound for the degree of the formal discriminant with respect to v; negative where that is zero."""
    order = _of_discriminant(_degrees(p), len(p) - 1)
    return -1 if order is None else -order


def resultant_degree(p: Coefficients, q: Coefficients) -> int:
    """A bound for the degree of the formal resultant with respect to v; negative where that is zero."""
    left, right = _degrees(p), _degrees(q)
    if not left or not right:
        return -1
    n, m = max(left), max(right)
    first, second = _roots(left), _roots(right)
    far, further = len(p) - 1 - n, len(q) - 1 - m
    if (far and further) or (len(first) < n and len(second) < m):
        return -1  # both have the root infinity, or both 0
    # the n - len(first) roots 0 are of infinite order, and the smaller order is the other root's
    total = (m + further) * left[n] + (n + far) * right[m] + sum(second) * (n - len(first))
    total += sum(first) * (m - len(second)) + sum((min(r, s) for r in first for s in second), Fraction(0))
    return -math.ceil(total)


def discriminant_factors(p: Coefficients) -> Factors:
    """Powers of irreducible polynomials that divide the discriminant, as far as they are seen easily.

    The places are those at which several roots come close to infinity, or to 0, 1 or -1: the discriminant is the same
    for v + s in place of v.
    """
    found: dict[tuple[int, ...], tuple[fmpz_poly, int]] = {}
    for s in _SHIFTS:
        shifted = _shifted(p, s)
        for end in (shifted[0], shifted[-1]):
            for factor, multiplicity in end.factor()[1] if end else ():
                if multiplicity > 1:
                    places = {i: _multiplicity(c, factor) for i, c in enumerate(shifted) if c}
                    order = _of_discriminant(places, len(p) - 1) or 0
                    key = tuple(int(c) for c in factor.coeffs())
                    if order > found.get(key, (factor, 0))[1]:
                        found[key] = (factor, order)
    return tuple(found.values())


def _degrees(p: Coefficients) -> dict[int, int]:
    """The orders at infinity of the coefficients that are not zero."""
    return {i: -int(c.degree()) for i, c in enumerate(p) if c}


def _of_discriminant(orders: Mapping[int, int], degree: int) -> int | None:
    """A bound from below for the formal discriminant's order; None where 0 or infinity is a multiple root."""
    n = max(orders, default=0)
    if not orders or min(orders) > 1 or degree - n > 1:
        return None
    # of formal degree n + 1 it is c_n^2 times that of degree n
    total = Fraction((2 * n - 2 + 2 * (degree - n)) * orders[n])
    return math.ceil(total + 2 * sum(r * (n - 1 - i) for i, r in enumerate(sorted(_roots(orders)))))


def _roots(orders: Mapping[int, int]) -> list[Fraction]:
    """The orders of the roots that are not 0."""
    hull: list[tuple[int, int]] = []
    for point in sorted(orders.items()):
        while len(hull) > 1 and _slope(hull[-1], point) <= _slope(hull[-2], hull[-1]):
            hull.pop()
        hull.append(point)
    return [-_slope(a, b) for a, b in pairwise(hull) for _ in range(b[0] - a[0])]


def _slope(left: tuple[int, int], right: tuple[int, int]) -> Fraction:
    return Fraction(right[1] - left[1], right[0] - left[0])


def _multiplicity(p: fmpz_poly, factor: fmpz_poly) -> int:
    found = 0
    while not (division := divmod(p, factor))[1]:
        p, found = division[0], found + 1
    return found


def _shifted(p: Coefficients, s: int) -> Coefficients:
    """p(u, v + s)."""
    row = list(p)
    for i in range(len(row) - 1 if s else 0):
        for j in range(len(row) - 2, i - 1, -1):
            row[j] = row[j] + s * row[j + 1]
    return row


def values(factors: Factors, points: Iterable[int]) -> list[int]:
    """Of the product of the powers, at integers."""
    return [math.prod(int(f(u)) ** e for f, e in factors) for u in points]


def degree(factors: Factors) -> int:
    """Of the product of the powers."""
    return sum(int(f.degree()) * e for f, e in factors)
