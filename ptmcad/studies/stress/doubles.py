"""The equilibria at a point in double precision, as they are computed in practice: the baseline that can be wrong.

Not guaranteed: anything. Without free lengths: eigenvalues of the companion matrix of the sextic in t = tan(th2/2)
(`ptmcad.studies.sextic`), th1 from the first equation, the Hessian's signs in floats. It is treated kindly: th2 = pi,
which t cannot reach, is put back where the leading coefficients vanish. With free lengths: Newton's method from a grid
of starts. Deciding which roots are real, which are one, and what is zero takes tolerances; they are usual ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from ptmcad.mechanism import ptm
from ptmcad.studies.equilibria import SAME_POSE, IndexedPose, angle_error, guesses, in_doubles

REAL_TOLERANCE = 1e-8
"""A root is taken for real when its imaginary part is at most this much of 1 + its modulus."""
ZERO_TOLERANCE = 1e-12
"""A coefficient is taken for zero when it is at most this much of the largest."""
STARTS = 24
"""Starts of Newton's method along each angle."""


def double_poses(parameters: Mapping[str, Fraction]) -> tuple[IndexedPose, ...] | None:
    """The equilibria in double precision; None when numbers overflow or the eigenvalue method fails."""
    p = {name: float(value) for name, value in parameters.items()}
    with np.errstate(all="ignore"):
        if any(p.get(name) for name in ptm().free_lengths):
            return tuple(_pose(p, *angles) for angles in guesses(p, STARTS))
        return _companion(p)


def _companion(p: Mapping[str, float]) -> tuple[IndexedPose, ...] | None:
    a1, a2 = (p["k2"] + p["k3"]) * p["rho"] + p["F3x"], (p["k1"] + p["k3"]) * p["rho"] - p["F4x"]
    g, pull = p["k3"] * p["L2"], p["k3"] * p["L1"]
    square = a1 * a1 + p["F3"] ** 2 + g * g
    # highest degree first; not `ptmcad.studies.sextic`, whose products round in another order
    first_moment, second_moment = np.array([-p["F3"], 2 * a1, p["F3"]]), np.array([p["F4"], 2 * a2, -p["F4"]])
    length = np.array([square + 2 * a1 * g, 4 * g * p["F3"], square - 2 * a1 * g])
    left = pull**2 * np.convolve(np.convolve(first_moment, first_moment), [1.0, 0.0, 1.0])
    sextic = left - np.convolve(np.convolve(second_moment, second_moment), length)
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
    found: list[IndexedPose] = []
    for th2 in angles:
        c2, s2 = float(np.cos(th2)), float(np.sin(th2))
        p_value, q_value = p["F3"] * c2 + a1 * s2, a2 * s2 - p["F4"] * c2
        x, y = a1 - g * c2, p["F3"] + g * s2
        flat = abs(p_value) <= SAME_POSE * abs(a1) and abs(q_value) <= SAME_POSE * abs(a2)
        for sign in (1.0, -1.0) if flat else (float(np.sign(p_value * q_value)),):
            _adopt(found, _pose(p, float(np.arctan2(sign * y, sign * x)), th2))
    return tuple(found)


def _pose(p: Mapping[str, float], th1: float, th2: float) -> IndexedPose:
    h11, h12, h22 = _hessian(p, th1, th2)
    values = np.linalg.eigvalsh([[h11, h12], [h12, h22]])
    return IndexedPose(th1, th2, int((values < 0).sum()))


def _hessian(p: Mapping[str, float], th1: float, th2: float) -> tuple[float, float, float]:
    """Without free lengths written out, as one would; next to a fold signs depend on the order of such sums.

    The same sums derived from the description answer 7 of 3100 points otherwise, so that what is typed in here stays.
    """
    if any(p.get(name) for name in ptm().free_lengths):
        return in_doubles(p, np.array(th1), np.array(th2)).hessian
    x3, y3, turned, y4 = p["L1"] * np.cos(th1), p["L1"] * np.sin(th1), p["L2"] * np.cos(th2), p["L2"] * np.sin(th2)
    x4 = p["rho"] - turned
    h11, h22 = p["F3x"] * x3 + p["F3"] * y3, -p["F4x"] * turned + p["F4"] * y4
    h22 += p["k1"] * (p["L2"] ** 2 + x4 * turned - y4 * y4)
    h11 += p["k2"] * (p["L1"] ** 2 - ((x3 - p["rho"]) * x3 + y3 * y3))
    dx, dy = x4 - x3, y4 - y3
    h11 += p["k3"] * -1 * (-1 * p["L1"] ** 2 - (dx * x3 + dy * y3))
    h22 += p["k3"] * (p["L2"] ** 2 + dx * turned - dy * y4)
    return h11, -p["k3"] * (x3 * turned - y3 * y4), h22


def _adopt(found: list[IndexedPose], pose: IndexedPose) -> None:
    if not any(angle_error(q.th1, pose.th1) <= SAME_POSE and angle_error(q.th2, pose.th2) <= SAME_POSE for q in found):
        found.append(pose)
