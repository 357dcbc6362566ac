"""The eigenvalues of symmetric matrices of balls, in order, equal ones too; and how many of them are negative.

Guarantee: the k-th ball contains the k-th eigenvalue, counted with multiplicity from the smallest one on, of every
symmetric matrix in the balls; balls may overlap. Where the matrix is narrow they are narrow, however near eigenvalues
are to each other: no proof here separates them.
"""

from __future__ import annotations

import numpy as np
from flint import acb_mat, arb, arb_mat


def ordered_eigenvalues(matrix: arb_mat) -> list[arb]:
    """The eigenvalues, the smallest first, at the context's precision; balls that are not finite where entries are not.

    Arb's enclosures are disjoint, or the same for all eigenvalues of a cluster. All of them meet the real axis, so that
    disjoint ones have disjoint real parts.
    """
    size = matrix.nrows()
    if size < 2:
        return [matrix[k, k] for k in range(size)]
    found = (value.real for value in acb_mat(matrix).eig(multiple=True, nonstop=True))
    return sorted(found, key=arb.mid)


def inertia(matrix: arb_mat) -> int | None:
    """The number of negative eigenvalues of every symmetric matrix in a matrix of balls; None when undecided.

    By Sylvester's law: with the columns of V near eigenvectors, V' H V is strictly diagonally dominant, so that neither
    it nor V is singular, and the signs of its diagonal are those of its eigenvalues (Gershgorin).
    """
    size = matrix.nrows()
    middle = np.array([[float(matrix[i, j].mid()) for j in range(size)] for i in range(size)])
    if not np.isfinite(middle).all():
        return None
    vectors = np.linalg.eigh((middle + middle.T) / 2)[1]
    v = arb_mat(size, size, [float(entry) for entry in vectors.flat])
    form = v.transpose() * matrix * v
    negative = 0
    for i in range(size):
        off = sum((abs(form[i, j]) for j in range(size) if j != i), arb(0))
        if not abs(form[i, i]) > off:
            return None
        negative += bool(form[i, i] < 0)
    return negative
