"""What a text means: a rational function in the two axes of a slice, or a number.

Guarantee: every coefficient is exact (``0.1`` is 1/10, ``1e-30`` is 10^-30); nothing is rounded,
nothing is evaluated as Python. Any text is answered within a fraction of a second, by an
`Expression` or by an `ExpressionError`: the limits of `ptmcad.text.syntax` and those below bound
the work.

>>> from ptmcad.text.expressions import axis
>>> rho, force = axis(0), axis(1)
>>> str(parse("-0.1*rho^2 + 3/4", {"rho": rho}))
'3/4 - 1/10*x^2'
>>> parse("2*rho*F / rho", {"rho": rho, "F": force}) == 2 * force
True
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from functools import partial
from math import comb

from ptmcad.errors import ConfigError, ExpressionError, shown
from ptmcad.text.expressions import Expression, Expressions, constant
from ptmcad.text.numerals import exactly
from ptmcad.text.syntax import NOT_INTEGER, unknown_name
from ptmcad.text.syntax import parse as tree_of
from ptmcad.text.tree import OPERATORS, Call, Name, Number, Power, Step, Tree, interpret

MAX_EXPONENT = 64
MAX_DEGREE = 64
MAX_TERMS = 300
MAX_BITS = 13_000  # under 4300 decimal digits, so that Python prints it
MAX_WORK = 100_000


def parse(text: object, names: Expressions | None = None) -> Expression:
    """Read an arithmetic expression: numbers, names, ``+ - * /``, integer powers ``^`` or ``**``,
    parentheses.

    ``^`` binds tighter than a sign on its left and groups to the right, as in mathematics: ``-x^2``
    is -(x^2).

    Parameters
    ----------
    text : the expression, or a number: an int, a Fraction, a float (its shortest decimal), a
        Decimal, or one of numpy's.
    names : what each name stands for.

    Raises
    ------
    ExpressionError
        With the position of the offending character: not arithmetic, an unknown name, a division by
        zero, or one of the limits (length, depth, digits, exponent, degree, number of terms, size
        of numbers).
    """
    if isinstance(text, str | Decimal):  # a Decimal's exponent may be huge: a text has limits
        return value_in_axes(tree_of(str(text)), names or {})
    try:
        return constant(exactly(text))
    except (TypeError, ValueError) as error:
        raise ExpressionError(str(error)) from error


def value_in_axes(tree: Tree, names: Expressions) -> Expression:
    """The function of the axes that a tree is.

    Parameters
    ----------
    names : what each name stands for.

    Raises
    ------
    ExpressionError
        As `parse`.
    """
    return interpret(tree, _InTheAxes(names))


def rational(text: object) -> Fraction:
    """Read an exact rational number: a text such as ``3/4``, ``-0.1`` or ``1e-30``, or a number as
    `parse` takes it.

    >>> rational("-0.1") == rational(-0.1)
    True

    Raises
    ------
    ExpressionError
        If it is no number.
    """
    return parse(text).constant()


def number_for(key: str | None, value: object) -> Fraction:
    """The number that a caller gave for something.

    Raises
    ------
    ConfigError
        With the key, if it is no number.
    """
    try:
        return rational(value)
    except ExpressionError as error:
        raise ConfigError(str(error), key=key) from error


def share_for(key: str, value: object) -> Fraction:
    """The share between 0 and 1, such as a tolerance, that a caller gave for something.

    Raises
    ------
    ConfigError
        With the key, if it is none.
    """
    share = number_for(key, value)
    if not 0 < share < 1:
        raise ConfigError(f"{shown(str(value), 60)} is not between 0 and 1", key=key)
    return share


class _InTheAxes:
    """The interpretation of a text as a rational function of the axes, with a budget for the
    arithmetic.
    """

    def __init__(self, names: Expressions):
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
            raise ExpressionError(
                f"'{call.function}' is no function here: is an operator missing?", call.position
            )
        raise unknown_name(call.function, call.position, self.names)

    def negative(self, value: Expression) -> Expression:
        return -value

    def joined(self, left: Expression, step: Step, right: Expression) -> Expression:
        if step.operator == "/" and not right.numerator:
            raise ExpressionError("division by zero", step.position)
        spread = (len(left.numerator) + len(left.denominator)) * (
            len(right.numerator) + len(right.denominator)
        )
        self.spend(spread * (1 + (_bits(left) + _bits(right)) // 512), step.position)
        degrees = (left.degree, right.degree)
        adds_up = step.operator in "*/" or not (left.is_polynomial and right.is_polynomial)
        if (sum(degrees) if adds_up else max(degrees)) > MAX_DEGREE:
            raise ExpressionError(f"the degree exceeds {MAX_DEGREE}", step.position)
        return self.limited(partial(OPERATORS[step.operator], left, right), step.position)

    def power(self, base: Expression, power: Power, exponent: Expression) -> Expression:
        if not exponent.is_constant or exponent.constant().denominator != 1:
            raise ExpressionError(NOT_INTEGER, power.position)
        n = exponent.constant().numerator
        if n < 0 and not base.numerator:
            raise ExpressionError("division by zero", power.position)
        if base.is_constant:
            if abs(base.constant()) in (0, 1):
                n = n % 2 if n <= 0 else 2 - n % 2
            elif abs(n) * _bits(base) > MAX_BITS:
                raise ExpressionError(f"the power has more than {MAX_BITS} bits", power.position)
        else:
            size = abs(n)
            if size > MAX_EXPONENT:
                raise ExpressionError(
                    f"an exponent of a name is at most {MAX_EXPONENT}", power.position
                )
            terms = max(len(base.numerator), len(base.denominator))
            if size * base.degree > MAX_DEGREE or size * _bits(base) > MAX_BITS:
                raise ExpressionError(
                    f"the power is too large (degree over {MAX_DEGREE} or numbers over {MAX_BITS} bits)",
                    power.position,
                )
            if min(comb(terms + size - 1, size), comb(size * base.degree + 2, 2)) > MAX_TERMS:
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
            raise ExpressionError(
                f"a number in the expression has more than {MAX_BITS} bits", position
            )
        return value


def _bits(expression: Expression) -> int:
    """Bits of the largest integer in the coefficients."""
    return max(
        (max(c.numerator.bit_length(), c.denominator.bit_length())
         for _, _, c in expression.numerator + expression.denominator),
        default=0,
    )  # fmt: skip
