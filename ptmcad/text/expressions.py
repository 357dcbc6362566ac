"""Rational functions in the two axes of a slice, and what a text means as one of them.

Guarantee: every coefficient is exact (``0.1`` is 1/10, ``1e-30`` is 10^-30); nothing is rounded, nothing is evaluated
as Python. Any text is answered within a fraction of a second, by an `Expression` or by an `ExpressionError`:
the limits of `ptmcad.text.syntax` and those below bound the work.

>>> rho, force = axis(0), axis(1)
>>> str(parse("-0.1*rho^2 + 3/4", {"rho": rho}))
'3/4 - 1/10*x^2'
>>> parse("2*rho*F / rho", {"rho": rho, "F": force}) == 2 * force
True
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import comb, gcd, lcm
from operator import add, mul, sub, truediv

from ptmcad.errors import ExpressionError, PoleError
from ptmcad.text.numerals import text_of
from ptmcad.text.syntax import Call, Name, Number, Power, Step, interpret, unknown_name
from ptmcad.text.syntax import names_in as names_in_text
from ptmcad.text.syntax import parse as tree_of
from ptmcad.text.terms import terms_text

Term = tuple[int, int, Fraction]
_Polynomial = dict[tuple[int, int], Fraction]

MAX_EXPONENT = 64
MAX_DEGREE = 64
MAX_TERMS = 300
MAX_BITS = 13_000  # under 4300 decimal digits, so that Python prints it
MAX_WORK = 100_000

ONE: tuple[Term, ...] = ((0, 0, Fraction(1)),)


# ---------------------------------------------------------------------------------------------- the rational function


@dataclass(frozen=True, slots=True)
class Expression:
    """A rational function numerator/denominator in Q(x, y), x and y being the two axes in their order.

    Guarantee: terms are sorted by exponents, without zero coefficients; the denominator is not zero; common monomials
    are cancelled; a denominator that divides the numerator is gone; a constant denominator is 1 and any other is a
    primitive integer polynomial with positive last coefficient.

    Not guaranteed: that every common factor is cancelled. Two equal functions whose denominators share no more than a
    part with their numerators may compare unequal.

    Attributes
    ----------
    numerator, denominator : terms ``(i, j, c)``, meaning c x^i y^j; an empty numerator is zero.
    """

    numerator: tuple[Term, ...]
    denominator: tuple[Term, ...] = ONE

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
        denominator = _value(self.denominator, x, y)
        if denominator == 0:
            raise PoleError(
                f"division by zero: the denominator of {self} vanishes at x = {text_of(x)}, y = {text_of(y)}"
            )
        return _value(self.numerator, x, y) / denominator

    def to_text(self, names: tuple[str, str] = ("x", "y")) -> str:
        """The expression as text that `parse` reads back."""
        numerator = _terms_text(self.numerator, names)
        if self.is_polynomial:
            return numerator
        return f"({numerator})/({_terms_text(self.denominator, names)})"

    def __str__(self) -> str:
        return self.to_text()

    def __add__(self, other: Expression | Fraction | int) -> Expression:
        other = _as_expression(other)
        if self.denominator == other.denominator:
            return _reduced(_sum(dict_of(self.numerator), other.numerator), dict_of(self.denominator))
        left = _product(self.numerator, other.denominator)
        right = _product(other.numerator, self.denominator)
        return _reduced(_sum(left, terms_of(right)), _product(self.denominator, other.denominator))

    def __neg__(self) -> Expression:
        return Expression(tuple((i, j, -c) for i, j, c in self.numerator), self.denominator)

    def __sub__(self, other: Expression | Fraction | int) -> Expression:
        return self + -_as_expression(other)

    def __mul__(self, other: Expression | Fraction | int) -> Expression:
        other = _as_expression(other)
        return _reduced(_product(self.numerator, other.numerator), _product(self.denominator, other.denominator))

    def __truediv__(self, other: Expression | Fraction | int) -> Expression:
        other = _as_expression(other)
        if not other.numerator:
            raise ExpressionError("division by zero")
        return _reduced(_product(self.numerator, other.denominator), _product(self.denominator, other.numerator))

    def __pow__(self, exponent: int) -> Expression:
        if self.is_constant:
            base = self.constant()
            if base == 0 and exponent < 0:
                raise ExpressionError("division by zero")
            return constant(base**exponent)
        if exponent < 0:
            return (constant(1) / self) ** -exponent
        result, square = constant(1), self
        while exponent:
            if exponent & 1:
                result = result * square
            exponent >>= 1
            if exponent:
                square = square * square
        return result

    def __radd__(self, other: Fraction | int) -> Expression:
        return _as_expression(other) + self

    def __rsub__(self, other: Fraction | int) -> Expression:
        return _as_expression(other) - self

    def __rmul__(self, other: Fraction | int) -> Expression:
        return _as_expression(other) * self

    def __rtruediv__(self, other: Fraction | int) -> Expression:
        return _as_expression(other) / self


def constant(value: Fraction | int) -> Expression:
    """The constant function."""
    return Expression(((0, 0, Fraction(value)),) if value else ())


def axis(index: int) -> Expression:
    """The coordinate function of axis 0 (x) or 1 (y)."""
    return Expression(((1, 0, Fraction(1)),) if index == 0 else ((0, 1, Fraction(1)),))


def dict_of(terms: tuple[Term, ...]) -> dict[tuple[int, int], Fraction]:
    """Terms as a new dictionary from exponent pairs to coefficients."""
    return {(i, j): c for i, j, c in terms}


def terms_of(polynomial: Mapping[tuple[int, int], Fraction]) -> tuple[Term, ...]:
    """A dictionary from exponent pairs to coefficients as sorted terms, zeros dropped."""
    return tuple((i, j, c) for (i, j), c in sorted(polynomial.items()) if c)


def _as_expression(value: Expression | Fraction | int) -> Expression:
    return value if isinstance(value, Expression) else constant(value)


def _value(terms: tuple[Term, ...], x: Fraction, y: Fraction) -> Fraction:
    return sum((c * x**i * y**j for i, j, c in terms), Fraction(0))


def _sum(left: _Polynomial, right: tuple[Term, ...]) -> _Polynomial:
    for i, j, c in right:
        left[i, j] = left.get((i, j), Fraction(0)) + c
    return left


def _product(left: tuple[Term, ...], right: tuple[Term, ...]) -> _Polynomial:
    product: _Polynomial = {}
    for i, j, c in left:
        for m, n, d in right:
            product[i + m, j + n] = product.get((i + m, j + n), Fraction(0)) + c * d
    return product


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
    """The rational u for which polynomial/u is primitive over the integers with positive last coefficient."""
    coefficients = polynomial.values()
    content = Fraction(gcd(*(c.numerator for c in coefficients)), lcm(*(c.denominator for c in coefficients)))
    return content if polynomial[max(polynomial)] > 0 else -content


def _exact_quotient(numerator: _Polynomial, divisor: _Polynomial) -> _Polynomial | None:
    """numerator/divisor when it is a polynomial, else None. Division by the leading term in graded order."""

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


def _terms_text(terms: tuple[Term, ...], names: tuple[str, str]) -> str:
    return terms_text((((i, j), c) for i, j, c in terms), names)


# ------------------------------------------------------------------------------------------------------ from a text

_OPERATION: dict[str, Callable[[Expression, Expression], Expression]] = {"+": add, "-": sub, "*": mul, "/": truediv}


def parse(text: str | int | Fraction, names: Mapping[str, Expression] | None = None) -> Expression:
    """Read an arithmetic expression: numbers, names, ``+ - * /``, integer powers ``^`` or ``**``, parentheses.

    ``^`` binds tighter than a sign on its left and groups to the right, as in mathematics: ``-x^2`` is -(x^2).

    Parameters
    ----------
    text : the expression; an int or a Fraction is taken as the constant.
    names : what each name stands for.

    Raises
    ------
    ExpressionError
        With the position of the offending character: not arithmetic, an unknown name, a division by zero, or one of
        the limits (length, depth, digits, exponent, degree, number of terms, size of numbers).
    """
    if isinstance(text, bool) or not isinstance(text, str | int | Fraction):
        raise ExpressionError(
            f'{text!r} is not an exact number: write it as text, such as "0.1", or as a fractions.Fraction'
        )
    if not isinstance(text, str):
        return constant(text)
    return interpret(tree_of(text), _InTheAxes(names or {}))


def rational(text: str | int | Fraction) -> Fraction:
    """Read an exact rational number: ``3/4``, ``-0.1``, ``1e-30``, an int or a Fraction.

    >>> rational("-0.1"), rational("1e-3")
    (Fraction(-1, 10), Fraction(1, 1000))

    Raises
    ------
    ExpressionError
        If it is no number, also for a binary float (write it as text).
    """
    return parse(text).constant()


def names_in(text: str | int | Fraction) -> tuple[str, ...]:
    """The names that occur in a text, in order of appearance, each once.

    Raises
    ------
    ExpressionError
        If a character cannot stand in an expression.
    """
    if not isinstance(text, str):
        return ()
    return names_in_text(text)


class _InTheAxes:
    """The interpretation of a text as a rational function of the axes, with a budget for the arithmetic."""

    def __init__(self, names: Mapping[str, Expression]):
        self.names = names
        self.work = 0

    def number(self, number: Number) -> Expression:
        return constant(number.value)

    def name(self, name: Name) -> Expression:
        if name.name in self.names:
            return self.names[name.name]
        raise unknown_name(name.name, name.position, self.names)

    def call(self, call: Call) -> Expression:
        if call.function in self.names:
            raise ExpressionError(f"'{call.function}' is no function here: is an operator missing?", call.position)
        raise unknown_name(call.function, call.position, self.names)

    def negative(self, value: Expression) -> Expression:
        return -value

    def joined(self, left: Expression, step: Step, right: Expression) -> Expression:
        if step.operator == "/" and not right.numerator:
            raise ExpressionError("division by zero", step.position)
        spread = (len(left.numerator) + len(left.denominator)) * (len(right.numerator) + len(right.denominator))
        self.spend(spread * (1 + (_bits(left) + _bits(right)) // 512), step.position)
        degrees = (left.degree, right.degree)
        adds_up = step.operator in "*/" or not (left.is_polynomial and right.is_polynomial)
        if (sum(degrees) if adds_up else max(degrees)) > MAX_DEGREE:
            raise ExpressionError(f"the degree exceeds {MAX_DEGREE}", step.position)
        return self.limited(partial(_OPERATION[step.operator], left, right), step.position)

    def power(self, base: Expression, power: Power, exponent: Expression) -> Expression:
        if not exponent.is_constant or exponent.constant().denominator != 1:
            raise ExpressionError("the exponent is not an integer", power.position)
        n = exponent.constant().numerator
        if n < 0 and not base.numerator:
            raise ExpressionError("division by zero", power.position)
        if base.is_constant:
            if abs(base.constant()) not in (0, 1) and abs(n) * _bits(base) > MAX_BITS:
                raise ExpressionError(f"the power has more than {MAX_BITS} bits", power.position)
            if abs(base.constant()) in (0, 1):
                n = n % 2 if n <= 0 else 2 - n % 2
        else:
            if abs(n) > MAX_EXPONENT:
                raise ExpressionError(f"an exponent of a name is at most {MAX_EXPONENT}", power.position)
            terms = max(len(base.numerator), len(base.denominator))
            if abs(n) * base.degree > MAX_DEGREE or abs(n) * _bits(base) > MAX_BITS:
                raise ExpressionError(
                    f"the power is too large (degree over {MAX_DEGREE} or numbers over {MAX_BITS} bits)",
                    power.position,
                )
            if min(comb(terms + abs(n) - 1, abs(n)), comb(abs(n) * base.degree + 2, 2)) > MAX_TERMS:
                raise ExpressionError(f"the power has more than {MAX_TERMS} terms", power.position)
            self.spend(MAX_TERMS * terms, power.position)
        return self.limited(partial(base.__pow__, n), power.position)

    def spend(self, work: int, position: int) -> None:
        self.work += work
        if self.work > MAX_WORK:
            raise ExpressionError("the expression takes too much work to expand", position)

    def limited(self, operation: Callable[[], Expression], position: int) -> Expression:
        value = operation()
        if max(len(value.numerator), len(value.denominator)) > MAX_TERMS:
            raise ExpressionError(f"the expression has more than {MAX_TERMS} terms", position)
        if _bits(value) > MAX_BITS:
            raise ExpressionError(f"a number in the expression has more than {MAX_BITS} bits", position)
        return value


def _bits(expression: Expression) -> int:
    """Bits of the largest integer in the coefficients."""
    return max(
        (max(c.numerator.bit_length(), c.denominator.bit_length())
         for _, _, c in expression.numerator + expression.denominator),
        default=0,
    )  # fmt: skip
