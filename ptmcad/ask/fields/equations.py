"""A model's equations at many points at once, in floating point: residuals, Jacobian, energy, stability.

Guarantee: none but that of the compiled system, whose formulas and their derivatives are evaluated in doubles.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.formulas.doubles import Doubles
from ptmcad.formulas.graph import Formula
from ptmcad.model import Model
from ptmcad.model.compile import CompiledSystem, compiled

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class State:
    """A model at points of shape S.

    Attributes
    ----------
    residuals : shape (n, *S): zero at a solution.
    jacobian : shape (n, n, *S): their derivatives.
    energy : shape S; None where there is no potential.
    conditions : what is positive at solutions that count.
    stability : without a potential what is positive at stable ones.
    points : of a mechanism without closed loops, by name.
    lengths, forces : of its springs, in their order; a force is positive where the spring pulls.
    work : of moments, shape S; None where none works.
    """

    residuals: Floats
    jacobian: Floats
    energy: Floats | None
    conditions: tuple[Floats, ...] = ()
    stability: tuple[Floats, ...] = ()
    points: Mapping[str, Floats] = field(default_factory=dict)
    lengths: tuple[Floats, ...] = ()
    forces: tuple[Floats, ...] = ()
    work: Floats | None = None

    @property
    def height(self) -> Floats | None:
        """What descends: the energy less the moments' work, of which the residuals are the slopes; None without one."""
        return self.energy if self.energy is None or self.work is None else self.energy - self.work


def state_at(model: Model, values: Mapping[str, Any], at: Floats) -> State:
    """The model at values of its parameters (arrays that fit S; a free length that is not there is zero) and points.

    Parameters
    ----------
    at : shape (n, *S): angles in radians, then unknowns on the line.
    """
    system = compiled(model)
    known = dict.fromkeys(model.free_lengths, 0.0) | dict(values)
    given = {k: _shaped(known[name], at[0]) for k, name in enumerate(system.names) if name in known}
    given |= dict(zip(system.unknowns, at, strict=True))
    with np.errstate(divide="ignore", invalid="ignore"):  # a spring without length has no direction: nan
        free = _free_lengths(system).at(given)[""]
        # a root has no slope at zero, so that there is none where no free length is
        relaxed = tuple(k for k, length in enumerate(free) if np.any(length))
        values_of = _formulas(system, relaxed).at(given)
    found = {name: _stacked(group, at.shape[1:]) for name, group in values_of.items()}
    residuals, jacobian = found["residuals"], found["jacobian"].reshape(len(at), *at.shape)
    return State(
        residuals,
        jacobian,
        next(iter(found["energy"]), None),
        tuple(found["conditions"]),
        (determinant(jacobian),) if relaxed and system.tangent else tuple(found["stability"]),
        dict(zip(system.points, found["points"].reshape(-1, 2, *at.shape[1:]), strict=False)),
        tuple(found["lengths"]),
        tuple(found["forces"]),
        next(iter(found["work"]), None),
    )


@lru_cache(maxsize=16)
def _free_lengths(system: CompiledSystem) -> Doubles:
    return Doubles({"": system.free_lengths}, np)


@lru_cache(maxsize=16)
def _formulas(system: CompiledSystem, relaxed: tuple[int, ...]) -> Doubles:
    """What a state consists of, with the free lengths of some springs."""
    equations = system.balance(relaxed)
    energy = system.energy(relaxed) if system.has_index else None
    formulas: dict[str, Sequence[Formula]] = dict.fromkeys(("points", "lengths", "forces", "work"), ())
    formulas |= {
        "residuals": equations,
        "jacobian": [
            system.graph.derivative(equations[i], system.unknowns[j])
            for i, j in _places(len(equations), symmetric=system.has_index)
        ],
        "energy": [] if energy is None else [energy],
        "conditions": system.inequalities,
        "stability": system.stability,
    }
    if system.are_slopes:
        formulas |= {
            "points": [coordinate for point in system.points.values() for coordinate in point],
            "lengths": system.lengths,
            "forces": system.forces,
            "work": [system.work] if system.acting else [],
        }
    return Doubles(formulas, np)


def _places(size: int, symmetric: bool) -> Iterator[tuple[int, int]]:
    """Of a matrix's entries; with those above the diagonal in place of those below."""
    for i, j in product(range(size), repeat=2):
        yield (min(i, j), max(i, j)) if symmetric else (i, j)


def _stacked(values: Sequence[Any], shape: tuple[int, ...]) -> Floats:
    """Numbers and arrays as one array of shape (number, *shape)."""
    found = np.empty((len(values), *shape))
    for row, value in zip(found, values, strict=True):
        row[...] = value
    return found


def _shaped(value: Any, like: Floats) -> Any:
    """Parameters of shape (pixels,) beside points of shape (pixels, solutions)."""
    array = np.asarray(value, dtype=float)
    return array if array.ndim in (0, like.ndim) else array.reshape(array.shape + (1,) * (like.ndim - array.ndim))


def determinant(matrix: Floats) -> Floats:
    """Of shape (n, n, *S)."""
    found: Floats = np.linalg.det(np.moveaxis(matrix, (0, 1), (-2, -1)))
    return found


def eigenvalues(hessian: Floats) -> Floats:
    """Of symmetric matrices of shape (n, n, *S), the smallest first: shape (n, *S)."""
    if len(hessian) == 1:
        only: Floats = hessian[0]
        return only
    if len(hessian) == 2:
        half, spread = (hessian[0, 0] + hessian[1, 1]) / 2, (hessian[0, 0] - hessian[1, 1]) / 2
        root = np.hypot(spread, hessian[0, 1])
        return np.stack([half - root, half + root])
    matrices: Floats = np.moveaxis(hessian, (0, 1), (-2, -1))
    return np.moveaxis(np.asarray(np.linalg.eigvalsh(matrices), dtype=np.float64), -1, 0)


def newton_step(state: State) -> Floats:
    """What Newton's method subtracts: shape (n, *S); nan where the Jacobian is singular."""
    a, b = state.jacobian, state.residuals
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if len(b) == 1:
            return np.asarray(b / a[0])
        if len(b) == 2:
            d = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
            return np.stack([(a[1, 1] * b[0] - a[0, 1] * b[1]) / d, (a[0, 0] * b[1] - a[1, 0] * b[0]) / d])
        d = determinant(a)
        columns = []
        for k in range(len(b)):
            replaced = a.copy()
            replaced[:, k] = b
            columns.append(determinant(replaced) / d)
        return np.stack(columns)
