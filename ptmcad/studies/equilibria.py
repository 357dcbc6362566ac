"""Equilibria of the paper's mechanism with free lengths: derivatives in any field, guesses in doubles, proofs in balls.

Guarantee: gradient and Hessian are derived by hand and owe nothing to an engine; tests hold them against the
description. A pose that `newton_pose` gives is the only zero of the gradient in its box, with a nonsingular Hessian.
Guesses prove nothing.

A spring of stiffness k, free length l0 and squared length q has the energy k (sqrt q - l0)^2 / 2. Its derivatives,
K q_i / 2 and K q_ij / 2 + k l0/l^3 (q_i / 2) (q_j / 2), are those of a spring without free length and with the
stiffness K = k (1 - l0/l), but for the last term. The squares are

    q1 = rho^2 + L2^2 - 2 rho L2 c2,    q2 = rho^2 + L1^2 - 2 rho L1 c1,
    q3 = rho^2 + L1^2 + L2^2 - 2 rho (L1 c1 + L2 c2) + 2 L1 L2 c12.

References: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations (1990), theorem 5.1.8;
Rump, Acta Numerica 19 (2010), section 13.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat, ctx
from numpy.typing import NDArray

from ptmcad.mechanism import ptm
from ptmcad.text.balls import ball_of

BITS = 600
ROUNDS = 60
"""Of Newton's method."""
RESIDUAL = 1e-9
"""A gradient is taken for zero when it is at most this much of the largest force times length."""
SAME_POSE = 1e-6
"""Poses no farther apart than this (radians) are taken for one."""


@dataclass(frozen=True, slots=True)
class IndexedPose:
    """A pose that is, or is taken for, an equilibrium: its angles, and the Hessian's number of negative eigenvalues."""

    th1: Any
    th2: Any
    index: int


class Derivatives(NamedTuple):
    """dU/dth1 and dU/dth2; U11, U12 and U22."""

    gradient: tuple[Any, Any]
    hessian: tuple[Any, Any, Any]


def derivatives(
    parameters: Mapping[str, Any], circles: Sequence[tuple[Any, Any]], root: Callable[[Any], Any]
) -> Derivatives:
    """The potential's derivatives at a pose.

    Parameters
    ----------
    parameters : by name, those that are missing being zero.
    circles : cosine and sine of th1 and of th2, elements of the parameters' field, or arrays.
    root : the field's square root, of either sign; asked for the springs with a free length only, in their order.
    """
    p: dict[str, Any] = {**dict.fromkeys(ptm().parameters, 0), **parameters}
    rho, first, second = p["rho"], p["L1"], p["L2"]
    (c1, s1), (c2, s2) = circles
    x, y, z = rho * first * c1, rho * second * c2, first * second * (c1 * c2 - s1 * s2)
    u, v, w = rho * first * s1, rho * second * s2, first * second * (s1 * c2 + c1 * s2)
    springs = (
        (rho**2 + second**2 - 2 * y, (0, v)),
        (rho**2 + first**2 - 2 * x, (u, 0)),
        (rho**2 + first**2 + second**2 - 2 * (x + y) + 2 * z, (u - w, v - w)),
    )
    pulls, bends = [], [0, 0, 0]
    for number, (square, (a, b)) in enumerate(springs, 1):
        k, free = p[f"k{number}"], p[f"l0_{number}"]
        if free != 0:
            length = root(square)
            bends = [old + k * free / length**3 * new for old, new in zip(bends, (a * a, a * b, b * b), strict=True)]
            k = k * (1 - free / length)
        pulls.append(k)
    k1, k2, k3 = pulls
    return Derivatives(
        (
            k2 * u + k3 * (u - w) + first * (p["F3x"] * s1 - p["F3"] * c1),
            k1 * v + k3 * (v - w) - second * (p["F4x"] * s2 + p["F4"] * c2),
        ),
        (
            k2 * x + k3 * (x - z) + first * (p["F3x"] * c1 + p["F3"] * s1) + bends[0],
            bends[1] - k3 * z,
            k1 * y + k3 * (y - z) + second * (p["F4"] * s2 - p["F4x"] * c2) + bends[2],
        ),
    )


# ---------------------------------------------------------------------------------------------------------- in doubles

Floats = NDArray[np.float64]


def in_doubles(parameters: Mapping[str, float], th1: Floats, th2: Floats) -> Derivatives:
    """The derivatives at many poses."""
    return derivatives(parameters, [(np.cos(a), np.sin(a)) for a in (th1, th2)], np.sqrt)


def angle_error(a: float, b: float) -> float:
    """The distance of two angles on the circle."""
    return abs((a - b + np.pi) % (2 * np.pi) - np.pi)


def different(poses: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The poses without those that are taken for one before them."""
    found: list[tuple[float, float]] = []
    for pose in poses:
        if all(max(map(angle_error, pose, other)) > SAME_POSE for other in found):
            found.append(pose)
    return found


def guesses(parameters: Mapping[str, float], starts: int) -> list[tuple[float, float]]:
    """Different poses to which Newton's method leads from a grid with so many starts along each angle."""
    grid = 2 * np.pi * (np.arange(starts) + 0.37) / starts - np.pi
    th1, th2 = (a.ravel() for a in np.meshgrid(grid, grid))
    with np.errstate(all="ignore"):
        for _ in range(ROUNDS):
            (g1, g2), (h11, h12, h22) = in_doubles(parameters, th1, th2)
            determinant = h11 * h22 - h12 * h12
            step1, step2 = (h22 * g1 - h12 * g2) / determinant, (h11 * g2 - h12 * g1) / determinant
            longest = np.maximum(1.0, 2 * np.hypot(step1, step2))  # steps of at most half a radian
            th1, th2 = th1 - step1 / longest, th2 - step2 / longest
        (g1, g2), _ = in_doubles(parameters, th1, th2)
        good = (np.hypot(g1, g2) <= RESIDUAL * scale(parameters)) & np.isfinite(th1) & np.isfinite(th2)
    turned = ((angles[good] + np.pi) % (2 * np.pi) - np.pi for angles in (th1, th2))
    return different(list(zip(*(angles.tolist() for angles in turned), strict=True)))


def scale(p: Mapping[str, float]) -> float:
    """The largest summand of the gradient: of a spring's or a load's moment about a joint."""
    mechanism = ptm()
    longest = max(p["L1"], p["L2"])
    span = max(p["rho"], longest, *(p.get(name, 0.0) for name in mechanism.free_lengths))
    loads = max(abs(p.get(name, 0.0)) for name in mechanism.forces)
    return max(max(p[name] for name in mechanism.stiffnesses) * span, loads) * longest


# ------------------------------------------------------------------------------------------------------------ in balls


def in_balls(parameters: Mapping[str, arb], angles: Sequence[arb]) -> tuple[arb_mat, arb_mat]:
    """Gradient and Hessian at a pose, or over a box of angles."""
    (g1, g2), (h11, h12, h22) = derivatives(parameters, [(a.cos(), a.sin()) for a in angles], arb.sqrt)
    return arb_mat([[g1], [g2]]), arb_mat([[h11, h12], [h12, h22]])


def sign(value: arb) -> int:
    """The sign of a ball, 0 when it contains zero."""
    return int(value > 0) - int(value < 0)


def newton_pose(
    parameters: Mapping[str, Fraction], start: tuple[arb | float, arb | float], bits: int = BITS
) -> IndexedPose | None:
    """The equilibrium that Newton's method finds from a start, proved by Krawczyk's test; None when it finds none.

    Parameters
    ----------
    start : th1, th2 in radians.
    bits : of precision; the pose is enclosed within 2^(-2/3 bits) of its angles.
    """
    with ctx.workprec(bits):
        p, radius = {name: ball_of(v) for name, v in parameters.items()}, arb(2) ** (-2 * bits // 3)
        middle = [arb(arb(a).mid()) for a in start]
        try:
            for _ in range(ROUNDS):
                gradient, hessian = in_balls(p, middle)
                step = (hessian.mid().inv() * gradient).entries()
                middle = [arb((a - s).mid()) for a, s in zip(middle, step, strict=True)]
                if all(abs(s) < radius for s in step):
                    break
            box = [a + radius * arb(0, 1) for a in middle]
            gradient, hessian = in_balls(p, middle)[0], in_balls(p, box)[1]
            inverse = hessian.mid().inv().mid()
        except ZeroDivisionError:  # a Hessian that is singular, or not finite
            return None
        at, rest = inverse * gradient, arb_mat(2, 2, 1) - inverse * hessian
        reaches = [abs(at[n, 0]) + (abs(rest[n, 0]) + abs(rest[n, 1])) * radius for n in (0, 1)]
        determinant, first = sign(hessian.det()), sign(hessian[0, 0])
        if not all(reach < radius for reach in reaches) or not determinant or (determinant > 0 and not first):
            return None
        return IndexedPose(box[0], box[1], 1 if determinant < 0 else 0 if first > 0 else 2)
