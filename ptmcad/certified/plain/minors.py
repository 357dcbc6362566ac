"""Determinants of a matrix that springs bend by a matrix of rank one each.

Guarantee: exact identities. A spring's inverse length enters to the first power only, as by the
matrix determinant lemma; written out, a determinant would have products of the same inverse length
that cancel.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

from ptmcad.certified.plain.cones import ConeFormulas, Matrix
from ptmcad.formulas.graph import Formula
from ptmcad.model.determinants import determinant


class Bent(NamedTuple):
    """What is taken off a matrix M: factor v (g v)^T, with the products v_i v_j and v, the sines of
    a spring.

    Of closed loops v stands in one row only, and another vector in the place of the second v.
    """

    factor: Formula
    products: Matrix
    spring: ConeFormulas


def bent(
    matrix: Matrix,
    bends: Sequence[Bent],
    scales: Sequence[Formula],
    by: Bent | None = None,
    extents: Sequence[Formula] | None = None,
) -> Formula:
    """det(M - sum of factor_s v_s (g v_s)^T), g being the scales.

    Springs that are in one equation are in M's row. For the others it is the sum over sets S of
    springs of (-1)^|S| times their factors times the sum over sets I, K of as many rows and columns
    of det(v_S in I) times det(g v_S in K) times the complementary minor of M with its sign (Cauchy
    and Binet; Lemma S2 of docs/soundness.md).

    Parameters
    ----------
    by : only the terms with this spring in S, which is none of ``bends``, less their sign.
    """
    size = len(matrix)
    entries = [list(row) for row in matrix]
    for bend in bends if extents is None else ():
        if len(bend.spring.active) == 1:
            (i,) = bend.spring.active
            row = zip(entries[i], scales, bend.products[i], strict=True)
            entries[i] = [m - bend.factor * (g * p) for m, g, p in row]
    rigid = tuple(map(tuple, entries))
    shared = [bend for bend in bends if len(bend.spring.active) > 1 or extents is not None]
    total = matrix[0][0].graph.constant(0)
    orders = range(size + 1) if by is None else range(size)
    for order in orders:
        for chosen in combinations(shared, order):
            among = chosen if by is None else (by, *chosen)
            factor = matrix[0][0].graph.constant(1)
            for bend in among:
                factor = factor * bend.factor
            if extents is not None:
                for bend, extent in zip(bends, extents, strict=True):
                    if bend not in chosen:
                        factor = factor * extent
            part = factor * _complement(rigid, among, scales)
            total = total + part if order % 2 == 0 else total - part
    return total


def _complement(matrix: Matrix, among: Sequence[Bent], scales: Sequence[Formula]) -> Formula:
    """The sum over rows I and columns K of the springs' minors times the complementary minor of the
    matrix.
    """
    size, graph = range(len(matrix)), matrix[0][0].graph
    total = graph.constant(0)
    for rows in combinations(size, len(among)):
        for columns in combinations(size, len(among)):
            rest = tuple(
                tuple(matrix[i][k] for k in size if k not in columns) for i in size if i not in rows
            )
            minor = _springs_minor(among, rows, columns, graph.constant(1))
            for k in columns:
                minor = minor * scales[k]
            part = minor * (determinant(rest) if rest else 1)
            total = total + part if (sum(rows) + sum(columns)) % 2 == 0 else total - part
    return total


def _springs_minor(
    among: Sequence[Bent], rows: Sequence[int], columns: Sequence[int], one: Formula
) -> Formula:
    """det(v_S in I) det(v_S in K)."""
    if not among:
        return one
    if len(among) == 1:
        return among[0].products[rows[0]][columns[0]]
    if len(among) == 2 and rows == columns:
        (a, b), (i, j) = (bend.products for bend in among), rows
        return a[i][i] * b[j][j] + a[j][j] * b[i][i] - 2 * (a[i][j] * b[i][j])
    first, second = (
        determinant(tuple(tuple(bend.spring.sines[i] for bend in among) for i in some))
        for some in (rows, columns)
    )
    return first * second
