"""Formulas: expressions in variables, shared as nodes of one graph, with exact constants and exact
derivatives; gradients and determinants of a few rows, and rational functions of the two axes.

Guarantee: a node is created once for the same operation on the same nodes; rational constants are
folded exactly; and terms that are zero, such as those of a load or a free length that a slice does
not have, are left out. Determinants are exact identities.

>>> graph = Graph()
>>> x, y = graph.variable(0), graph.variable(1)
>>> f = x.sin() * y + 0 * x
>>> graph.derivative(f, 1) is x.sin()
True
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from fractions import Fraction
from typing import Any

from ptmcad.text.expressions import Expression, Term


class Operation(IntEnum):
    """What a node computes from the nodes a and b."""

    CONSTANT = 0
    VARIABLE = 1
    ADD = 2
    SUBTRACT = 3
    MULTIPLY = 4
    SQUARE = 5
    NEGATE = 6
    SINE = 7
    COSINE = 8
    INVERSE_LENGTH = 9
    """1 / |(a, b)|"""
    DIRECTION = 10
    """a / |(a, b)|: the first coordinate of the unit vector"""
    LENGTH = 11
    """|(a, b)|"""
    MEET = 12
    """a number of which a and b are both formulas, at least where the search looks for solutions"""
    DIVIDE = 13


OPERATORS: Mapping[int, Callable[..., Any]] = {
    Operation.ADD: operator.add,
    Operation.SUBTRACT: operator.sub,
    Operation.MULTIPLY: operator.mul,
    Operation.NEGATE: operator.neg,
}
"""Those that are Python's in all arithmetics."""
Number = Fraction | int


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Formula:
    """A node of a graph; formulas of one graph combine by the arithmetic operators."""

    graph: Graph
    number: int
    operation: Operation
    a: Formula | None = None
    b: Formula | None = None
    value: Fraction | None = None
    """Of a constant."""
    variable: int = -1

    def __add__(self, other: Formula | Number) -> Formula:
        other = self.graph.formula(other)
        if self.value == 0:
            return other
        if other.value == 0:
            return self
        if self.value is not None and other.value is not None:
            return self.graph.constant(self.value + other.value)
        if other.operation is Operation.NEGATE:
            return self - _operand(other)
        if self.operation is Operation.NEGATE:
            return other - _operand(self)
        return self.graph.node(Operation.ADD, *_sorted(self, other))

    def __sub__(self, other: Formula | Number) -> Formula:
        other = self.graph.formula(other)
        if other.value == 0:
            return self
        if self.value == 0:
            return -other
        if self is other:
            return self.graph.constant(0)
        if self.value is not None and other.value is not None:
            return self.graph.constant(self.value - other.value)
        if other.operation is Operation.NEGATE:
            return self + _operand(other)
        return self.graph.node(Operation.SUBTRACT, self, other)

    def __neg__(self) -> Formula:
        if self.value is not None:
            return self.graph.constant(-self.value)
        if self.operation is Operation.NEGATE:
            return _operand(self)
        if self.operation is Operation.SUBTRACT:
            assert self.a is not None and self.b is not None
            return self.b - self.a
        return self.graph.node(Operation.NEGATE, self)

    def __mul__(self, other: Formula | Number) -> Formula:
        other = self.graph.formula(other)
        for factor, rest in ((self, other), (other, self)):
            if factor.value == 0:
                return factor
            if factor.value == 1:
                return rest
            if factor.value == -1:
                return -rest
        if self.value is not None and other.value is not None:
            return self.graph.constant(self.value * other.value)
        if self.operation is Operation.NEGATE:
            return -(_operand(self) * other)
        if other.operation is Operation.NEGATE:
            return -(self * _operand(other))
        if self is other:
            return self.squared()
        return self.graph.node(Operation.MULTIPLY, *_sorted(self, other))

    def __truediv__(self, other: Formula | Number) -> Formula:
        other = self.graph.formula(other)
        if other.value is not None:
            return self * (1 / other.value)
        return self.graph.node(Operation.DIVIDE, self, other)

    def __radd__(self, other: Number) -> Formula:
        return self + other

    def __rsub__(self, other: Number) -> Formula:
        return self.graph.constant(other) - self

    def __rmul__(self, other: Number) -> Formula:
        return self * other

    def __rtruediv__(self, other: Number) -> Formula:
        return self.graph.constant(other) / self

    def squared(self) -> Formula:
        if self.value is not None:
            return self.graph.constant(self.value**2)
        if self.operation is Operation.NEGATE:
            return _operand(self).squared()
        return self.graph.node(Operation.SQUARE, self)

    def sin(self) -> Formula:
        return self.graph.node(Operation.SINE, self)

    def cos(self) -> Formula:
        return self.graph.node(Operation.COSINE, self)


@dataclass(slots=True)
class Graph:
    """All formulas over the same variables."""

    nodes: list[Formula] = field(default_factory=list)
    _known: dict[tuple[object, ...], Formula] = field(default_factory=dict)
    _derivatives: dict[tuple[int, int], Formula] = field(default_factory=dict)

    def constant(self, value: Number) -> Formula:
        return self.node(Operation.CONSTANT, value=Fraction(value))

    def variable(self, number: int) -> Formula:
        return self.node(Operation.VARIABLE, variable=number)

    def formula(self, value: Formula | Number) -> Formula:
        return value if isinstance(value, Formula) else self.constant(value)

    def node(
        self,
        operation: Operation,
        a: Formula | None = None,
        b: Formula | None = None,
        value: Fraction | None = None,
        variable: int = -1,
    ) -> Formula:
        """The node of this operation; an old one if there is one."""
        key = (operation, a and a.number, b and b.number, value, variable)
        known = self._known.get(key)
        if known is None:
            known = Formula(self, len(self.nodes), operation, a, b, value, variable)
            self.nodes.append(known)
            self._known[key] = known
        return known

    def derivative(self, formula: Formula, variable: int) -> Formula:
        """The partial derivative. That of `meet` is its first operand's: the operands have to be
        equal functions.
        """
        key = (formula.number, variable)
        known = self._derivatives.get(key)
        if known is None:
            known = self._derivatives[key] = self._differentiate(formula, variable)
        return known

    def _differentiate(self, f: Formula, variable: int) -> Formula:
        operation = f.operation
        if operation is Operation.CONSTANT:
            return self.constant(0)
        if operation is Operation.VARIABLE:
            return self.constant(int(f.variable == variable))
        assert f.a is not None
        da = self.derivative(f.a, variable)
        if operation is Operation.NEGATE:
            return -da
        if operation is Operation.SQUARE:
            return 2 * (f.a * da)
        if operation is Operation.SINE:
            return f.a.cos() * da
        if operation is Operation.COSINE:
            return -(f.a.sin() * da)
        if operation is Operation.MEET:
            return da
        assert f.b is not None
        db = self.derivative(f.b, variable)
        if operation is Operation.ADD:
            return da + db
        if operation is Operation.SUBTRACT:
            return da - db
        if operation is Operation.MULTIPLY:
            return da * f.b + f.a * db
        if operation is Operation.DIVIDE:
            return (da - f * db) / f.b
        # the vector (a, b) = length * (ux, uy) turns and stretches
        ux, uy, inverse = direction(f.a, f.b), direction(f.b, f.a), inverse_length(f.a, f.b)
        if operation is Operation.DIRECTION:
            return -(uy * (inverse * (ux * db - uy * da)))
        stretch = ux * da + uy * db
        return stretch if operation is Operation.LENGTH else -(inverse.squared() * stretch)


def length(x: Formula, y: Formula) -> Formula:
    """|(x, y)|"""
    return x.graph.node(Operation.LENGTH, x, y)


def inverse_length(x: Formula, y: Formula) -> Formula:
    """1/|(x, y)|, positive infinity at the origin."""
    return x.graph.node(Operation.INVERSE_LENGTH, x, y)


def direction(x: Formula, y: Formula) -> Formula:
    """x/|(x, y)|, the first coordinate of the unit vector; any number from -1 to 1 at the origin."""
    return x.graph.node(Operation.DIRECTION, x, y)


def meet(a: Formula, b: Formula) -> Formula:
    """A number that both a and b enclose; where their enclosures are disjoint, the box holds no
    solution.
    """
    return a.graph.node(Operation.MEET, a, b)


def _operand(formula: Formula) -> Formula:
    assert formula.a is not None
    return formula.a


def _sorted(a: Formula, b: Formula) -> tuple[Formula, Formula]:
    return (a, b) if a.number <= b.number else (b, a)


Rows = Sequence[tuple[Formula, ...]]


def gradient(f: Formula, variables: Iterable[int]) -> tuple[Formula, ...]:
    """The derivatives by the variables of these numbers."""
    return tuple(f.graph.derivative(f, k) for k in variables)


def determinant(matrix: Rows) -> Formula:
    """Of a square matrix with at least one row."""
    if len(matrix) == 1:
        return matrix[0][0]
    total = matrix[0][0].graph.constant(0)
    for j, entry in enumerate(matrix[0]):
        minor = determinant(_without(matrix[1:], j))
        total = total + entry * minor if j % 2 == 0 else total - entry * minor
    return total


def cofactors(rows: Rows) -> tuple[Formula, ...]:
    """What a further row's entries are multiplied by in the determinant: a vector at right angles
    to all rows.

    Parameters
    ----------
    rows : one fewer than columns, and at least one.
    """
    minors = (determinant(_without(rows, k)) for k in range(len(rows) + 1))
    return tuple(minor if (len(rows) + k) % 2 == 0 else -minor for k, minor in enumerate(minors))


def _without(rows: Rows, column: int) -> Rows:
    return [row[:column] + row[column + 1 :] for row in rows]


def expression_formula(graph: Graph, expression: Expression) -> Formula:
    """A rational function of the axes, by Horner's rule in the first axis over polynomials in the
    second.
    """
    return _polynomial(graph, expression.numerator) / _polynomial(graph, expression.denominator)


def _polynomial(graph: Graph, terms: tuple[Term, ...]) -> Formula:
    rows: dict[int, dict[int, Fraction]] = {}
    for i, j, c in terms:
        rows.setdefault(i, {})[j] = c
    x, y = graph.variable(0), graph.variable(1)
    coefficients = {
        i: _horner(graph, {j: graph.constant(c) for j, c in row.items()}, y)
        for i, row in rows.items()
    }
    return _horner(graph, coefficients, x)


def _horner(graph: Graph, coefficients: Mapping[int, Formula], variable: Formula) -> Formula:
    value = graph.constant(0)
    for power in range(max(coefficients, default=0), -1, -1):
        value = value * variable + coefficients.get(power, 0)
    return value
