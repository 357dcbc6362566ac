"""Factors that an equation has in all its terms, such as the length of the bar that an angle turns.

Guarantee: each factor is a polynomial in the axes that is proved to be positive in the open window, and an equation
over its factor has the same solutions there; principal minors of the Jacobian keep their signs.

Such a factor is often zero on an edge of the window. There the equation itself would vanish identically, its
derivatives too, and no box along the edge could be discarded.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import reduce

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.certified.plain.problem import Problem
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.question.positivity import PROVED, Need, decide
from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, Term, constant

_PLANE = fmpq_mpoly_ctx.get(("x", "y"), Ordering.lex)


def common_factors(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Expression, ...]:
    """Of each equation and the slopes of its springs' ends: a positive common factor, 1 where none is proved to be."""
    return tuple(
        common_factor([f, *(d.derivative(i) for cone in problem.cones for d in cone.difference)], axes)
        for i, f in enumerate(problem.equations)
    )


def common_factor(polynomials: Iterable[TrigonometricPolynomial], axes: tuple[Axis, Axis]) -> Expression:
    """A positive polynomial in the axes that divides all coefficients' numerators; 1 in case of doubt."""
    coefficients = [c for f in polynomials for pair in f.terms.values() for c in pair if c.numerator]
    found = reduce(lambda f, g: f.gcd(g), (_polynomial(c.numerator) for c in coefficients), _PLANE.constant(0))
    factor = Expression(_terms(found))
    if not found or factor.is_constant:
        return constant(1)
    for candidate in (factor, -factor):
        if decide(candidate, axes, Need.POSITIVE) == PROVED:
            return candidate
    return constant(1)


def over(f: TrigonometricPolynomial, factor: Expression) -> TrigonometricPolynomial:
    """The polynomial over a factor of its coefficients' numerators."""
    if factor == constant(1):
        return f
    divisor = _polynomial(factor.numerator)
    return TrigonometricPolynomial({key: (_over(a, divisor), _over(b, divisor)) for key, (a, b) in f.terms.items()})


def _over(coefficient: Expression, divisor: fmpq_mpoly) -> Expression:
    if not coefficient.numerator:
        return coefficient
    return Expression(_terms(_polynomial(coefficient.numerator) / divisor), coefficient.denominator)


def _polynomial(terms: tuple[Term, ...]) -> fmpq_mpoly:
    return _PLANE.from_dict({(i, j): fmpq(c.numerator, c.denominator) for i, j, c in terms})


def _terms(polynomial: fmpq_mpoly) -> tuple[Term, ...]:
    found = polynomial.to_dict().items()
    return tuple((int(i), int(j), Fraction(int(c.p), int(c.q))) for (i, j), c in sorted(found))
