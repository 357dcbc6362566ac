"""A polynomial in two variables on the lines on which one of them is a rational number.

Guarantee: exact. Hundreds of lines are asked for, so the coefficients are a matrix, and one line is
one product with the powers of its number; three to five times faster than evaluating each
coefficient, which reduces fractions.
"""

from __future__ import annotations

from flint import fmpq, fmpz_mat, fmpz_poly

from ptmcad.algebra.polynomials import UnivariatePolynomial


class Restrictions:
    """sum_j c_j(u) v^j for given u.

    Parameters
    ----------
    rows : c_j in Z[u], the last one not zero.
    """

    __slots__ = ("_matrix", "_rows")

    def __init__(self, rows: tuple[UnivariatePolynomial, ...]) -> None:
        self._rows = rows
        self._matrix: fmpz_mat | None = None

    def at(self, u: fmpq) -> UnivariatePolynomial:
        """A positive multiple of the polynomial in Z[v]."""
        if self._matrix is None:
            length = 1 + max(row.degree() for row in self._rows)
            self._matrix = fmpz_mat([[row[i] for i in range(length)] for row in self._rows])
        # u^i times the largest power of the denominator
        p, q = int(u.p), int(u.q)
        powers = [1]
        for _ in range(self._matrix.ncols() - 1):
            powers.append(powers[-1] * p)
        factor = 1
        for i in range(len(powers) - 1, -1, -1):
            powers[i] *= factor
            factor *= q
        return fmpz_poly((self._matrix * fmpz_mat(len(powers), 1, powers)).entries())
