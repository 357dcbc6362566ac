"""Values in floating point of what can be asked of a solution: a quantity of
`ptmcad.ask.quantities`, or an expression.

Guarantee: a name that the model does not have is refused before anything is computed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ptmcad.ask.fields.equations import Floats, ModelState, eigenvalues
from ptmcad.ask.quantities import Quantity, QuantityKind, named, quantities, unit_of, unknown
from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.question.slice import Slice
from ptmcad.text.syntax import did_you_mean, parse
from ptmcad.text.tree import Call, Name, Number, Power, Step, interpret, names_of

OPTION = "--value"
Values = Callable[[ModelState, Floats, Mapping[str, Any]], Floats]
"""From a state, its points of shape (n, *S), angles first, and the values of parameters and axes.
"""


@dataclass(frozen=True, slots=True)
class Valued:
    """What is shown: its name, its unit, and its values.

    Attributes
    ----------
    values : nan where there is none, infinite where no double is near it.
    is_barrier : whether it is counted from the values, which are a pose's energy then.
    """

    name: str
    unit: str
    values: Values
    is_barrier: bool = False


def quantity_of(text: str, slice: Slice) -> Valued:
    """The quantity of this name.

    ``energy``, ``stiffness`` (the least eigenvalue of the Hessian), ``barrier``, ``force:SPRING``,
    ``length:SPRING``, ``angle:UNKNOWN`` in degrees, ``x:POINT``, ``y:POINT``, or an expression in
    the unknowns (angles in radians), parameters and axes.

    Raises
    ------
    ConfigError
        For a name or an expression that has no meaning here.
    """
    known = named(slice.model, text, OPTION) or unknown(slice.model, text.strip())
    if (
        known is None or known.name in slice.model.angles
    ):  # by itself an angle is in radians, as in any expression
        return _expression(text, slice)
    return Valued(
        known.name, unit_of(known, slice), _values(known), known.kind is QuantityKind.BARRIER
    )


def _values(quantity: Quantity) -> Values:
    number, part = quantity.number, quantity.part
    match quantity.kind:
        case QuantityKind.ENERGY | QuantityKind.BARRIER:
            return lambda state, at, values: state.known_energy
        case QuantityKind.STIFFNESS:
            return lambda state, at, values: eigenvalues(state.jacobian)[0]
        case QuantityKind.FORCE:
            return lambda state, at, values: state.stretches[number][2]
        case QuantityKind.LENGTH:
            return lambda state, at, values: state.stretches[number][0]
        case QuantityKind.ANGLE:
            return lambda state, at, values: np.degrees(at[number])
        case QuantityKind.REAL:
            return lambda state, at, values: at[number]
        case QuantityKind.X | QuantityKind.Y:
            side = int(quantity.kind is QuantityKind.Y)
            return lambda state, at, values: state.points[part][side]


def _expression(text: str, slice: Slice) -> Valued:
    model = slice.model
    known = (*model.sorted_unknowns, *slice.axis_names, *slice.parameters)
    try:
        tree = parse(text)
        for name in names_of(tree):
            if name not in known:
                if name in quantities(model):
                    raise ConfigError(
                        f"{name!r} is a quantity of its own, and no part of an expression",
                        key=OPTION,
                    )
                hint = did_you_mean(name, (*known, *quantities(model)))
                raise ConfigError(
                    f"{name!r} is neither an unknown nor a parameter{hint}", key=OPTION
                )
        with np.errstate(all="ignore"):
            # where no quotient of names is zero by chance
            generic = {
                name: np.float64(math.fmod(math.sqrt(2) * (k + 1), 1))
                for k, name in enumerate(known)
            }
            anywhere = interpret(tree, _Arrays(generic))
        if np.isinf(anywhere.value) and not anywhere.lost():
            raise ConfigError(f"{text[:60]!r} divides by zero", key=OPTION)
    except ExpressionError as error:
        raise ConfigError(f"{text!r}: {error.message}", key=OPTION) from error
    except (OverflowError, ValueError) as error:  # an exponent may be infinite, or no number
        raise ConfigError(
            f"{text[:60]!r} has a number beyond doubles, 1.8e308", key=OPTION
        ) from error

    def values(_state: ModelState, at: Floats, given: Mapping[str, Any]) -> Floats:
        unknowns = dict(zip(model.sorted_unknowns, at, strict=True))
        with np.errstate(all="ignore"):
            found = interpret(tree, _Arrays({**given, **unknowns}))
            value = np.where(
                np.isfinite(found.value), found.value, np.nan
            )  # else the expression has no value there
            return np.broadcast_to(np.where(found.lost(), np.inf, value), at.shape[1:]) + 0.0

    return Valued(text.strip(), "", values)


_TINY, _EPSILON = np.finfo(np.float64).tiny, np.finfo(np.float64).eps


@dataclass(frozen=True, slots=True)
class _Doubles:
    """Values of a part of an expression, and how far from the true ones they may be where doubles
    did not hold a part of it, being too small or too large; rounding apart, which this error does
    not count."""

    value: Any
    error: Any = 0.0

    def lost(self) -> Any:
        """Where the error is more than rounding."""
        return (self.error != 0) & ~(self.error < _EPSILON * np.abs(self.value))


class _Arrays:
    """The interpretation of an expression in arrays; quotients and functions of any argument are
    allowed.
    """

    def __init__(self, values: Mapping[str, Any]):
        self.values = values

    def number(self, number: Number) -> _Doubles:
        value = np.float64(number.value)
        return _Doubles(value, _TINY if number.value and abs(value) < _TINY else 0.0)

    def name(self, name: Name) -> _Doubles:
        return _Doubles(self.values[name.name])

    def call(self, call: Call) -> _Doubles:
        argument = interpret(call.argument, self)
        return _Doubles(
            (np.cos if call.function == "cos" else np.sin)(argument.value), argument.error
        )

    def negative(self, one: _Doubles) -> _Doubles:
        return _Doubles(-one.value, one.error)

    def joined(self, left: _Doubles, step: Step, right: _Doubles) -> _Doubles:
        a, b = left.value, right.value
        match step.operator:
            case "+" | "-":
                value = a + b if step.operator == "+" else a - b
                return _Doubles(value, left.error + right.error + _overflow(value, a, b))
            case "*":
                value = a * b
                error = np.abs(a) * right.error + np.abs(b) * left.error + left.error * right.error
                return _Doubles(
                    value, error + _overflow(value, a, b) + _underflow(value, (a != 0) & (b != 0))
                )
            case _:
                value = a / b
                error = (left.error + np.abs(value) * right.error) / (np.abs(b) - right.error)
                known = (left.error == 0) & (right.error == 0)
                error = np.where(known, 0.0, np.where(np.abs(b) > right.error, error, np.inf))
                beyond = np.where(b != 0, _overflow(value, a, b), 0.0)
                return _Doubles(value, error + beyond + _underflow(value, a != 0))

    def power(self, base: _Doubles, power: Power, exponent: _Doubles) -> _Doubles:
        a, b = base.value, exponent.value
        whole = not np.ndim(b) and math.isclose(float(b), round(float(b)))
        value = a ** round(float(b)) if whole else a**b
        known = (base.error == 0) & (exponent.error == 0)
        slight = (base.error <= _EPSILON * np.abs(a)) & (exponent.error == 0)
        error = np.where(known, 0.0, np.where(slight, np.abs(value * b * base.error / a), np.inf))
        beyond = np.where(a != 0, _overflow(value, a, b), 0.0)
        return _Doubles(value, error + beyond + _underflow(value, a != 0))


def _overflow(value: Any, a: Any, b: Any) -> Any:
    """Infinite where a value is and what it is made of is not."""
    return np.where(np.isinf(value) & np.isfinite(a) & np.isfinite(b), np.inf, 0.0)


def _underflow(value: Any, expected: Any) -> Any:
    """The error where a value that is not zero is nearer to it than doubles are."""
    return np.where(expected & (np.abs(value) < _TINY), _TINY, 0.0)
