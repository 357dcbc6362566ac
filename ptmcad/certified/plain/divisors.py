"""Common divisors of polynomials in the two axes, as `expressions` has them.

Guarantee: exact, in Q[x, y]. They are FLINT's, whose types stay in here: the certified engine uses
nothing of `algebra`, which has more of them.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx
from flint.utils.flint_exceptions import DomainError

from ptmcad.text.expressions import Expression, Term
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


def lowest_terms(value: Expression) -> Expression:
    """The same function, whose numerator and denominator have no common divisor."""
    divisor = common_divisor([value.numerator, value.denominator])
    above, below = (
        Expression(quotient(terms, divisor)) for terms in (value.numerator, value.denominator)
    )
    return above / below


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
