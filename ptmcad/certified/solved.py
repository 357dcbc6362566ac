"""Equations that are linear in an axis, solved for it: what value the axis has at solutions,
without a search for it.

Guarantee: a solution satisfies rest + slope v = 0 for each `Quotient` of its system, v being the
axis; neither formula has v in it. (Lemma 21 of docs/soundness.md.)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ptmcad.formulas.graph import Formula, Operation
from ptmcad.formulas.values import nodes_of, substituted


class Quotient(NamedTuple):
    """A variable that is -rest/slope at solutions, where the slope is not zero."""

    variable: int
    rest: Formula
    slope: Formula


def quotients(vanishing: Iterable[Formula], axes: Iterable[int]) -> tuple[Quotient, ...]:
    """For each axis the formulas, of those that vanish at solutions, that are linear in it.

    Parameters
    ----------
    vanishing : formulas without a `meet` that may be empty.
    axes : unknowns that the configuration tells, as it tells loads, stiffnesses and free lengths.
        To solve for an axis that springs' directions depend on is sound, and no use: the direction
        of a short one may be anything.
    """
    formulas = list(dict.fromkeys(vanishing))
    return tuple(q for axis in axes for formula in formulas for q in _quotient(formula, axis))


def occurs(variable: int, formula: Formula) -> bool:
    """Whether the formula has the variable in it."""
    return any(
        n.operation is Operation.VARIABLE and n.variable == variable for n in nodes_of([formula])
    )


def _quotient(formula: Formula, axis: int) -> Iterator[Quotient]:
    graph = formula.graph
    slope = graph.derivative(formula, axis)
    # a slope that is zero nowhere for the graph's rules may be so: it is left to the search
    if slope.value != 0 and not occurs(axis, slope):
        rest = _without(axis, formula)
        if rest is not None:
            yield Quotient(axis, rest, slope)


def _without(variable: int, formula: Formula) -> Formula | None:
    """The formula with zero in place of the variable; None where that would be a division by zero."""
    try:
        return substituted(formula, {variable: formula.graph.constant(0)})
    except ZeroDivisionError:
        return None
