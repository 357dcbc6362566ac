"""Factors that an equation has in all its terms, such as the length of the bar that an angle turns.

Guarantee: each factor is a polynomial in the axes that is proved to be positive in the open window,
and an equation over its factor has the same solutions there; principal minors of the Jacobian keep
their signs.

Such a factor is often zero on an edge of the window. There the equation itself would vanish
identically, its derivatives too, and no box along the edge could be discarded.
"""

from __future__ import annotations

from collections.abc import Iterable

from ptmcad.certified.plain.divisors import common_divisor, quotient
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.question.positivity import Need, decide
from ptmcad.question.signs import PROVED
from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, constant


def common_factor(
    polynomials: Iterable[TrigonometricPolynomial], axes: tuple[Axis, Axis]
) -> Expression:
    """A positive polynomial in the axes that divides all coefficients' numerators; 1 in case of
    doubt.
    """
    factor = largest_factor(polynomials)
    return factor if factor.is_constant else absolute(factor, axes) or constant(1)


def absolute(polynomial: Expression, axes: tuple[Axis, Axis]) -> Expression | None:
    """The absolute value of a polynomial that is proved to be zero nowhere in the open window; None
    without a proof.
    """
    x, y = ((axis.low + axis.high) / 2 for axis in axes)
    found = polynomial if polynomial.evaluate(x, y) > 0 else -polynomial
    return found if decide(found, axes, Need.POSITIVE) is PROVED else None


def largest_factor(polynomials: Iterable[TrigonometricPolynomial]) -> Expression:
    """The greatest common divisor of all coefficients' numerators, of any sign; 1 where it is a
    constant.
    """
    coefficients = [
        c for f in polynomials for pair in f.terms.values() for c in pair if c.numerator
    ]
    factor = Expression(common_divisor(c.numerator for c in coefficients))
    return constant(1) if not factor.numerator or factor.is_constant else factor


def divided(
    f: TrigonometricPolynomial, factor: Expression
) -> tuple[TrigonometricPolynomial, TrigonometricPolynomial]:
    """Polynomials g and h of which f is factor g + h; h is zero where the factor divides all
    numerators.
    """
    if factor == constant(1):
        return f, TrigonometricPolynomial({})
    pairs = {key: (_whole(a, factor), _whole(b, factor)) for key, (a, b) in f.terms.items()}
    found = TrigonometricPolynomial(
        {key: (a, b) for key, (a, b) in pairs.items() if a.numerator or b.numerator}
    )
    return found, f - found.scaled(factor)


def over(f: TrigonometricPolynomial, factor: Expression) -> TrigonometricPolynomial:
    """The polynomial over a factor of its coefficients' numerators."""
    found, rest = divided(f, factor)
    assert not rest.terms
    return found


def _whole(coefficient: Expression, factor: Expression) -> Expression:
    return Expression(quotient(coefficient.numerator, factor.numerator), coefficient.denominator)
