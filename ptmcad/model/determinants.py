"""Gradients of formulas, and determinants of matrices by Laplace's expansion: for the few rows that
there are.

Guarantee: exact identities.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ptmcad.formulas.graph import Formula

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
