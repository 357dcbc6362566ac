"""The equilibria at a point in double precision, as they are computed in practice: the baseline that can be wrong.

Not guaranteed: anything. Without free lengths: eigenvalues of the companion matrix of the sextic in t = tan(th2/2)
(see `ptmcad.studies.stress.reference`), th1 from the first equation, the Hessian's signs in floats. It is treated
kindly: th2 = pi, which t cannot reach, is put back where the leading coefficients vanish. With free lengths: Newton's
method from a grid of starts. Deciding which roots are real, which are one, and what is zero takes tolerances; they are
usual ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

REAL_TOLERANCE = 1e-8
"""A root is taken for real when its imaginary part is at most this much of 1 + its modulus."""
ZERO_TOLERANCE = 1e-12
"""A coefficient is taken for zero when it is at most this much of the largest."""
SAME_POSE = 1e-6
"""Poses no farther apart than this (radians) are taken for one."""
STARTS = 24
"""Starts along each angle."""
ROUNDS = 60
RESIDUAL = 1e-9
"""A gradient is taken for zero when it is at most this much of the largest force times length."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class DoublePose:
    """A pose that the double-precision method takes for an equilibrium, with its index (0 is stable)."""

    th1: float
    th2: float
    index: int


def double_poses(parameters: Mapping[str, Fraction]) -> tuple[DoublePose, ...] | None:
    """The equilibria in double precision; None when numbers overflow or the eigenvalue method fails."""
    p = {name: float(value) for name, value in parameters.items()}
    with np.errstate(all="ignore"):
        if any(p.get(name) for name in ("l0_1", "l0_2", "l0_3")):
            return _multistart(p)
        return _companion(p)


def _companion(p: Mapping[str, float]) -> tuple[DoublePose, ...] | None:
    a1, a2 = (p["k2"] + p["k3"]) * p["rho"] + p["F3x"], (p["k1"] + p["k3"]) * p["rho"] - p["F4x"]
    g, pull = p["k3"] * p["L2"], p["k3"] * p["L1"]
    square = a1 * a1 + p["F3"] ** 2 + g * g
    # highest degree first
    first_moment, second_moment = np.array([-p["F3"], 2 * a1, p["F3"]]), np.array([p["F4"], 2 * a2, -p["F4"]])
    length = np.array([square + 2 * a1 * g, 4 * g * p["F3"], square - 2 * a1 * g])
    left = pull**2 * np.convolve(np.convolve(first_moment, first_moment), [1.0, 0.0, 1.0])
    right = np.convolve(np.convolve(second_moment, second_moment), length)
    sextic = left - right
    largest = float(np.max(np.abs(sextic), initial=0.0))
    if not np.isfinite(largest) or largest == 0:
        return None
    leading = 0
    while leading < 6 and abs(sextic[leading]) <= ZERO_TOLERANCE * largest:
        leading += 1
    try:
        roots = np.roots(sextic[leading:])
    except np.linalg.LinAlgError:
        return None
    angles = [2 * float(np.arctan(r.real)) for r in roots if abs(r.imag) <= REAL_TOLERANCE * (1 + abs(r))]
    angles += [float(np.pi)] * leading
    found: list[DoublePose] = []
    for th2 in angles:
        c2, s2 = float(np.cos(th2)), float(np.sin(th2))
        p_value, q_value = p["F3"] * c2 + a1 * s2, a2 * s2 - p["F4"] * c2
        x, y = a1 - g * c2, p["F3"] + g * s2
        flat = abs(p_value) <= SAME_POSE * abs(a1) and abs(q_value) <= SAME_POSE * abs(a2)
        for sign in (1.0, -1.0) if flat else (float(np.sign(p_value * q_value)),):
            _adopt(found, _pose(p, float(np.arctan2(sign * y, sign * x)), th2))
    return tuple(found)


def _pose(p: Mapping[str, float], th1: float, th2: float) -> DoublePose:
    _, hessian = _gradient_and_hessian(p, np.array([th1]), np.array([th2]))
    values = np.linalg.eigvalsh([[hessian[0][0], hessian[1][0]], [hessian[1][0], hessian[2][0]]])
    return DoublePose(th1, th2, int((values < 0).sum()))


def _adopt(found: list[DoublePose], pose: DoublePose) -> None:
    if not any(angle_error(q.th1, pose.th1) <= SAME_POSE and angle_error(q.th2, pose.th2) <= SAME_POSE for q in found):
        found.append(pose)


def angle_error(a: float, b: float) -> float:
    """The distance of two angles on the circle."""
    return abs((a - b + np.pi) % (2 * np.pi) - np.pi)


def _multistart(p: Mapping[str, float]) -> tuple[DoublePose, ...]:
    grid = 2 * np.pi * (np.arange(STARTS) + 0.37) / STARTS - np.pi
    th1, th2 = (a.ravel() for a in np.meshgrid(grid, grid))
    for _ in range(ROUNDS):
        (g1, g2), (h11, h12, h22) = _gradient_and_hessian(p, th1, th2)
        determinant = h11 * h22 - h12 * h12
        step1, step2 = (h22 * g1 - h12 * g2) / determinant, (h11 * g2 - h12 * g1) / determinant
        longest = np.maximum(1.0, 2 * np.hypot(step1, step2))  # steps of at most half a radian
        th1, th2 = th1 - step1 / longest, th2 - step2 / longest
    (g1, g2), _ = _gradient_and_hessian(p, th1, th2)
    good = np.hypot(g1, g2) <= RESIDUAL * scale(p)
    found: list[DoublePose] = []
    for a, b in zip(th1[good], th2[good], strict=True):
        if np.isfinite(a) and np.isfinite(b):
            _adopt(found, _pose(p, float((a + np.pi) % (2 * np.pi) - np.pi), float((b + np.pi) % (2 * np.pi) - np.pi)))
    return tuple(found)


def scale(p: Mapping[str, float]) -> float:
    """The largest summand of the gradient: of a spring's or a load's moment about a joint."""
    longest = max(p["L1"], p["L2"])
    span = max(p["rho"], p["L1"], p["L2"], *(p.get(name, 0.0) for name in ("l0_1", "l0_2", "l0_3")))
    loads = max(abs(p[name]) for name in ("F3", "F4", "F3x", "F4x"))
    return max(max(p["k1"], p["k2"], p["k3"]) * span, loads) * longest


def _gradient_and_hessian(
    p: Mapping[str, float], th1: Floats, th2: Floats
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats, Floats]]:
    """dU/dth1, dU/dth2 and U11, U12, U22 at many poses."""
    c1, s1, c2, s2 = np.cos(th1), np.sin(th1), np.cos(th2), np.sin(th2)
    x3, y3, turned, y4 = p["L1"] * c1, p["L1"] * s1, p["L2"] * c2, p["L2"] * s2
    x4 = p["rho"] - turned
    g1, g2 = p["F3x"] * y3 - p["F3"] * x3, -p["F4x"] * y4 - p["F4"] * turned
    h11, h22, h12 = p["F3x"] * x3 + p["F3"] * y3, -p["F4x"] * turned + p["F4"] * y4, np.zeros_like(th1)
    for number, dx, dy, by1, by2 in (
        ("1", x4, y4, 0, 1), ("2", x3 - p["rho"], y3, 1, 0), ("3", x4 - x3, y4 - y3, -1, 1),
    ):  # fmt: skip
        length = np.hypot(dx, dy)
        free = p.get(f"l0_{number}", 0.0)
        slack = p[f"k{number}"] * (1 - free / length if free else 1.0)
        bend = p[f"k{number}"] * free / length**3 if free else 0.0
        along1, along2 = by1 * (dy * x3 - dx * y3), by2 * (dx * y4 + dy * turned)
        g1, g2 = g1 + slack * along1, g2 + slack * along2
        h11 = h11 + bend * along1**2 + slack * by1 * (by1 * p["L1"] ** 2 - (dx * x3 + dy * y3))
        h22 = h22 + bend * along2**2 + slack * by2 * (by2 * p["L2"] ** 2 + dx * turned - dy * y4)
        h12 = h12 + bend * along1 * along2 + slack * by1 * by2 * (x3 * turned - y3 * y4)
    return (g1, g2), (h11, h12, h22)
