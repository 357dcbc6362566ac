"""Determinants of matrices over Q(x, y), by fraction-free elimination, or of one variable by values at integers.

Guarantee: exact.

References: Bareiss, Math. Comp. 22 (1968); von zur Gathen & Gerhard, Modern Computer Algebra, section 5.5 (determinants
by evaluation and interpolation).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from flint import fmpz_mat, fmpz_poly, nmod_mat

from ptmcad.algebra.assignment import least_assignment
from ptmcad.algebra.polynomials import (
    Coefficient,
    Ratio,
    coefficients_in,
    common_factor,
    constant_like,
    lcm,
    ratio,
)
from ptmcad.algebra.residues import primes

MIN_INTERPOLATED = 12
"""Rows; of fewer the elimination is as fast."""
MANY_TERMS = 15_000
"""Rows times terms, in two variables; with fewer, likewise."""


def laplace(rows: Sequence[Sequence[Any]]) -> Any:
    """The determinant of a small matrix over any commutative ring, along its first row."""
    if len(rows) == 1:
        return rows[0][0]
    total = None
    for k, entry in enumerate(rows[0]):
        term = entry * laplace([[*row[:k], *row[k + 1 :]] for row in rows[1:]])
        total = term if total is None else total - term if k % 2 else total + term
    return total


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
    return ratio(numerator * _primitive_determinant(matrix), denominator)


def _primitive_determinant(matrix: list[list[Coefficient]]) -> Coefficient:
    """The determinant, by the way that is likely to be the shorter one."""
    terms = sum(len(entry) for row in matrix for entry in row)
    degrees = [max(d) for d in zip(*(entry.degrees() for row in matrix for entry in row), strict=True)]
    if len(degrees) != 2 or len(matrix) < MIN_INTERPOLATED or (min(degrees) > 0 and len(matrix) * terms < MANY_TERMS):
        return _bareiss(matrix)
    return _interpolated(matrix)


def _interpolated(matrix: Sequence[Sequence[Coefficient]]) -> Coefficient:
    """The determinant from its values at integer points modulo primes of one word.

    Its degree in either variable is at most that of a product of entries, one of each row and column; the sum of its
    coefficients' moduli is at most the product over the rows of these sums.
    """
    zero = constant_like(matrix[0][0], 0)
    costs = [[[None if e.is_zero() else -int(e.degrees()[k]) for e in row] for row in matrix] for k in (0, 1)]
    bounds = [bound for cost in costs if (bound := least_assignment(cost)) is not None]
    if len(bounds) < len(costs):
        return zero
    across, up = (range(1 - bound) for bound in bounds)
    entries = [coefficients_in(entry, 1) for row in matrix for entry in row]
    values = []
    for x in across:
        on_line = [fmpz_poly([c(x) for c in entry]) for entry in entries]
        values += [fmpz_mat(len(matrix), len(matrix), [entry(y) for entry in on_line]) for y in up]
    most = 2 * math.prod(sum(abs(int(c)) for entry in row for c in entry.coeffs()) for row in matrix)
    modulus, found = 1, [0] * len(values)
    for prime in primes():
        if modulus > most:
            break
        dets = nmod_mat(len(across), len(up), [int(nmod_mat(v, prime).det()) for v in values], prime)
        image = _powers(across, prime).inv() * dets * _powers(up, prime).transpose().inv()
        inverse = pow(modulus, -1, prime)
        found = [a + modulus * ((int(b) - a) * inverse % prime) for a, b in zip(found, image.entries(), strict=True)]
        modulus *= prime
    balanced = (c - modulus if 2 * c > modulus else c for c in found)
    places = ((i, j) for i in across for j in up)
    return zero.context().from_dict({place: c for place, c in zip(places, balanced, strict=True) if c})


def _powers(points: range, prime: int) -> nmod_mat:
    """Vandermonde's matrix."""
    return nmod_mat(len(points), len(points), [pow(x, k, prime) for x in points for k in points], prime)


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
