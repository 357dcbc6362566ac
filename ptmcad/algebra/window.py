"""Polynomials over a rectangle of the plane: a proof that one has no zero there.

Guarantee: `nowhere_zero` answers True only with proof. False means that the test did not decide, not that there is a
zero.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb

from flint import fmpq, fmpq_mat

from ptmcad.algebra.polynomials import Coefficient, coefficients_in
from ptmcad.algebra.real_roots import isolate, squarefree_part

Interval = tuple[fmpq, fmpq]


def nowhere_zero(p: Coefficient, x: Interval, y: Interval, depth: int = 4) -> bool:
    """Whether p is proved to have no zero in the open rectangle, by the signs of its Bernstein coefficients.

    If all coefficients of p in the Bernstein basis of the rectangle are >= 0 and one is positive, then p > 0 in its
    interior (Farouki, Comput. Aided Geom. Design 29, 2012). Undecided rectangles are cut in four, ``depth`` times;
    then the cuts must be free of zeros too, so strict signs are asked for. A p in one variable is decided exactly.
    """
    n, m = (int(d) for d in p.degrees())
    if n == 0 or m == 0:
        only = 0 if m == 0 else 1
        return not isolate(squarefree_part(coefficients_in(p, 1 - only)[0]), *((x, y)[only]))
    coefficients = fmpq_mat(n + 1, m + 1)
    for (i, j), c in p.terms():
        coefficients[int(i), int(j)] = c
    rows = _bernstein(n, *x)
    columns = _bernstein(m, *y)
    return _decides(rows * coefficients * columns.transpose(), n, m, depth, top=True)


@lru_cache(maxsize=64)  # a slice has few degrees, and a family's members have one window
def _bernstein(n: int, low: fmpq, high: fmpq) -> fmpq_mat:
    """The matrix from monomial to Bernstein coefficients of degree n on [low, high]."""
    # (low (1-t) + high t)^i in degree n: the blossom of x^i at k times high and n-k times low
    matrix = fmpq_mat(n + 1, n + 1)
    for k in range(n + 1):
        for i in range(n + 1):
            matrix[k, i] = sum(
                (fmpq(comb(k, a) * comb(n - k, i - a), comb(n, i)) * high**a * low ** (i - a))
                for a in range(max(0, i - n + k), min(i, k) + 1)
            )
    return matrix


def _decides(b: fmpq_mat, n: int, m: int, depth: int, top: bool) -> bool:
    entries = b.entries()
    smallest, largest = min(entries), max(entries)
    if smallest > 0 or largest < 0:
        return True
    if top and (smallest >= 0 or largest <= 0) and smallest != largest:
        return True
    if depth == 0 or (top is False and b[0, 0] * b[n, m] <= 0) or b[0, 0] * b[n, m] < 0:
        return False
    left, right = _halves(n)
    below, above = _halves(m)
    return all(
        _decides(u * b * v.transpose(), n, m, depth - 1, top=False) for u in (left, right) for v in (below, above)
    )


@lru_cache(maxsize=64)
def _halves(n: int) -> tuple[fmpq_mat, fmpq_mat]:
    """De Casteljau's subdivision at the middle, as matrices."""
    left, right = fmpq_mat(n + 1, n + 1), fmpq_mat(n + 1, n + 1)
    for i in range(n + 1):
        for j in range(i + 1):
            left[i, j] = fmpq(comb(i, j), 2**i)
            right[n - i, n - j] = fmpq(comb(i, j), 2**i)
    return left, right
