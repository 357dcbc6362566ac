"""Where a chosen solution is of another branch than at the neighbouring pixel, found by following
it.

From a pixel's centre the chosen solution is followed by Newton's method to the centre of the pixel
at the right and of the one above, in so many parts of the way as it takes. What it has become there
is the nearest of that pixel's solutions, of which all are known; it is another branch where this is
not the one that is chosen there. No threshold decides it: neither values nor energies are compared.

Not guaranteed: more than that. Newton's method in floating point may step from one solution's way
to another's.
"""

from __future__ import annotations

import numpy as np

from ptmcad.answer.boundaries import NONE
from ptmcad.ask.fields.equations import Flags, Floats, Integers, apart
from ptmcad.workbench.fields.pixelsolver import BATCH, PixelSolver

PARTS = (1, 4, 16, 64)
"""Of the way between two pixels: more are taken while the neighbour's solution is not met."""

Pixels = tuple[Integers, Integers]


def jumps(solver: PixelSolver, chosen: Integers, region: Integers) -> tuple[Flags, Flags]:
    """Between which neighbours of one region the branch of the chosen solution changes.

    Parameters
    ----------
    solver : with the solutions at all places.
    chosen : shape (rows, columns): the number of the chosen solution, `NONE` where there is none.
    region : shape (rows, columns).

    Returns
    -------
    For a pixel and its neighbour at the right, shape (rows, columns - 1), and above, shape
    (rows - 1, columns).
    """
    rows, columns = chosen.shape
    found = []
    for up in (0, 1):
        jump = np.zeros((rows - up, columns - 1 + up), dtype=np.bool_)
        here = (slice(0, rows - up), slice(0, columns - 1 + up))
        there = (slice(up, rows), slice(1 - up, columns))
        known = (chosen[here] != NONE) & (chosen[there] != NONE) & (region[here] == region[there])
        r, c = np.nonzero(known)
        for first in range(0, len(r), 100 * BATCH):
            part = slice(first, first + 100 * BATCH)
            own = (r[part], c[part])
            jump[own] = _differ(solver, chosen, own, (own[0] + up, own[1] + 1 - up))
        found.append(jump)
    return found[0], found[1]


def _differ(solver: PixelSolver, chosen: Integers, start: Pixels, end: Pixels) -> Flags:
    """Whether following the chosen solutions from pixels does not lead to those that are chosen at
    others.
    """
    apart = np.ones(len(start[0]), dtype=np.bool_)
    for parts in PARTS:
        (left,) = np.nonzero(apart)
        if not len(left):
            break
        a, b = ((rows[left], columns[left]) for rows, columns in (start, end))
        at = _followed(solver, solver.at[:, *a, chosen[a]], (a, b), parts)
        apart[left] = _nearest(at, solver.at[:, *b, :], solver.angles) != chosen[b]
    return apart


def _followed(solver: PixelSolver, at: Floats, ends: tuple[Pixels, Pixels], parts: int) -> Floats:
    """Solutions of shape (n, pixels), led along straight ways between pixels in equal parts; nan
    where that fails.
    """
    shares = np.arange(1, parts + 1) / parts
    x, y = (
        along[ends[0]][:, None] + (along[ends[1]] - along[ends[0]])[:, None] * shares
        for along in (solver.x, solver.y)
    )
    on_way = PixelSolver(solver.result, x, y, np.full(x.shape, NONE))
    rows = np.arange(len(at[0]))
    for step in range(parts):
        at = on_way.converged(rows, np.full(len(rows), step), at[:, :, None])[:, :, 0]
    return at


def _nearest(at: Floats, solutions: Floats, angles: int) -> Integers:
    """The number of the nearest of a pixel's solutions, shape (n, pixels, most); `NONE` for no
    point.
    """
    far = np.sqrt((apart(at[:, :, None], solutions, angles) ** 2).sum(axis=0))
    nearest = np.where(np.isnan(far), np.inf, far).argmin(axis=1)
    return np.where(np.isnan(at[0]), NONE, nearest)
