"""The inertia of a symmetric matrix of balls.

Guarantee: the answer holds for every regular symmetric matrix in the balls. For a regular matrix
and balls narrow enough there is an answer: of the diagonal entries and the differences'
determinants some is certainly not zero.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, ctx


def negative_eigenvalues(matrix: Sequence[Sequence[arb]]) -> int | None:
    """The number of negative eigenvalues; None when the balls are too wide to tell.

    By block elimination with pivots of one row or two, each of a certain sign (Sylvester's law of
    inertia; Bunch & Kaufman, Math. Comp. 31 (1977)).

    Raises
    ------
    ArithmeticError
        When an entry is not finite.
    """
    rows = [list(row) for row in matrix]
    if not all(entry.is_finite() for row in rows for entry in row):
        raise ArithmeticError(f"a matrix has an entry that is not finite at {ctx.prec} bits")
    if len(rows) == 2:  # the usual case, at once
        determinant = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
        if determinant < 0:
            return 1
        if determinant > 0 and not rows[0][0].contains(0):
            return 0 if rows[0][0] > 0 else 2
        return None
    negative = 0
    while rows:
        size = len(rows)
        k = max(range(size), key=lambda i: float(rows[i][i].abs_lower()))
        pivot = rows[k][k]
        if not pivot.contains(0):
            negative += bool(pivot < 0)
            rows = [
                [rows[i][j] - rows[i][k] * rows[k][j] / pivot for j in range(size) if j != k]
                for i in range(size)
                if i != k
            ]
            continue
        pairs = [(i, j) for i in range(size) for j in range(i)]
        blocks = {(i, j): rows[i][i] * rows[j][j] - rows[i][j] * rows[i][j] for i, j in pairs}
        certain = [pair for pair, determinant in blocks.items() if determinant < 0]
        if not certain:
            return None
        i, j = max(certain, key=lambda pair: float(blocks[pair].abs_lower()))
        negative += 1  # and one positive
        rest = [m for m in range(size) if m not in (i, j)]
        a, b, c, determinant = rows[i][i], rows[i][j], rows[j][j], blocks[i, j]
        rows = [
            [
                rows[m][n]
                - (
                    rows[m][i] * (c * rows[i][n] - b * rows[j][n])
                    + rows[m][j] * (a * rows[j][n] - b * rows[i][n])
                )
                / determinant
                for n in rest
            ]
            for m in rest
        ]
    return negative
