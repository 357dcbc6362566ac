"""Equilibria of the paper's mechanism in double precision, as they are computed in practice, at many points at once.

Guarantee: none; floating point and usual tolerances decide which roots are real, which poses are one, and what is zero.
The same input gives the same poses. Nothing is imported that is not needed: the methods are timed as processes.

`companion` takes eigenvalues of stacked companion matrices (numpy, hence LAPACK) of the sextic, see
`ptmcad.studies.byhand`, and th1 from the first equation. It is treated kindly: th2 = pi, which t cannot reach, is put
back where leading coefficients vanish, and where the mechanism is flat both th1 are taken. `newton` is Newton's method
from a grid of starts; an equilibrium that no start leads to is not found.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.studies.byhand import derivatives, parts, sextic

Floats = NDArray[np.float64]
Values = Mapping[str, Floats]
"""Of the parameters by name, each of shape (points,); one that is missing is zero."""
REAL_TOLERANCE = 1e-8
"""A root is taken for real when its imaginary part is at most this much of 1 + its modulus."""
ZERO_TOLERANCE = 1e-12
"""A coefficient is taken for zero when it is at most this much of the largest."""
SAME_POSE = 1e-6
"""Poses no farther apart than this (radians) are taken for one."""
ROUNDS = 60
"""Of Newton's method."""
RESIDUAL = 1e-9
"""A gradient is taken for zero when it is at most this much of the largest force times length."""


def companion(p: Values, real_tolerance: float = REAL_TOLERANCE) -> tuple[Floats, Floats]:
    """th1 and th2 of equilibria without free lengths, each of shape (12, points), NaN in places that have none.

    Two places belong to a root of the sextic; the second one has a pose where the mechanism is flat.

    Raises
    ------
    LinAlgError
        When numbers overflow, all coefficients vanish, or an eigenvalue is not found.
    """
    coefficients = np.stack(np.broadcast_arrays(*sextic(p)[0][::-1]))
    sizes = np.abs(coefficients)
    leading = (sizes > ZERO_TOLERANCE * sizes.max(axis=0)).argmax(axis=0)
    trailing = (coefficients[::-1] != 0).argmax(axis=0)
    th2 = np.full((6, len(leading)), np.nan)
    for first, last in {*zip(leading.tolist(), trailing.tolist(), strict=True)}:
        here = (leading == first) & (trailing == last)
        own = coefficients[first : 7 - last, here]
        degree = len(own) - 1
        matrices = np.zeros((own.shape[1], degree, degree))
        matrices[:, :1] = (-own[1:] / own[0]).T[:, None]
        matrices[:, np.arange(1, degree), np.arange(degree - 1)] = 1
        t = np.linalg.eigvals(matrices).T
        real = np.abs(t.imag) <= real_tolerance * (1 + np.abs(t))
        th2[:degree, here] = np.where(real, 2 * np.arctan(t.real), np.nan)
        th2[degree : degree + last, here] = 0
        th2[degree + last :, here] = np.pi
    v, w, x, y = parts(p, np.cos(th2), np.sin(th2))
    whole1, whole2, *_ = parts(p, 0.0, 1.0)
    flat = (np.abs(v) <= SAME_POSE * np.abs(whole1)) & (np.abs(w) <= SAME_POSE * np.abs(whole2))
    side = np.where(flat, 1.0, np.sign(v * w))
    th1 = np.stack([np.arctan2(side * y, side * x), np.where(flat, np.arctan2(-y, -x), np.nan)], axis=1)
    return th1.reshape(12, -1), np.repeat(th2, 2, axis=0)


def newton(p: Values, starts: int) -> tuple[Floats, Floats]:
    """th1 and th2 to which so many starts along each angle lead, of shape (starts^2, points), or NaN."""
    grid = 2 * np.pi * (np.arange(starts) + 0.37) / starts - np.pi
    th1, th2 = (a.reshape(-1, 1) + 0 * p["rho"] for a in np.meshgrid(grid, grid))
    for _ in range(ROUNDS):
        (g1, g2), (h11, h12, h22) = at(p, th1, th2)
        determinant = h11 * h22 - h12 * h12
        step1, step2 = (h22 * g1 - h12 * g2) / determinant, (h11 * g2 - h12 * g1) / determinant
        longest = np.maximum(1.0, 2 * np.hypot(step1, step2))  # steps of at most half a radian
        th1, th2 = th1 - step1 / longest, th2 - step2 / longest
    good = np.hypot(*at(p, th1, th2)[0]) <= RESIDUAL * scale(p)
    first, second = (np.where(good, (angle + np.pi) % (2 * np.pi) - np.pi, np.nan) for angle in (th1, th2))
    return first, second


def at(p: Values, th1: Floats, th2: Floats) -> tuple[Any, Any]:
    """Gradient and Hessian at many poses."""
    return derivatives(p, [(np.cos(a), np.sin(a)) for a in (th1, th2)], np.sqrt)


def scale(p: Mapping[str, Any]) -> Any:
    """The largest summand of the gradient: of a spring's or a load's moment about a joint."""
    longest = np.maximum(p["L1"], p["L2"])
    span = np.maximum.reduce([p["rho"], longest, *(value for name, value in p.items() if name.startswith("l0"))])
    loads = np.maximum.reduce([0 * longest, *(np.abs(value) for name, value in p.items() if name.startswith("F"))])
    return np.maximum(np.maximum.reduce([p["k1"], p["k2"], p["k3"]]) * span, loads) * longest


def distinct(th1: Floats, th2: Floats) -> NDArray[np.bool_]:
    """Where a pose is none that is taken for one before it at the same point."""
    kept = np.isfinite(th1) & np.isfinite(th2)
    before: list[int] = []
    for place in np.flatnonzero(kept.any(axis=1)).tolist():
        for earlier in before:
            errors = [angle_error(a[place], a[earlier]) for a in (th1, th2)]
            kept[place] &= ~(kept[earlier] & (np.maximum(*errors) <= SAME_POSE))
        if kept[place].any():
            before.append(place)
    return kept


def angle_error(a: Any, b: Any) -> Any:
    """The distance of two angles from -pi to pi on the circle."""
    gap = abs(a - b)
    return np.minimum(gap, abs(2 * np.pi - gap))
