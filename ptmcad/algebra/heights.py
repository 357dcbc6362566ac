"""Bounds for the coefficients of a discriminant in Z[u] from its size on the circle |u| = 1, by matrices in doubles.

Guarantee: rigorous, whatever doubles do. Where D has at most the degree N - 1, its coefficients are means of D(w)
w^(-k) over the N-th roots of unity w, so that none is larger than the largest |D(w)|. There n^(n-2) D is up to sign
the determinant of Bezout's matrix B of n p - v p' and p'. For any triangular X, |det B| is by Hadamard's inequality
at most the product of the lengths of the columns of B X over that of X's diagonal. X is the inverse of a factor of B,
found in doubles, and how well it was found decides only how close the bound is. What is lost to rounding in B and in
B X is bounded by the sums of absolute values that go into each entry, and added to the columns' lengths.

Hadamard's inequality for Sylvester's matrix, without X, is off by a sixth to two thirds of all bits.

References: Higham, Accuracy and Stability of Numerical Algorithms, chapter 3; Rump, Acta Numerica 19 (2010).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from flint import fmpz_poly

Stack = np.ndarray
"""Of shape (points, rows, columns)."""
_MAX_SPREAD = 200
"""Bits between the largest and the smallest coefficients, beyond which doubles might underflow."""
_POINTS_AT_ONCE = 256


def discriminant_bits(p: Sequence[fmpz_poly], degree: int, unit: int) -> int | None:
    """A number b with 2^b larger than every coefficient of p's discriminant with respect to v; None where none is
    found.

    Parameters
    ----------
    p : coefficients of v^0, v^1, ..., of degree n >= 2 in v.
    degree : a bound for the discriminant's degree in u.
    unit : 2^unit v is taken in place of v; any integer will do, a good one makes the coefficients similar in size.
    """
    n = len(p) - 1
    top = max(int(c.height_bits()) + unit * i for i, c in enumerate(p) if c)
    rows = [[_scaled(int(a), unit * i - top) for a in c.coeffs()] for i, c in enumerate(p)]
    sizes = [math.log2(sum(map(abs, row))) for row in rows if any(row)]
    if max(sizes) - min(sizes) > _MAX_SPREAD or any(a and abs(a) < 2.0**-500 for row in rows for a in row):
        return None
    coefficients = np.zeros((n + 1, max(map(len, rows))))
    for i, row in enumerate(rows):
        coefficients[i, : len(row)] = row
    weights = np.arange(n + 1)[:, None]
    pair = ((n - weights) * coefficients)[:-1], (weights * coefficients)[1:]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # then the bound is not finite
        found = _log_determinant(*pair, max(degree, 0) + 1)
    if not math.isfinite(found):
        return None
    # the discriminant of p(u, t v) is t^(n (n - 1)) times that of p, and of degree 2 n - 2 in the coefficients
    exponent = (2 * n - 2) * top - unit * n * (n - 1)
    return max(math.ceil(found + 1 - (n - 2) * math.log2(n)) + exponent, 0)


def _scaled(a: int, exponent: int) -> float:
    """a 2^exponent, rounded."""
    drop = max(abs(a).bit_length() - 64, 0)
    return math.ldexp(float(a >> drop), exponent + drop)


def _log_determinant(a: Stack, b: Stack, points: int) -> float:
    """The largest log2 |det B| at the roots of unity, rounded up; a and b are of shape (powers of v, powers of u)."""
    k, length = a.shape
    # twice what is lost to powers (20 units in the last place), sums of `length` products, of k, and of k once more
    rounding = 2.0**-52 * (4 * length + 8 * k + 64)
    sums = _bezout(np.abs(a).sum(1)[None], np.abs(b).sum(1)[None], 1.0)[0]
    scale = np.exp2(-np.floor(np.log2(np.maximum(sums.max(1), 2.0**-400)) / 2))
    sums = sums * scale[:, None] * scale[None, :]
    peaks = []
    half = points // 2 + 1  # at conjugate points the values are conjugate
    for start in range(0, half, _POINTS_AT_ONCE):
        j = np.arange(start, min(start + _POINTS_AT_ONCE, half))
        turns = np.outer(j, np.arange(length)) % points
        powers = np.exp(2j * np.pi * turns / points)
        matrix = _bezout(powers @ a.T, powers @ b.T, -1.0) * scale[:, None] * scale[None, :]
        peaks.append(_bound(matrix, sums * rounding).max())
    return float(np.max(peaks) - 2 * np.log2(scale).sum())  # NaN where one of them is


def _bezout(a: Stack, b: Stack, sign: float) -> Stack:
    """Bezout's matrices from coefficients of shape (points, k), one of each sum's products taken with this sign."""
    k = a.shape[1] - 1
    rows = []
    row = np.zeros((len(a), k), a.dtype)
    for i in range(k):
        row = np.concatenate([row[:, 1:], np.zeros((len(a), 1), a.dtype)], 1)
        row = row + b[:, i : i + 1] * a[:, 1:] + sign * a[:, i : i + 1] * b[:, 1:]
        rows.append(row)
    return np.stack(rows, 1)


def _bound(matrix: Stack, error: Stack) -> Stack:
    """Bounds for log2 of the determinants' absolute values, for entries known up to ``error``."""
    factor = np.linalg.qr(matrix, mode="r")
    diagonal = np.einsum("pii->pi", factor)
    diagonal[np.abs(diagonal) < 2.0**-100] = 2.0**-100
    inverse = np.triu(np.linalg.inv(factor))
    lengths = np.linalg.norm(matrix @ inverse, axis=1) + np.linalg.norm(error @ np.abs(inverse), axis=1)
    lengths = np.maximum(lengths, 2.0**-1000)
    bounds: Stack = np.log2(lengths).sum(1) - np.log2(np.abs(np.einsum("pii->pi", inverse))).sum(1)
    return bounds
