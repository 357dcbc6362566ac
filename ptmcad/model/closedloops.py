"""Closed loops, as equations: each loop is cut at a bar, which keeps its length. With one degree of
freedom left:

Guarantee: off the places where a loop folds flat the solutions are the equilibria, and the stable
ones are the strict minima of the energy under the loops' conditions.

Let g_1 .. g_m be squared distances less squared lengths, in m + 1 unknowns, and T the vector of the
maximal minors of their derivatives, with signs: it is tangent to g = 0 and vanishes only where
these derivatives are dependent, where a loop folds flat. Along the curve g = 0, run through with
velocity T, the energy has the derivative E = T . grad U, and where that is zero the second
derivative T . grad E: which is the determinant of the derivatives of g_1 .. g_m and E. So an
equilibrium is a zero of g and E, simple where the determinant is not zero, and stable where it is
positive. Where T vanishes E does, and the determinant: such places are on the curves at which
solutions meet.

A spring with a free length takes K |d| off the energy, K its stiffness times that length and d
between its ends, which takes K (T . grad) |d| off E. The equations here are those without it, which
exact algebra solves where no spring has a free length; `ptmcad.model.compile` and
`ptmcad.certified.plain.problem` take it off.

With several degrees of freedom left there is one multiplier for each closing bar. Let
g_i = (d_i^2 - l_i^2)/2 with d_i the distance of the ends of closing bar i and l_i its length, in n
unknowns u, and U the energy. An equilibrium is a zero of g and of the derivatives of U + sum t_i
g_i by u; t_i is the bar's tension divided by its length. With B(s) the symmetric matrix of the
second derivatives of this sum by u, s added on the diagonal, bordered by the derivatives of g,

    det B(s) = (-1)^m (c_0 s^f + ... + c_(f-1) s + c_f),

m bars, f = n - m: c_0 > 0 where the derivatives of g are independent, and the roots of the
polynomial, all real, are the eigenvalues of the Hessian on the loops' tangent space with the other
sign. So that is positive definite where c_1, ..., c_f are all positive (Descartes' rule). The
determinant of the Jacobian of the equations is det B(0), so that c_f is that but for its sign. A
tension that leaves every bounded set is noticed, as it is an unknown on the line: loops fold flat
on curves at infinity, which are part of the variety.

Source: elementary (Lagrange); for the bordered determinant Mann, Amer. Math. Monthly 50 (1943).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

from ptmcad.formulas.graph import Formula, cofactors, determinant, gradient

Row = tuple[Formula, ...]


Conditions = tuple[Row, Row, Row, Row]
"""What holds at equilibria of closed loops, or of angles that follow others: one equation for each
unknown; what is positive at stable solutions; T, where one degree of freedom of closed loops is
left; and what is positive at all solutions.
"""


def conditions(closing: Row, forces: Row, unknowns: Sequence[int], tensions: Row) -> Conditions:
    """What holds at equilibria.

    Parameters
    ----------
    closing : squared distances of closing bars' ends, less their squared lengths.
    forces : the energy's derivatives by the unknowns, less the moments.
    unknowns : their numbers among the variables.
    tensions : further unknowns, where several degrees of freedom are left.
    """
    if tensions:
        return _stationary(closing, forces, unknowns, tensions)
    rows = [gradient(g, unknowns) for g in closing]
    tangent = cofactors(rows)
    slope = dot(tangent, forces)
    stable = determinant([*rows, gradient(slope, unknowns)])
    return (*closing, slope), (stable,), tangent, ()


def _stationary(closing: Row, forces: Row, unknowns: Sequence[int], tensions: Row) -> Conditions:
    """The multipliers' equations and the conditions c_1, ..., c_f for stability."""
    halves = tuple(g / 2 for g in closing)
    rows = [gradient(g, unknowns) for g in halves]
    columns = list(zip(*rows, strict=True))
    pulls = tuple(
        force + dot(tensions, column) for force, column in zip(forces, columns, strict=True)
    )
    zero = (closing[0].graph.constant(0),) * len(closing)
    matrix = [(*gradient(p, unknowns), *column) for p, column in zip(pulls, columns, strict=True)]
    matrix += [(*row, *zero) for row in rows]
    return (*pulls, *halves), tuple(_definite(matrix, len(closing))), (), ()


def _definite(matrix: Sequence[Row], bars: int) -> Iterator[Formula]:
    """c_k is the sum of the principal minors with the border and k + m of the other rows, but for
    its sign.
    """
    count = len(matrix) - bars
    border = tuple(range(count, len(matrix)))
    for k in range(1, count - bars + 1):
        kept = [(*chosen, *border) for chosen in combinations(range(count), k + bars)]
        minors = (determinant([tuple(matrix[i][j] for j in rows) for i in rows]) for rows in kept)
        total = sum(minors, start=matrix[0][0].graph.constant(0))
        yield -total if bars % 2 else total


def dot(one: Sequence[Formula], other: Sequence[Formula]) -> Formula:
    """The sum of products, of at least one."""
    return sum((a * b for a, b in zip(one, other, strict=True)), start=one[0].graph.constant(0))
