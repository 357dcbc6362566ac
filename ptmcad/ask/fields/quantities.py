"""What can be asked of an equilibrium, as a number: energy, stiffness, forces, lengths, unknowns, or an expression.

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
from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.mechanism import Mechanism, Model
from ptmcad.question.slice import Slice
from ptmcad.text.syntax import did_you_mean, parse
from ptmcad.text.tree import Call, Name, Number, Power, Step, interpret, names_of

BARRIER = "barrier"
Values = Callable[[State, Floats, Mapping[str, Any]], Floats]
"""From a state, its points of shape (n, *S), angles first, and the values of parameters and axes."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """What is shown: its name as it was asked for, its unit in words, and its values."""

    name: str
    unit: str
    values: Values


def quantity_of(text: str, slice: Slice) -> Quantity:
    """The quantity of this name.

    ``energy``, ``stiffness`` (the least eigenvalue of the Hessian), ``barrier``, ``force:SPRING``, ``length:SPRING``,
    ``angle:UNKNOWN`` in degrees, ``x:POINT``, ``y:POINT``, or an expression in the unknowns (angles in radians),
    parameters and axes.

    Raises
    ------
    ConfigError
        For a name or an expression that has no meaning here.
    """
    model = slice.model
    mechanism = model if isinstance(model, Mechanism) else None
    kind, colon, name = (part.strip() for part in text.partition(":"))
    if text.strip() in ("energy", "stiffness", BARRIER):
        return _of_energy(text.strip(), model)
    if not colon:
        return _expression(text, slice)
    if kind in ("force", "length"):
        known = tuple(mechanism.spring_numbers) if mechanism else ()
    elif kind in ("x", "y"):
        known = tuple(mechanism.points) if mechanism else ()
    elif kind == "angle":
        known = model.angles
    else:
        raise ConfigError(f"{kind!r} is not among force, length, angle, x and y", key="--value")
    if name not in known:
        what = {"force": "spring", "length": "spring", "angle": "unknown angle"}.get(kind, "point")
        there = f"they are {', '.join(known)}" if known else "there are none"
        raise ConfigError(
            f"{model.name} has no {what} {name!r}{did_you_mean(name, known) or f': {there}'}", key="--value"
        )
    unit = {"force": "force", "angle": "degrees"}.get(kind, "length")
    return Quantity(f"{kind}:{name}", unit, _named(kind, name, model))


def _of_energy(name: str, model: Model) -> Quantity:
    if not model.has_potential:
        raise ConfigError(f"solutions of {model.name} have no energy", key="--value")
    unit = "force × length" if isinstance(model, Mechanism) else ""
    if name == "stiffness":
        return Quantity(name, unit, lambda state, at, values: eigenvalues(state.jacobian)[0])
    # of a barrier, the level from which it is counted
    return Quantity(name, unit, lambda state, at, values: _known(state.energy))


def _known(value: Any) -> Any:
    assert value is not None
    return value


def _named(kind: str, name: str, model: Model) -> Values:
    if kind == "angle":
        k = model.angles.index(name)
        return lambda state, at, values: np.degrees(at[k])
    if kind in ("force", "length") and isinstance(model, Mechanism):
        number = model.spring_numbers[name]
        return lambda state, at, values: _known(state.forces if kind == "force" else state.lengths)[number]
    side = 0 if kind == "x" else 1
    return lambda state, at, values: _known(state.points)[name][side]


def _expression(text: str, slice: Slice) -> Quantity:
    model = slice.model
    known = (*model.angles, *model.reals, *slice.axis_names, *slice.parameters)
    try:
        tree = parse(text)
        for name in names_of(tree):
            if name not in known:
                raise ConfigError(
                    f"{name!r} is neither an unknown nor a parameter{did_you_mean(name, known)}", key="--value"
                )
        interpret(tree, _Arrays({name: np.float64(0.5) for name in known}))
    except ExpressionError as error:
        raise ConfigError(f"{text!r}: {error.message}", key="--value") from error

    def values(_state: State, at: Floats, given: Mapping[str, Any]) -> Floats:
        unknowns = dict(zip((*model.angles, *model.reals), at, strict=True))
        with np.errstate(all="ignore"):
            found: Floats = np.broadcast_to(interpret(tree, _Arrays({**given, **unknowns})), at.shape[1:]) + 0.0
        return found

    return Quantity(text.strip(), "", values)


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
