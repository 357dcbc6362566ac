"""A quantity of one chosen equilibrium at every pixel of a map's window."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.boundaries import Grid
from ptmcad.answer.field import Field
from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.fields.barrier import barriers
from ptmcad.ask.fields.branches import Filling, Follower, filled, wanted_of
from ptmcad.ask.fields.equations import State, eigenvalues
from ptmcad.ask.fields.jets import Floats
from ptmcad.ask.fields.quantities import BARRIER, Quantity, quantity_of
from ptmcad.ask.pixels import grid as grid_of
from ptmcad.ask.solving import poses_at
from ptmcad.errors import ConfigError
from ptmcad.mechanism import Mechanism, Model
from ptmcad.mechanism.moments import acting
from ptmcad.mechanism.work import split_moments

BATCH, LARGE_BATCH = 300, 20_000
"""Pixels at a time: what they take stays in the processor's cache; of descents few are long, which go on together."""
MAX_LEFT = 3000
"""Pixels that are given to exact poses, one by one, where neighbours led nowhere."""
EQUAL = 1e-9
"""Energies this near are taken for equal, as those of mirrored poses are: then the larger first unknown comes first,
or the next one."""
CHECKS = 50
DIGITS = 12


@dataclass(frozen=True, slots=True)
class Choice:
    """Which of a point's solutions: the ``rank``-th, from 1, of a kind, in the order of `Poses`: stable ones first,
    then by energy. Kinds are ``stable``, ``unstable``, ``saddle``, ``maximum`` and ``pose``, which is any."""

    kind: str
    rank: int

    def __str__(self) -> str:
        return f"{self.kind}:{self.rank}"


def choice_of(text: str, model: Model) -> Choice:
    """``stable:1`` and the like.

    Raises
    ------
    ConfigError
        For another text, and for kinds that the model does not tell apart.
    """
    match = re.fullmatch(r"(stable|unstable|saddle|maximum|pose)(?::([1-9]\d{0,3}))?", text.strip(), re.ASCII)
    if match is None:
        raise ConfigError(
            f"{text!r} is not a pose such as stable:1, unstable:1, saddle:2, maximum:1 or pose:3", key="--pose"
        )
    if match[1] in ("saddle", "maximum") and not model.has_potential:
        raise ConfigError(f"solutions of {model.name} have no index: no {match[1]} is known", key="--pose")
    if match[1] in ("stable", "unstable") and not model.tells_stability:
        raise ConfigError(f"nothing says which solutions of {model.name} are stable", key="--pose")
    return Choice(match[1], int(match[2] or 1))


def field_of(
    result: RegionMap,
    value: str = "energy",
    pose: str = "stable:1",
    columns: int = 400,
    rows: int | None = None,
    checks: int = CHECKS,
    check: Callable[[], None] = lambda: None,
) -> Field:
    """A quantity of a pose at the centres of columns x rows pixels.

    Parameters
    ----------
    value : see `quantity_of`.
    pose : see `choice_of`.
    checks : number of pixels that are compared with exact poses.
    check : called again and again; may raise to stop.

    Raises
    ------
    ConfigError
        For a value or pose that has no meaning here, or a map without cells.
    """
    model = result.slice.model
    quantity, choice = quantity_of(value, result.slice), choice_of(pose, model)
    _check_request(result, quantity, choice)
    grid = grid_of(result, columns, rows)
    solutions = filled(result, grid, check)
    wanted = wanted_of(result, grid)
    if wanted.only_stable and choice.kind != "stable":
        raise ConfigError("this map knows the stable equilibria only: ask for stable:1", key="--pose")
    if wanted.only_stable and quantity.name == BARRIER:
        raise ConfigError("this map knows the stable equilibria only, and a barrier is a saddle's", key="--value")
    missed = _complete(result, grid, solutions, wanted.total, check)
    follower = Follower(result, grid, wanted)
    values = np.full(grid.region.shape, np.nan)
    places = np.nonzero(solutions.done & (wanted.total > 0))
    batch = LARGE_BATCH if quantity.name == BARRIER else BATCH
    for first in range(0, len(places[0]), batch):
        check()
        r, c = (p[first : first + batch] for p in places)
        values[r, c] = _at_pixels(model, quantity, choice, follower, (r, c), solutions.at[:, r, c])
    if quantity.name == BARRIER:  # there is one wherever there is another stable pose
        missed += int((np.isnan(values) & solutions.done & (grid.stable >= max(2, choice.rank))).sum())
    number, difference = _checked(result, quantity, choice, values, follower, checks)
    return Field(
        quantity.name, str(choice), quantity.unit, grid.x, grid.y, grid.names, values, grid.region, missed, number,
        difference,
    )  # fmt: skip


def _check_request(result: RegionMap, quantity: Quantity, choice: Choice) -> None:
    if quantity.name != BARRIER:
        return
    if choice.kind != "stable":
        raise ConfigError("a barrier is that of a stable pose: ask for stable:1", key="--pose")
    model = result.slice.model
    if isinstance(model, Mechanism) and (steady := split_moments(model).steady):
        what = acting(model, [moment.unknown for moment in steady])
        raise ConfigError(f"under the {what} a pose's energy is not what a barrier is counted from", key="--value")


def _at_pixels(
    model: Model,
    quantity: Quantity,
    choice: Choice,
    follower: Follower,
    places: tuple[NDArray[np.int64], NDArray[np.int64]],
    at: Floats,
) -> Floats:
    """The quantity of the chosen solution at pixels; at : shape (n, pixels, most)."""
    rows, columns = places
    here = np.nan_to_num(at)
    state = follower.state(rows, columns, here)
    there = ~np.isnan(at[0])
    order, fits = _in_order(model, state, at, there, choice)
    own = np.arange(len(rows))
    number = np.cumsum(np.take_along_axis(fits, order, axis=1), axis=1)
    hit = (number == choice.rank) & np.take_along_axis(fits, order, axis=1)
    found = hit.any(axis=1)
    k = order[own, hit.argmax(axis=1)]
    if quantity.name == BARRIER:

        def evaluate(pixels: NDArray[np.int64], points: Floats) -> State:
            return follower.state(rows[pixels], columns[pixels], points)

        stable = _is_stable(model, state) & there
        values = barriers(evaluate, at, stable, k, len(model.angles))
    else:
        given = {name: v[rows, columns] if np.ndim(v) else v for name, v in follower.values.items()}
        axes = dict(zip(follower.grid.names, (follower.grid.x[columns], follower.grid.y[rows]), strict=True))
        given = {name: np.asarray(v)[:, None] if np.ndim(v) else v for name, v in {**given, **axes}.items()}
        values = quantity.values(state, here, given)[own, k]
    return np.where(found, values, np.nan)


def _is_stable(model: Model, state: State) -> NDArray[np.bool_]:
    if model.has_potential:
        return np.asarray(eigenvalues(state.jacobian)[0] > 0)
    return (
        np.logical_and.reduce([c > 0 for c in state.stability])
        if state.stability
        else np.zeros_like(state.residuals[0], dtype=np.bool_)
    )


def _in_order(
    model: Model, state: State, at: Floats, there: NDArray[np.bool_], choice: Choice
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """The solutions in the order of `Poses`, shape (pixels, most), and which are of the chosen kind."""
    stable = _is_stable(model, state) & there if model.tells_stability else np.zeros_like(there)
    energy = np.zeros(there.shape) if state.energy is None else np.where(there, state.energy, np.inf)
    size = np.max(np.abs(np.where(there, energy, 0.0)), axis=1, keepdims=True)
    # equal up to rounding: the same multiple of a tolerance, or of the next
    ascending = np.argsort(energy, axis=1, kind="stable")
    steps = np.diff(np.take_along_axis(np.where(there, energy, 1e300), ascending, axis=1), axis=1) > EQUAL * (
        size + 1e-300
    )
    rank = np.zeros(there.shape, dtype=np.int64)
    np.put_along_axis(rank, ascending[:, 1:], np.cumsum(steps, axis=1), axis=1)
    # the larger unknown first; an angle of -180 degrees is one of 180, and rounding decides nothing
    places = np.nan_to_num(at).copy()
    turns = places[: len(model.angles)]
    turns[turns < EQUAL - np.pi] += 2 * np.pi
    order = np.lexsort((*(-np.round(p, 9) for p in places[::-1]), rank, ~stable, ~there), axis=1)
    kinds = {"pose": there, "stable": stable, "unstable": there & ~stable}
    if choice.kind in ("saddle", "maximum"):
        negative = (eigenvalues(state.jacobian) < 0).sum(axis=0)
        n = len(at)
        kinds |= {"saddle": there & (negative > 0) & (negative < n), "maximum": there & (negative == n)}
    return order, kinds[choice.kind]


def _complete(
    result: RegionMap, grid: Grid, solutions: Filling, total: NDArray[np.int64], check: Callable[[], None]
) -> int:
    """Exact poses where neighbours led nowhere; the number of pixels that stay without their solutions."""
    rows, columns = np.nonzero(~solutions.done & (total > 0))
    for row, column in list(zip(rows.tolist(), columns.tolist(), strict=True))[:MAX_LEFT]:
        check()
        poses = exact_at(result, *centre(result, grid, row, column))
        points = [_unknowns(p) for p in poses.equilibria]
        if len(points) != total[row, column]:  # of a map of the stable ones only
            points = [_unknowns(p) for p in poses.equilibria if p.stable]
        if len(points) == total[row, column]:
            solutions.at[:, row, column, : len(points)] = np.array(points).T
            solutions.done[row, column] = True
    return int((~solutions.done & (total > 0)).sum())


def centre(result: RegionMap, grid: Grid, row: int, column: int) -> tuple[Fraction, Fraction]:
    """A pixel's centre, exactly."""
    (x, y), (rows, columns) = result.slice.axes, grid.region.shape
    return (
        x.low + (x.high - x.low) * Fraction(2 * column + 1, 2 * columns),
        y.low + (y.high - y.low) * Fraction(2 * row + 1, 2 * rows),
    )


def exact_at(result: RegionMap, x: Fraction, y: Fraction) -> Poses:
    """All solutions at a point of the slice."""
    model = result.slice.model
    values = {name: e.evaluate(x, y) for name, e in result.slice.parameters.items()}
    return poses_at(model, values, DIGITS)


def _unknowns(pose: Pose) -> list[float]:
    return [float(e.center) for e in (*pose.angles, *pose.reals)]


def _checked(
    result: RegionMap, quantity: Quantity, choice: Choice, values: Floats, follower: Follower, checks: int
) -> tuple[int, float]:
    """How many random pixels were compared with exact poses, and the largest difference as a share.

    Where certified poses could not be told apart there is nothing to compare with.
    """
    rows, columns = np.nonzero(~np.isnan(values))
    if not len(rows) or not checks:
        return 0, 0.0
    size = float(np.nanmax(np.abs(values))) or 1.0
    source = random.Random(f"{result.slice.name} {quantity.name} {choice}")
    picked = source.sample(range(len(rows)), min(checks, len(rows)))
    worst, number = 0.0, 0
    for k in picked:
        row, column = int(rows[k]), int(columns[k])
        poses = exact_at(result, *centre(result, follower.grid, row, column))
        if not poses.equilibria:
            continue
        number += 1
        points = np.array([_unknowns(p) for p in poses.equilibria]).T[:, None, :]
        place = (rows[k : k + 1], columns[k : k + 1])
        exact = _at_pixels(result.slice.model, quantity, choice, follower, place, points)
        difference = abs(float(exact[0]) - float(values[row, column])) / size
        worst = max(worst, np.inf if np.isnan(difference) else difference)
    return number, worst
