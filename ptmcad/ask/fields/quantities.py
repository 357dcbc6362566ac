"""Values in floating point of what can be asked of a solution: a quantity of `ptmcad.ask.quantities`, or an expression.

Guarantee: a name that the model does not have is refused before anything is computed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ptmcad.ask.fields.equations import State, eigenvalues
from ptmcad.ask.fields.jets import Floats
from ptmcad.ask.quantities import Kind, Quantity, named, quantities, unit_of, unknown
from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.question.slice import Slice
from ptmcad.text.syntax import did_you_mean, parse
from ptmcad.text.tree import Call, Name, Number, Power, Step, interpret, names_of

OPTION = "--value"
Values = Callable[[State, Floats, Mapping[str, Any]], Floats]
"""From a state, its points of shape (n, *S), angles first, and the values of parameters and axes."""


@dataclass(frozen=True, slots=True)
class Valued:
    """What is shown: its name, its unit, and its values.

    Attributes
    ----------
    is_barrier : whether it is counted from the values, which are a pose's energy then.
    """

    name: str
    unit: str
    values: Values
    is_barrier: bool = False


def quantity_of(text: str, slice: Slice) -> Valued:
    """The quantity of this name.

    ``energy``, ``stiffness`` (the least eigenvalue of the Hessian), ``barrier``, ``force:SPRING``, ``length:SPRING``,
    ``angle:UNKNOWN`` in degrees, ``x:POINT``, ``y:POINT``, or an expression in the unknowns (angles in radians),
    parameters and axes.

    Raises
    ------
    ConfigError
        For a name or an expression that has no meaning here.
    """
    known = named(slice.model, text, OPTION) or unknown(slice.model, text.strip())
    if known is None or known.name in slice.model.angles:  # by itself an angle is in radians, as in any expression
        return _expression(text, slice)
    return Valued(known.name, unit_of(known, slice), _values(known), known.kind is Kind.BARRIER)


def _values(quantity: Quantity) -> Values:
    number, part = quantity.number, quantity.part
    match quantity.kind:
        case Kind.ENERGY | Kind.BARRIER:
            return lambda state, at, values: _known(state.energy)
        case Kind.STIFFNESS:
            return lambda state, at, values: eigenvalues(state.jacobian)[0]
        case Kind.FORCE:
            return lambda state, at, values: state.forces[number]
        case Kind.LENGTH:
            return lambda state, at, values: state.lengths[number]
        case Kind.ANGLE:
            return lambda state, at, values: np.degrees(at[number])
        case Kind.REAL:
            return lambda state, at, values: at[number]
        case Kind.X | Kind.Y:
            side = int(quantity.kind is Kind.Y)
            return lambda state, at, values: _known(state.points)[part][side]


def _known(value: Any) -> Any:
    assert value is not None
    return value


def _expression(text: str, slice: Slice) -> Valued:
    model = slice.model
    known = (*model.angles, *model.reals, *slice.axis_names, *slice.parameters)
    try:
        tree = parse(text)
        for name in names_of(tree):
            if name not in known:
                hint = did_you_mean(name, (*known, *quantities(model)))
                raise ConfigError(f"{name!r} is neither an unknown nor a parameter{hint}", key=OPTION)
        with np.errstate(all="ignore"):
            # where no quotient of names is zero by chance
            generic = {name: np.float64(math.fmod(math.sqrt(2) * (k + 1), 1)) for k, name in enumerate(known)}
            anywhere = interpret(tree, _Arrays(generic))
        if np.isinf(anywhere):
            raise ConfigError(f"{text[:60]!r} divides by zero", key=OPTION)
    except ExpressionError as error:
        raise ConfigError(f"{text!r}: {error.message}", key=OPTION) from error
    except (OverflowError, ValueError) as error:  # an exponent may be infinite, or no number
        raise ConfigError(f"{text[:60]!r} has a number beyond doubles, 1.8e308", key=OPTION) from error

    def values(_state: State, at: Floats, given: Mapping[str, Any]) -> Floats:
        unknowns = dict(zip((*model.angles, *model.reals), at, strict=True))
        with np.errstate(all="ignore"):
            found: Floats = np.broadcast_to(interpret(tree, _Arrays({**given, **unknowns})), at.shape[1:]) + 0.0
        found[np.isinf(found)] = np.nan  # there the expression has no value
        return found

    return Valued(text.strip(), "", values)


class _Arrays:
    """The interpretation of an expression in arrays; quotients and functions of any argument are allowed."""

    def __init__(self, values: Mapping[str, Any]):
        self.values = values

    def number(self, number: Number) -> Any:
        return np.float64(number.value)

    def name(self, name: Name) -> Any:
        return self.values[name.name]

    def call(self, call: Call) -> Any:
        return (np.cos if call.function == "cos" else np.sin)(interpret(call.argument, self))

    def negative(self, value: Any) -> Any:
        return -value

    def joined(self, left: Any, step: Step, right: Any) -> Any:
        match step.operator:
            case "+":
                return left + right
            case "-":
                return left - right
            case "*":
                return left * right
            case _:
                return left / right

    def power(self, base: Any, power: Power, exponent: Any) -> Any:
        if not np.ndim(exponent) and math.isclose(float(exponent), round(float(exponent))):
            return base ** round(float(exponent))
        return base**exponent
