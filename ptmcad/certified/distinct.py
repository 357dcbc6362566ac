"""Which of the proved boxes hold the same zero: of unknowns on the circle, and of others.

Guarantee: two zeros are called one only when a box that holds exactly one holds both (moved by full
turns), and different only when narrow boxes around them are disjoint. (Lemma 10 of
docs/soundness.md.)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.search import Boxes
from ptmcad.formulas.compiled import compiled

FULL_TURN = 6.283185307179586
_TURN_ERROR = 1e-14
"""More than the error of FULL_TURN, and of adding it to an angle under 60."""


def distinct(
    unique: Boxes, narrow: Boxes, first: int, periods: NDArray[np.float64] | None = None
) -> NDArray[np.int64] | None:
    """Rows of zeros that are all different; every zero is one of them. None when this cannot be
    decided for some pair.

    Parameters
    ----------
    unique, narrow : (k, 2v): boxes with exactly one zero each, and narrower ones around the same
        zero.
    first : number of the first unknown; all variables from it on are unknowns.
    periods : shape (v,), for each variable `FULL_TURN` if it is an angle, else 0; all unknowns are
        angles when None.
    """
    kept = np.empty(len(unique), np.int64)
    if periods is None:
        periods = np.full(unique.shape[1] // 2, FULL_TURN)
    count = int(_distinct(unique, narrow, first, periods, kept))
    return None if count < 0 else kept[:count]


@compiled
def _distinct(
    unique: Boxes, narrow: Boxes, first: int, periods: NDArray[np.float64], kept: NDArray[np.int64]
) -> int:
    count = 0
    for i in range(unique.shape[0]):
        known = False
        for k in range(count):
            j = kept[k]
            relation = _relation(unique, narrow, first, periods, i, j)
            if relation < 0:
                relation = _relation(unique, narrow, first, periods, j, i)
            if relation < 0:
                return -1
            if relation > 0:
                known = True
                break
        if not known:
            kept[count] = i
            count += 1
    return count


@compiled
def _relation(
    unique: Boxes, narrow: Boxes, first: int, periods: NDArray[np.float64], i: int, j: int
) -> int:
    """1 when zero i, moved by full turns, lies in the box in which zero j is the only one; 0
    different; -1 unknown.
    """
    variables = unique.shape[1] // 2
    inside, separate = True, False
    for k in range(first, variables):
        low, high = narrow[i, k], narrow[i, variables + k]
        if not high - low < 0.5 or not narrow[j, variables + k] - narrow[j, k] < 0.5:
            return -1
        turns = 0.0
        if periods[k] > 0:
            turns = np.rint(
                (0.5 * (narrow[j, k] + narrow[j, variables + k]) - 0.5 * (low + high)) / periods[k]
            )
        error = 0.0 if turns == 0 else _TURN_ERROR
        low, high = low + turns * periods[k] - error, high + turns * periods[k] + error
        inside = inside and unique[j, k] <= low and high <= unique[j, variables + k]
        separate = separate or high < narrow[j, k] or low > narrow[j, variables + k]
    return 1 if inside else (0 if separate else -1)
