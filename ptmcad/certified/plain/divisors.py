"""Common divisors of polynomials in the two axes, and the factors that an equation has in all its
terms, such as the length of the bar that an angle turns.

Guarantee: exact, in Q[x, y]. A factor is a polynomial in the axes that is proved to be positive in
the open window, and an equation over its factor has the same solutions there; principal minors of
the Jacobian keep their signs. The divisors are FLINT's, whose types stay in here: the certified
engine uses nothing of `algebra`, which has more of them.

Such a factor is often zero on an edge of the window. There the equation itself would vanish
identically, its derivatives too, and no box along the edge could be discarded.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx
from flint.utils.flint_exceptions import DomainError

from ptmcad.certified.plain.harmonics import TrigonometricPolynomial
from ptmcad.question.positivity import Need, decide
from ptmcad.question.slice import PROVED, Axis
from ptmcad.text.expressions import Expression, Term, constant
from ptmcad.text.flint_numbers import from_fraction, to_fraction

_PLANE = fmpq_mpoly_ctx.get(("x", "y"), Ordering.lex)


def common_divisor(polynomials: Iterable[tuple[Term, ...]]) -> tuple[Term, ...]:
    """The greatest one, unique but for a constant; none, the zero polynomial, of polynomials that
    are all zero.
    """
    return _terms(reduce(lambda f, g: f.gcd(g), map(_polynomial, polynomials), _PLANE.constant(0)))


def quotient(polynomial: tuple[Term, ...], divisor: tuple[Term, ...]) -> tuple[Term, ...]:
    """By any polynomial but zero, without the remainder."""
    return _terms(_polynomial(polynomial) // _polynomial(divisor))


def square_root(polynomial: tuple[Term, ...]) -> tuple[Term, ...] | None:
    """A polynomial with this square, either one of both; None where there is none."""
    try:
        return _terms(_polynomial(polynomial).sqrt())
    except DomainError:
        return None


def _polynomial(terms: tuple[Term, ...]) -> fmpq_mpoly:
    return _PLANE.from_dict({(i, j): from_fraction(c) for i, j, c in terms})


def _terms(polynomial: fmpq_mpoly) -> tuple[Term, ...]:
    found = polynomial.to_dict().items()
    return tuple((int(i), int(j), to_fraction(c)) for (i, j), c in sorted(found))


def common_factor(
    polynomials: Iterable[TrigonometricPolynomial], axes: tuple[Axis, Axis]
) -> Expression:
    """A positive polynomial in the axes that divides all coefficients' numerators; 1 in case of
    doubt.
    """
    factor = largest_factor(polynomials)
    return factor if factor.is_constant else absolute(factor, axes) or constant(1)


def positive_inside(polynomial: Expression, axes: tuple[Axis, Axis]) -> Expression:
    """A polynomial, or its negative, that is positive in the middle of the window."""
    x, y = ((axis.low + axis.high) / 2 for axis in axes)
    return polynomial if polynomial.evaluate(x, y) > 0 else -polynomial


def absolute(polynomial: Expression, axes: tuple[Axis, Axis]) -> Expression | None:
    """The absolute value of a polynomial that is proved to be zero nowhere in the open window; None
    without a proof.
    """
    found = positive_inside(polynomial, axes)
    return found if decide(found, axes, Need.POSITIVE) == PROVED else None


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
