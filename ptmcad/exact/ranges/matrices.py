"""Vectors and matrices of balls, as small as a system has unknowns."""

from __future__ import annotations

from flint import arb, arb_mat

Vector = tuple[arb, ...]
"""One ball for each unknown: the angles, then those on the line."""
Matrix = tuple[Vector, ...]


def inverse_of(matrix: Matrix) -> Matrix | None:
    """An approximate inverse with exact entries."""
    size = len(matrix)
    try:
        found = arb_mat(size, size, [x.mid() for row in matrix for x in row]).inv()
    except ZeroDivisionError:
        return None
    inverse = tuple(tuple(found[i, j].mid() for j in range(size)) for i in range(size))
    return inverse if all(x.is_finite() for row in inverse for x in row) else None


def times(matrix: Matrix, vector: Vector) -> Vector:
    return tuple(sum((a * b for a, b in zip(row, vector, strict=True)), arb(0)) for row in matrix)


def product(first: Matrix, second: Matrix) -> Matrix:
    columns = [times(first, column) for column in zip(*second, strict=True)]
    return tuple(zip(*columns, strict=True))


def from_identity(matrix: Matrix) -> Matrix:
    """The identity minus a matrix."""
    return tuple(tuple(int(i == j) - x for j, x in enumerate(row)) for i, row in enumerate(matrix))


def plus(*vectors: Vector) -> Vector:
    return tuple(sum(entries, arb(0)) for entries in zip(*vectors, strict=True))


def scaled(vector: Vector, factor: arb) -> Vector:
    return tuple(x * factor for x in vector)


def scaled_rows(matrix: Matrix, factor: arb) -> Matrix:
    return tuple(scaled(row, factor) for row in matrix)


def added(matrices: list[Matrix]) -> Matrix:
    return tuple(plus(*rows) for rows in zip(*matrices, strict=True))
