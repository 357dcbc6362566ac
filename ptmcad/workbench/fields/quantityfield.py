"""A quantity of one chosen equilibrium at every pixel of a map's window."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ptmcad.answer.boundaries import NONE, Grid
from ptmcad.answer.field import Field
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.fields.equations import Flags, Floats, Integers, ModelState, unknowns_of
from ptmcad.ask.pixels import grid as grid_of
from ptmcad.ask.solving import poses_at
from ptmcad.errors import ConfigError, expect
from ptmcad.model import Model
from ptmcad.model.compile import compiled
from ptmcad.model.work import acting
from ptmcad.options import Progress
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import values_at
from ptmcad.workbench.fields.barrier import barriers
from ptmcad.workbench.fields.fieldvalues import OPTION, Valued, quantity_of
from ptmcad.workbench.fields.pixelsolver import PixelSolver, filled, jumps

BATCH, LARGE_BATCH = 300, 20_000
"""Pixels at a time: what they take stays in the processor's cache; of descents few are long, which
go on together.
"""
MAX_LEFT = 3000
"""Pixels that are given to exact poses, one by one, where neighbours led nowhere."""
EQUAL = 1e-9
"""Energies this near are taken for equal, as those of mirrored poses are: then the larger first
unknown comes first, or the next one."""
CHECKS = 50
DIGITS = 12


@dataclass(frozen=True, slots=True)
class Choice:
    """Which of a point's solutions: the ``rank``-th, from 1, of a kind, in the order of `Poses`:
    stable ones first, then by energy. Kinds are ``stable``, ``unstable``, ``saddle``, ``maximum``
    and ``pose``, which is any."""

    kind: str
    rank: int

    def __str__(self) -> str:
        return f"{self.kind}:{self.rank}"

    def numbers(self, poses: Poses) -> list[int]:
        """Those of the poses that are of the kind."""
        own = [
            (poses.model.criterion.kind(pose.stable, pose.index), pose.stable)
            for pose in poses.equilibria
        ]
        names = [("pose", kind, "unstable" if stable is False else kind) for kind, stable in own]
        return [k for k, each in enumerate(names) if self.kind in each]


_NEEDED = {
    "pose": "total",
    "stable": "stable",
    "unstable": "stable",
    "saddle": "index",
    "maximum": "index",
}
"""The kinds, to the names of counts that tell them apart."""


def choice_of(text: str, model: Model) -> Choice:
    """``stable:1`` and the like.

    Raises
    ------
    ConfigError
        For another text, and for kinds that the model does not tell apart.
    """
    match = re.fullmatch(
        r"(stable|unstable|saddle|maximum|pose)(?::([1-9]\d{0,3}))?", text.strip(), re.ASCII
    )
    if match is None:
        raise ConfigError(
            f"{text!r} is not a pose such as stable:1, unstable:1, saddle:2, maximum:1 or pose:3",
            key="--pose",
        )
    if (needed := _NEEDED[match[1]]) not in model.criterion.counts:
        what = f"nothing says which solutions of {model.name} are stable"
        if needed == "index":
            what = f"solutions of {model.name} have no index: no {match[1]} is known"
        raise ConfigError(what, key="--pose")
    return Choice(match[1], int(match[2] or 1))


FieldRequest = tuple[Valued, Choice]
"""A quantity of a pose, both of which have a meaning for the slice."""


def request_of(slice: Slice, value: str, pose: str) -> FieldRequest:
    """What is asked for, before there is a map.

    Parameters
    ----------
    value : see `quantity_of`.
    pose : see `choice_of`.

    Raises
    ------
    ConfigError
        For a value or pose that has no meaning here.
    """
    expect(value, str, "value", "the name of a quantity, such as energy, or an expression as text")
    expect(pose, str, "pose", "one of the poses as text, such as stable:1")
    quantity, choice = quantity_of(value, slice), choice_of(pose, slice.model)
    if quantity.is_barrier:
        if choice.kind != "stable":
            raise ConfigError("a barrier is that of a stable pose: ask for stable:1", key="--pose")
        system = compiled(slice.model)
        if system.acting:
            what = acting(slice.model, [system.names[system.unknowns[k]] for k in system.acting])
            raise ConfigError(
                f"under the {what} a pose's energy is not what a barrier is counted from",
                key=OPTION,
            )
    return quantity, choice


def field_of(
    result: RegionMap,
    request: FieldRequest,
    columns: int = 400,
    rows: int | None = None,
    checks: int = CHECKS,
    progress: Progress = lambda _stage, _done, _total: None,
) -> Field:
    """A quantity of a pose at the centres of columns x rows pixels.

    Parameters
    ----------
    request : of the map's slice.
    checks : number of pixels that are compared with exact poses.
    progress : called as progress(stage, done, total).

    Raises
    ------
    ConfigError
        For what this map does not know, or a map without cells.
    """
    quantity, choice = request
    if result.only_stable:
        _check_stable(request)
    grid = grid_of(result, columns, rows)
    x, y = np.broadcast_arrays(grid.x[None, :], grid.y[:, None])
    solver = filled(result, x, y, grid.cell)
    missed = complete(solver, lambda r, c: centre(result, grid, r, c))
    values = np.full(grid.region.shape, np.nan)
    chosen = np.full(grid.region.shape, NONE, dtype=np.int64)
    places = np.nonzero(solver.done & (solver.total > 0))
    batch = LARGE_BATCH if quantity.is_barrier else BATCH
    for first in range(0, len(places[0]), batch):
        progress("pixels", first, len(places[0]))
        r, c = (p[first : first + batch] for p in places)
        values[r, c], chosen[r, c] = _at_pixels(solver, request, (r, c), solver.at[:, r, c])
    if quantity.is_barrier:  # there is one wherever there is another stable pose
        lacking = np.isnan(values) & solver.done & (grid.stable >= max(2, choice.rank))
        missed += int(lacking.sum())
    beyond = np.isinf(values)
    values[beyond] = np.nan
    other = jumps(solver, chosen, grid.region)
    number, difference = _checked(solver, request, values, checks)
    return Field(
        quantity.name,
        str(choice),
        quantity.unit,
        grid.x,
        grid.y,
        grid.names,
        values,
        grid.region,
        missed,
        number,
        difference,
        int(beyond.sum()),
        other,
    )


def _check_stable(request: FieldRequest) -> None:
    """Refuse what a map of the stable equilibria alone does not know."""
    quantity, choice = request
    if choice.kind != "stable":
        raise ConfigError(
            "this map knows the stable equilibria only: ask for stable:1", key="--pose"
        )
    if quantity.is_barrier:
        raise ConfigError(
            "this map knows the stable equilibria only, and a barrier is a saddle's", key=OPTION
        )


def expect_somewhere(result: RegionMap, choice: Choice) -> None:
    """Refuse a pose that the map's counts exclude from the whole window.

    Raises
    ------
    ConfigError
    """
    most = _most_of(result, choice.kind)
    if most is not None and most < choice.rank:
        few = (
            f"of its kind there are at most {most} at any point"
            if most
            else "nor any other of its kind"
        )
        raise ConfigError(f"there is no {choice} in the window: {few}", key="--pose")


def _most_of(result: RegionMap, kind: str) -> int | None:
    """What no point has more solutions of, for a kind of `Choice`, by the counts of all cells; None
    where these are unknown, or a part of the window is undetermined."""
    if not result.cells or result.cover is not None:
        return None
    found = []
    for cell in result.cells:
        if kind in ("stable", "pose"):
            number = cell.stable if kind == "stable" else cell.total
        elif kind == "unstable" or cell.index is None:
            # where the indices are not known, there are no more of one than are unstable
            if cell.total is None or cell.stable is None:
                return None
            number = cell.total - cell.stable
        else:
            number = cell.index[-1] if kind == "maximum" else sum(cell.index[1:-1])
        if number is None:
            return None
        found.append(number)
    return max(found)


def _at_pixels(
    solver: PixelSolver, request: FieldRequest, places: tuple[Integers, Integers], at: Floats
) -> tuple[Floats, Integers]:
    """The quantity of the chosen solution at pixels, and its number there, `NONE` without one; at :
    shape (n, pixels, most)."""
    (rows, columns), (quantity, choice) = places, request
    here = np.nan_to_num(at)
    turns = here[: solver.angles]
    # an angle of -180 degrees is one of 180, and rounding decides nothing
    turns[turns < EQUAL - np.pi] += 2 * np.pi
    state = solver.state(rows, columns, here)
    there = ~np.isnan(at[0])
    order, fits = _in_order(state, here, there, choice)
    own = np.arange(len(rows))
    number = np.cumsum(np.take_along_axis(fits, order, axis=1), axis=1)
    hit = (number == choice.rank) & np.take_along_axis(fits, order, axis=1)
    found = hit.any(axis=1)
    k = order[own, hit.argmax(axis=1)]
    if quantity.is_barrier:

        def evaluate(pixels: Integers, points: Floats) -> ModelState:
            return solver.state(rows[pixels], columns[pixels], points)

        values = barriers(evaluate, at, k, solver.angles)
    else:
        axes = dict(zip(solver.result.slice.axis_names, (solver.x, solver.y), strict=True))
        given = {
            name: v[rows, columns][:, None] if np.ndim(v) else v
            for name, v in {**solver.values, **axes}.items()
        }
        values = quantity.values(state, here, given)[own, k]
    return np.where(found, values, np.nan), np.where(found, k, NONE)


def _in_order(
    state: ModelState, at: Floats, there: Flags, choice: Choice
) -> tuple[Integers, Flags]:
    """The solutions in the order of `Poses`, shape (pixels, most), and which are of the chosen
    kind.
    """
    stable = state.stable & there
    energy = (
        np.zeros(there.shape) if state.energy is None else np.where(there, state.energy, np.inf)
    )
    size = np.max(np.abs(np.where(there, energy, 0.0)), axis=1, keepdims=True)
    # equal up to rounding: the same multiple of a tolerance, or of the next
    ascending = np.argsort(energy, axis=1, kind="stable")
    steps = np.diff(
        np.take_along_axis(np.where(there, energy, 1e300), ascending, axis=1), axis=1
    ) > EQUAL * (size + 1e-300)
    rank = np.zeros(there.shape, dtype=np.int64)
    np.put_along_axis(rank, ascending[:, 1:], np.cumsum(steps, axis=1), axis=1)
    # the larger unknown first
    order = np.lexsort((*(-np.round(p, 9) for p in at[::-1]), rank, ~stable, ~there), axis=1)
    match choice.kind:
        case "pose":
            return order, there
        case "stable":
            return order, stable
        case "unstable":
            return order, there & ~stable
    negative = state.negatives
    all_ = negative == len(at)
    return order, there & (all_ if choice.kind == "maximum" else (negative > 0) & ~all_)


def complete(solver: PixelSolver, point: Callable[[int, int], tuple[Fraction, Fraction]]) -> int:
    """Exact poses where neighbours led nowhere; the number of places that stay without their
    solutions.

    Parameters
    ----------
    point : gives the exact coordinates of a row and a column.
    """
    total, done = solver.total, solver.done
    for row, column in np.argwhere(~done & (total > 0))[:MAX_LEFT].tolist():
        poses = exact_at(solver.result, *point(row, column))
        points = [unknowns_of(p) for p in poses.equilibria]
        if len(points) != total[row, column]:  # of a map of the stable ones only
            points = [unknowns_of(p) for p in poses.equilibria if p.stable]
        if len(points) == total[row, column]:
            solver.at[:, row, column, : len(points)] = np.array(points).T
            done[row, column] = True
    return int((~done & (total > 0)).sum())


def centre(
    result: RegionMap, grid: Grid | PixelSolver, row: int, column: int
) -> tuple[Fraction, Fraction]:
    """A pixel's centre, exactly."""
    (x, y), (rows, columns) = result.slice.axes, grid.cell.shape
    return x.middle(column, columns), y.middle(row, rows)


def exact_at(result: RegionMap, x: Fraction, y: Fraction) -> Poses:
    """All solutions at a point of the slice."""
    return poses_at(result.slice.model, values_at(result.slice.parameters, x, y), DIGITS)


def _checked(
    solver: PixelSolver, request: FieldRequest, values: Floats, checks: int
) -> tuple[int, float]:
    """How many random pixels were compared with exact poses, and the largest difference as a share.

    Where certified poses could not be distinguished there is nothing to compare with.
    """
    result, (quantity, choice) = solver.result, request
    rows, columns = np.nonzero(~np.isnan(values))
    if not len(rows) or not checks:
        return 0, 0.0
    size = float(np.nanmax(np.abs(values))) or 1.0
    source = random.Random(f"{result.slice.name} {quantity.name} {choice}")
    picked = source.sample(range(len(rows)), min(checks, len(rows)))
    compared = []
    for k in picked:
        poses = exact_at(result, *centre(result, solver, int(rows[k]), int(columns[k])))
        if poses.equilibria and poses.status is not Status.UNDECIDED:
            compared.append((k, np.array([unknowns_of(p) for p in poses.equilibria]).T))
    if not compared:
        return 0, 0.0
    # all at once: for one pixel alone a barrier takes as long as for a thousand
    at = np.full((len(compared[0][1]), len(compared), max(p.shape[1] for _, p in compared)), np.nan)
    for n, (_, points) in enumerate(compared):
        at[:, n, : points.shape[1]] = points
    own = [k for k, _ in compared]
    places = (rows[own], columns[own])
    exact, _ = _at_pixels(solver, request, places, at)
    difference = np.abs(exact - values[places]) / size
    return len(compared), float(np.where(np.isnan(difference), np.inf, difference).max())
