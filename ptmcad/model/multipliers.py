"""Closed loops with several degrees of freedom left, as equations: with one multiplier for each closing bar.

Guarantee: off the places where loops fold flat the solutions are the equilibria, and the stable ones the strict minima
of the energy under the loops' conditions.

Let g_i = (d_i^2 - l_i^2)/2 with d_i the distance of the ends of closing bar i and l_i its length, in n unknowns u, and
U the energy. An equilibrium is a zero of g and of the derivatives of U + sum t_i g_i by u; t_i is the bar's tension
divided by its length. With B(s) the symmetric matrix of the second derivatives of this sum by u, s added on the
diagonal, bordered by the derivatives of g,

    det B(s) = (-1)^m (c_0 s^f + ... + c_(f-1) s + c_f),

m bars, f = n - m: c_0 > 0 where the derivatives of g are independent, and the roots of the polynomial, all real, are
the eigenvalues of the Hessian on the loops' tangent space with the other sign. So that is positive definite where
c_1, ..., c_f are all positive (Descartes' rule). The determinant of the Jacobian of the equations is det B(0), so that
c_f is that but for its sign.

A tension that leaves every bounded set is noticed, as it is an unknown on the line: loops fold flat on curves at
infinity, which are part of the variety.

Source: Lagrange; for the bordered determinant Mann, Amer. Math. Monthly 50 (1943).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations

from ptmcad.errors import ConfigError
from ptmcad.model.derivative import ZERO, derivative, determinant, negative, total
from ptmcad.model.description import Mechanism
from ptmcad.model.elements import UnknownKind
from ptmcad.text.tree import Chain, Name, Number, Step, Tree

MAX_ENTRIES = 8
"""Rows of the bordered matrix: its minors are multiplied out, and their number grows with the factorial."""


def tensions(mechanism: Mechanism) -> dict[str, UnknownKind]:
    """The further unknowns: a name for each closing bar."""
    names = [f"force_density_{closing.start}{closing.end}" for closing in mechanism.closing]
    taken = {*mechanism.parameters, *mechanism.unknowns}
    if clash := next((name for name in names if name in taken), None):
        raise ConfigError(f"'{clash}' is the name of a closing bar's force density: choose another name", key="closing")
    return dict.fromkeys(names, UnknownKind.REAL)


def stationary(
    forces: Sequence[Tree], conditions: Sequence[Tree], names: Sequence[str], tension: Sequence[str]
) -> tuple[tuple[Tree, ...], tuple[Tree, ...]]:
    """The equations and the conditions c_1, ..., c_f for stability.

    Parameters
    ----------
    forces : the energy's derivatives by the unknowns of these names, less the moments.
    conditions : twice the g_i.

    Raises
    ------
    ConfigError
        When there are too many unknowns and bars.
    """
    count, bars = len(names), len(conditions)
    if count + bars > MAX_ENTRIES:
        raise ConfigError(
            f"{count} unknowns and {bars} closing bars: with several degrees of freedom left they may be {MAX_ENTRIES} "
            "in all",
            key="closing",
        )
    halves = [_half(g) for g in conditions]
    rows = [[derivative(g, name) for name in names] for g in halves]
    pulls = [
        total(force, *(_product(Name(t), row[k]) for t, row in zip(tension, rows, strict=True)))
        for k, force in enumerate(forces)
    ]
    matrix = [[*(derivative(p, name) for name in names), *(row[k] for row in rows)] for k, p in enumerate(pulls)]
    matrix += [[*row, *[ZERO] * bars] for row in rows]
    return (*pulls, *halves), tuple(_conditions(matrix, count, bars))


def _conditions(matrix: Sequence[Sequence[Tree]], count: int, bars: int) -> Iterator[Tree]:
    """c_k is the sum of the principal minors with the border and k + m of the other rows, but for its sign."""
    border = tuple(range(count, count + bars))
    for k in range(1, count - bars + 1):
        kept = [(*chosen, *border) for chosen in combinations(range(count), k + bars)]
        minors = total(*(determinant([[matrix[i][j] for j in rows] for i in rows]) for rows in kept))
        yield negative(minors) if bars % 2 else minors


def _half(tree: Tree) -> Tree:
    return Chain(tree, (Step("/", Number(Fraction(2))),))


def _product(factor: Tree, tree: Tree) -> Tree:
    return ZERO if tree == ZERO else Chain(factor, (Step("*", tree),))
