"""Polynomials over Z[u, w]: coefficients of one in three variables, discriminants, resultants, and
common zeros.

Guarantee: exact. As in `resultants`, proved bounds for the degrees say from how many values results
are interpolated.

The ring Z[u, w] is that of `polynomials.PLANE`: u stands for the free parameter of a family, w for
one of its axes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import gcd

from flint import fmpq, fmpz_poly

from ptmcad.algebra import resultants
from ptmcad.algebra.polynomials import (
    PLANE,
    Coefficient,
    UnivariatePolynomial,
    coefficients_in,
    irreducible_factors,
)
from ptmcad.algebra.resultants import Check, interpolate_rows, nothing

Rows = Sequence[Coefficient]
"""A polynomial in v over Z[u, w]: its coefficients, constant first, the last one not zero."""


def rows_in(p: Coefficient, axis: int) -> tuple[Coefficient, ...]:
    """An element of Z[x, y, z] as a polynomial in one axis (0 or 1) over Z[u, w], u being z and w
    the other axis.
    """
    rows: list[dict[tuple[int, ...], int]] = [{} for _ in range(int(p.degrees()[axis]) + 1)]
    for powers, c in p.terms():
        rows[int(powers[axis])][int(powers[2]), int(powers[1 - axis])] = int(c)
    return tuple(PLANE.from_dict(row) for row in rows)


def at_value(rows: Rows, v: fmpq) -> Coefficient:
    """A positive multiple of the polynomial's value at a rational v, in Z[u, w]."""
    a, b, top = int(v.p), int(v.q), len(rows) - 1
    return sum((row * (a**i * b ** (top - i)) for i, row in enumerate(rows)), PLANE.constant(0))


def discriminant(rows: Rows, check: Check = nothing) -> Coefficient:
    """The discriminant with respect to v, for degree at least 1, up to a nonzero constant."""
    return _interpolated([rows], check)


def resultant(p: Rows, q: Rows, check: Check = nothing) -> Coefficient:
    """The resultant with respect to v, up to a nonzero constant."""
    return _interpolated([p, q], check)


def predicted_work(polynomials: Sequence[Rows]) -> int:
    """Of the discriminant of one, or the resultant of two: values, times the cube of the degree,
    times bits.
    """
    shorter, _ = _deflated(polynomials)
    _, bound = _OF[len(polynomials)]
    values = 1
    for variable in (0, 1):
        values *= max(bound(*(_degrees(rows, variable) for rows in shorter)), 0) + 1
    bits = max(_bits(row) for p in shorter for row in p)
    return values * sum(len(p) - 1 for p in shorter) ** 3 * max(bits, 1)


def common_zeros(rows: Rows, check: Check = nothing) -> list[UnivariatePolynomial]:
    """Irreducible polynomials among whose roots is the u of each common zero (u, w) of all
    coefficients.

    Parameters
    ----------
    rows : without a common factor that is not constant.
    """
    present = [row for row in rows if not row.is_zero()]
    if any(row.is_constant() for row in present):
        return []
    found = []
    for factor in irreducible_factors(min(present, key=len)):
        if factor.degrees()[1] == 0:
            found.append(coefficients_in(factor, 1)[0])
            continue
        others = [row for row in present if not (row % factor).is_zero()]
        common = UnivariatePolynomial([])
        for other in others:
            common = common.gcd(
                resultants.resultant(coefficients_in(factor, 1), coefficients_in(other, 1), check)
            )
            if common.degree() == 0:
                break
        found += [p for p, _ in common.factor()[1]] if common.degree() > 0 else []
    return found


def _bits(row: Coefficient) -> int:
    return max((int(c).bit_length() for _, c in row.terms()), default=0)


def _degrees(rows: Rows, variable: int) -> tuple[UnivariatePolynomial, ...]:
    """A power of one variable for each coefficient, that of its degree: all that bounds of degrees
    look at.
    """
    return tuple(
        UnivariatePolynomial([] if row.is_zero() else [*([0] * int(row.degrees()[variable])), 1])
        for row in rows
    )


_OF: dict[int, tuple[Callable[..., fmpz_poly], Callable[..., int]]] = {
    1: (resultants.discriminant, resultants.discriminant_degree),
    2: (resultants.resultant, resultants.resultant_degree),
}
"""What there is of one polynomial and of two, and the bound for its degree."""


def _interpolated(polynomials: Sequence[Rows], check: Check) -> Coefficient:
    """The discriminant of one, or the resultant of two, by those over Z[w] at integers u."""
    compute, bound = _OF[len(polynomials)]
    shorter, (k, m) = _deflated(polynomials)
    degree = bound(*(_degrees(rows, 0) for rows in shorter))
    in_w = [
        [coefficients_in(row, 1) for row in rows] for rows in shorter
    ]  # of powers of w, in Z[u]

    def at(u: int) -> fmpz_poly:
        values = [[fmpz_poly([c(u) for c in row]) for row in rows] for rows in in_w]
        return compute(*values, check) if all(map(any, values)) else fmpz_poly([])

    return PLANE.from_dict(
        {(i * k, j * m): c for (i, j), c in interpolate_rows(at, degree, check).items()}
    )


def _deflated(polynomials: Sequence[Rows]) -> tuple[list[Rows], tuple[int, int]]:
    """The polynomials with u and w in place of their powers, as far as only such occur."""
    exponents = [powers for rows in polynomials for row in rows for powers, _ in row.terms()]
    k, m = (max(1, gcd(*(int(powers[variable]) for powers in exponents))) for variable in (0, 1))
    return [
        tuple(
            PLANE.from_dict({(int(i) // k, int(j) // m): c for (i, j), c in row.terms()})
            for row in rows
        )
        for rows in polynomials
    ], (k, m)
