"""Equations that are linear in an axis, solved for it: what value the axis has at solutions, without a search for it.

Guarantee: a solution satisfies rest + slope v = 0 for each `Quotient` of its system, v being the axis; neither formula
has v in it. (Lemma 21 of docs/soundness.md.)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ptmcad.formulas.graph import Formula, Operation


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
    axes : unknowns that the configuration tells, as it tells loads, stiffnesses and free lengths. To solve for an axis
        that springs' directions depend on is sound, and no use: the direction of a short one may be anything.
    """
    formulas = list(dict.fromkeys(vanishing))
    return tuple(q for axis in axes for formula in formulas for q in _quotient(formula, axis))


def occurs(variable: int, formula: Formula) -> bool:
    """Whether the formula has the variable in it."""
    return any(n.operation is Operation.VARIABLE and n.variable == variable for n in _nodes(formula))


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
        return with_formula(variable, formula.graph.constant(0), formula)
    except ZeroDivisionError:
        return None


def with_formula(variable: int, value: Formula, formula: Formula) -> Formula:
    """The formula with another one in place of a variable.

    Raises
    ------
    ZeroDivisionError
        Where something would be divided by the constant zero.
    """
    made: dict[int, Formula] = {}
    for node in _nodes(formula):
        a, b = (None if operand is None else made[operand.number] for operand in (node.a, node.b))
        if node.operation is Operation.VARIABLE and node.variable == variable:
            made[node.number] = value
        elif (a, b) == (node.a, node.b):
            made[node.number] = node
        elif node.operation is Operation.DIVIDE and b is not None and b.value == 0:
            raise ZeroDivisionError
        else:
            made[node.number] = _again(node, a, b)
    return made[formula.number]


def _again(node: Formula, a: Formula | None, b: Formula | None) -> Formula:
    """The node's operation on other operands, with constants folded."""
    assert a is not None
    operation = node.operation
    if b is None:
        simple = {Operation.NEGATE: a.__neg__, Operation.SQUARE: a.squared, Operation.SINE: a.sin}
        return simple.get(operation, a.cos)()
    if operation is Operation.ADD:
        return a + b
    if operation is Operation.SUBTRACT:
        return a - b
    if operation is Operation.MULTIPLY:
        return a * b
    if operation is Operation.DIVIDE:
        return a / b
    return node.graph.node(operation, a, b)


def _nodes(formula: Formula) -> list[Formula]:
    """All nodes that the formula needs; operands have smaller numbers and come first."""
    found: dict[int, Formula] = {}
    waiting = [formula]
    while waiting:
        node = waiting.pop()
        if node.number not in found:
            found[node.number] = node
            waiting += [operand for operand in (node.a, node.b) if operand is not None]
    return [found[number] for number in sorted(found)]
