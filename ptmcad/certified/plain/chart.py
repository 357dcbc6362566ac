"""The formulas of a problem: equations, Hessian and determinant, with the direction of one spring as a variable or not.

Guarantee: the formulas are those of the potential wherever every spring with a free length has a length. Where a spring
has none, its direction stands for every unit vector, so that an equilibrium that comes from nearby is not lost.

With u_s = d_s/|d_s| the equations are dV/dq_i - sum of K_s u_s . dd_s/dq_i, with closed loops T . grad V - sum of
K_s u_s . (T . grad) d_s beside those that close the loops, and the Hessian, or Jacobian, has poles |d_s| = 0. In the
chart of spring s its direction is (cos phi, sin phi) with phi an unknown, and d_s x u = 0 an equation more. Then all is
smooth at |d_s| = 0, and by Schur's complement the Jacobian of the larger system has the determinant -+ |d_s| det H.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from ptmcad.certified.formula import Formula, Graph, direction, length
from ptmcad.certified.parameters import expression_formula
from ptmcad.certified.plain.problem import FIRST, Problem

Matrix = tuple[tuple[Formula, ...], ...]


@dataclass(frozen=True, slots=True)
class Chart:
    """Formulas in the axes, the unknowns and, with a spring in its chart, phi as the last variable.

    Attributes
    ----------
    equations : one for each unknown.
    hessian : their derivatives by the unknowns, with phi fixed where there is one; no Hessian but a Jacobian where they
        are not those of a potential.
    lengths : |d_s| of each cone.
    balances : formulas that vanish at every equilibrium, smooth where one spring has no length, unlike the equations:
        the equations solved for its unit vector u_s, which has the length 1.
    turning : of the spring in its chart d_s x u, d_s . u and the derivatives of d_s x u by the unknowns; empty without.
    """

    equations: tuple[Formula, ...]
    hessian: Matrix
    lengths: tuple[Formula, ...]
    balances: tuple[Formula, ...]
    turning: tuple[Formula, ...]


def chart(problem: Problem, short: int | None = None) -> Chart:
    """The formulas of a problem in a graph of their own.

    Parameters
    ----------
    short : number of the cone whose direction is a variable.
    """
    graph = Graph()
    unknowns = [graph.variable(k) for k in problem.variables]
    size = len(unknowns)
    smooth = [f.formula(graph, unknowns) for f in problem.equations]
    entries = [[f.derivative(j).formula(graph, unknowns) for j in range(size)] for f in problem.equations]
    pulls = [expression_formula(graph, cone.pull) for cone in problem.cones]
    vectors = [tuple(d.formula(graph, unknowns) for d in cone.difference) for cone in problem.cones]
    slopes = [
        [tuple(d.derivative(i).formula(graph, unknowns) for d in cone.difference) for i in range(size)]
        for cone in problem.cones
    ]
    weights = [[tuple(w.formula(graph, unknowns) for w in pair) for pair in cone.weights] for cone in problem.cones]
    units = [(direction(dx, dy), direction(dy, dx)) for dx, dy in vectors]
    turning: tuple[Formula, ...] = ()
    if short is not None:
        phi = graph.variable(FIRST + size)
        ux, uy = units[short] = (phi.cos(), phi.sin())
        dx, dy = vectors[short]
        turning = (dx * uy - dy * ux, dx * ux + dy * uy, *(a * uy - b * ux for a, b in slopes[short]))
    parts = [
        [pull * (ux * a + uy * b) for a, b in pairs]
        for pull, (ux, uy), pairs in zip(pulls, units, weights, strict=True)
    ]
    for i in range(size):
        for part in parts:
            for j in range(size):
                entries[i][j] = entries[i][j] - graph.derivative(part[i], problem.variables[j])
    balances = [
        # the rest is put together without the spring: taken off again, its part would leave an interval's width behind
        _balance(pulls[s], _without(smooth, parts[:s] + parts[s + 1 :]), weights[s], pair)
        for s in range(len(pulls))
        for pair in (() if problem.closing else combinations(range(size), 2))
    ]
    equations = _without(smooth, parts)
    return Chart(
        tuple(equations),
        tuple(map(tuple, entries)),
        tuple(length(dx, dy) for dx, dy in vectors),
        tuple(balances),
        turning,
    )


def _without(smooth: Sequence[Formula], parts: Sequence[Sequence[Formula]]) -> list[Formula]:
    """The smooth part of each equation less the springs' parts."""
    total = list(smooth)
    for part in parts:
        total = [whole - piece for whole, piece in zip(total, part, strict=True)]
    return total


def _balance(
    pull: Formula, rest: Sequence[Formula], slopes: Sequence[Sequence[Formula]], pair: tuple[int, int]
) -> Formula:
    """|adj(A) r|^2 - (K det A)^2, with A the slopes of d by two unknowns and r = K A u the rest of their equations."""
    i, j = pair
    (ai, bi), (aj, bj) = slopes[i], slopes[j]
    x, y = bj * rest[i] - bi * rest[j], ai * rest[j] - aj * rest[i]
    return x.squared() + y.squared() - (pull * (ai * bj - aj * bi)).squared()


def extended_determinant(at: Chart, problem: Problem) -> Formula:
    """The determinant of the equations and of d x u by the unknowns and phi: det H times -+ |d|, and smooth."""
    graph = at.equations[0].graph
    phi = FIRST + len(problem.unknowns)
    _, along, *turned = at.turning
    rows = [(*row, graph.derivative(f, phi)) for row, f in zip(at.hessian, at.equations, strict=True)]
    return determinant((*rows, (*turned, along)))


def determinant(matrix: Matrix) -> Formula:
    """By Laplace's expansion; for the few rows that there are."""
    if len(matrix) == 1:
        return matrix[0][0]
    total = matrix[0][0].graph.constant(0)
    for j, entry in enumerate(matrix[0]):
        minor = determinant(tuple(row[:j] + row[j + 1 :] for row in matrix[1:]))
        total = total + entry * minor if j % 2 == 0 else total - entry * minor
    return total


def principal_minors(hessian: Matrix) -> list[Formula]:
    """All but the determinant itself; none is negative where the Hessian is positive semidefinite."""
    size = len(hessian)
    return [
        determinant(tuple(tuple(hessian[i][j] for j in chosen) for i in chosen))
        for order in range(1, size)
        for chosen in combinations(range(size), order)
    ]
