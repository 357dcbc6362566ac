"""Determinants of matrices over Q(x, y), by fraction-free elimination or by values at integers
modulo primes; and the assignment problem, which bounds their orders and degrees.

Guarantee: exact.

References: Bareiss, Math. Comp. 22 (1968); von zur Gathen & Gerhard, Modern Computer Algebra,
section 5.5 (determinants by evaluation and interpolation); Kuhn, Naval Research Logistics Quarterly
2 (1955), and for the assignment with potentials of rows and columns Jonker & Volgenant, Computing 38
(1987).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate, count, islice, product
from typing import Any

from flint import fmpz, fmpz_mat, fmpz_poly, nmod_mat

from ptmcad.algebra.polynomials import (
    Coefficient,
    Ratio,
    coefficients_in,
    common_factor,
    constant_like,
    lcm,
    ratio,
)
from ptmcad.algebra.resultants import PRIME_BITS, primes

OVERHEAD = 5000
"""Of a value, in steps of an elimination in numbers."""
SHARE = 0.045
"""Products of terms in the elimination that is tried first, for each step in the values: at most
about their time.
"""


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

    By Bareiss's elimination, or for many rows by interpolation, which has no long quotients on the
    way.
    """
    zero, one = (constant_like(rows[0][0][0], value) for value in (0, 1))
    denominator = numerator = one
    matrix: list[list[Coefficient]] = []
    for row in rows:
        scale = lcm(d for _, d in row)
        matrix.append([n * (scale / d) for n, d in row])
        denominator = denominator * scale
    for _ in range(2):  # the columns, then the rows
        matrix = [list(line) for line in zip(*matrix, strict=True)]
        for i, line in enumerate(matrix):
            common = common_factor(line)
            if common.is_zero():
                return zero, one
            if not common.is_one():
                numerator = numerator * common
                matrix[i] = [c / common for c in line]
    return ratio(numerator * _primitive_determinant(matrix), denominator)


def _primitive_determinant(matrix: list[list[Coefficient]]) -> Coefficient:
    """The determinant, by values where an elimination turns out to be long, which the entries do
    not say beforehand.
    """
    rows = len(matrix)
    most = math.inf
    if matrix[0][0].context().nvars() == 2:
        across, up, both, size = _bounds(matrix)
        values = sum(max(0, min(up, both - i)) for i in range(across))
        most = SHARE * values * (size.bit_length() // PRIME_BITS + 1) * (OVERHEAD + rows**3)
    found = _bareiss([list(row) for row in matrix], most)
    return characteristic(matrix)[0] if found is None else found


def _bounds(
    matrix: Sequence[Sequence[Coefficient]], scales: Sequence[Coefficient] = ()
) -> tuple[int, int, int, int]:
    """What the exponents of x, of y, and their sum are below, and twice the coefficients' moduli;
    zeros for det A = 0.

    These degrees are at most those of a product of entries, one of each row and column; the sum of
    the coefficients' moduli is at most the product over the rows of these sums.
    """
    sizes = [[_moduli(entry) for entry in row] for row in matrix]
    for k, scale in enumerate(scales):
        sizes[k][k] = sizes[k][k] + _moduli(scale)
    degrees = [
        [None if p.is_zero() else (*p.degrees(), p.total_degree()) for p in row] for row in sizes
    ]
    least = [
        least_assignment([[None if d is None else -int(d[k]) for d in row] for row in degrees])
        for k in range(3)
    ]
    if None in least:
        return 0, 0, 0, 0
    across, up, both = (1 - (bound or 0) for bound in least)
    return across, up, both, 2 * math.prod(int(sum(p(1, 1) for p in row)) for row in sizes)


def characteristic(
    matrix: Sequence[Sequence[Coefficient]], scales: Sequence[Coefficient] = ()
) -> list[Coefficient]:
    """The coefficients of T^0, ..., T^(n-1) in det (T S - A) over Z[x, y]; without S det A alone.

    They come from values at integer points modulo primes of one word, as many as proved bounds ask
    for.

    Parameters
    ----------
    scales : the diagonal of S; none is zero.
    """
    ring = matrix[0][0].context()
    across, up, triangle, most = _bounds(matrix, scales)
    if not across:
        return [ring.constant(0)]
    leading = coefficients_in(math.prod(scales, start=ring.constant(1)), 1)
    xs = _integers(across, lambda x: any(c(x) for c in leading))
    products = [fmpz_poly([c(x) for c in leading]) for x in xs]
    ys = _integers(up, lambda y: all(p(y) for p in products))
    entries = [coefficients_in(p, 1) for row in matrix for p in row]
    diagonal = [coefficients_in(p, 1) for p in scales]
    values = {}
    for i, x in enumerate(xs):
        on_line, scales_on_line = (
            [fmpz_poly([c(x) for c in p]) for p in ps] for ps in (entries, diagonal)
        )
        for j, y in enumerate(ys[: triangle - i]):
            values[i, j] = _whole([p(y) for p in on_line], [int(p(y)) for p in scales_on_line])
    newton = [_newton(points) for points in (xs, ys)]
    modulus, found = 1, [dict.fromkeys(values, 0) for _ in range(max(len(scales), 1))]
    for prime in primes():
        if modulus > most:
            break
        if any(common % prime == 0 for _, common, _ in values.values()):
            continue
        bases = [(nmod_mat(a, prime).inv(), nmod_mat(b, prime)) for a, b in newton]
        images = [_modulo(prime, *value) for value in values.values()]
        inverse = pow(modulus, -1, prime)
        for coefficient, image in zip(found, zip(*images, strict=True), strict=True):
            residues = _expanded(dict(zip(values, image, strict=True)), *bases)
            for place, known in coefficient.items():
                coefficient[place] = known + modulus * (
                    (int(residues[place]) - known) * inverse % prime
                )
        modulus *= prime
    return [
        ring.from_dict(
            {place: c - modulus if 2 * c > modulus else c for place, c in coefficient.items() if c}
        )
        for coefficient in found
    ]


def _moduli(p: Coefficient) -> Coefficient:
    """The polynomial with its coefficients' moduli: in sums of such no term is lost."""
    return p.context().from_dict({powers: abs(c) for powers, c in p.terms()})


def _integers(number: int, allowed: Callable[[int], bool]) -> list[int]:
    """The first ones that are allowed."""
    return list(islice(filter(allowed, count()), number))


def _whole(matrix: Sequence[fmpz], diagonal: Sequence[int]) -> tuple[fmpz_mat, int, int]:
    """S^-1 A times a common denominator, this number, and det S."""
    size = math.isqrt(len(matrix))
    common = math.lcm(*diagonal)
    if diagonal:
        matrix = [c * (common // diagonal[k // size]) for k, c in enumerate(matrix)]
    return fmpz_mat(size, size, matrix), common, math.prod(diagonal) if diagonal else 0


def _modulo(prime: int, matrix: fmpz_mat, common: int, scale: int) -> list[int]:
    """What is looked for at a point, modulo a prime that does not divide the common denominator."""
    image = nmod_mat(matrix, prime)
    if not scale:  # there is no S
        return [int(image.det())]
    found, factor, inverse = image.charpoly(), scale, pow(common, -1, prime)
    coefficients = []
    for k in reversed(range(image.nrows())):
        factor = factor * inverse % prime
        coefficients.append(int(found[k]) * factor % prime)
    return coefficients[::-1]


def _newton(points: Sequence[int]) -> tuple[fmpz_mat, fmpz_mat]:
    """Newton's polynomials for these points, one in each column: their values at the points, and
    their coefficients.
    """
    polynomials = list(
        accumulate(points[:-1], lambda p, x: p * fmpz_poly([-x, 1]), initial=fmpz_poly([1]))
    )
    values = [[p(x) for p in polynomials] for x in points]
    return fmpz_mat(values), fmpz_mat([[p[k] for p in polynomials] for k in range(len(points))])


_Basis = tuple[nmod_mat, nmod_mat]
"""From values to coefficients in Newton's form, and from these to those of powers, modulo a prime.
"""


def _expanded(values: Mapping[tuple[int, int], int], across: _Basis, up: _Basis) -> nmod_mat:
    """The coefficients of the polynomial with exponents among the places of the values, which are a
    lower set.

    In Newton's form a coefficient depends on values at smaller places only, so that those at others
    may be anything.
    """
    rows, columns = across[0].nrows(), up[0].nrows()
    found = nmod_mat(rows, columns, across[0].modulus())
    for place, value in values.items():
        found[place] = value
    found = across[0] * found * up[0].transpose()
    for place in product(range(rows), range(columns)):
        if place not in values:
            found[place] = 0
    return across[1] * found * up[1].transpose()


def _bareiss(matrix: list[list[Coefficient]], most: float) -> Coefficient | None:
    """The determinant by fraction-free elimination in place; None where that takes more products of
    terms.
    """
    size, previous, sign, products = len(matrix), constant_like(matrix[0][0], 1), 1, 0
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
                products += len(matrix[k][k]) * len(matrix[i][j]) + len(matrix[i][k]) * len(
                    matrix[k][j]
                )
                if products > most:
                    return None
                matrix[i][j] = (
                    matrix[k][k] * matrix[i][j] - matrix[i][k] * matrix[k][j]
                ) / previous
        previous = matrix[k][k]
    return matrix[-1][-1] * sign


def least_assignment(costs: Sequence[Sequence[int | None]]) -> int | None:
    """The least sum of entries of a square matrix in different rows and columns; None stands for
    infinity. The time grows with the cube of the size.
    """
    size = len(costs)
    row_of: list[int | None] = [None] * size  # for each column
    above, beside = (
        [0] * size,
        [0] * size,
    )  # potentials: no cost is less than above[row] + beside[column]
    for start in range(size):
        distance: list[float] = [math.inf] * size
        before: list[int | None] = [None] * size
        done: list[int] = []
        waiting = set(range(size))
        row, column, reached = start, None, 0
        while True:
            for j in waiting:
                cost = costs[row][j]
                if (
                    cost is not None
                    and (found := reached + cost - above[row] - beside[j]) < distance[j]
                ):
                    distance[j], before[j] = found, column
            nearest = min(waiting, key=lambda j: distance[j], default=None)
            if nearest is None or distance[nearest] == math.inf:
                return None
            reached = int(distance[nearest])
            waiting.discard(nearest)
            column, following = nearest, row_of[nearest]
            if following is None:
                break
            done.append(nearest)
            row = following
        above[start] += reached
        for j in done:
            taken = row_of[j]
            assert taken is not None
            above[taken] += reached - int(distance[j])
            beside[j] -= reached - int(distance[j])
        while column is not None:
            origin = before[column]
            row_of[column] = start if origin is None else row_of[origin]
            column = origin
    return sum(
        cost for j, i in enumerate(row_of) if i is not None and (cost := costs[i][j]) is not None
    )
