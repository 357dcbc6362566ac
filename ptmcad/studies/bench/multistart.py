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

from ptmcad.studies.bench.companion import Values, main

Array = NDArray[np.float64]
STARTS = 5
"""Along each angle: 25 starts a point."""
RESIDUAL = 1e-9
"""Of the equations, relative to the sizes of their terms."""
SAME_SOLUTION = 1e-5
"""Two solutions closer than this in both angles are one."""


def counts(values: Values, seed: int) -> NDArray[np.int8]:
    """Stable and total counts at each point, of shape (2, points)."""
    number = len(values["rho"])
    generator = np.random.default_rng(seed)
    found = np.zeros((2, number), dtype=np.int8)
    places = (np.arange(STARTS) + 0.5) * (2 * np.pi / STARTS) - np.pi
    starts = np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 2)
    for k in range(number):
        moved = starts + generator.uniform(-0.5, 0.5, starts.shape) * (2 * np.pi / STARTS)
        found[:, k] = _count({name: float(array[k]) for name, array in values.items()}, moved)
    return found


def _count(p: dict[str, float], starts: Array) -> tuple[int, int]:
    l1, l2, k3, f3, f4 = p["L1"], p["L2"], p["k3"], p["F3"], p["F4"]
    b1, b2 = (p["k2"] + k3) * p["rho"] + p["F3x"], (p["k1"] + k3) * p["rho"] - p["F4x"]
    scale = abs(k3) * (abs(l1) + abs(l2)) + abs(b1) + abs(b2) + abs(f3) + abs(f4)

    def gradient(angles: Array) -> tuple[Array, Array]:
        (c1, c2), (s1, s2) = np.cos(angles), np.sin(angles)
        s12, c12 = s1 * c2 + c1 * s2, c1 * c2 - s1 * s2
        value = np.array([k3 * l2 * s12 - b1 * s1 + f3 * c1, k3 * l1 * s12 - b2 * s2 + f4 * c2])
        slope = np.array(
            [
                [k3 * l2 * c12 - b1 * c1 - f3 * s1, k3 * l2 * c12],
                [k3 * l1 * c12, k3 * l1 * c12 - b2 * c2 - f4 * s2],
            ]
        )
        return value, slope

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
        # the Hessian's rows are -L1 and -L2 times those of the slope
        stable += bool(-l1 * slope[0, 0] > 0 and np.linalg.det(slope) > 0)
    return stable, len(seen)


if __name__ == "__main__":
    main(sys.argv[1:], counts)
