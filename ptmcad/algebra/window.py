"""Polynomials over a rectangle of the plane: a proof that one has no zero there.

Guarantee: `nowhere_zero` answers True only with proof. False means that the test did not decide,
not that there is a zero.
"""

from __future__ import annotations

from ptmcad.algebra.bernstein import Table, over, quarters, sign, table_of
from ptmcad.algebra.polynomials import Coefficient, coefficients_in
from ptmcad.algebra.real_roots import Interval, isolate, squarefree_part


def nowhere_zero(p: Coefficient, x: Interval, y: Interval, depth: int = 4) -> bool:
    """Whether p is proved to have no zero in the open rectangle, by the signs of its Bernstein
    coefficients.

    Undecided rectangles are cut in four, ``depth`` times; then the cuts must be free of zeros too,
    so strict signs are asked for. A p in one variable is decided exactly.
    """
    n, m = (int(d) for d in p.degrees())
    if n == 0 or m == 0:
        only = 0 if m == 0 else 1
        return not isolate(squarefree_part(coefficients_in(p, 1 - only)[0]), *((x, y)[only]))
    table = over(table_of(((i, j, 0), c) for (i, j), c in p.terms()), (x, y, x))
    return bool(sign(table)) or _is_free(table, depth)


def _is_free(table: Table, depth: int) -> bool:
    """Whether the quarters of a rectangle are proved to be free of zeros, their boundaries too."""
    corners = table.layers[0].entries()
    if depth == 0 or corners[0] * corners[-1] <= 0:
        return False
    return all(
        (sign(part) and all(part.layers[0].entries())) or _is_free(part, depth - 1)
        for part in quarters(table)
    )
