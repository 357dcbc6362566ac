"""Rational functions of the two axes as formulas.

Guarantee: every coefficient is exact; variables 0 and 1 are the axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.formulas.graph import Formula, Graph
from ptmcad.text.expressions import Expression, Term


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
