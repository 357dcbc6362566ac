"""The other rival: at each grid point, scipy's root finder from many starts in (theta1, theta2), duplicates removed.

Guarantee: none for the counts: a start may run away, and an equilibrium that no start leads to is not counted. The same
input and seed give the same counts.

It runs as ``python -m ptmcad.studies.bench.multistart QUESTION N RESULT SEED`` and imports no algebra.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from ptmcad.studies.bench.companion import Moments, Values, main

Array = NDArray[np.float64]
STARTS = 5
"""Along each angle: 25 starts a point."""
RESIDUAL = 1e-9
"""Of the equations, relative to the sizes of their terms."""
SAME_SOLUTION = 1e-5
"""Two solutions closer than this in both angles are one."""


def counts(values: Values, moments: Moments, seed: int) -> NDArray[np.int8]:
    """Stable and total counts at each point, of shape (2, points).

    Parameters
    ----------
    moments : the functions of `ptmcad.studies.moments`.
    """
    number = len(values["rho"])
    generator = np.random.default_rng(seed)
    found = np.zeros((2, number), dtype=np.int8)
    places = (np.arange(STARTS) + 0.5) * (2 * np.pi / STARTS) - np.pi
    starts = np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 2)
    for k in range(number):
        moved = starts + generator.uniform(-0.5, 0.5, starts.shape) * (2 * np.pi / STARTS)
        found[:, k] = _count({name: float(array[k]) for name, array in values.items()}, moments, moved)
    return found


def _count(p: dict[str, float], moments: Moments, starts: Array) -> tuple[int, int]:
    a, (first, second), equations = moments["coefficients"](p), moments["factors"](p), moments["equations"]
    scale = sum(map(abs, a))

    def gradient(angles: Array) -> tuple[Array, Array]:
        (c1, c2), (s1, s2) = np.cos(angles), np.sin(angles)
        e1, e2, e11, e12, e21, e22 = equations(a, c1, s1, c2, s2)
        return np.array([e1, e2]), np.array([[e11, e12], [e21, e22]])

    seen: list[Array] = []
    stable = 0
    for start in starts:
        answer: Any = root(gradient, start, jac=True, method="hybr")
        angles = answer.x
        value, slope = gradient(angles)
        if not np.abs(value).max() < RESIDUAL * scale:
            continue
        if any(np.abs(np.remainder(angles - other + np.pi, 2 * np.pi) - np.pi).max() < SAME_SOLUTION for other in seen):
            continue
        seen.append(angles)
        # the Hessian's rows are these slopes times the factors
        stable += bool(first * slope[0, 0] > 0 and first * second * np.linalg.det(slope) > 0)
    return stable, len(seen)


if __name__ == "__main__":
    main(sys.argv[1:], counts)
