"""What need not be free of critical curves, as pieces of the window: rectangles, tubes, and components without a cell.

Guarantee: what is said to be held by the pieces is so; bounds are rounded by `SLACK`. A piece is what of a closed
rectangle lies between the graphs of two polynomials, or between one and a side.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ptmcad.cover.rectangles import Patch, Rectangle
from ptmcad.verification.certified.slanted import SlantedSweep
from ptmcad.verification.certified.structure import CertifiedClaims
from ptmcad.verification.certified.sweep import Sweep

Bound = tuple[int, tuple[int, ...]] | None
"""A polynomial by its controls, and what is added to them."""
SLACK = 2.0**-44
"""Share of the window's lattice by which bounds are narrower than they are: far more than what is lost in rounding."""
MOST_BINS = 512


class Pieces(NamedTuple):
    """Pieces in arrays, and where they are.

    Attributes
    ----------
    frames : (pieces, 4), left, right, bottom and top in lattice steps.
    along : the axis over which the polynomials are.
    lower, upper : place and number of controls of each bound; none at all where there is no bound.
    controls : all controls, with what is added.
    bins : the window is a grid of so many squares a side; starts and members: the pieces that meet each.
    """

    steps: float
    frames: Any
    along: Any
    lower: Any
    upper: Any
    controls: Any
    bins: int
    starts: Any
    members: Any


def pieces_of(claims: CertifiedClaims) -> Pieces:
    """The pieces of a map's cover, and the components that have no cell."""
    cover = claims.result.cover
    assert cover is not None
    rows: list[tuple[Rectangle, int, Bound, Bound]] = [(r, 0, None, None) for r in cover.rectangles]
    for patch in cover.patches:
        rows += [
            (patch.frame, patch.along, (-t.half, t.controls), (t.half, t.controls)) for t in patch.tubes
        ]  # fmt: skip
    cells, found = claims.cell_of, claims.sweep
    if isinstance(found, SlantedSweep):
        rows += _open_in_strips(found, cells) + _open_in_frames(found, cells)
    else:
        rows += _gaps(found, cells)
    return _in_arrays(rows, cover.steps)


def _gaps(found: Sweep, cells: dict[int, int]) -> list[tuple[Rectangle, int, Bound, Bound]]:
    return [
        ((left, right, low, high), 0, None, None)
        for (low, high), row in zip(pairwise(found.lines), found.gaps, strict=True)
        for left, right, n in row
        if n not in cells
    ]


def _open_in_strips(found: SlantedSweep, cells: dict[int, int]) -> list[tuple[Rectangle, int, Bound, Bound]]:
    return [
        ((item.left, item.right, low, high), 0, None, None)
        for (low, high), row in zip(pairwise(found.lines), found.rows, strict=True)
        for item in row
        if item.frame < 0 and item.free and found.component_of[item.node] not in cells
    ]


def _open_in_frames(found: SlantedSweep, cells: dict[int, int]) -> list[tuple[Rectangle, int, Bound, Bound]]:
    rows = []
    for frame, first in zip(found.frames, found.first_part, strict=True):
        patch = frame.patch
        for k in range(len(patch.tubes) + 1):
            if found.component_of[first + k] not in cells:
                rows.append((patch.frame, patch.along, *_between(patch, k)))
    return rows


def _between(patch: Patch, k: int) -> tuple[Bound, Bound]:
    """What bounds the part of a frame that has so many tubes below it, together with the tubes beside it."""
    below, above = patch.tubes[k - 1 : k], patch.tubes[k : k + 1]
    return (
        (-below[0].half, below[0].controls) if k else None,
        (above[0].half, above[0].controls) if above else None,
    )


def _in_arrays(rows: list[tuple[Rectangle, int, Bound, Bound]], steps: int) -> Pieces:
    frames = np.array([row[0] for row in rows], dtype=np.float64).reshape(-1, 4)
    controls: list[int] = []
    bounds = np.zeros((2, len(rows), 2), dtype=np.int64)
    for n, row in enumerate(rows):
        for side in (0, 1):
            bound = row[2 + side]
            if bound is not None:
                bounds[side, n] = len(controls), len(bound[1])
                controls += [c + bound[0] for c in bound[1]]
    bins = int(min(max(1, len(rows) ** 0.5), MOST_BINS, steps))
    low = np.floor(frames[:, ::2] * (bins / steps) - 1e-6).clip(0, bins - 1).astype(np.int64)
    high = np.floor(frames[:, 1::2] * (bins / steps) + 1e-6).clip(0, bins - 1).astype(np.int64)
    held: list[list[int]] = [[] for _ in range(bins * bins)]
    for n, ((i0, j0), (i1, j1)) in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                held[i * bins + j].append(n)
    starts = np.cumsum([0, *map(len, held)]).astype(np.int64)
    members = np.array([n for some in held for n in some], dtype=np.int64)
    along = np.array([row[1] for row in rows], dtype=np.int64)
    return Pieces(
        float(steps), frames, along, bounds[0], bounds[1], np.array(controls, dtype=np.float64), bins, starts, members
    )
