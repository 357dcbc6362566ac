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
from ptmcad.studies.equilibria import SAME_POSE, IndexedPose, different, guesses, in_doubles
from ptmcad.studies.sextic import parts, sextic

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
        free = any(p.get(name) for name in ptm().free_lengths)
        angles = guesses(p, STARTS) if free else _companion(p)
        return None if angles is None else tuple(_pose(p, *pair) for pair in angles)


def _pose(p: Mapping[str, float], th1: float, th2: float) -> IndexedPose:
    h11, h12, h22 = in_doubles(p, np.array(th1), np.array(th2)).hessian
    return IndexedPose(th1, th2, int((np.linalg.eigvalsh([[h11, h12], [h12, h22]]) < 0).sum()))


def _companion(p: Mapping[str, float]) -> list[tuple[float, float]] | None:
    """Different pairs of angles."""
    coefficients = np.array(sextic(p)[0][::-1])
    largest = float(np.max(np.abs(coefficients), initial=0.0))
    if not np.isfinite(largest) or largest == 0:
        return None
    leading = int(np.argmax(np.abs(coefficients) > ZERO_TOLERANCE * largest))
    try:
        roots = np.roots(coefficients[leading:])
    except np.linalg.LinAlgError:
        return None
    second = [2 * float(np.arctan(r.real)) for r in roots if abs(r.imag) <= REAL_TOLERANCE * (1 + abs(r))]
    return different([(th1, th2) for th2 in second + [float(np.pi)] * leading for th1 in _first_angles(p, th2)])


def _first_angles(p: Mapping[str, float], th2: float) -> list[float]:
    """The angles th1 that belong to th2: both where the mechanism is flat."""
    v, w, x, y = parts(p, np.cos(th2), np.sin(th2))
    a1, a2, *_ = parts(p, 0.0, 1.0)
    flat = abs(v) <= SAME_POSE * abs(a1) and abs(w) <= SAME_POSE * abs(a2)
    return [float(np.arctan2(sign * y, sign * x)) for sign in ((1.0, -1.0) if flat else (np.sign(v * w),))]
