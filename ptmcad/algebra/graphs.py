"""Curves that are graphs of polynomials, whose integrals are rational; and any curve over such a
graph.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq, fmpq_poly, fmpz_poly


def on_graph(rows: Sequence[fmpz_poly | fmpq_poly], graph: fmpq_poly) -> fmpz_poly:
    """A positive multiple of p(u, graph(u)); zero where the graph is a part of the curve.

    Parameters
    ----------
    rows : coefficients of p as a polynomial in v.
    """
    total = fmpq_poly([0])
    for row in reversed(rows):
        total = total * graph + row
    return total.numer()


def graph_integral(in_v: Sequence[fmpz_poly], low: fmpq, high: fmpq) -> fmpq | None:
    """The integral of v over [low, high] on the curve p(u, v) = 0; None where it is not the graph
    of a polynomial in u.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    """
    if len(in_v) != 2 or in_v[1].degree() > 0:
        return None
    whole = fmpq_poly(-in_v[0]).integral()
    return (whole(high) - whole(low)) / fmpq(in_v[1][0])
