"""Lines as the data of SVG paths, in few characters: places on a grid, of which only what changes is written.

Guarantee: every corner is within half a step of the grid of its place, and corners at one place are written alike.
(Steps from corner to corner would take fewer characters, but browsers add them up in single precision, so that two
cells would no longer meet where they share a side.)
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

GRID = 100
"""Steps of the grid in one of the picture's units."""


def path_data(line: NDArray[np.float64], *, closed: bool = False) -> str:
    """The data of a polyline, or of a polygon; corners within a side along an axis are left out.

    >>> path_data(np.array([[0, 10], [2.5, 10], [3, 10], [3, 9.75], [2, 9.125], [1.5, 8.5]]))
    'M0 10H3V9.75L2 9.12 1.5 8.5'
    """
    corners = _needed(np.rint(line * GRID).astype(np.int64)).tolist()
    parts, last = [f"M{_text(corners[0][0])} {_text(corners[0][1])}"], "M"
    for (x0, y0), (x, y) in pairwise(corners):
        command, numbers = ("V", [y]) if x == x0 else ("H", [x]) if y == y0 else ("L", [x, y])
        parts.append(command if command != last else " ")
        parts.append(" ".join(map(_text, numbers)))
        last = command
    return "".join(parts) + "Z" * closed


def _needed(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Without corners that are where the one before them is, or on the way along an axis to the next one."""
    corners = corners[np.concatenate([[True], (corners[1:] != corners[:-1]).any(axis=1)])]
    if len(corners) < 3:
        return corners
    steps = np.sign(np.diff(corners, axis=0))
    straight = (steps[1:] == steps[:-1]).all(axis=1) & (steps[1:] == 0).any(axis=1)
    kept: NDArray[np.int64] = corners[np.concatenate([[True], ~straight, [True]])]
    return kept


def _text(steps: int) -> str:
    whole, rest = divmod(abs(steps), GRID)
    decimals = f".{rest:02}".rstrip("0") if rest else ""
    return ("-" if steps < 0 else "") + (str(whole) if whole or not rest else "") + decimals
