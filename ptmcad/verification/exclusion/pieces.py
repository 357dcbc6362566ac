"""What need not be free of critical curves, as pieces of the window: rectangles, tubes, and
components without a cell.

Guarantee: what is said to be held by the pieces is so; bounds are rounded by `SLACK`. A piece is
what of a closed rectangle lies between the graphs of two polynomials, or between one and a side.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ptmcad.cover.rectangles import Rectangle

Bound = tuple[int, tuple[int, ...]] | None
"""A polynomial by its controls, and what is added to them."""
SLACK = 2.0**-44
"""Share of the window's lattice by which bounds are narrower than they are: far more than what is
lost in rounding.
"""
MAX_BINS = 512
MAX_CONTROLS = 64
"""Of a polynomial: pieces with more hold nothing."""


class PieceRow(NamedTuple):
    """A piece: its frame, its polynomials and their axis, and by how much the frame is wider than
    their interval.
    """

    frame: Rectangle
    along: int = 0
    lower: Bound = None
    upper: Bound = None
    wider: int = 0


class Pieces(NamedTuple):
    """Pieces in arrays, and where they are.

    Attributes
    ----------
    frames : (pieces, 4), left, right, bottom and top in lattice steps.
    spans : (pieces, 2), the interval that the controls belong to.
    along : the axis over which the polynomials are.
    lower, upper : place and number of controls of each bound; none at all where there is no bound.
    controls : all controls, with what is added.
    bins : the window is a grid of so many squares a side; starts and members: the pieces that meet
        each.
    """

    steps: float
    frames: Any
    spans: Any
    along: Any
    lower: Any
    upper: Any
    controls: Any
    bins: int
    starts: Any
    members: Any


def no_pieces(steps: int) -> Pieces:
    """Of a window of which nothing is held."""
    return pieces_in([], steps)


def pieces_in(rows: list[PieceRow], steps: int) -> Pieces:
    frames = np.array([row.frame for row in rows], dtype=np.float64).reshape(-1, 4)
    spans = np.array([_span(row) for row in rows], dtype=np.float64).reshape(-1, 2)
    along = np.array([row.along for row in rows], dtype=np.int64)
    controls: list[int] = []
    bounds = np.zeros((2, len(rows), 2), dtype=np.int64)
    for n, row in enumerate(rows):
        for side, bound in enumerate((row.lower, row.upper)):
            if bound is not None:
                bounds[side, n] = len(controls), len(bound[1])
                controls += [c + bound[0] for c in bound[1]]
    bins = int(min(max(1, len(rows) ** 0.5), MAX_BINS, steps))
    low = np.floor(frames[:, ::2] * (bins / steps) - 1e-6).clip(0, bins - 1).astype(np.int64)
    high = np.floor(frames[:, 1::2] * (bins / steps) + 1e-6).clip(0, bins - 1).astype(np.int64)
    held: list[list[int]] = [[] for _ in range(bins * bins)]
    for n, ((i0, j0), (i1, j1)) in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                held[i * bins + j].append(n)
    starts = np.cumsum([0, *map(len, held)]).astype(np.int64)
    members = np.array([n for some in held for n in some], dtype=np.int64)
    return Pieces(
        float(steps),
        frames,
        spans,
        along,
        bounds[0],
        bounds[1],
        np.array(controls, dtype=np.float64),
        bins,
        starts,
        members,
    )


def _span(row: PieceRow) -> tuple[int, int]:
    """The interval of a piece's polynomials."""
    return row.frame[2 * row.along] + row.wider, row.frame[2 * row.along + 1] - row.wider
