"""Where a polynomial vanishes at the solutions of a fibre: a divisor of the representation's
polynomial.

Guarantee: exact; a solution is a zero of the polynomial exactly when its root is one of the
divisor.
"""

from __future__ import annotations

from flint import fmpq_poly, fmpz_poly

from ptmcad.algebra.fibre import (
    FibreAlgebra,
    RationalPolynomial,
    UnivariateRepresentation,
    evaluate,
)

Divisor = fmpz_poly
"""In Z[T], of the representation's minimal polynomial."""


def vanishing_divisor(
    algebra: FibreAlgebra, representation: UnivariateRepresentation, p: RationalPolynomial
) -> Divisor | None:
    """The divisor whose roots are those at which p vanishes; None when there are none.

    Parameters
    ----------
    p : in the unknowns; it may have fewer than the algebra.
    """
    if evaluate(algebra, p).det() != 0:
        return None
    degree = max((sum(m) for m in p), default=0)
    minimal = fmpq_poly(representation.minimal)
    powers = [fmpq_poly([1])]
    for _ in range(degree):
        powers.append(powers[-1] * representation.slope % minimal)
    total = fmpq_poly([0])
    for monomial, c in p.items():
        term = powers[degree - sum(monomial)] * c
        for coordinate, e in zip(representation.coordinates, monomial, strict=False):
            for _ in range(e):
                term = term * coordinate % minimal
        total += term
    return fmpz_poly(total.numer()).gcd(representation.minimal)
