"""Bounds of lengths that springs hold together, by diagonal dominance.

Guarantee: for all parameters and all values of the other unknowns in the balls, no solution has one
of the lengths beyond its bound.

Let equations be A s + b = sum of K_c (u_c . w_ci), with unit vectors u_c. For any matrix V let
M = V A and Q be upper bounds of |I - M|, g positive upper bounds of |V b| + sum of K_c |sum_j V_ij
w_cj|. As s = V (A s) + (I - M) s,

    |s| <= g + Q |s|,  so that with  t = max |s_i|/g_i  and  q = max (Q g)_i/g_i  is  t <= 1 + q t,

and |s_i| <= g_i/(1 - q) if q < 1: M, with columns times g_j, has a dominant diagonal then
(Gershgorin). V is about the inverse of A's middle, as balls without a radius have it; that it is
any matrix is enough. The second engine solves by Cramer's rule, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat

from ptmcad.verification.normalform.boxes import size

MAX_SHARE = 0.5
"""Of q: a wider box of what A depends on is halved, as bounds grow like 1/(1 - q)."""
_MIN_SIZE = 2.0**-60

Row = Sequence[arb]


def bounds_of(
    matrix: Sequence[Row], rest: Row, springs: Sequence[tuple[arb, Row, Row]]
) -> list[arb] | None:
    """Of each length, exact numbers; None where no dominant diagonal is found.

    Parameters
    ----------
    matrix, rest : A, row by row, and b.
    springs : for each K, and the coordinates of the vector w_ci for each equation.
    """
    n = range(len(rest))
    try:
        inverse = arb_mat([[arb(a.mid()) for a in row] for row in matrix]).inv()
    except ZeroDivisionError:
        return None
    guess = [[arb(inverse[i, j].mid()) for j in n] for i in n]
    columns = list(zip(*matrix, strict=True))
    reach = [_reach(row, rest, springs) for row in guess]
    off = [[(int(i == j) - _dot(guess[i], columns[j])).abs_upper() for j in n] for i in n]
    shares = [_dot(off[i], reach).abs_upper() / reach[i] for i in n]
    if not all(share < MAX_SHARE for share in shares):
        return None
    most = max(share.abs_upper() for share in shares)
    return [(r / (1 - most)).abs_upper() for r in reach]


def _reach(factors: Row, rest: Row, springs: Sequence[tuple[arb, Row, Row]]) -> arb:
    """A positive upper bound of the rest and the springs' parts, where the equations are summed up
    with factors.
    """
    total = abs(_dot(factors, rest)) + _MIN_SIZE
    for pull, across, up in springs:
        total = total + pull * size(_dot(factors, across), _dot(factors, up))
    return total.abs_upper()


def _dot(a: Row, b: Row) -> arb:
    return sum((x * y for x, y in zip(a, b, strict=True)), arb(0))
