"""The eigenvalues of symmetric matrices of balls, in order, equal ones too; and how many of them
are negative.

Guarantee: the k-th ball contains the k-th eigenvalue, counted with multiplicity from the smallest
one on, of every symmetric matrix in the balls; balls may overlap. Where the matrix is narrow they
are narrow, however near eigenvalues are to each other: no proof here separates them.
"""

from __future__ import annotations

from flint import arb, arb_mat, ctx

_MAX_SWEEPS = 40
"""Over all pairs of rows; convergence is quadratic, and some ten do for 300 bits."""


def ordered_eigenvalues(matrix: arb_mat) -> list[arb]:
    """The eigenvalues, the smallest first, at the context's precision; balls that are not finite
    where entries are not.

    With any regular V, the k-th eigenvalue of V' A V is that of A times a number between the least
    and the greatest eigenvalue of V' V (Ostrowski; Horn & Johnson, Matrix Analysis, theorem 4.5.9).
    V' A V differs from a diagonal matrix, whose entries in order are its eigenvalues, by a matrix
    whose norm bounds how much each of them, in order, is moved (Weyl; corollary 4.3.15). Norms are
    row sums. V comes from rotations by Jacobi and need not be exact.
    """
    size = matrix.nrows()
    if size < 2:
        return [matrix[k, k] for k in range(size)]
    if not all(matrix[i, j].is_finite() for i in range(size) for j in range(size)):
        return [arb.nan()] * size
    v = _near_eigenvectors(matrix)
    turned, metric = v.transpose() * matrix * v, v.transpose() * v
    middles = [turned[k, k].mid() for k in range(size)]
    shift = max(_row_sum(turned, i, middles[i]) for i in range(size))
    stretch = max(_row_sum(metric, i, arb(1)) for i in range(size))
    return [arb(middle, shift) / arb(1, stretch) for middle in sorted(middles)]


def _row_sum(matrix: arb_mat, i: int, diagonal: arb) -> arb:
    """An upper bound of a row's sum of moduli, exact as a ball, after a number is subtracted on the
    diagonal.
    """
    size = matrix.nrows()
    total: arb = sum(
        (abs(matrix[i, j]) for j in range(size) if j != i), abs(matrix[i, i] - diagonal)
    )
    return total.upper()


def _near_eigenvectors(matrix: arb_mat) -> arb_mat:
    """Columns near eigenvectors of the matrix of middles, orthonormal but for rounding; of this
    nothing is proved.
    """
    size = matrix.nrows()
    a, v = matrix.mid(), _identity(size)
    negligible = max(abs(entry) for entry in a.entries()) * arb(2) ** -ctx.prec
    for _ in range(_MAX_SWEEPS):
        pairs = [(p, q) for q in range(size) for p in range(q) if abs(a[p, q]) > negligible]
        if not pairs:
            break
        for p, q in pairs:
            turn = _rotation(a, p, q)
            a, v = (turn.transpose() * a * turn).mid(), (v * turn).mid()
    return v


def _rotation(a: arb_mat, p: int, q: int) -> arb_mat:
    """In the plane of two coordinates, such that the matrix that is turned has a zero at p, q but
    for rounding.
    """
    turn = _identity(a.nrows())
    if a[p, q] != 0:
        ratio = ((a[q, q] - a[p, p]) / (2 * a[p, q])).mid()
        tangent = (1 / (abs(ratio) + (ratio**2 + 1).sqrt())).mid() * (-1 if ratio < 0 else 1)
        cosine = (1 / (tangent**2 + 1).sqrt()).mid()
        sine = (tangent * cosine).mid()
        turn[p, p], turn[q, q], turn[p, q], turn[q, p] = cosine, cosine, sine, -sine
    return turn


def _identity(size: int) -> arb_mat:
    return arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])


def inertia(matrix: arb_mat) -> int | None:
    """The number of negative eigenvalues of every symmetric matrix in a matrix of balls; None when
    undecided.
    """
    eigenvalues = ordered_eigenvalues(matrix)
    decided = all(value < 0 or value > 0 for value in eigenvalues)
    return sum(bool(value < 0) for value in eigenvalues) if decided else None
