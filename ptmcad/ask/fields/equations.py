"""A model's equations at many points at once, in floating point: residuals, Jacobian, energy,
stability.

Guarantee: none but that of the compiled system, whose formulas and their derivatives are evaluated
in doubles.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.poses import Pose
from ptmcad.formulas.instructions import Doubles
from ptmcad.model import Model
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.question.slice import Slice, within_doubles

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


class ModelState(NamedTuple):
    """A model at points of shape S.

    Attributes
    ----------
    residuals : shape (n, *S): zero at a solution.
    jacobian : shape (n, n, *S): their derivatives.
    energy : shape S; None where there is no potential.
    conditions : what is positive at solutions that count.
    stability : without a potential what is positive at stable ones.
    points : of a mechanism without closed loops, by name.
    stretches : of its springs, in their order, length, free length and force, which is positive
        where the spring pulls.
    work : of moments, shape S; None where none works.
    hessian : the Jacobian where solutions are critical points, else without rows.
    """

    residuals: Floats
    jacobian: Floats
    energy: Floats | None
    conditions: tuple[Floats, ...] = ()
    stability: tuple[Floats, ...] = ()
    points: Mapping[str, tuple[Floats, Floats]] = MappingProxyType({})
    stretches: tuple[tuple[Floats, Floats, Floats], ...] = ()
    work: Floats | None = None
    hessian: Floats = np.empty((0, 1))

    @property
    def counts(self) -> Flags:
        """Where all conditions hold, shape S; one for all where there is no condition."""
        return np.asarray(np.all([condition > 0 for condition in self.conditions], axis=0))

    @property
    def known_energy(self) -> Floats:
        """Of a model that has one."""
        assert self.energy is not None
        return self.energy

    @property
    def height(self) -> Floats | None:
        """What descends: the energy less the moments' work, of which the residuals are the slopes;
        None without one.
        """
        return self.energy if self.energy is None or self.work is None else self.energy - self.work

    @property
    def stable(self) -> Flags:
        """Where solutions are stable, shape S; nowhere where nothing says which are."""
        margins = (*self.stability, *eigenvalues(self.hessian)[:1])
        if not margins:
            return np.zeros_like(self.residuals[0], dtype=np.bool_)
        return np.asarray(np.logical_and.reduce([margin > 0 for margin in margins]))

    @property
    def negatives(self) -> Integers:
        """The numbers of negative eigenvalues of the Hessian, shape S."""
        return np.asarray((eigenvalues(self.jacobian) < 0).sum(axis=0))


def state_at(model: Model, values: Mapping[str, Any], at: Floats) -> ModelState:
    """The model at values of its parameters (arrays that fit S; a free length that is not there is
    zero) and points.

    Parameters
    ----------
    at : shape (n, *S): angles in radians, then unknowns on the line.
    """
    system = compiled(model)
    known = dict.fromkeys(model.free_lengths, 0.0) | dict(values)
    given = {k: _shaped(known[name], at[0]) for k, name in enumerate(system.names) if name in known}
    given |= dict(zip(system.unknowns, at, strict=True))
    with np.errstate(
        divide="ignore", invalid="ignore"
    ):  # a spring without length has no direction: nan
        # a root has no slope at zero, so that there is none where no free length is
        relaxed = tuple(k for k, free in enumerate(_free_lengths(system).at(given)) if np.any(free))
        found = _formulas(system, relaxed).at(
            given, lambda value: np.broadcast_to(value, at.shape[1:])
        )
    jacobian = np.stack([np.stack(row) for row in found["jacobian"]])
    if (
        relaxed and system.tangent
    ):  # along loops, of which the compiled conditions are without free lengths
        found["stability"] = (determinant(jacobian),)
    found |= {"residuals": np.stack(found["residuals"]), "jacobian": jacobian}
    return ModelState(**found, hessian=jacobian[: system.criterion.order])


@lru_cache(maxsize=16)
def _free_lengths(system: CompiledSystem) -> Doubles:
    return Doubles(tuple(free for _, free, _ in system.stretches), np)


@lru_cache(maxsize=16)
def _formulas(system: CompiledSystem, relaxed: tuple[int, ...]) -> Doubles:
    """What a state consists of, with the free lengths of some springs."""
    equations = system.balance(relaxed)
    rows = [
        tuple(system.graph.derivative(equation, k) for k in system.unknowns)
        for equation in equations
    ]
    places = [[system.criterion.entry(i, j) for j in range(len(rows))] for i in range(len(rows))]
    found: dict[str, Any] = {
        "residuals": equations,
        # a Hessian is symmetric, of which the half is evaluated
        "jacobian": tuple(tuple(rows[i][j] for i, j in row) for row in places),
        "energy": system.potential(relaxed),
        "conditions": system.inequalities,
        "stability": system.stability,
        "points": system.shown.points,
        "stretches": system.shown.stretches,
        "work": system.work if system.acting else None,
    }
    return Doubles(found, np)


def _shaped(value: Any, like: Floats) -> Any:
    """Parameters of shape (pixels,) beside points of shape (pixels, solutions)."""
    array = np.asarray(value, dtype=float)
    return (
        array
        if array.ndim in (0, like.ndim)
        else array.reshape(array.shape + (1,) * (like.ndim - array.ndim))
    )


def determinant(matrix: Floats) -> Floats:
    """Of shape (n, n, *S)."""
    found: Floats = np.linalg.det(np.moveaxis(matrix, (0, 1), (-2, -1)))
    return found


def eigenvalues(hessian: Floats) -> Floats:
    """Of symmetric matrices of shape (n, n, *S), the smallest first: shape (n, *S)."""
    if len(hessian) < 2:
        own: Floats = hessian[:, 0]
        return own
    if len(hessian) == 2:
        half, spread = (hessian[0, 0] + hessian[1, 1]) / 2, (hessian[0, 0] - hessian[1, 1]) / 2
        root = np.hypot(spread, hessian[0, 1])
        return np.stack([half - root, half + root])
    matrices: Floats = np.moveaxis(hessian, (0, 1), (-2, -1))
    return np.moveaxis(np.asarray(np.linalg.eigvalsh(matrices), dtype=np.float64), -1, 0)


def newton_step(state: ModelState) -> Floats:
    """What Newton's method subtracts: shape (n, *S); nan where the Jacobian is singular."""
    a, b = state.jacobian, state.residuals
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if len(b) == 1:
            return np.asarray(b / a[0])
        if len(b) == 2:
            d = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
            return np.stack(
                [(a[1, 1] * b[0] - a[0, 1] * b[1]) / d, (a[0, 0] * b[1] - a[1, 0] * b[0]) / d]
            )
        d = determinant(a)
        columns = []
        for k in range(len(b)):
            replaced = a.copy()
            replaced[:, k] = b
            columns.append(determinant(replaced) / d)
        return np.stack(columns)


Evaluation = Callable[[Floats], ModelState]
"""From unknowns of shape (n, *S) to the model there."""


def newton(evaluate: Evaluation, start: Floats, most: int, small: float) -> tuple[Floats, Floats]:
    """Where Newton's method leads, in steps of at most 1, and the lengths of the last ones, shape
    S.

    Parameters
    ----------
    most : steps; fewer, when all are at most ``small``. What is not a number is left out of this.
    """
    at = start
    length = np.full(start.shape[1:], np.inf)
    with np.errstate(all="ignore"):
        for _ in range(most):
            step = newton_step(evaluate(at))
            length = np.sqrt((step**2).sum(axis=0))
            step = np.where(np.isfinite(step), step, np.nan)
            at = at - step * np.minimum(1.0, 1.0 / np.maximum(length, 1e-300))
            if not np.nanmax(length, initial=0.0) > small:
                break
    return at, length


def apart(one: Floats, other: Floats, angles: int) -> Floats:
    """One place less another, by at most half a turn in the first unknowns, which are angles; shape
    (n, *S).
    """
    gap = one - other
    gap[:angles] = np.remainder(gap[:angles] + np.pi, 2 * np.pi) - np.pi
    return gap


def parameters_at(slice: Slice, x: Floats, y: Floats) -> Mapping[str, Any]:
    """Every parameter of the model at points, given by arrays of coordinates of one shape: a
    number, or that shape.
    """
    found: dict[str, Any] = {}
    with within_doubles(slice):
        for name, e in slice.parameters.items():
            sides = [
                sum((float(c) * x**i * y**j for i, j, c in terms), 0.0 * x * y)
                for terms in (e.numerator, e.denominator)
            ]
            found[name] = float(e.constant()) if e.is_constant else sides[0] / sides[1]
    return found


def unknowns_of(pose: Pose) -> Floats:
    return np.array([float(e.center) for e in (*pose.angles, *pose.reals)])
