"""The parameters of a family of slices as rational functions of its axes and its free parameter.

Guarantee: at each value of the free parameter they are the member's own parameters, exactly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ptmcad.algebra.polynomials import SPACE, Coefficient, Ratio, add_ratios, ratio
from ptmcad.errors import ExpressionError
from ptmcad.text.syntax import NOT_INTEGER, parse, unknown_name
from ptmcad.text.tree import Call, Name, Number, Power, Step, interpret

MAX_DEGREE = 32
"""Of numerator and denominator in the axes and the free parameter together."""
MAX_BITS = 13_000


def space_parameters(
    names: Sequence[str], text: Mapping[str, str], coordinates: tuple[str, str, str]
) -> dict[str, Ratio]:
    """Parameters as ratios of polynomials in Z[x, y, z].

    Parameters
    ----------
    names : those that are wanted.
    text : what each parameter is written as, and each that such a text names; without circles.
    coordinates : names of the two axes and of the free parameter.

    Raises
    ------
    ExpressionError
        When the degree or a number is too large to be expanded in three variables.
    """
    space = _Space(
        dict(zip(coordinates, ((g, SPACE.constant(1)) for g in SPACE.gens()), strict=True)), text
    )
    return {name: space.value_of(name) for name in names}


class _Space(NamedTuple):
    """Z[x, y, z] as a ring in which texts have values; ``known`` grows."""

    known: dict[str, Ratio]
    text: Mapping[str, str]

    def value_of(self, name: str, position: int = 0) -> Ratio:
        if name not in self.known:
            if name not in self.text:
                raise unknown_name(name, position, (*self.known, *self.text))
            self.known[name] = interpret(parse(self.text[name]), self)
        return self.known[name]

    def number(self, number: Number) -> Ratio:
        return (SPACE.constant(number.value.numerator), SPACE.constant(number.value.denominator))

    def name(self, name: Name) -> Ratio:
        return self.value_of(name.name, name.position)

    def call(self, call: Call) -> Ratio:
        raise ExpressionError(f"'{call.function}' is no function here", call.position)

    def negative(self, value: Ratio) -> Ratio:
        return (-value[0], value[1])

    def joined(self, left: Ratio, step: Step, right: Ratio) -> Ratio:
        _check_size(_degree(left) + _degree(right), _bits(left) + _bits(right), step.position)
        match step.operator:
            case "+":
                return add_ratios(left, right)
            case "-":
                return add_ratios(left, (-right[0], right[1]))
            case "/":
                if right[0].is_zero():
                    raise ExpressionError("division by zero", step.position)
                right = right[::-1]
        return ratio(left[0] * right[0], left[1] * right[1])

    def power(self, base: Ratio, power: Power, exponent: Ratio) -> Ratio:
        quotient = ratio(*exponent)
        if not (
            quotient[0].is_constant()
            and quotient[1].is_constant()
            and abs(_integer(quotient[1])) == 1
        ):
            raise ExpressionError(NOT_INTEGER, power.position)
        n = _integer(quotient[0]) * _integer(quotient[1])
        _check_size(abs(n) * _degree(base), abs(n) * _bits(base), power.position)
        above, below = base if n >= 0 else (base[1], base[0])
        if below.is_zero():
            raise ExpressionError("division by zero", power.position)
        return (above ** abs(n), below ** abs(n))


def _integer(p: Coefficient) -> int:
    return int(p.coeffs()[0]) if not p.is_zero() else 0


def _degree(value: Ratio) -> int:
    return max(int(p.total_degree()) for p in value if not p.is_zero())


def _bits(value: Ratio) -> int:
    return max((int(c).bit_length() for p in value for c in p.coeffs()), default=0)


def _check_size(degree: int, bits: int, position: int) -> None:
    if degree > MAX_DEGREE or bits > MAX_BITS:
        raise ExpressionError(
            f"too large for a family (degree over {MAX_DEGREE} or numbers over {MAX_BITS} bits)",
            position,
        )
