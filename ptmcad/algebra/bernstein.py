"""Polynomials in up to three variables over boxes: exact coefficients whose signs prove that there
is no zero inside.

Guarantee: exact. With x = (low + high s) / (1 + s) for a variable between low and high, a
polynomial times a positive function is one in the s of its variables, its coefficients being those
of Bernstein up to binomials. If none is negative and one is positive, it is positive in the
interior of the box.

Reference: Farouki, Comput. Aided Geom. Design 29 (2012).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import product
from typing import Any

from flint import fmpq, fmpz_mat, fmpz_poly

from ptmcad.algebra.polynomials import Coefficient, UnivariatePolynomial, coefficients_in, integral
from ptmcad.algebra.real_roots import Interval, isolate, squarefree_part

Terms = Iterable[tuple[tuple[Any, ...], Any]]
"""Exponents of three variables, with coefficients."""


Table = tuple[fmpz_mat, ...]
"""A polynomial, not zero, in powers of its three variables: for each power of the third a matrix that
has the first one's powers as its rows, and the second one's as its columns.
"""


def _degrees(table: Table) -> tuple[int, int, int]:
    """In the three variables."""
    return table[0].nrows() - 1, table[0].ncols() - 1, len(table) - 1


def table_of(terms: Terms) -> Table:
    """The table of a polynomial that is not zero."""
    known = [(tuple(map(int, powers)), int(c)) for powers, c in terms]
    n, m, top = (max(powers[k] for powers, _ in known) for k in range(3))
    layers = tuple(fmpz_mat(n + 1, m + 1) for _ in range(top + 1))
    for (i, j, k), c in known:
        layers[k][i, j] = c
    return layers


def over(table: Table, box: Sequence[Interval]) -> Table:
    """The coefficients over a box, up to a positive factor.

    Parameters
    ----------
    box : the ranges of the three variables; of one that does not occur any will do.
    """
    matrices = [
        _substitution(degree, interval)
        for degree, interval in zip(_degrees(table), box, strict=True)
    ]
    right = matrices[1].transpose()
    sides = [matrices[0] * layer * right for layer in table]
    return tuple(_combined(matrices[2], sides))


def halves(table: Table) -> tuple[Table, Table]:
    """The coefficients over the lower and the upper half of the first variable's range, up to
    positive factors.
    """
    lower, upper = _halving(_degrees(table)[0])
    return tuple(lower * layer for layer in table), tuple(upper * layer for layer in table)


def quarters(table: Table) -> Iterator[Table]:
    """The coefficients over the quarters of the first two variables' ranges, up to positive
    factors.
    """
    n, m, _ = _degrees(table)
    for across, up in product(_halving(n), _halving(m)):
        transposed = up.transpose()
        yield tuple(across * layer * transposed for layer in table)


def sign(table: Table) -> int:
    """1 or -1 when the polynomial is proved to have this sign in the interior of the box; 0 when
    that is not decided.

    Parameters
    ----------
    table : of coefficients over the box.
    """
    n, m, _ = _degrees(table)
    found = 0
    for layer in (table[0], table[-1]):  # values at the corners, most often of different signs
        for i in (0, n):
            for j in (0, m):
                value = layer[i, j]
                if value and found * value < 0:
                    return 0
                found = found or (int(value > 0) - int(value < 0))
    for layer in table:
        for value in layer.entries():
            if value:
                if not found:
                    found = 1 if value > 0 else -1
                elif (value > 0) != (found > 0):
                    return 0
    return found


def on_lines(tables: Iterable[Table], at: tuple[fmpq, fmpq]) -> UnivariatePolynomial:
    """The product of polynomials at values of the second and third variable, up to a positive
    factor.

    Parameters
    ----------
    tables : in powers of the variables.
    """
    total = fmpz_poly([1])
    for table in tables:
        n, m, _ = _degrees(table)
        columns = [at[0] ** j for j in range(m + 1)]
        rows = [fmpq(0)] * (n + 1)
        for k, layer in enumerate(table):
            height = at[1] ** k
            for i in range(len(rows)):
                rows[i] += sum(
                    (layer[i, j] * c * height for j, c in enumerate(columns) if layer[i, j]),
                    fmpq(0),
                )
        total *= fmpz_poly(integral(rows)[0])
    return total


def _combined(matrix: fmpz_mat, layers: Sequence[fmpz_mat]) -> Iterable[fmpz_mat]:
    for k in range(len(layers)):
        yield sum(
            (layer * matrix[k, i] for i, layer in enumerate(layers) if matrix[k, i]),
            fmpz_mat(layers[0].nrows(), layers[0].ncols()),
        )


def _substitution(degree: int, interval: Interval) -> fmpz_mat:
    """From coefficients of powers to those over an interval: column i has (low + high s)^i
    (1 + s)^(degree - i).
    """
    ends, scale = integral(interval)
    line, unit = fmpz_poly(ends), fmpz_poly([scale, scale])
    return _columns([line**i * unit ** (degree - i) for i in range(degree + 1)])


@cache
def _halving(degree: int) -> tuple[fmpz_mat, fmpz_mat]:
    """For the lower half s becomes s / (2 + s), for the upper one 1 + 2 s."""
    s, two = fmpz_poly([0, 1]), fmpz_poly([2, 1])
    one_two, unit = fmpz_poly([1, 2]), fmpz_poly([1])
    lower = [s**i * two ** (degree - i) for i in range(degree + 1)]
    upper = [one_two**i * unit for i in range(degree + 1)]
    return _columns(lower), _columns(upper)


def _columns(polynomials: Sequence[fmpz_poly]) -> fmpz_mat:
    size = len(polynomials)
    found = fmpz_mat(size, size)
    for column, p in enumerate(polynomials):
        for row, c in enumerate(p.coeffs()):
            found[row, column] = c
    return found


def nowhere_zero(p: Coefficient, box: Sequence[Interval], depth: int = 4) -> bool:
    """Whether a polynomial in two or three variables is proved to have no zero in an open box, by the
    signs of its Bernstein coefficients.

    False means that the test did not decide, not that there is a zero. Undecided rectangles of the
    plane are cut in four, ``depth`` times; then the cuts must be free of zeros too, so strict signs
    are asked for. A p in one variable of two is decided exactly.
    """
    if len(box) == 3:
        return sign(over(table_of(p.terms()), box)) != 0
    n, m = (int(d) for d in p.degrees())
    if n == 0 or m == 0:
        only = 0 if m == 0 else 1
        return not isolate(squarefree_part(coefficients_in(p, 1 - only)[0]), *box[only])
    table = over(table_of(((i, j, 0), c) for (i, j), c in p.terms()), (*box, box[0]))
    return bool(sign(table)) or _is_free(table, depth)


def _is_free(table: Table, depth: int) -> bool:
    """Whether the quarters of a rectangle are proved to be free of zeros, their boundaries too."""
    corners = table[0].entries()
    if depth == 0 or corners[0] * corners[-1] <= 0:
        return False
    return all(
        (sign(part) and all(part[0].entries())) or _is_free(part, depth - 1)
        for part in quarters(table)
    )
