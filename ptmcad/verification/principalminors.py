"""The inertia of symmetric matrices, by leading principal minors (Jacobi) or by elementary
symmetric functions.

Guarantee: where no leading principal minor is zero, the number of negative eigenvalues is that of
the changes of sign in the sequence that starts with 1 and goes on with the minors. `bases` gives
others in which that is so: it is in almost every one. Entries may be matrices of multiplication,
which commute.

Of balls the elementary symmetric functions, the sums of all principal minors of one size, are in
their place: the characteristic polynomial has real roots only, so that Descartes' rule counts them
exactly (`inertia`). What is said holds for every matrix within the balls.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, pairwise, product
from typing import Any

from flint import arb

from ptmcad.verification.coordinates import square

Rows = Sequence[Sequence[Any]]


def bases(size: int) -> Iterator[list[list[int]]]:
    """Bases without end, the given one first: unipotent lower triangular matrices, whose columns
    are the vectors.

    Upper triangular ones would have the same leading principal minors.
    """
    for k in range(10**9):
        yield [
            [
                int(i == j) if i <= j else k and 1 + (k - 1) * (3 * i + 5 * j + i * j * k)
                for j in range(size)
            ]
            for i in range(size)
        ]


def leading_minors(form: Rows, basis: Sequence[Sequence[int]], order: int) -> list[Any]:
    """The leading principal minors up to an order of a symmetric matrix in another basis.

    That of full order does not depend on a unipotent basis.
    """
    turned = [[_value(form, basis, i, j) for j in range(order)] for i in range(order)]
    return [determinant([row[:k] for row in turned[:k]]) for k in range(1, order + 1)]


def _value(form: Rows, basis: Sequence[Sequence[int]], i: int, j: int) -> Any:
    """The form's value at the i-th and the j-th vector."""
    return total(
        form[k][m] * (basis[k][i] * basis[m][j])
        for k in range(i, len(basis))
        for m in range(j, len(basis))
        if basis[k][i] and basis[m][j]
    )


def total(terms: Iterable[Any]) -> Any:
    """A sum of at least one term, of things that no number can be added to."""
    waiting = iter(terms)
    found = next(waiting)
    for term in waiting:
        found = found + term
    return found


def determinant(rows: Rows) -> Any:
    """The determinant, without division: entries commute."""
    if len(rows) == 1:
        return rows[0][0]
    if len(rows) == 2:
        return rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    return total(
        entry * determinant([[*row[:k], *row[k + 1 :]] for row in rows[1:]]) * (-1 if k % 2 else 1)
        for k, entry in enumerate(rows[0])
    )


def negative_eigenvalues(signs: Iterable[int]) -> int:
    """Their number, from the signs of the leading principal minors."""
    return sum(a != b for a, b in pairwise((1, *signs)))


def inertia(h: Sequence[Sequence[arb]]) -> str | None:
    """The signs of the eigenvalues of all symmetric matrices in the balls, positive ones first;
    None when undecided.
    """
    n = len(h)
    functions = [total(_principal_minors(h, size)) for size in range(1, n + 1)]
    if functions[-1].contains(0):
        return None
    # of a function that may be zero no sign matters if both say the same
    signs = ([sign for sign in (1, -1) if not sign * value < 0] for value in functions)
    found = {negative_eigenvalues(chosen) for chosen in product(*signs)}
    return "+" * (n - min(found)) + "-" * min(found) if len(found) == 1 else None


def _principal_minors(h: Sequence[Sequence[arb]], size: int) -> Iterator[arb]:
    for chosen in combinations(range(len(h)), size):
        if size == 2:
            i, j = chosen
            yield h[i][i] * h[j][j] - square(h[i][j])
        else:
            yield determinant([[h[i][j] for j in chosen] for i in chosen])
