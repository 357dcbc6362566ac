"""Rational functions in the two axes of a slice.

Guarantee: every coefficient is exact; nothing is rounded.

>>> rho, force = axis(0), axis(1)
>>> str(2 * rho * force / rho)
'2*y'
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import gcd, lcm

from ptmcad.errors import ExpressionError, PoleError
from ptmcad.text.numerals import text_of
from ptmcad.text.plane import plane_text

Term = tuple[int, int, Fraction]
Terms = tuple[Term, ...]
_Polynomial = dict[tuple[int, int], Fraction]

ONE: Terms = ((0, 0, Fraction(1)),)


@dataclass(frozen=True, slots=True)
class Expression:
    """A rational function numerator/denominator in Q(x, y), x and y being the two axes in their
    order.

    Guarantee: terms are sorted by exponents, without zero coefficients; the denominator is not
    zero; common monomials are cancelled; a denominator that divides the numerator is gone; a
    constant denominator is 1 and any other is a primitive integer polynomial with positive last
    coefficient.

    Not guaranteed: that every common factor is cancelled. Two equal functions whose denominators
    share no more than a part with their numerators may compare unequal.

    Attributes
    ----------
    numerator, denominator : terms ``(i, j, c)``, meaning c x^i y^j; an empty numerator is zero.
    """

    numerator: Terms
    denominator: Terms = ONE

    @property
    def is_constant(self) -> bool:
        """Whether neither axis occurs."""
        return self.denominator == ONE and all(i == j == 0 for i, j, _ in self.numerator)

    @property
    def is_polynomial(self) -> bool:
        """Whether the denominator is 1."""
        return self.denominator == ONE

    @property
    def degree(self) -> int:
        """The larger of the total degrees of numerator and denominator."""
        return max(i + j for i, j, _ in self.numerator + self.denominator)

    def constant(self) -> Fraction:
        """The value of a constant expression.

        Raises
        ------
        ExpressionError
            If an axis occurs in it.
        """
        if not self.is_constant:
            raise ExpressionError(f"{self} is not a constant")
        return self.numerator[0][2] if self.numerator else Fraction(0)

    def uses(self, axis_index: int) -> bool:
        """Whether axis 0 or 1 occurs."""
        return any(term[axis_index] for term in self.numerator + self.denominator)

    def evaluate(self, x: Fraction, y: Fraction) -> Fraction:
        """The exact value at the point (x, y).

        Raises
        ------
        PoleError
            If the denominator vanishes there.
        """
        denominator = polynomial_value(self.denominator, x, y)
        if denominator == 0:
            raise PoleError(
                f"division by zero: the denominator of {self} vanishes at x = {text_of(x)}, y = {text_of(y)}"
            )
        value = polynomial_value(self.numerator, x, y)
        return value if denominator == 1 else value / denominator

    def to_text(self, names: tuple[str, str] = ("x", "y")) -> str:
        """The expression as text that `ptmcad.text.parsing.parse` reads back."""
        if self.is_polynomial:
            return plane_text(self.numerator, names)
        # the normal form's sign may put a minus first in both, as in (-x)/(-1 + x)
        sign = -1 if self.denominator[0][2] < 0 else 1
        above, below = (
            plane_text(tuple((i, j, sign * c) for i, j, c in terms), names)
            for terms in (self.numerator, self.denominator)
        )
        return f"{above if len(self.numerator) == 1 else f'({above})'}/({below})"

    def __str__(self) -> str:
        return self.to_text()

    def __add__(self, other: Expression | Fraction | int) -> Expression:
        other = _as_expression(other)
        if not (self.numerator and other.numerator):
            return self if self.numerator else other
        if self.denominator == other.denominator:
            total = _sum(dict_of(self.numerator), other.numerator)
            return (
                Expression(terms_of(total))
                if self.is_polynomial
                else _reduced(total, dict_of(self.denominator))
            )
        left = _product(self.numerator, other.denominator)
        right = _product(other.numerator, self.denominator)
        return _reduced(_sum(left, terms_of(right)), _product(self.denominator, other.denominator))

    def __neg__(self) -> Expression:
        return Expression(tuple((i, j, -c) for i, j, c in self.numerator), self.denominator)

    def __sub__(self, other: Expression | Fraction | int) -> Expression:
        return self + -_as_expression(other)

    def __mul__(self, other: Expression | Fraction | int) -> Expression:
        other = _as_expression(other)
        if not (self.numerator and other.numerator):
            return constant(0)
        product = _product(self.numerator, other.numerator)
        if self.is_polynomial and other.is_polynomial:  # as most are
            return Expression(terms_of(product))
        return _reduced(product, _product(self.denominator, other.denominator))

    def __truediv__(self, other: Expression | Fraction | int) -> Expression:
        other = _as_expression(other)
        if not other.numerator:
            raise ExpressionError("division by zero")
        return _reduced(
            _product(self.numerator, other.denominator), _product(self.denominator, other.numerator)
        )

    def __pow__(self, exponent: int) -> Expression:
        if exponent < 0:
            return constant(1) / self**-exponent
        if self.is_constant:
            return constant(self.constant() ** exponent)
        # powers of a normal form are in normal form
        return Expression(_power(self.numerator, exponent), _power(self.denominator, exponent))

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Fraction | int) -> Expression:
        return _as_expression(other) - self

    def __rtruediv__(self, other: Fraction | int) -> Expression:
        return _as_expression(other) / self


Expressions = Mapping[str, Expression]
"""Functions of the axes by the names of the parameters that they are."""


def values_at(
    parameters: Expressions, x: Fraction, y: Fraction = Fraction(0)
) -> dict[str, Fraction]:
    """The exact values of parameters at a point; of those on a line it has no second coordinate.

    Raises
    ------
    PoleError
        If a denominator vanishes there.
    """
    return {name: expression.evaluate(x, y) for name, expression in parameters.items()}


def constant(value: Fraction | int) -> Expression:
    """The constant function."""
    return Expression(((0, 0, Fraction(value)),) if value else ())


def axis(index: int) -> Expression:
    """The coordinate function of axis 0 (x) or 1 (y)."""
    return Expression(((1, 0, Fraction(1)),) if index == 0 else ((0, 1, Fraction(1)),))


def dict_of(terms: Terms) -> dict[tuple[int, int], Fraction]:
    """Terms as a new dictionary from exponent pairs to coefficients."""
    return {(i, j): c for i, j, c in terms}


def terms_of(polynomial: Mapping[tuple[int, int], Fraction]) -> Terms:
    """A dictionary from exponent pairs to coefficients as sorted terms, zeros dropped."""
    return tuple((i, j, c) for (i, j), c in sorted(polynomial.items()) if c)


def _as_expression(value: Expression | Fraction | int) -> Expression:
    return value if isinstance(value, Expression) else constant(value)


def polynomial_value(terms: Terms, x: Fraction, y: Fraction) -> Fraction:
    """The exact value of a polynomial."""
    total = Fraction(0)
    for i, j, c in terms:
        # most parameters are numbers or an axis: powers that are 1 would be most of the work
        value = c * x**i if i else c
        value = value * y**j if j else value
        total = total + value if total else value
    return total


def _sum(left: _Polynomial, right: Terms) -> _Polynomial:
    for i, j, c in right:
        power = (i, j)
        left[power] = left[power] + c if power in left else c
    return left


def _product(left: Terms, right: Terms) -> _Polynomial:
    product: _Polynomial = {}
    for i, j, c in left:
        for m, n, d in right:
            power = (i + m, j + n)
            product[power] = product[power] + c * d if power in product else c * d
    return product


def _power(terms: Terms, exponent: int) -> Terms:
    return reduce(lambda found, _: terms_of(_product(found, terms)), range(exponent), ONE)


def _reduced(numerator: _Polynomial, denominator: _Polynomial) -> Expression:
    """The normal form of numerator/denominator that `Expression` promises; denominator is not zero."""
    numerator = {power: c for power, c in numerator.items() if c}
    denominator = {power: c for power, c in denominator.items() if c}
    if not numerator:
        return Expression(())
    if denominator.keys() != {(0, 0)}:
        common_i = min(i for i, _ in numerator.keys() | denominator.keys())
        common_j = min(j for _, j in numerator.keys() | denominator.keys())
        numerator = {(i - common_i, j - common_j): c for (i, j), c in numerator.items()}
        denominator = {(i - common_i, j - common_j): c for (i, j), c in denominator.items()}
        quotient = _exact_quotient(numerator, denominator)
        if quotient is not None:
            return Expression(terms_of(quotient))
        unit = _unit(denominator)
    else:
        unit = denominator[0, 0]
    if unit != 1:
        numerator = {power: c / unit for power, c in numerator.items()}
        denominator = {power: c / unit for power, c in denominator.items()}
    return Expression(terms_of(numerator), terms_of(denominator))


def _unit(polynomial: _Polynomial) -> Fraction:
    """The rational u for which polynomial/u is primitive over the integers with positive last
    coefficient.
    """
    coefficients = polynomial.values()
    content = Fraction(
        gcd(*(c.numerator for c in coefficients)), lcm(*(c.denominator for c in coefficients))
    )
    return content if polynomial[max(polynomial)] > 0 else -content


def _exact_quotient(numerator: _Polynomial, divisor: _Polynomial) -> _Polynomial | None:
    """numerator/divisor when it is a polynomial, else None. Division by the leading term in graded
    order.
    """

    def graded(power: tuple[int, int]) -> tuple[int, int]:
        return (power[0] + power[1], power[0])

    lead = max(divisor, key=graded)
    rest, quotient = dict(numerator), {}
    while rest:
        top = max(rest, key=graded)
        shift = (top[0] - lead[0], top[1] - lead[1])
        if min(shift) < 0:
            return None
        factor = rest[top] / divisor[lead]
        quotient[shift] = factor
        for (i, j), c in divisor.items():
            power = (i + shift[0], j + shift[1])
            value = rest.get(power, Fraction(0)) - factor * c
            if value:
                rest[power] = value
            else:
                rest.pop(power, None)
    return quotient
