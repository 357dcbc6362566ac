"""Lines as the data of SVG paths, in few characters: whole steps of a grid, from corner to corner.

Guarantee: every corner is within half a step of the grid of its place in each direction, and
corners at one place are drawn alike: browsers add the steps up in single precision, in which whole
numbers of this size are exact.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ptmcad.show.render.simplification import distinct
from ptmcad.show.render.view import Floats

GRID = 20
"""Steps of the grid in one of the picture's units; what is drawn by such data is scaled down by as
much.
"""


def path_data(line: Floats, *, closed: bool = False) -> str:
    """The data of a polyline, or of a polygon; corners within a side along an axis are left out.

    A line that is shorter than a step is drawn one step long: a browser leaves out one without
    length.

    >>> path_data(np.array([[0, 10], [2.5, 10], [3, 10], [3, 9.75], [2, 9.1], [1.5, 8.5]]))
    'M0 200h60v-5l-20-13-10-12'
    """
    corners = _needed(np.rint(line * GRID).astype(np.int64))
    if len(corners) == 1:
        corners = np.concatenate([corners, corners + np.array([[1, 0]])])
    x, y = corners[0].tolist()
    parts, last = [f"M{x}{_after(y)}"], "M"
    for dx, dy in np.diff(corners, axis=0).tolist():
        command, numbers = (
            ("v", f"{dy}") if not dx else ("h", f"{dx}") if not dy else ("l", f"{dx}{_after(dy)}")
        )
        parts.append(command if command != last else "" if numbers[0] == "-" else " ")
        parts.append(numbers)
        last = command
    return "".join(parts) + "z" * closed


def _after(steps: int) -> str:
    """A number after another one: a minus sign parts them, too."""
    return str(steps) if steps < 0 else f" {steps}"


def _needed(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Without corners that are where the one before them is, or on the way along an axis to the
    next one.
    """
    corners = distinct(corners)
    if len(corners) < 3:
        return corners
    steps = np.sign(np.diff(corners, axis=0))
    straight = (steps[1:] == steps[:-1]).all(axis=1) & (steps[1:] == 0).any(axis=1)
    kept: NDArray[np.int64] = corners[np.concatenate([[True], ~straight, [True]])]
    return kept
