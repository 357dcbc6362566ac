"""The search for critical points in the free area: boxes in generations, and what is left of them.

Guarantee: each critical point over the window that no piece of the cover holds is in one of the
boxes that are left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ptmcad.verification.exclusion.boxsearch import GONE, HALVED, STUCK, look, spread
from ptmcad.verification.exclusion.pieces import Pieces
from ptmcad.verification.exclusion.systemtapes import CriticalSystem

MAX_WAITING = 1_000_000
"""Boxes: with more of them the youngest are looked at first."""
AT_ONCE = 16_384
GRID = 512
LEARNT_FROM, SAMPLE = 1024, 16
"""Boxes over which all formulas are evaluated; and one of so many of the others ..."""
FORGETTING = 0.5
"""... of which the older ones count less, generation by generation."""
WORTH = 0.01
"""Share of the boxes that any formula excludes: those that exclude fewer are left out."""


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
    choice = _Choice(system, pieces, smallest)
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
            some, outcome, other = choice.look(some)
            halved = outcome == HALVED
            children = np.concatenate([some[halved], other[halved]])
            stuck.append(some[outcome == STUCK].copy())
            gone += float(before.sum() - _volumes(children).sum())
            looked, number = looked + len(some), number - len(some) + len(children)
            if len(children):
                waiting.append(children)
            report(gone / whole if whole else 1.0)
    return np.concatenate([start[:0], *waiting]), np.concatenate(stuck), looked


class _Choice:
    """A system with those of its formulas that have lately excluded boxes: most of them hardly ever
    do.

    All of them are evaluated over the first boxes, over some of all others, which tells what is
    worth it, and over those that would not be halved any more.
    """

    def __init__(self, system: CriticalSystem, pieces: Pieces, smallest: float):
        self._all, self._pieces, self._smallest = system, pieces, smallest
        self._some, self._chosen = (
            system,
            np.ones(len(system.zeros) + len(system.signs), dtype=bool),
        )
        self._told, self._looked = np.zeros(len(self._chosen)), 0

    def look(self, boxes: Any) -> tuple[Any, Any, Any]:
        """Boxes in another order, what becomes of them, and the second halves, as `search.look` has
        them.
        """
        parts = 1 if self._looked < LEARNT_FROM else SAMPLE
        boxes = boxes[np.argsort(np.arange(len(boxes)) % parts, kind="stable")]
        outcome, other = np.full(len(boxes), GONE), np.empty_like(boxes)
        tried = -(-len(boxes) // parts)
        self._told *= FORGETTING
        self._look(self._all, boxes[:tried], outcome[:tried], other[:tried], self._told)
        self._look(self._some, boxes[tried:], outcome[tried:], other[tried:])
        small = tried + np.flatnonzero(outcome[tried:] == STUCK)
        # copies, each of which is written back: a box that became smaller may be halved after all
        left, anew, second = boxes[small], outcome[small], other[small]
        self._look(self._all, left, anew, second)
        boxes[small], outcome[small], other[small] = left, anew, second
        self._looked += len(boxes)
        chosen = self._told >= WORTH * self._told.sum()
        if self._looked >= LEARNT_FROM and (chosen != self._chosen).any():
            self._chosen, self._some = chosen, self._all.with_some(chosen)
        return boxes, outcome, other

    def _look(
        self, system: CriticalSystem, boxes: Any, outcome: Any, other: Any, exclusions: Any = None
    ) -> None:
        if exclusions is None:
            exclusions = np.zeros(len(system.zeros) + len(system.signs))
        look(system.compiled(self._smallest), self._pieces, boxes, outcome, other, exclusions)


def _volumes(boxes: Any) -> Any:
    return (boxes[:, :, 1] - boxes[:, :, 0]).prod(axis=1)


def share_over(rests: Sequence[Any], pieces: Pieces) -> float:
    """At most this share of the window is under boxes that are left."""
    grid = np.zeros((GRID, GRID))
    for boxes in rests:
        spread(boxes, pieces.steps, grid)
    return float(np.minimum(grid, 1.0).mean()) * (1 + 1e-9)
