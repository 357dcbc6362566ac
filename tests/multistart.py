"""Stable equilibria with free lengths by dense numerical search: an independent answer, approximate and without proof.

Newton's method in floating point from every point of a grid over the torus, with derivatives written out here.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def derivatives(values: Mapping[str, float], a: Floats, b: Floats) -> tuple[Floats, ...]:
    """Gradient (2) and Hessian (11, 12, 22) of the energy, and the least of l_i - l0_i, at angles a, b."""
    p, q, rho = values["L1"], values["L2"], values["rho"]
    sa, ca, sb, cb = np.sin(a), np.cos(a), np.sin(b), np.cos(b)
    zero = np.zeros_like(a)
    node3 = ((p * ca, p * sa), (-p * sa, p * ca), (-p * ca, -p * sa))
    node4 = ((rho - q * cb, q * sb), (q * sb, q * cb), (q * cb, -q * sb))
    g1 = -values["F3x"] * node3[1][0] - values["F3"] * node3[1][1]
    g2 = -values["F4x"] * node4[1][0] - values["F4"] * node4[1][1]
    h11 = -values["F3x"] * node3[2][0] - values["F3"] * node3[2][1]
    h22 = -values["F4x"] * node4[2][0] - values["F4"] * node4[2][1]
    h12 = zero.copy()
    excess = np.full_like(a, np.inf)
    for n in (1, 2, 3):
        fourth, third = n in (1, 3), n in (2, 3)
        start = (zero, zero) if n == 1 else (zero + rho, zero) if n == 2 else node3[0]
        end = node4[0] if fourth else node3[0]
        d = (end[0] - start[0], end[1] - start[1])
        # derivatives of d by a and by b
        da = (zero, zero) if not third else node3[1] if n == 2 else (-node3[1][0], -node3[1][1])
        daa = (zero, zero) if not third else node3[2] if n == 2 else (-node3[2][0], -node3[2][1])
        db, dbb = (node4[1], node4[2]) if fourth else ((zero, zero), (zero, zero))
        length = np.hypot(*d)
        free, k = values[f"l0_{n}"], values[f"k{n}"]
        excess = np.minimum(excess, length - free)
        m, w = k * (1 - free / length), k * free / length**3
        u = d[0] * da[0] + d[1] * da[1]
        v = d[0] * db[0] + d[1] * db[1]
        g1, g2 = g1 + m * u, g2 + m * v
        h11 = h11 + m * (da[0] ** 2 + da[1] ** 2 + d[0] * daa[0] + d[1] * daa[1]) + w * u * u
        h22 = h22 + m * (db[0] ** 2 + db[1] ** 2 + d[0] * dbb[0] + d[1] * dbb[1]) + w * v * v
        h12 = h12 + m * (da[0] * db[0] + da[1] * db[1]) + w * u * v
    return g1, g2, h11, h12, h22, excess


def equilibria(values: Mapping[str, float], grid: int = 48) -> list[tuple[float, float, str, float]]:
    """Angles, signs of the Hessian's eigenvalues and the least l_i - l0_i of all equilibria that the search finds."""
    angles = (np.arange(grid) + 0.31) * 2 * np.pi / grid
    a, b = (x.ravel() for x in np.meshgrid(angles, angles + 0.17))
    with np.errstate(all="ignore"):
        for _ in range(60):
            g1, g2, h11, h12, h22, _ = derivatives(values, a, b)
            determinant = h11 * h22 - h12 * h12
            s, t = (h22 * g1 - h12 * g2) / determinant, (h11 * g2 - h12 * g1) / determinant
            size = np.hypot(s, t)
            damping = np.minimum(1, 0.5 / size)
            a, b = a - damping * s, b - damping * t
        converged = size < 1e-11
        a, b = np.remainder(a[converged], 2 * np.pi), np.remainder(b[converged], 2 * np.pi)
        _, _, h11, h12, h22, excess = derivatives(values, a, b)
    found: list[tuple[float, float, str, float]] = []
    for k in range(len(a)):
        if any(np.hypot(np.sin((a[k] - x) / 2), np.sin((b[k] - y) / 2)) < 1e-7 for x, y, _, _ in found):
            continue
        determinant = h11[k] * h22[k] - h12[k] ** 2
        signs = "+-" if determinant < 0 else "++" if h11[k] > 0 else "--"
        found.append((float(a[k]), float(b[k]), signs, float(excess[k])))
    return found


def stable(values: Mapping[str, float]) -> int:
    """The number of minima."""
    return sum(signs == "++" for _, _, signs, _ in equilibria(values))
