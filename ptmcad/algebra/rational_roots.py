"""Rational roots of a monic polynomial over a number field.

Guarantee: all of them are found, each with its multiplicity, by exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TypeVar

from flint import fmpq, fmpq_poly, nmod_poly

from ptmcad.algebra.number_field import FieldElement

_Polynomial = TypeVar("_Polynomial", fmpq_poly, nmod_poly)


def rational_roots(lower: Sequence[FieldElement]) -> Iterator[tuple[Fraction, int]]:
    """The rational roots of a polynomial with leading coefficient 1, with multiplicities.

    With coefficients in powers of the field's generator, a rational root is one of each power's
    polynomial, so of their greatest common divisor. Where that is constant modulo a prime it is so
    over Q; most often this settles the matter.

    Parameters
    ----------
    lower : the other coefficients, from the constant one on.
    """
    images = [total.image_coefficients() for total in lower]
    known = [image for image in images if image is not None]
    if len(known) == len(images) and known:
        p = known[0][0].modulus()
        columns = [
            nmod_poly([int(image[j]) for image in known] + [int(j == 0)], p)
            for j in range(len(known[0]))
        ]
        if _common(columns).degree() < 1:
            return
    rows = [total.coefficients() for total in lower]
    exact = (
        [fmpq_poly([row[j] for row in rows] + [fmpq(int(j == 0))]) for j in range(len(rows[0]))]
        if rows
        else []
    )
    for factor, multiplicity in _common(exact).numer().factor()[1] if exact else []:
        if factor.degree() == 1:
            yield Fraction(-int(factor[0]), int(factor[1])), multiplicity


def _common(polynomials: Sequence[_Polynomial]) -> _Polynomial:
    total = polynomials[0]
    for p in polynomials[1:]:
        total = total.gcd(p)
    return total
