"""The signs of the eigenvalues of symmetric matrices of up to three rows, whose entries are balls.

Guarantee: what is said holds for every matrix within the balls.
"""

from __future__ import annotations

from itertools import combinations

from flint import arb

from ptmcad.verification.certified.field import Matrix
from ptmcad.verification.certified.terms import square
from ptmcad.verification.inertia import determinant


def inertia(h: Matrix) -> str | None:
    """The signs of the eigenvalues of all symmetric matrices in the balls, positive ones first; None when undecided.

    The characteristic polynomial has real roots only, so that Descartes' rule counts them exactly: as many are positive
    as its coefficients, the elementary symmetric functions with alternating signs, change theirs.
    """
    n = len(h)
    if n == 1:
        return "+" if h[0][0] > 0 else "-" if h[0][0] < 0 else None
    trace = sum((h[i][i] for i in range(n)), arb(0))
    minors = sum((h[i][i] * h[j][j] - square(h[i][j]) for i, j in combinations(range(n), 2)), arb(0))
    if n == 2:
        if minors < 0:
            return "+-"
        return None if not minors > 0 else "++" if trace > 0 else "--" if trace < 0 else None
    product = determinant(h)
    sign = 1 if product > 0 else -1 if product < 0 else 0
    if not sign:
        return None
    one, other = ("+", "-") if sign > 0 else ("-", "+")
    # one eigenvalue has the product's sign, and the other two have one sign: also that one, if the first and the second
    # symmetric function have the signs that they then have
    if sign * trace > 0 and minors > 0:
        return one * 3
    if sign * trace < 0 or minors < 0:
        return "".join(sorted([one, other, other], key="+-".index))
    return None


def is_no_minimum(h: Matrix) -> bool:
    """Whether a symmetric matrix has a negative eigenvalue, whatever it is within the balls."""
    if any(h[i][i] < 0 for i in range(len(h))):
        return True
    if any(h[i][i] * h[j][j] - square(h[i][j]) < 0 for i, j in combinations(range(len(h)), 2)):
        return True
    return len(h) == 3 and bool(determinant(h) < 0)
