"""Determinants of matrices over Q(x, y), by fraction-free elimination or by values at integers.

Guarantee: exact. Values in one axis are taken in Z, those in two modulo primes, see `pencils`; which way is taken is
predicted from the number of terms.

References: Bareiss, Math. Comp. 22 (1968); von zur Gathen & Gerhard, Modern Computer Algebra, section 5.5 (determinants
by evaluation and interpolation).
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpz_mat, fmpz_poly

from ptmcad.algebra.polynomials import (
    PLANE,
    Coefficient,
    Ratio,
    coefficients_in,
    common_factor,
    constant_like,
    lcm,
    ratio,
)
from ptmcad.algebra.resultants import interpolate, nothing

MIN_INTERPOLATED = 12
"""Rows; of fewer the elimination is as fast."""
MIN_MODULAR = 6
"""Rows, likewise for values modulo primes."""
_MANY_TERMS = 10_000
"""Rows times terms from which on costs are predicted; with fewer the elimination takes some tens of milliseconds."""


def determinant(rows: list[list[Ratio]]) -> Ratio:
    """The determinant of a square matrix over Q(x, y): rows and columns made primitive first.

    By Bareiss's elimination, or for many rows by interpolation, which has no long quotients on the way.
    """
    zero, one = (constant_like(rows[0][0][0], value) for value in (0, 1))
    denominator = numerator = one
    matrix: list[list[Coefficient]] = []
    for row in rows:
        scale = lcm(d for _, d in row)
        matrix.append([n * (scale / d) for n, d in row])
        denominator = denominator * scale
    for j in range(len(matrix)):
        common = common_factor(line[j] for line in matrix)
        if common.is_zero():
            return zero, one
        if not common.is_one():
            numerator = numerator * common
            for line in matrix:
                line[j] = line[j] / common
    for i, line in enumerate(matrix):
        common = common_factor(line)
        if common.is_zero():
            return zero, one
        if not common.is_one():
            numerator = numerator * common
            matrix[i] = [c / common for c in line]
    return ratio(numerator * _primitive_determinant(matrix, denominator), denominator)


def _primitive_determinant(matrix: list[list[Coefficient]], denominator: Coefficient) -> Coefficient:
    """The determinant, by the way that is predicted to be the shortest.

    Parameters
    ----------
    denominator : its irreducible factors may divide the determinant to high powers.
    """
    axis = _only_axis(matrix) if len(matrix) >= MIN_INTERPOLATED else None
    if axis is not None:
        return _interpolated(matrix, axis)
    found = _modular(matrix, denominator) if len(matrix) >= MIN_MODULAR else None
    return _bareiss(matrix) if found is None else found


def _modular(matrix: list[list[Coefficient]], denominator: Coefficient) -> Coefficient | None:
    """The determinant by values modulo primes; None where the elimination is predicted to be shorter."""
    if matrix[0][0].context() is not PLANE or len(matrix) * sum(len(e) for row in matrix for e in row) < _MANY_TERMS:
        return None
    from ptmcad.algebra import pencils  # few slices need it

    pencil = pencils.Pencil(matrix)
    asked = pencils.bounds(pencil, pencils.places_of(denominator))
    if asked is None:
        return constant_like(matrix[0][0], 0)
    if pencils.seconds(pencil, asked) * _MARGIN > pencils.seconds_in_polynomials(pencil, asked):
        return None
    cofactor, factors = pencils.determinant(matrix, asked, nothing)
    for factor, exponent in factors:
        cofactor = cofactor * factor**exponent
    return cofactor


_MARGIN = 2
"""By how much the prediction has to favour values modulo primes."""


def _only_axis(matrix: Sequence[Sequence[Coefficient]]) -> int | None:
    """The number of the one axis that occurs, of two; None where another number of them does."""
    degrees = [max(d) for d in zip(*(entry.degrees() for row in matrix for entry in row), strict=True)]
    return degrees.index(max(degrees)) if len(degrees) == 2 and sum(d > 0 for d in degrees) == 1 else None


def _interpolated(matrix: Sequence[Sequence[Coefficient]], axis: int) -> Coefficient:
    """The determinant of a matrix in one axis, from its values at as many integers as its degree may ask for."""
    entries = [[_in_axis(entry, axis) for entry in row] for row in matrix]
    bounds = [[max(0, entry.degree()) for entry in row] for row in entries]
    most = min(sum(map(max, bounds)), sum(map(max, zip(*bounds, strict=True))))
    found = interpolate(lambda x: fmpz_mat([[entry(x) for entry in row] for row in entries]).det(), most)
    ring = matrix[0][0].context()
    return ring.from_dict({(k, 0) if axis == 0 else (0, k): int(c) for k, c in enumerate(found.coeffs()) if c})


def _in_axis(entry: Coefficient, axis: int) -> fmpz_poly:
    return coefficients_in(entry, 1 - axis)[0]


def _bareiss(matrix: list[list[Coefficient]]) -> Coefficient:
    size, previous, sign = len(matrix), constant_like(matrix[0][0], 1), 1
    for k in range(size - 1):
        candidates = [i for i in range(k, size) if not matrix[i][k].is_zero()]
        if not candidates:
            return constant_like(matrix[0][0], 0)
        pivot = min(candidates, key=lambda i: (len(matrix[i][k]), i))
        if pivot != k:
            matrix[k], matrix[pivot] = matrix[pivot], matrix[k]
            sign = -sign
        for i in range(k + 1, size):
            for j in range(k + 1, size):
                matrix[i][j] = (matrix[k][k] * matrix[i][j] - matrix[i][k] * matrix[k][j]) / previous
        previous = matrix[k][k]
    return matrix[-1][-1] * sign
