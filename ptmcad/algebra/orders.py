"""Degrees of discriminants and resultants in u, from those of the coefficients: Newton's polygons.

Guarantee: proved bounds from above. The degree is the negative of the order at infinity.

Let o be the order at a place, with o(0) infinite. It extends to the roots of p = sum_i c_i v^i over
an algebraic closure, and the slopes of the lower convex hull of the points (i, o(c_i)) are the
orders of the roots, with a change of sign. Now disc p = c_n^(2n-2) prod_{i<j} (r_i - r_j)^2 and
res(p, q) = c_n^m d_m^n prod (r_i - s_j), and o(r - s) is at least the smaller one of o(r) and o(s).
The bound is sharp where roots of the same order have different leading terms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise

from flint import fmpz_poly

Coefficients = Sequence[fmpz_poly]


def discriminant_degree(p: Coefficients) -> int:
    """A bound for the degree of the formal discriminant with respect to v; negative where that is
    zero.
    """
    order = _of_discriminant(_degrees(p), len(p) - 1)
    return -1 if order is None else -order


def resultant_degree(p: Coefficients, q: Coefficients) -> int:
    """A bound for the degree of the formal resultant with respect to v; negative where that is
    zero.
    """
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
    total += sum(first) * (m - len(second)) + sum(
        (min(r, s) for r in first for s in second), Fraction(0)
    )
    return -math.ceil(total)


def _degrees(p: Coefficients) -> dict[int, int]:
    """The orders at infinity of the coefficients that are not zero."""
    return {i: -int(c.degree()) for i, c in enumerate(p) if c}


def _of_discriminant(orders: Mapping[int, int], degree: int) -> int | None:
    """A bound from below for the formal discriminant's order; None where 0 or infinity is a
    multiple root.
    """
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
