"""Values in floating point of what can be asked of a solution: a quantity of
`ptmcad.ask.quantities`, or an expression.

Guarantee: a name that the model does not have is refused before anything is computed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
from flint import arb

from ptmcad.ask.fields.equations import Floats, ModelState, eigenvalues
from ptmcad.ask.quantities import Quantity, QuantityKind, named, quantities, unit_of, unknown
from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.question.slice import Slice
from ptmcad.text.balls import in_balls
from ptmcad.text.syntax import did_you_mean, parse
from ptmcad.text.tree import Tree, arithmetic, interpret, names_of

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
    # by itself an angle is in radians, as in any expression
    if known is None or known.name in slice.model.angles:
        return _expression(text, slice)
    is_barrier = known.kind is QuantityKind.BARRIER
    return Valued(known.name, unit_of(known, slice), partial(_value, known), is_barrier)


def _value(quantity: Quantity, state: ModelState, at: Floats, _: object) -> Any:
    match quantity.kind:
        case QuantityKind.ENERGY | QuantityKind.BARRIER:
            return state.known_energy
        case QuantityKind.STIFFNESS:
            return eigenvalues(state.jacobian)[0]
        case QuantityKind.FORCE:
            return state.stretches[quantity.number][2]
        case QuantityKind.LENGTH:
            return state.stretches[quantity.number][0]
        case QuantityKind.ANGLE:
            return np.degrees(at[quantity.number])
        case QuantityKind.REAL:
            return at[quantity.number]
        case QuantityKind.X | QuantityKind.Y:
            return state.points[quantity.part][quantity.kind is QuantityKind.Y]


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
        # where no quotient of names is zero by chance
        generic = {
            name: np.float64(math.fmod(math.sqrt(2) * (k + 1), 1)) for k, name in enumerate(known)
        }
        with np.errstate(all="ignore"), suppress(FloatingPointError):
            _in_arrays(tree, generic)
        if not in_balls(tree, {name: arb(value) for name, value in generic.items()}).is_finite():
            raise ConfigError(f"{text[:60]!r} divides by zero", key=OPTION)
    except ExpressionError as error:
        raise ConfigError(f"{text!r}: {error.message}", key=OPTION) from error
    except (OverflowError, ValueError) as error:  # an exponent may be infinite, or no number
        raise ConfigError(
            f"{text[:60]!r} has a number beyond doubles, 1.8e308", key=OPTION
        ) from error

    def values(_state: ModelState, at: Floats, given: Mapping[str, Any]) -> Floats:
        unknowns = dict(zip(model.sorted_unknowns, at, strict=True))
        return _in_doubles(tree, {**given, **unknowns}, at.shape[1:])

    return Valued(text.strip(), "", values)


_TINY = np.finfo(np.float64).tiny
_ENOUGH = 50
"""Bits of a value that is taken for a double."""


def _in_doubles(tree: Tree, given: Mapping[str, Any], shape: tuple[int, ...]) -> Floats:
    """An expression's values: nan where it has none, infinite where no double is near it."""
    try:
        with np.errstate(over="raise", under="raise", divide="ignore", invalid="ignore"):
            found = np.asarray(_in_arrays(tree, given), dtype=float)
            return np.broadcast_to(np.where(np.isfinite(found), found, np.nan), shape) + 0.0
    except FloatingPointError:  # some part of it is beyond doubles at some point
        names = names_of(tree)
        rows = zip(*(np.broadcast_to(given[name], shape).flat for name in names), strict=True)
        points = rows if names else ((),) * math.prod(shape)
        balls = (
            in_balls(tree, {name: arb(float(x)) for name, x in zip(names, point, strict=True)})
            for point in points
        )
        return np.reshape([_double(ball) for ball in balls], shape)


def _double(ball: arb) -> float:
    """The double near a number; nan of none, infinite where there is none near it."""
    if not ball.is_finite():
        return math.nan
    size = abs(float(ball.mid()))
    is_near = ball == 0 or (_TINY <= size < math.inf and ball.rel_accuracy_bits() >= _ENOUGH)
    return float(ball.mid()) if is_near else math.inf


_FUNCTIONS = {"cos": np.cos, "sin": np.sin}


def _in_arrays(tree: Tree, values: Mapping[str, Any]) -> Any:
    """An expression's value in arrays; quotients and functions of any argument are allowed."""
    return interpret(tree, arithmetic(_constant, values, _FUNCTIONS, _power))


def _constant(number: Fraction) -> Any:
    value = np.float64(number)
    if number and abs(value) < _TINY:
        raise FloatingPointError("the number is nearer to zero than doubles are")
    return value


def _power(base: Any, exponent: Any) -> Any:
    whole = not np.ndim(exponent) and math.isclose(float(exponent), round(float(exponent)))
    return base ** round(float(exponent)) if whole else base**exponent
