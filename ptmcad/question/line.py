"""A line of a slice: one axis varies over its window, the other has a value.

Guarantee: exact; on the line every parameter is a rational function of the first axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from ptmcad.errors import A_SLICE, ConfigError, ExpressionError, expect
from ptmcad.formulas.graph import Graph, expression_formula
from ptmcad.model import Model
from ptmcad.model.compile import CompiledSystem, compiled_with
from ptmcad.question.slice import Axis, Slice, have_free_lengths, without_free_lengths
from ptmcad.text.expressions import Expression, Expressions, axis, constant, values_at
from ptmcad.text.numerals import Numbers, shortest_text
from ptmcad.text.parsing import number_for


@dataclass(frozen=True, slots=True)
class Line:
    """The part of a slice that lies on a line: parameters as expressions in ``along``, the first
    axis.
    """

    along: Axis
    at: Numbers
    parameters: Expressions
    model: Model

    def values(self, value: Fraction) -> dict[str, Fraction]:
        """The parameters at a value of the axis that varies."""
        return values_at(self.parameters, value)

    def place(self, value: Fraction) -> str:
        """A point of the line in words."""
        fixed = (f"{name} = {shortest_text(v)}" for name, v in self.at.items())
        return ", ".join([f"{self.along.name} = {value}", *fixed])


def varying_axis(slice: Slice, along: str, at: Mapping[str, Any]) -> tuple[int, str, Fraction]:
    """The number of the axis that varies on a line, and the other axis with its value.

    Raises
    ------
    ConfigError
        When ``along`` is no axis, or ``at`` does not name exactly the other one with an exact
        number.
    """
    expect(slice, Slice, "slice", A_SLICE)
    names = slice.axis_names
    expect(along, str, "along", f"an axis of the slice, {names[0]} or {names[1]}")
    expect(at, Mapping, "at", "a mapping of the other axis to its value")
    if along not in names:
        raise ConfigError(
            f"{along} is not an axis of the slice: choose {names[0]} or {names[1]}", key="along"
        )
    varying = names.index(along)
    other = names[1 - varying]
    if set(at) != {other}:
        given = ", ".join(map(str, at)) or "nothing"
        raise ConfigError(
            f"a line along {along} needs a value of {other} and of nothing else, not of {given}",
            key="at",
        )
    return varying, other, number_for(f"at {other}", at[other])


def line_of(slice: Slice, along: str, at: Mapping[str, Any], *, free: bool = False) -> Line:
    """The line of a slice on which one axis varies and the other is fixed.

    Parameters
    ----------
    free : whether springs may have a free length on it.

    Raises
    ------
    ConfigError
        When ``along`` is no axis, ``at`` does not name exactly the other one, its value is not an
        exact number, a parameter is not defined on the line, or springs have a free length on it
        that they may not have.
    """
    varying, other, value = varying_axis(slice, along, at)
    try:
        parameters = on_line(slice, varying, value)
    except ExpressionError as error:
        raise ConfigError(str(error), key=f"at {other}") from error
    if not free:
        parameters = without_free_lengths(
            slice.model,
            parameters,
            "exact ends are",
            "ptmcad range with --at alone encloses the ends",
        )
    return Line(slice.axes[varying], {other: value}, parameters, slice.model)


def on_line(slice: Slice, varying: int, value: Fraction) -> dict[str, Expression]:
    """The parameters of a slice on the line where the other axis has a value, in the first axis.

    Raises
    ------
    ExpressionError
        When one has a pole all along the line.
    """
    return {
        name: _restricted(expression, varying, value)
        for name, expression in slice.parameters.items()
    }


def _restricted(expression: Expression, varying: int, value: Fraction) -> Expression:
    def along(terms: tuple[tuple[int, int, Fraction], ...]) -> Expression:
        total = constant(0)
        for term in terms:
            powers, c = term[:2], term[2]
            total = total + axis(0) ** powers[varying] * (c * value ** powers[1 - varying])
        return total

    return along(expression.numerator) / along(expression.denominator)


def compiled_on(model: Model, parameters: Expressions) -> CompiledSystem:
    """A model's formulas on a line: variable 0 is the axis that varies, the next ones are the
    unknowns.

    Parameters
    ----------
    parameters : as of `Line`; free lengths that are not among them are zero.
    """
    graph = Graph()
    given = {
        name: expression_formula(graph, parameters[name])
        if name in parameters
        else graph.constant(0)
        for name in model.variables
    }
    followers = () if model.whole is None else tuple(model.whole.followers)
    unknowns = (*model.angles, *model.reals, *followers)
    return compiled_with(
        model, given | {name: graph.variable(k) for k, name in enumerate(unknowns, 1)}
    )


def has_free_lengths(slice: Slice, along: str, at: Mapping[str, Any]) -> bool:
    """Whether a spring has a free length on the line; where none has, algebra answers, or refuses
    the line.
    """
    try:
        varying, _, value = varying_axis(slice, along, at)
        return have_free_lengths(slice.model, on_line(slice, varying, value))
    except (ConfigError, ExpressionError):
        return False
