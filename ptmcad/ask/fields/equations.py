"""A model's equations in floating point, from its description: residuals, Jacobian, energy, stability.

Guarantee: none but that of the description: terms are read off it, and no model is known by name.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ptmcad.ask.fields.jets import Floats, Jet, cos_sin, unknowns
from ptmcad.model import ClosedMechanism, Mechanism, Model, System
from ptmcad.model.energy import points_in, with_springs
from ptmcad.model.evaluate import evaluate
from ptmcad.model.work import split_moments


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
    points : of a mechanism, by name.
    lengths, forces : of its springs, in their order; a force is positive where the spring pulls.
    work : of moments, shape S; None where none works.
    """

    residuals: Floats
    jacobian: Floats
    energy: Floats | None
    conditions: tuple[Floats, ...] = ()
    stability: tuple[Floats, ...] = ()
    points: Mapping[str, tuple[Floats, Floats]] | None = None
    lengths: tuple[Floats, ...] = ()
    forces: tuple[Floats, ...] = ()
    work: Floats | None = None

    @property
    def height(self) -> Floats | None:
        """What descends: the energy less the moments' work, of which the residuals are the slopes; None without one."""
        return self.energy if self.energy is None or self.work is None else self.energy - self.work


@dataclass(frozen=True, slots=True)
class _Ring:
    """Numbers and jets, as what trees take values in."""

    values: Mapping[str, Any]
    jets: Mapping[str, Jet]
    turns: Mapping[str, tuple[Jet, Jet]]

    def constant(self, value: Fraction) -> Any:
        return float(value)

    def parameter(self, name: str) -> Any:
        return self.jets[name] if name in self.jets else self.values[name]

    def cos(self, angle: str) -> Any:
        return self.turns[angle][0]

    def sin(self, angle: str) -> Any:
        return self.turns[angle][1]


def state_at(model: Model, values: Mapping[str, Any], at: Floats) -> State:
    """The model at values of its parameters (arrays that fit S; a free length that is not there is zero) and points.

    Parameters
    ----------
    at : shape (n, *S): angles in radians, then unknowns on the line.
    """
    names = (*model.angles, *model.reals)
    jets = dict(zip(names, unknowns(at), strict=True))
    known = dict.fromkeys(model.free_lengths, 0.0) | dict(values)
    turns = cos_sin(tuple(jets[name] for name in model.angles))
    ring = _Ring(
        {name: _shaped(known[name], at[0]) for name in known}, jets, dict(zip(model.angles, turns, strict=True))
    )
    # the ring's protocol asks for more than arrays' types tell
    evaluated: Any = ring
    with np.errstate(divide="ignore", invalid="ignore"):  # a spring without length has no direction: nan
        if isinstance(model, Mechanism):
            return _mechanism(model, evaluated, at)
        if isinstance(model, ClosedMechanism) and model.tangent and _has_free_lengths(model, evaluated):
            return _along_loops(model, evaluated, at)
    assert isinstance(model, System)
    conditions = tuple(_jet(evaluate(tree, evaluated), at).value for tree in model.inequalities)
    stability = tuple(_jet(evaluate(tree, evaluated), at).value for tree in model.stability)
    if model.potential is not None:
        energy = _jet(evaluate(model.potential, evaluated), at)
        return State(energy.gradient, energy.hessian, energy.value, conditions)
    equations = [_jet(evaluate(tree, evaluated), at) for tree in model.equations]
    residuals = np.stack([e.value for e in equations])
    return State(residuals, np.stack([e.gradient for e in equations]), None, conditions, stability)


def _mechanism(model: Mechanism, ring: Any, at: Floats) -> State:
    points = {name: (_jet(x, at), _jet(y, at)) for name, (x, y) in points_in(model, ring).items()}
    energy = _jet(0.0, at)
    lengths, forces = [], []
    for spring in model.springs:
        (x0, y0), (x1, y1) = points[spring.start], points[spring.end]
        k, free = evaluate(spring.stiffness, ring), evaluate(spring.free, ring)
        dx, dy = x1 - x0, y1 - y0
        square = dx * dx + dy * dy
        if np.any(free):
            length = square.root()
            energy = energy + (length - free) * (length - free) * (k / 2)
            lengths.append(length.value)
        else:
            energy = energy + square * (k / 2)
            lengths.append(np.sqrt(np.maximum(square.value, 0)))
        forces.append(k * (lengths[-1] - free))
    energy = with_springs(model, ring, points, energy)
    work = None
    residuals, jacobian = energy.gradient, energy.hessian
    if steady := split_moments(model).steady:
        residuals, jacobian = residuals.copy(), jacobian.copy()
        for moment in steady:
            k = (*model.angles, *model.reals).index(moment.unknown)
            value = _jet(evaluate(moment.value, ring), at)
            residuals[k] -= value.value
            jacobian[k] -= value.gradient
            work = value.value * at[k] + (0.0 if work is None else work)
    places = {name: (x.value, y.value) for name, (x, y) in points.items()}
    potential = energy.value if model.has_potential else None
    return State(residuals, jacobian, potential, points=places, lengths=tuple(lengths), forces=tuple(forces), work=work)


def _has_free_lengths(model: ClosedMechanism, ring: Any) -> bool:
    return any(np.any(evaluate(spring.free, ring)) for spring in model.mechanism.springs)


def _along_loops(model: ClosedMechanism, ring: Any, at: Floats) -> State:
    """With one degree of freedom left: the loops' equations and the energy's slope along them, T . grad U."""
    energy = _mechanism(model.mechanism, ring, at)
    closed = [_jet(evaluate(tree, ring), at) for tree in model.equations[:-1]]
    tangent = [_jet(evaluate(tree, ring), at) for tree in model.tangent]
    slope = np.sum([t.value * force for t, force in zip(tangent, energy.residuals, strict=True)], axis=0)
    bent = np.sum(
        [t.gradient * f + t.value * row for t, f, row in zip(tangent, energy.residuals, energy.jacobian, strict=True)],
        axis=0,
    )
    residuals = np.stack([*(g.value for g in closed), slope])
    jacobian = np.stack([*(g.gradient for g in closed), bent])
    return State(residuals, jacobian, None, (), (determinant(jacobian),))


def _jet(value: Any, at: Floats) -> Jet:
    """A number as a function that does not change."""
    if isinstance(value, Jet):
        return value
    n, shape = len(at), at.shape[1:]
    constant = np.broadcast_to(np.asarray(value, dtype=float), shape) + 0.0
    return Jet(constant, np.zeros((n, *shape)), np.zeros((n, n, *shape)))


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
