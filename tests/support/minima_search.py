"""Minima of an energy of two angles, by Newton's method from a grid on the torus; nothing of ptmcad
is used.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
Energy = Callable[[Numbers, Numbers], Numbers]


def minima(energy: Energy, grid: int = 240, step: float = 1e-4) -> list[tuple[float, float]]:
    """Places that are lower than all that is around them, to about 1e-6."""
    turn = np.linspace(-np.pi, np.pi, grid, endpoint=False)
    a, b = np.meshgrid(turn, turn, indexing="ij")
    heights = energy(a, b)
    around = [np.roll(heights, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
    lowest = np.all([heights <= other for other in around], axis=0)
    found: list[tuple[float, float]] = []
    for x, y in zip(a[lowest], b[lowest], strict=True):
        p = _descended(energy, np.array([x, y]), step)
        if all(np.hypot(*np.sin((p - np.array(q)) / 2)) > 1e-4 for q in found):
            found.append((float(p[0]), float(p[1])))
    return found


def _descended(energy: Energy, p: Numbers, h: float) -> Numbers:
    """Newton's method with steps that go down, by differences."""
    for _ in range(60):
        offsets = np.array([(i * h, j * h) for i in (-1, 0, 1) for j in (-1, 0, 1)])
        e = energy(*(p + offsets).T).reshape(3, 3)
        gradient = np.array([e[2, 1] - e[0, 1], e[1, 2] - e[1, 0]]) / (2 * h)
        mixed = (e[2, 2] - e[2, 0] - e[0, 2] + e[0, 0]) / (4 * h * h)
        hessian = np.array(
            [
                [(e[2, 1] - 2 * e[1, 1] + e[0, 1]) / h**2, mixed],
                [mixed, (e[1, 2] - 2 * e[1, 1] + e[1, 0]) / h**2],
            ]
        )
        values, vectors = np.linalg.eigh(hessian)
        move = -vectors @ ((vectors.T @ gradient) / np.maximum(np.abs(values), 1e-3))
        size = np.hypot(*move)
        move *= min(1.0, 0.1 / size) if size else 1.0
        while energy(*(p + move)) > e[1, 1] + 1e-14 and np.hypot(*move) > 1e-9:
            move /= 2
        p = p + move
        if np.hypot(*move) < 1e-8:
            break
    return p
