"""What need not be free of critical curves, as rectangles of the window: those of a cover, and
components without a cell.

Guarantee: what is said to be held by the rectangles is so; bounds are rounded by `SLACK`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ptmcad.cover.rectangles import Rectangle

SLACK = 2.0**-44
"""Share of the window's lattice by which bounds are narrower than they are: far more than what is
lost in rounding.
"""
MAX_BINS = 512


class Pieces(NamedTuple):
    """Rectangles in arrays, and where they are.

    Attributes
    ----------
    frames : (pieces, 4), left, right, bottom and top in lattice steps.
    bins : the window is a grid of so many squares a side; starts and members: the pieces that meet
        each.
    """

    steps: float
    frames: Any
    bins: int
    starts: Any
    members: Any


def no_pieces(steps: int) -> Pieces:
    """Of a window of which nothing is held."""
    return pieces_in([], steps)


def pieces_in(rectangles: Sequence[Rectangle], steps: int) -> Pieces:
    """Rectangles of a window of so many lattice steps a side."""
    frames = np.array(rectangles, dtype=np.float64).reshape(-1, 4)
    bins = int(min(max(1, len(frames) ** 0.5), MAX_BINS, steps))
    low = np.floor(frames[:, ::2] * (bins / steps) - 1e-6).clip(0, bins - 1).astype(np.int64)
    high = np.floor(frames[:, 1::2] * (bins / steps) + 1e-6).clip(0, bins - 1).astype(np.int64)
    held: list[list[int]] = [[] for _ in range(bins * bins)]
    for n, ((i0, j0), (i1, j1)) in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                held[i * bins + j].append(n)
    starts = np.cumsum([0, *map(len, held)]).astype(np.int64)
    members = np.array([n for some in held for n in some], dtype=np.int64)
    return Pieces(float(steps), frames, bins, starts, members)
