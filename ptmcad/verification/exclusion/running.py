"""The search for critical points in the free area: boxes in generations, and what is left of them.

Guarantee: each critical point over the window that no piece of the cover holds is in one of the
boxes that are left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ptmcad.verification.exclusion.boxsearch import GONE, HALVED, STUCK, look, spread
from ptmcad.verification.exclusion.criticalsystems import CriticalSystem
from ptmcad.verification.exclusion.pieces import Pieces

MAX_WAITING = 1_000_000
"""Boxes: with more of them the youngest are looked at first."""
AT_ONCE = 16_384
GRID = 512


def search(
    system: CriticalSystem,
    pieces: Pieces,
    start: Any,
    budget: int,
    smallest: float,
    report: Callable[[float], None] = lambda _share: None,
) -> tuple[Any, Any, int]:
    """Look at boxes, and halve them.

    Parameters
    ----------
    start : (number, variables, 2).
    budget : number of boxes.
    smallest : share of the window's width; boxes over less than that are stuck.
    report : called with the share of the start's volume that is done with.

    Returns
    -------
    The boxes that were not looked at, those that were not halved any more, and how many were looked
    at.
    """
    compiled = system.compiled(smallest)
    waiting, stuck, looked, number = [start.copy()], [start[:0]], 0, len(start)
    whole, gone = float(_volumes(start).sum()), 0.0
    while waiting:
        boxes = waiting.pop(0 if number < MAX_WAITING else -1)
        if looked + len(boxes) > budget:
            waiting.append(boxes)
            break
        for k in range(0, len(boxes), AT_ONCE):
            some = boxes[k : k + AT_ONCE]
            before = _volumes(some)
            outcome, other = np.full(len(some), GONE), np.empty_like(some)
            look(compiled, system.tape, pieces, some, outcome, other)
            halved = outcome == HALVED
            children = np.concatenate([some[halved], other[halved]])
            stuck.append(some[outcome == STUCK].copy())
            gone += float(before.sum() - _volumes(children).sum())
            looked, number = looked + len(some), number - len(some) + len(children)
            if len(children):
                waiting.append(children)
            report(gone / whole if whole else 1.0)
    return np.concatenate([start[:0], *waiting]), np.concatenate(stuck), looked


def _volumes(boxes: Any) -> Any:
    return (boxes[:, :, 1] - boxes[:, :, 0]).prod(axis=1)


def share_over(rests: Sequence[Any], pieces: Pieces) -> float:
    """At most this share of the window is under boxes that are left."""
    grid = np.zeros((GRID, GRID))
    for boxes in rests:
        spread(boxes, pieces.steps, grid)
    return float(np.minimum(grid, 1.0).mean()) * (1 + 1e-9)
