"""Equilibria of the paper's mechanism with free lengths: derivatives in any field, guesses in doubles, proofs in balls.

Guarantee: gradient and Hessian follow from the points, springs and loads of the description, by second-order jets; they
owe nothing to an engine. A box that `proved` accepts holds exactly one zero of the gradient, at which the Hessian is
nonsingular. Guesses prove nothing.

With q = |d|^2 for a spring of stiffness k and free length l0 along d, its energy k (sqrt q - l0)^2 / 2 has the
derivatives k (1 - l0/l) q_i / 2 and k (1 - l0/l) q_ij / 2 + k l0/l^3 q_i q_j / 4.

References: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations (1990), theorem 5.1.8;
Rump, Acta Numerica 19 (2010), section 13.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from flint import arb
from numpy.typing import NDArray

from ptmcad.mechanism import ptm
from ptmcad.mechanism.evaluate import evaluate
from ptmcad.text.balls import ball_of

ROUNDS = 60
RESIDUAL = 1e-9
"""A gradient is taken for zero when it is at most this much of the largest force times length."""
SAME_POSE = 1e-6
"""Poses no farther apart than this (radians) are taken for one."""

_FIRST, _SECOND = ((0,), (1,)), ((0, 0), (0, 1), (1, 1))


@dataclass(frozen=True, slots=True)
class Jet:
    """A value, at (), and derivatives by th1 and th2, at (0,), (1,), (0, 0), (0, 1) and (1, 1); what is absent is 0."""

    parts: Mapping[tuple[int, ...], Any]

    def __add__(self, other: Jet) -> Jet:
        total = dict(self.parts)
        for n, part in other.parts.items():
            total[n] = total[n] + part if n in total else part
        return Jet(total)

    def __sub__(self, other: Jet) -> Jet:
        return self + Jet({n: -part for n, part in other.parts.items()})

    def __mul__(self, other: Jet) -> Jet:
        total: dict[tuple[int, ...], Any] = {}
        for m, a in self.parts.items():
            for n, b in other.parts.items():
                if len(m) + len(n) <= 2:
                    both, term = tuple(sorted(m + n)), a * b if not m or m != n else 2 * (a * b)
                    total[both] = total[both] + term if both in total else term
        return Jet(total)


@dataclass(frozen=True, slots=True)
class _Jets:
    """Jets as a ring in which trees have values: parameters, and the angles' cosines and sines, in some field."""

    parameters: Mapping[str, Any]
    circles: Sequence[tuple[Any, Any]]

    def constant(self, value: Fraction) -> Jet:
        return Jet({(): value} if value else {})

    def parameter(self, name: str) -> Jet:
        value = self.parameters.get(name, 0)
        return Jet({} if value == 0 else {(): value})

    def cos(self, angle: str) -> Jet:
        n = ptm().angles.index(angle)
        c, s = self.circles[n]
        return Jet({(): c, (n,): -s, (n, n): -c})

    def sin(self, angle: str) -> Jet:
        n = ptm().angles.index(angle)
        c, s = self.circles[n]
        return Jet({(): s, (n,): c, (n, n): -s})


@dataclass(frozen=True, slots=True)
class IndexedPose:
    """A pose that is, or is taken for, an equilibrium: its angles, and the Hessian's number of negative eigenvalues."""

    th1: Any
    th2: Any
    index: int


class Derivatives(NamedTuple):
    """dU/dth1, dU/dth2; U11, U12, U22; and the springs' squared lengths."""

    gradient: tuple[Any, Any]
    hessian: tuple[Any, Any, Any]
    squares: tuple[Any, ...]


def derivatives(
    parameters: Mapping[str, Any], circles: Sequence[tuple[Any, Any]], root: Callable[[Any], Any]
) -> Derivatives:
    """The potential's derivatives at a pose.

    Parameters
    ----------
    parameters : by name, those that are missing being zero.
    circles : cosine and sine of th1 and of th2, elements of the parameters' field, or arrays.
    root : the field's square root; asked for springs with a free length only.
    """
    ring, mechanism = _Jets(parameters, circles), ptm()
    at = {name: (evaluate(x, ring), evaluate(y, ring)) for name, (x, y) in mechanism.points.items()}
    energy, squares = Jet({}), []
    for load in mechanism.loads:
        x, y = at[load.point]
        energy = energy - evaluate(load.x, ring) * x - evaluate(load.y, ring) * y
    for spring in mechanism.springs:
        dx, dy = (b - a for a, b in zip(at[spring.start], at[spring.end], strict=True))
        q = (dx * dx + dy * dy).parts
        k, free = (evaluate(tree, ring).parts.get((), 0) for tree in (spring.stiffness, spring.free))
        slack, bend = k / 2, 0
        if free != 0:
            length = root(q[()])
            slack, bend = k * (1 - free / length) / 2, k * free / length**3 / 4
        energy = energy + Jet({n: slack * part for n, part in q.items()})
        if free != 0:
            energy = energy + Jet({(i, j): bend * q[i,] * q[j,] for i, j in _SECOND if (i,) in q and (j,) in q})
        squares.append(q[()])
    first, second = (tuple(energy.parts.get(n, 0) for n in orders) for orders in (_FIRST, _SECOND))
    return Derivatives((first[0], first[1]), (second[0], second[1], second[2]), tuple(squares))


# ---------------------------------------------------------------------------------------------------------- in doubles

Floats = NDArray[np.float64]


def in_doubles(parameters: Mapping[str, float], th1: Floats, th2: Floats) -> Derivatives:
    """The derivatives at many poses."""
    return derivatives(parameters, [(np.cos(a), np.sin(a)) for a in (th1, th2)], np.sqrt)


def angle_error(a: float, b: float) -> float:
    """The distance of two angles on the circle."""
    return abs((a - b + np.pi) % (2 * np.pi) - np.pi)


def guesses(parameters: Mapping[str, float], starts: int) -> tuple[tuple[float, float], ...]:
    """Different poses to which Newton's method leads from a grid with so many starts along each angle."""
    grid = 2 * np.pi * (np.arange(starts) + 0.37) / starts - np.pi
    th1, th2 = (a.ravel() for a in np.meshgrid(grid, grid))
    with np.errstate(all="ignore"):
        for _ in range(ROUNDS):
            (g1, g2), (h11, h12, h22), _ = in_doubles(parameters, th1, th2)
            determinant = h11 * h22 - h12 * h12
            step1, step2 = (h22 * g1 - h12 * g2) / determinant, (h11 * g2 - h12 * g1) / determinant
            longest = np.maximum(1.0, 2 * np.hypot(step1, step2))  # steps of at most half a radian
            th1, th2 = th1 - step1 / longest, th2 - step2 / longest
        (g1, g2), _, _ = in_doubles(parameters, th1, th2)
        good = (np.hypot(g1, g2) <= RESIDUAL * scale(parameters)) & np.isfinite(th1) & np.isfinite(th2)
    found: list[tuple[float, float]] = []
    for pose in zip(th1[good], th2[good], strict=True):
        a, b = (float((angle + np.pi) % (2 * np.pi) - np.pi) for angle in pose)
        if not any(angle_error(a, c) <= SAME_POSE and angle_error(b, d) <= SAME_POSE for c, d in found):
            found.append((a, b))
    return tuple(found)


def scale(p: Mapping[str, float]) -> float:
    """The largest summand of the gradient: of a spring's or a load's moment about a joint."""
    mechanism = ptm()
    longest = max(p["L1"], p["L2"])
    span = max(p["rho"], longest, *(p.get(name, 0.0) for name in mechanism.free_lengths))
    loads = max(abs(p.get(name, 0.0)) for name in mechanism.forces)
    return max(max(p[name] for name in mechanism.stiffnesses) * span, loads) * longest


# ------------------------------------------------------------------------------------------------------------ in balls


def in_balls(parameters: Mapping[str, arb], angles: Sequence[arb]) -> Derivatives:
    """The derivatives at a pose, or over a box of angles."""
    return derivatives(parameters, [(a.cos(), a.sin()) for a in angles], lambda q: q.sqrt())


def balls(parameters: Mapping[str, Fraction]) -> dict[str, arb]:
    """The parameters at the context's precision."""
    return {name: ball_of(v) for name, v in parameters.items()}


def sign(value: arb) -> int:
    """The sign of a ball, 0 when it contains zero."""
    return int(value > 0) - int(value < 0)


def inverse(hessian: Sequence[arb]) -> tuple[arb, arb, arb] | None:
    """About the inverse of a symmetric matrix, exact numbers; None when it may be singular."""
    h11, h12, h22 = (arb(h.mid()) for h in hessian)
    determinant = h11 * h22 - h12 * h12
    if not sign(determinant):
        return None
    return arb((h22 / determinant).mid()), arb((-h12 / determinant).mid()), arb((h11 / determinant).mid())


def proved(parameters: Mapping[str, arb], middle: Sequence[arb], radius: arb) -> IndexedPose | None:
    """The equilibrium, in a box of angles, within a radius of two exact ones; None when Krawczyk's test shows none."""
    box = middle[0] + radius * arb(0, 1), middle[1] + radius * arb(0, 1)
    (g1, g2), over = in_balls(parameters, middle).gradient, in_balls(parameters, box)
    h11, h12, h22 = over.hessian
    rough = inverse(over.hessian)
    if rough is None:
        return None
    y11, y12, y22 = rough
    reach1 = abs(y11 * g1 + y12 * g2) + (abs(1 - y11 * h11 - y12 * h12) + abs(y11 * h12 + y12 * h22)) * radius
    reach2 = abs(y12 * g1 + y22 * g2) + (abs(y12 * h11 + y22 * h12) + abs(1 - y12 * h12 - y22 * h22)) * radius
    determinant = sign(h11 * h22 - h12 * h12)
    if not (reach1 < radius and reach2 < radius) or not determinant or (determinant > 0 and not sign(h11)):
        return None
    return IndexedPose(*box, 1 if determinant < 0 else 0 if h11 > 0 else 2)
