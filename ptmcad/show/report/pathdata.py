"""Lines as the data of SVG paths, in as few characters as there can be: steps on a grid, each from the last place.

Guarantee: every corner is within half a step of the grid of its place, however many come before it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

GRID = 100
"""Steps of the grid in one of the picture's units."""


def path_data(line: NDArray[np.float64], *, closed: bool = False) -> str:
    """The data of a polyline, or of a polygon; corners that fall on the one before them are left out.

    >>> path_data(np.array([[0, 10], [2.5, 10], [2.5, 9.75], [2, 9.125], [1.5, 8.5]]))
    'M0 10h2.5v-.25l-.5-.63-.5-.62'
    """
    corners = np.rint(line * GRID).astype(np.int64)
    steps = np.diff(corners, axis=0)
    parts, last = [f"M{_joined(corners[0].tolist())}"], "M"
    for x, y in steps[steps.any(axis=1)].tolist():
        command, numbers = ("v", [y]) if x == 0 else ("h", [x]) if y == 0 else ("l", [x, y])
        text = _joined(numbers)
        parts.append(command if command != last else "" if text.startswith("-") else " ")
        parts.append(text)
        last = command
    return "".join(parts) + "Z" * closed


def _joined(numbers: list[int]) -> str:
    """Numbers of steps, apart by a blank where no sign tells them apart."""
    first, *others = map(_text, numbers)
    return first + "".join(text if text.startswith("-") else f" {text}" for text in others)


def _text(steps: int) -> str:
    whole, rest = divmod(abs(steps), GRID)
    decimals = f".{rest:02}".rstrip("0") if rest else ""
    return ("-" if steps < 0 else "") + (str(whole) if whole or not rest else "") + decimals
