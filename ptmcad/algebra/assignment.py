"""The assignment problem: bounds for orders and degrees of determinants, by one entry of each row
and column.

Guarantee: exact, in integers; the time grows with the cube of the size.

Reference: Kuhn, Naval Research Logistics Quarterly 2 (1955); the form with potentials of rows and
columns is that of Jonker & Volgenant, Computing 38 (1987).
"""

from __future__ import annotations

import math
from collections.abc import Sequence


def least_assignment(costs: Sequence[Sequence[int | None]]) -> int | None:
    """The least sum of entries of a square matrix in different rows and columns; None stands for
    infinity.
    """
    size = len(costs)
    row_of: list[int | None] = [None] * size  # for each column
    above, beside = (
        [0] * size,
        [0] * size,
    )  # potentials: no cost is less than above[row] + beside[column]
    for start in range(size):
        distance: list[float] = [math.inf] * size
        before: list[int | None] = [None] * size
        done: list[int] = []
        waiting = set(range(size))
        row, column, reached = start, None, 0
        while True:
            for j in waiting:
                cost = costs[row][j]
                if (
                    cost is not None
                    and (found := reached + cost - above[row] - beside[j]) < distance[j]
                ):
                    distance[j], before[j] = found, column
            nearest = min(waiting, key=lambda j: distance[j], default=None)
            if nearest is None or distance[nearest] == math.inf:
                return None
            reached = int(distance[nearest])
            waiting.discard(nearest)
            column, following = nearest, row_of[nearest]
            if following is None:
                break
            done.append(nearest)
            row = following
        above[start] += reached
        for j in done:
            taken = row_of[j]
            assert taken is not None
            above[taken] += reached - int(distance[j])
            beside[j] -= reached - int(distance[j])
        while column is not None:
            origin = before[column]
            row_of[column] = start if origin is None else row_of[origin]
            column = origin
    return sum(
        cost for j, i in enumerate(row_of) if i is not None and (cost := costs[i][j]) is not None
    )
