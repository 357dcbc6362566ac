"""Determinants of matrices over Z[x, y], and characteristic polynomials, by values at points of a grid modulo primes.

Guarantee: exact. With the diagonal matrix S (zero for a determinant) P = det (T S - A) is found from as many points and
primes as proved bounds ask for, see `grid`:

- *Exponents.* The degree a i + b j of x^i y^j, for some a, b >= 0, is that of a product of entries, one of each row and
  column, at most: an assignment problem. In the same way a product has an order along a curve at least, so that the
  curve's polynomial to that power is a known factor, and the cofactor's degrees are smaller.
- *Length.* Let M be Mahler's measure, exp of the mean of log |P| over the torus |x| = |y| = |T| = 1. By Hadamard's
  inequality |P| is at most the product of the rows' lengths; the mean of log of a length is at most half the log of the
  mean of its square (Jensen), which is the sum of the squares of the row's coefficients (Parseval). M is
  multiplicative and at least 1 for integer polynomials, so it is bounded for the cofactor, too. At last a
  coefficient of x^i y^j T^k is at most C(m, i) C(n, j) C(d, k) M for degrees m, n, d; or m! / (i! j! (m - i - j)!) C(d,
  k) M for total degree m in x and y (Mahler).

References: Mahler, J. London Math. Soc. 37 (1962); Goldstein & Graham, SIAM Review 16 (1974); Emiris & Pan, J.
Complexity 21 (2005), on determinants by values.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from flint import fmpz_mat, fmpz_poly, nmod_mat

from ptmcad.algebra.assignment import least_assignment
from ptmcad.algebra.grid import Asked, Check, Factors, Limit, Support, cofactors, support_of
from ptmcad.algebra.polynomials import PLANE, Coefficient, coefficients_in, irreducible_factors, multiplicity

Matrix = Sequence[Sequence[Coefficient]]
_DIRECTIONS = ((1, 0), (0, 1), (1, 1), (1, 2), (2, 1))
"""In which degrees are bounded, the first two and the third by name."""


class Pencil(NamedTuple):
    """T S - A, or -A.

    Attributes
    ----------
    matrix : A, square, over Z[x, y].
    scales : the diagonal of S; empty for a determinant.
    """

    matrix: Matrix
    scales: Sequence[Coefficient] = ()

    def entries(self, i: int, j: int) -> tuple[Coefficient, ...]:
        """The coefficients of the powers of T in an entry, those that are zero left out."""
        present = (self.matrix[i][j], *((self.scales[i],) if self.scales and i == j else ()))
        return tuple(p for p in present if not p.is_zero())


def determinant(matrix: Matrix, asked: Asked, check: Check) -> tuple[Coefficient, Factors]:
    """The determinant as a cofactor and powers of known polynomials; ``asked`` is what `bounds` proves of it."""
    pencil = Pencil(matrix)
    (found,) = cofactors(_values(pencil), asked, check)
    return found, asked.factors


def characteristic(
    matrix: Matrix, scales: Sequence[Coefficient], places: Sequence[Coefficient], check: Check
) -> tuple[list[Coefficient], Factors]:
    """The coefficients of T^0, ..., T^(d-1) in det (T S - A), d being the size, as cofactors of known powers.

    That of T^d is the product of the scales.
    """
    asked = bounds(Pencil(matrix, scales), places)
    assert asked is not None  # the product of the scales is not zero
    return cofactors(_values(Pencil(matrix, scales)), asked, check), asked.factors


def bounds(pencil: Pencil, places: Sequence[Coefficient]) -> Asked | None:
    """What is proved of the determinant of a pencil, or of its coefficients; None where it is certainly zero.

    Parameters
    ----------
    places : irreducible polynomials along which an order is looked for.
    """
    size = range(len(pencil.matrix))
    costs = [[_least(map(_degrees, pencil.entries(i, j))) for j in size] for i in size]
    most = [least_assignment([[None if c is None else c[n] for c in row] for row in costs]) for n in range(5)]
    if any(m is None for m in most):
        return None
    factors = []
    for place in places:
        orders = [[_least((multiplicity(p, place),) for p in pencil.entries(i, j)) for j in size] for i in size]
        order = least_assignment([[None if c is None else c[0] for c in row] for row in orders])
        if order:
            factors.append((place, order))
    taken = [sum(e * _degrees(f)[n] for f, e in factors) for n in range(5)]
    limits = _limits([(m or 0) - t for m, t in zip(most, taken, strict=True)])
    if any(limit[2] < 0 for limit in limits):
        return None
    support = support_of(limits)
    measure = _measure(pencil) - sum(e * _least_measure(f) for f, e in factors)
    d = len(pencil.scales)
    bits = measure + _spread(support, limits[2][2]) + math.log2(math.comb(d, d // 2))
    # a bit to spare for the rounding of doubles
    asked = Asked(d or 1, support, max(math.ceil(bits + 1), 1), tuple(factors), tuple(pencil.scales))
    return asked


def places_of(denominator: Coefficient) -> list[Coefficient]:
    """Where a high order is likely: along the curves on which the basis degenerates, and the axes."""
    found = irreducible_factors(denominator)
    return found + [axis for axis in PLANE.gens() if axis not in found]


def seconds(pencil: Pencil, asked: Asked) -> float:
    """What the values are predicted to take."""
    size = len(pencil.matrix)
    return asked.points * (asked.primes * (size**3 * 1e-9 + 4e-6) + size**2 * 7.5e-7)


def seconds_in_polynomials(pencil: Pencil, asked: Asked) -> float:
    """What Bareiss's elimination is predicted to take.

    The minors on the way have their share of the result's exponents, as far as these occur, which the entries tell;
    a step is two products of such polynomials and one quotient.
    """
    size = len(pencil.matrix)
    entries = [p for row in pencil.matrix for p in row if p]
    room = sum(sum(support_of(_limits(_degrees(p)))) for p in entries)
    filled = sum(map(len, entries)) / room
    terms = (asked.points * filled * (k / size) ** 2 for k in range(1, size))
    return 2.4e-8 * sum((size - k) ** 2 * t**2 for k, t in enumerate(terms, 1))


def _degrees(p: Coefficient) -> tuple[int, ...]:
    """Of a polynomial that is not zero the degrees in all directions, negative."""
    powers = p.monoms()
    return tuple(-max(a * int(i) + b * int(j) for i, j in powers) for a, b in _DIRECTIONS)


def _limits(most: Sequence[int]) -> list[Limit]:
    """From negative degrees in all directions."""
    return [(a, b, -m) for (a, b), m in zip(_DIRECTIONS, most, strict=True)]


def _least(numbers: Iterable[tuple[int, ...]]) -> tuple[int, ...] | None:
    """The least of each of some numbers over the parts of an entry; None where it has none."""
    found = tuple(map(min, zip(*numbers, strict=True)))
    return found or None


def _measure(pencil: Pencil) -> float:
    """log2 of a bound for Mahler's measure, by rows or by columns."""
    size = range(len(pencil.matrix))
    squares = [[sum(int(c) ** 2 for p in pencil.entries(i, j) for c in p.coeffs()) for j in size] for i in size]
    return min(sum(math.log2(max(sum(row), 1)) for row in lines) / 2 for lines in (squares, zip(*squares, strict=True)))


def _least_measure(p: Coefficient) -> float:
    """log2 of a number below Mahler's measure: the coefficient of a vertex of the Newton polygon."""
    terms = {(int(i), int(j)): abs(int(c)) for (i, j), c in p.terms()}
    corners = (max(terms, key=lambda m: (s * m[a], t * m[1 - a])) for a in (0, 1) for s in (1, -1) for t in (1, -1))
    return math.log2(max(terms[m] for m in corners))


def _spread(support: Support, total: int) -> float:
    """log2 of the largest ratio of a coefficient to Mahler's measure."""
    logs = [math.lgamma(k + 1) / math.log(2) for k in range(total + len(support) + support[0] + 1)]
    m, n = len(support) - 1, support[0] - 1

    def ratio(i: int, j: int) -> float:
        alone = logs[m] - logs[i] - logs[m - i] + logs[n] - logs[j] - logs[n - j]
        return min(alone, logs[total] - logs[i] - logs[j] - logs[total - i - j])

    return max(ratio(i, j) for i, height in enumerate(support) for j in range(height))


def _values(pencil: Pencil) -> Callable[[int], Callable[[int], Callable[[int], Sequence[int]]]]:
    """The values at (x, y) modulo a prime: of the determinant, or of the characteristic polynomial's coefficients."""
    size = len(pencil.matrix)
    entries = [coefficients_in(p, 1) for row in pencil.matrix for p in row]
    scales = [coefficients_in(p, 1) for p in pencil.scales]

    def at(x: int) -> Callable[[int], Callable[[int], Sequence[int]]]:
        on_line = [fmpz_poly([c(x) for c in p]) for p in entries]
        scales_on_line = [fmpz_poly([c(x) for c in p]) for p in scales]

        def at_height(y: int) -> Callable[[int], Sequence[int]]:
            matrix = fmpz_mat(size, size, [p(y) for p in on_line])
            diagonal = [int(p(y)) for p in scales_on_line]

            def value(prime: int) -> Sequence[int]:
                if not diagonal:
                    return (int(nmod_mat(matrix, prime).det()),)
                return _scaled(matrix, diagonal, prime)

            return value

        return at_height

    return at


def _scaled(matrix: fmpz_mat, diagonal: Sequence[int], prime: int) -> Sequence[int]:
    """det (T S - A) without its leading term, modulo a prime that divides no entry of S."""
    size = len(diagonal)
    inverses = nmod_mat(size, size, prime)
    product = 1
    for i, s in enumerate(diagonal):
        product = product * s % prime
        inverses[i, i] = pow(s, -1, prime)
    found = (inverses * nmod_mat(matrix, prime)).charpoly()
    return [int(found[k]) * product % prime for k in range(size)]
