"""Polynomials over Q in the two axes, and their irreducible factors.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from math import lcm

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.plane import PlanePolynomial

# Not over Z: python-flint sorts those factors by coefficients as machine integers.
PLANE: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(("u", "v"), Ordering.lex)


def polynomial(terms: Iterable[tuple[int, int, Fraction | int]]) -> fmpq_mpoly:
    """The polynomial of some terms."""
    return PLANE.from_dict({(i, j): from_fraction(c) for i, j, c in terms})


def factored(p: fmpq_mpoly) -> list[tuple[PlanePolynomial, int]]:
    """The irreducible factors of a polynomial that is not zero, with their multiplicities."""
    return [(_primitive(factor), int(multiplicity)) for factor, multiplicity in p.factor()[1]]


def factors(p: fmpq_mpoly) -> list[PlanePolynomial]:
    """Each of them once."""
    return [factor for factor, _ in factored(p)]


def _primitive(p: fmpq_mpoly) -> PlanePolynomial:
    scale = lcm(*(int(c.q) for c in p.coeffs()))
    return PlanePolynomial.of((int(i), int(j), int((c * scale).p)) for (i, j), c in p.terms())
