"""The formulas of closed loops with springs of free lengths, with the direction of one spring as a variable or not.

Guarantee: as that of `ptmcad.certified.plain.chart`. The equations that close the loops have no spring in them; in the
last one, the slope of the energy along the loops, T . grad V - sum of K_s u_s . w_s with w_s = (T . grad) d_s, a spring
does not stand by the derivatives of its length. So nothing here is symmetric, and the Jacobian's determinant is written
out: with the chart's equation d_s x u = 0 for a spring that may be short, it is -+ |d_s| times that without.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from ptmcad.certified.formula import Formula, Graph, direction, length
from ptmcad.certified.parameters import expression_formula
from ptmcad.certified.plain.minors import determinant
from ptmcad.certified.plain.problem import FIRST, Problem
from ptmcad.certified.plain.springs import Matrix


@dataclass(frozen=True, slots=True)
class LoopChart:
    """Formulas in the axes, the unknowns and, with a spring in its chart, phi as the last variable.

    Attributes
    ----------
    equations : one for each unknown, those first that close the loops.
    hessian : their derivatives by the unknowns, with phi fixed where there is one; no Hessian but a Jacobian.
    lengths : |d_s| of each cone.
    turning : of the spring in its chart d_s x u, d_s . u and the derivatives of d_s x u by the unknowns; empty without.
    dependent, balances : formulas that vanish at every equilibrium besides the equations; none are known.
    """

    equations: tuple[Formula, ...]
    hessian: Matrix
    lengths: tuple[Formula, ...]
    turning: tuple[Formula, ...]
    dependent: ClassVar[tuple[Formula, ...]] = ()
    balances: ClassVar[tuple[Formula, ...]] = ()

    def determinant(self) -> Formula:
        """Of the Jacobian."""
        return determinant(self.hessian)

    def extended_determinant(self) -> Formula:
        """Of the equations and d x u by the unknowns and phi: the Jacobian's times -+ |d|, and smooth."""
        graph = self.equations[0].graph
        phi = FIRST + len(self.equations)
        _, along, *turned = self.turning
        rows = [(*row, graph.derivative(f, phi)) for row, f in zip(self.hessian, self.equations, strict=True)]
        return determinant((*rows, (*turned, along)))


def loop_chart(problem: Problem, short: int | None = None) -> LoopChart:
    """The formulas of a problem with closed loops in a graph of their own.

    Parameters
    ----------
    short : number of the cone whose direction is a variable.
    """
    graph = Graph()
    unknowns = [graph.variable(k) for k in problem.variables]
    size = len(unknowns)
    smooth = [f.formula(graph, unknowns) for f in problem.equations]
    entries = [[f.derivative(j).formula(graph, unknowns) for j in range(size)] for f in problem.equations]
    for push in problem.pushes:
        strength = push.strength(graph)
        for i, w in enumerate(push.weights):
            smooth[i] = smooth[i] - strength * w.formula(graph, unknowns)
            entries[i] = [r - strength * w.derivative(j).formula(graph, unknowns) for j, r in enumerate(entries[i])]
    vectors = [tuple(d.formula(graph, unknowns) for d in cone.difference) for cone in problem.cones]
    units = [(direction(dx, dy), direction(dy, dx)) for dx, dy in vectors]
    turning: tuple[Formula, ...] = ()
    if short is not None:
        phi = graph.variable(FIRST + size)
        ux, uy = units[short] = (phi.cos(), phi.sin())
        dx, dy = vectors[short]
        slopes = [
            [d.derivative(i).formula(graph, unknowns) for d in problem.cones[short].difference] for i in range(size)
        ]
        turning = (dx * uy - dy * ux, dx * ux + dy * uy, *(a * uy - b * ux for a, b in slopes))
    for cone, (ux, uy) in zip(problem.cones, units, strict=True):
        pull = expression_formula(graph, cone.pull)
        for i, pair in enumerate(cone.weights):
            a, b = (w.formula(graph, unknowns) for w in pair)
            part = pull * (ux * a + uy * b)
            smooth[i] = smooth[i] - part
            for j in range(size):
                entries[i][j] = entries[i][j] - graph.derivative(part, problem.variables[j])
    return LoopChart(tuple(smooth), _rows(entries), tuple(length(dx, dy) for dx, dy in vectors), turning)


def _rows(entries: Sequence[Sequence[Formula]]) -> Matrix:
    return tuple(map(tuple, entries))
