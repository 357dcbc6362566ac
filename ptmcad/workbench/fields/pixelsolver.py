"""All solutions at every pixel, followed from the map's certified samples over the window; and where
a chosen one is of another branch than at the neighbouring pixel.

Each pixel takes the solutions of a neighbour of the same count, and Newton's method leads them to
its own. A pixel is done when as many different solutions are found as the exact map counts there,
with as many of each index where that is known; then they are all, whatever way they came. Coarse
pixels come first, so that most have a near neighbour.

Not guaranteed: the last step, that a converged iteration is near a solution, is floating point.
What is not done in this way is left to exact poses, one by one.

For the branches the chosen solution is followed from a pixel's centre to that of the pixel at the
right and of the one above, in so many parts of the way as it takes. What it has become there is the
nearest of that pixel's solutions, of which all are known; it is another branch where this is not
the one that is chosen there. No threshold decides it: neither values nor energies are compared.
Newton's method in floating point may step from one solution's way to another's.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ptmcad.answer.boundaries import NONE
from ptmcad.answer.regionmap import Cell, RegionMap
from ptmcad.ask.fields.equations import (
    Flags,
    Floats,
    Integers,
    ModelState,
    apart,
    determinant,
    eigenvalues,
    newton,
    parameters_at,
    state_at,
)
from ptmcad.ask.pixels import at_pixels
from ptmcad.model import Model

BATCH = 300
"""Pixels at a time: what they take stays in the processor's cache."""
STEPS = 12
"""Of Newton's method."""
SMALL = 1e-9
"""The last step, against the solution's size."""
APART = 1e-7
"""Solutions are different when they are further apart, and than a thousand last steps."""


def starting_points(model: Model, cell: Cell, only_stable: bool) -> Floats:
    """The certified solutions at a cell's sample: shape (n, number)."""
    angles, width = len(model.angles), 2 * len(model.angles) + len(model.reals)
    chosen = [s for s in cell.solutions if not only_stable or not set(s.signs) - {"+"}]
    found = np.zeros((len(model.unknowns), len(chosen)))
    for k, solution in enumerate(chosen):
        values = [float(v) for v in solution.center]
        if len(values) >= width:
            found[:angles, k] = np.arctan2(values[1 : 2 * angles : 2], values[0 : 2 * angles : 2])
            found[angles:, k] = values[2 * angles : width]
        else:
            found[:, k] = values[: len(found)]
    return found


class PixelSolver:
    """Newton's method for a slice's model at points of the window in rows, such that neighbours lie
    near each other: a grid's pixels, or steps of a path; and the solutions that it has found.

    Attributes
    ----------
    x, y, cell : shape (rows, columns): coordinates, and the number of the cell, `NONE` where there
        is none.
    total : how many solutions each place has, by the map: all of them, or the stable ones where
        only these are known; `NONE` where it is not known.
    at : shape (n, rows, columns, most): the solutions; nan where there are fewer.
    done : where they are all.
    """

    def __init__(self, result: RegionMap, x: Floats, y: Floats, cell: Integers):
        self.result, self.model = result, result.slice.model
        self.x, self.y, self.cell = x, y, cell
        counts = (c.stable if result.only_stable else c.total for c in result.cells)
        self.total: Integers = at_pixels(counts, cell)
        self.values = parameters_at(result.slice, x, y)
        self.angles = len(self.model.angles)
        most = max(int(self.total.max()), 1)
        self.at = np.full((len(self.model.unknowns), *cell.shape, most), np.nan)
        self.done: Flags = self.total <= 0

    def state(self, rows: Integers, columns: Integers, at: Floats) -> ModelState:
        """At pixels, points of shape (n, pixels, solutions)."""
        values = {name: v[rows, columns] if np.ndim(v) else v for name, v in self.values.items()}
        return state_at(self.model, values, at)

    def solved(self, rows: Integers, columns: Integers, start: Floats) -> tuple[Floats, Flags]:
        """Where Newton's method leads from points of shape (n, pixels, solutions), and where these
        are all.
        """
        empty = np.isnan(start[0])
        at, length, converged = self._led(rows, columns, start)
        with np.errstate(all="ignore"):
            good = converged.all(axis=1) & self._different(at, length, empty)
            good &= self._right_kinds(rows, columns, at, empty)
        at[:, empty] = np.nan
        return at, good

    def converged(self, rows: Integers, columns: Integers, start: Floats) -> Floats:
        """Where Newton's method leads from points of shape (n, pixels, solutions), each alone; nan
        if nowhere.
        """
        at, _, converged = self._led(rows, columns, start)
        at[:, ~converged | np.isnan(start[0])] = np.nan
        return at

    def _led(
        self, rows: Integers, columns: Integers, start: Floats
    ) -> tuple[Floats, Floats, Flags]:
        """Where Newton's method leads, the lengths of its last steps, and where it has converged or
        had no start.
        """
        at, length = newton(lambda at: self.state(rows, columns, at), start, STEPS, SMALL / 100)
        converged = (length <= SMALL * (1 + np.sqrt((at**2).sum(axis=0)))) | np.isnan(start[0])
        return apart(at, np.zeros_like(at), self.angles), length, converged

    def _different(self, at: Floats, length: Floats, empty: Flags) -> Flags:
        """Whether no two of a pixel's solutions are the same."""
        good = np.ones(at.shape[1], dtype=np.bool_)
        for a in range(at.shape[2]):
            for b in range(a):
                gap = apart(at[:, :, a], at[:, :, b], self.angles)
                near = np.abs(gap).max(axis=0) <= np.maximum(
                    APART, 1000 * (length[:, a] + length[:, b])
                )
                good &= ~near | empty[:, a] | empty[:, b]
        return good

    def _right_kinds(self, rows: Integers, columns: Integers, at: Floats, empty: Flags) -> Flags:
        """Whether the solutions count, and as many have each index as the map says."""
        state = self.state(rows, columns, np.nan_to_num(at))
        good = np.asarray((state.counts | empty).all(axis=1))
        if self.result.only_stable:
            return np.asarray(good & (state.stable | empty).all(axis=1))
        good &= ((determinant(state.jacobian) != 0) | empty).all(axis=1)
        negative, cells = (eigenvalues(state.hessian) < 0).sum(axis=0), self.cell[rows, columns]
        for cell in np.unique(cells):
            index = self.result.cells[cell].index if cell != NONE else None
            if index is not None:
                here = cells == cell
                for k, number in enumerate(index):
                    good[here] &= ((negative[here] == k) & ~empty[here]).sum(axis=1) == number
        return good


def filled(result: RegionMap, x: Floats, y: Floats, cell: Integers) -> PixelSolver:
    """The solutions at places as of `PixelSolver`, as far as neighbours lead to them."""
    solver = PixelSolver(result, x, y, cell)
    for stride in _strides(max(cell.shape)):
        seen = np.zeros(cell.shape, dtype=np.bool_)
        seen[::stride, ::stride] = True
        _spread(solver, seen, stride)
        _begin(solver, seen)
        _spread(solver, seen, stride)
    return solver


def _strides(size: int) -> Iterator[int]:
    stride = 1
    while size / (2 * stride) > 24:
        stride *= 2
    while stride:
        yield stride
        stride //= 2


def _begin(solver: PixelSolver, seen: Flags) -> None:
    """In each cell of which no pixel is done: from the sample's solutions to the pixels that are
    nearest to it.
    """
    cells, done = solver.cell, solver.done
    finished = set(np.unique(cells[done & (cells != NONE)]).tolist())
    for number in np.unique(cells[seen & ~done & (cells != NONE)]).tolist():
        cell = solver.result.cells[number]
        start = starting_points(solver.model, cell, solver.result.only_stable)
        if number in finished or not start.shape[1]:
            continue
        rows, columns = np.nonzero(seen & ~done & (cells == number))
        ways = (
            (at[rows, columns] - float(own)) / (np.ptp(np.append(at, float(own))) or 1.0)
            for at, own in zip((solver.x, solver.y), cell.sample, strict=True)
        )
        nearest = np.argsort(np.hypot(*ways), kind="stable")[:9]
        if start.shape[1] == solver.total[rows[0], columns[0]]:
            guess = np.full((len(start), len(nearest), solver.at.shape[3]), np.nan)
            guess[:, :, : start.shape[1]] = start[:, None, :]
            _take(solver, rows[nearest], columns[nearest], guess)


def _spread(solver: PixelSolver, seen: Flags, stride: int) -> None:
    """From pixels that are done to their neighbours of the same count, until none is left that this
    helps.
    """
    total, done = solver.total, solver.done
    steps = [
        (a * stride, b * stride)
        for a, b in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
    ]
    tried = {step: done | ~seen for step in steps}
    moved = True
    while moved:
        moved = False
        for step in steps:
            own = np.argwhere(~tried[step] & ~done)
            other = own + step
            inside = ((other >= 0) & (other < total.shape)).all(axis=1)
            (rows, columns), (s, t) = own[inside].T, other[inside].T
            use = done[s, t] & (total[rows, columns] == total[s, t])
            rows, columns, s, t = rows[use], columns[use], s[use], t[use]
            tried[step][rows, columns] = True
            if len(rows):
                moved |= _take(solver, rows, columns, solver.at[:, s, t])


def _take(solver: PixelSolver, rows: Integers, columns: Integers, guess: Floats) -> bool:
    """Solutions at pixels from a guess, kept where they are all; whether some are."""
    found = False
    for first in range(0, len(rows), BATCH):
        part = slice(first, first + BATCH)
        at, good = solver.solved(rows[part], columns[part], guess[:, part])
        r, c = rows[part][good], columns[part][good]
        solver.at[:, r, c] = at[:, good]
        solver.done[r, c] = True
        found |= bool(len(r))
    return found


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
