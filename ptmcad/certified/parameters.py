"""The parameters of a slice as formulas in its two axes.

Guarantee: every coefficient is exact; variables 0 and 1 are the axes, 2 and 3 the angles th1 and th2.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.certified.formula import Formula, Graph
from ptmcad.certified.mechanism import NAMES, Mechanism, mechanism
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, Term, axis

PHI_UNIT = 4
"""The search bisects the widest variable; with this factor it bisects phi, which follows from th1 and th2, later."""


def expression_formula(graph: Graph, expression: Expression) -> Formula:
    """A rational function of the axes, by Horner's rule in the first axis over polynomials in the second."""
    return _polynomial(graph, expression.numerator) / _polynomial(graph, expression.denominator)


def _polynomial(graph: Graph, terms: tuple[Term, ...]) -> Formula:
    rows: dict[int, dict[int, Fraction]] = {}
    for i, j, c in terms:
        rows.setdefault(i, {})[j] = c
    x, y = graph.variable(0), graph.variable(1)
    coefficients = {i: _horner(graph, {j: graph.constant(c) for j, c in row.items()}, y) for i, row in rows.items()}
    return _horner(graph, coefficients, x)


def _horner(graph: Graph, coefficients: Mapping[int, Formula], variable: Formula) -> Formula:
    value = graph.constant(0)
    for power in range(max(coefficients, default=0), -1, -1):
        value = value * variable + coefficients.get(power, 0)
    return value


def parameter_formulas(graph: Graph, slice: Slice) -> dict[str, Formula]:
    """All of `ptmcad.certified.mechanism.NAMES`; free lengths that the slice does not have are zero."""
    zero = graph.constant(0)
    return {
        name: expression_formula(graph, slice.parameters[name]) if name in slice.parameters else zero for name in NAMES
    }


def slice_mechanism(graph: Graph, slice: Slice, *, phi: bool = False, factored: bool = True) -> Mechanism:
    """The slice's mechanism in variables x, y, th1, th2 and, if asked for, v, which is phi / PHI_UNIT.

    ``factored`` says whether the unloaded mechanism's factor rho may be left out where rho is positive.
    """
    direction = PHI_UNIT * graph.variable(4) if phi else None
    values = parameter_formulas(graph, slice)
    return mechanism(
        graph, values, graph.variable(2), graph.variable(3), direction, positive_base=factored and positive_base(slice)
    )


def positive_base(slice: Slice) -> bool:
    """Whether rho is certainly positive in the open window."""
    rho = slice.parameters["rho"]
    # an axis is positive in the open window; of other expressions only constants are known to be
    return rho in (axis(0), axis(1)) or (rho.is_constant and rho.constant() > 0)
