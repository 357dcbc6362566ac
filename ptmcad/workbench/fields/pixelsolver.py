"""All solutions at every pixel, followed from the map's certified samples over the window.

Each pixel takes the solutions of a neighbour of the same count, and Newton's method leads them to
its own. A pixel is done when as many different solutions are found as the exact map counts there,
with as many of each index where that is known; then they are all, whatever way they came. Coarse
pixels come first, so that most have a near neighbour.

Not guaranteed: the last step, that a converged iteration is near a solution, is floating point.
What is not done in this way is left to exact poses, one by one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ptmcad.answer.boundaries import NONE, Grid
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
from ptmcad.model import Model

BATCH = 300
"""Pixels at a time: what they take stays in the processor's cache."""
STEPS = 12
"""Of Newton's method."""
SMALL = 1e-9
"""The last step, against the solution's size."""
APART = 1e-7
"""Solutions are different when they are further apart, and than a thousand last steps."""


@dataclass(frozen=True, slots=True)
class GridPoints:
    """Points of the window in rows, such that neighbours lie near each other: a grid's pixels, or
    steps of a path.

    All arrays have the shape (rows, columns): coordinates, and the number of the cell, `NONE` where
    there is none.
    """

    x: Floats
    y: Floats
    cell: Integers


def places_of(grid: Grid) -> GridPoints:
    """The centres of a grid's pixels."""
    x, y = np.broadcast_arrays(grid.x[None, :], grid.y[:, None])
    return GridPoints(x, y, grid.cell)


@dataclass(slots=True)
class Filling:
    """Solutions at pixels, shape (n, rows, columns, most); nan where there are fewer. ``done``
    where they are all.
    """

    at: Floats
    done: Flags


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
    """Newton's method for a slice's model at any of some places.

    Attributes
    ----------
    total : how many solutions each place has, by the map: all of them, or the stable ones where
        only these are known; `NONE` where it is not known.
    index : for each cell its counts by index; None where they are not known.
    """

    def __init__(self, result: RegionMap, places: GridPoints):
        self.model = result.slice.model
        self.names, self.places = result.slice.axis_names, places
        self.only_stable = result.only_stable
        counts = [c.stable if self.only_stable else c.total for c in result.cells]
        table = np.array([*(NONE if v is None else v for v in counts), NONE], dtype=np.int64)
        self.total: Integers = table[places.cell]
        self.index = tuple(c.index for c in result.cells)
        self.values = parameters_at(result.slice, places.x, places.y)
        self.angles = len(self.model.angles)

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
        if self.only_stable:
            return np.asarray(good & (state.stable | empty).all(axis=1))
        good &= ((determinant(state.jacobian) != 0) | empty).all(axis=1)
        negative, cells = (
            (eigenvalues(state.hessian) < 0).sum(axis=0),
            self.places.cell[rows, columns],
        )
        for cell in np.unique(cells):
            index = self.index[cell] if cell != NONE else None
            if index is not None:
                here = cells == cell
                for k, number in enumerate(index):
                    good[here] &= ((negative[here] == k) & ~empty[here]).sum(axis=1) == number
        return good


def filled(result: RegionMap, follower: PixelSolver) -> Filling:
    """The solutions at every pixel, as far as neighbours lead to them."""
    total = follower.total
    most = max(int(total.max()), 1)
    rows, columns = total.shape
    filling = Filling(
        np.full((len(result.slice.model.unknowns), rows, columns, most), np.nan), total <= 0
    )
    for stride in _strides(max(rows, columns)):
        seen = np.zeros((rows, columns), dtype=np.bool_)
        seen[::stride, ::stride] = True
        _spread(filling, follower, seen, stride)
        _begin(result, filling, follower, seen)
        _spread(filling, follower, seen, stride)
    return filling


def _strides(size: int) -> Iterator[int]:
    stride = 1
    while size / (2 * stride) > 24:
        stride *= 2
    while stride:
        yield stride
        stride //= 2


def _begin(
    result: RegionMap,
    filling: Filling,
    follower: PixelSolver,
    seen: Flags,
) -> None:
    """In each cell of which no pixel is done: from the sample's solutions to the pixels that are
    nearest to it.
    """
    cells = follower.places.cell
    finished = set(np.unique(cells[filling.done & (cells != NONE)]).tolist())
    for number in np.unique(cells[seen & ~filling.done & (cells != NONE)]).tolist():
        cell = result.cells[number]
        start = starting_points(result.slice.model, cell, follower.only_stable)
        if number in finished or not start.shape[1]:
            continue
        rows, columns = np.nonzero(seen & ~filling.done & (cells == number))
        x, y = float(cell.sample[0]), float(cell.sample[1])
        away = np.hypot(
            *(
                (at[rows, columns] - own) / (np.ptp(np.append(at, own)) or 1.0)
                for at, own in ((follower.places.x, x), (follower.places.y, y))
            )
        )
        nearest = np.argsort(away, kind="stable")[:9]
        if start.shape[1] == follower.total[rows[0], columns[0]]:
            guess = np.full((len(start), len(nearest), filling.at.shape[3]), np.nan)
            guess[:, :, : start.shape[1]] = start[:, None, :]
            _take(filling, follower, rows[nearest], columns[nearest], guess)


def _spread(filling: Filling, follower: PixelSolver, seen: Flags, stride: int) -> None:
    """From pixels that are done to their neighbours of the same count, until none is left that this
    helps.
    """
    total = follower.total
    steps = [
        (a * stride, b * stride)
        for a, b in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
    ]
    tried = {step: filling.done | ~seen for step in steps}
    moved = True
    while moved:
        moved = False
        for step in steps:
            rows, columns = np.nonzero(~tried[step] & ~filling.done)
            s, t = rows + step[0], columns + step[1]
            inside = (s >= 0) & (s < total.shape[0]) & (t >= 0) & (t < total.shape[1])
            rows, columns, s, t = rows[inside], columns[inside], s[inside], t[inside]
            use = filling.done[s, t] & (total[rows, columns] == total[s, t])
            rows, columns, s, t = rows[use], columns[use], s[use], t[use]
            tried[step][rows, columns] = True
            if len(rows):
                moved |= _take(filling, follower, rows, columns, filling.at[:, s, t])


def _take(
    filling: Filling, follower: PixelSolver, rows: Integers, columns: Integers, guess: Floats
) -> bool:
    """Solutions at pixels from a guess, kept where they are all; whether some are."""
    found = False
    for first in range(0, len(rows), BATCH):
        part = slice(first, first + BATCH)
        at, good = follower.solved(rows[part], columns[part], guess[:, part])
        r, c = rows[part][good], columns[part][good]
        filling.at[:, r, c] = at[:, good]
        filling.done[r, c] = True
        found |= bool(len(r))
    return found
