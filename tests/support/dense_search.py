"""Equilibria with free lengths by a dense numerical search: many starts of Newton's method on the
energy's gradient.

No proof and no code in common with `ptmcad`: the geometry is written out again, from the positions
of the nodes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from support.paper_energy import bent

Floats = NDArray[np.float64]


def derivatives(values: Mapping[str, float], a: Floats, b: Floats) -> tuple[Floats, ...]:
    """Gradient and Hessian of the energy at angles a, b, and the springs' lengths, shape (3, n)."""
    with np.errstate(all="ignore"):
        there = bent(values, a, b, np)
    return *there.slopes, *there.bends, np.array(there.lengths)


def _starts(values: Mapping[str, float], grid: int) -> tuple[Floats, Floats]:
    rho, p, q = values["rho"], values["L1"], values["L2"]
    t = (np.arange(grid) + 0.37) * 2 * np.pi / grid
    a, b = (x.ravel() for x in np.meshgrid(t, t + 0.011))
    near = [(a, b)]
    circle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    centres: list[tuple[float, float]] = []
    if abs(p - q) < rho < p + q:  # where spring 3 has no length
        x = (rho**2 + p**2 - q**2) / (2 * rho)
        for h in (1, -1):
            y = h * np.sqrt(max(0.0, p**2 - x**2))
            centres.append((np.arctan2(y, x), np.arctan2(y, rho - x)))
    for radius in np.logspace(-5, -0.5, 14):
        near.extend(
            (ca + radius * np.cos(circle), cb + radius * np.sin(circle)) for ca, cb in centres
        )
        # and where springs 1 and 2 are short
        near.extend((t, np.full_like(t, s * radius)) for s in (1, -1))
        near.extend((np.full_like(t, s * radius), t) for s in (1, -1))
    return np.concatenate([n[0] for n in near]), np.concatenate([n[1] for n in near])


def dense_search(values: Mapping[str, float], grid: int = 160) -> dict[str, Any]:
    """Counts: ``total``, ``stable``, ``admissible``, ``index``; and the smallest |det H|, relative,
    as ``margin``.
    """
    a, b = _starts(values, grid)
    arrived = []
    with np.errstate(all="ignore"):
        for _ in range(60):
            g1, g2, h11, h12, h22, _ = derivatives(values, a, b)
            det = h11 * h22 - h12 * h12
            s1, s2 = (h22 * g1 - h12 * g2) / det, (h11 * g2 - h12 * g1) / det
            size = np.hypot(s1, s2)
            scale = np.where(size > 0.3, 0.3 / size, 1.0)
            a, b = a - scale * s1, b - scale * s2
            # most are there after ten steps: to take the others' fifty with them would be most of
            # the work
            there = size < 1e-12
            arrived.append((a[there], b[there]))
            keep = np.isfinite(a) & np.isfinite(b) & ~there
            a, b = a[keep], b[keep]
    a, b = (
        np.concatenate([*(found[k] for found in arrived), last]) for k, last in enumerate((a, b))
    )
    with np.errstate(all="ignore"):
        g1, g2, h11, h12, h22, _ = derivatives(values, a, b)
        det = h11 * h22 - h12 * h12
        step = np.hypot((h22 * g1 - h12 * g2) / det, (h11 * g2 - h12 * g1) / det)
    done = step < 1e-9
    a, b = np.mod(a[done], 2 * np.pi), np.mod(b[done], 2 * np.pi)
    found: list[tuple[float, float]] = []
    seen: set[tuple[int, int]] = set()
    for x, y in zip(a.tolist(), b.tolist(), strict=True):
        cell = (round(x * 1e6), round(y * 1e6))
        if any((cell[0] + i, cell[1] + j) in seen for i in (-1, 0, 1) for j in (-1, 0, 1)):
            continue
        if any(np.hypot(np.sin((x - u) / 2), np.sin((y - v) / 2)) < 1e-6 for u, v in found):
            continue
        seen.add(cell)
        found.append((x, y))
    a, b = (np.array([f[k] for f in found]) for k in (0, 1))
    _, _, h11, h12, h22, lengths = derivatives(values, a, b)
    det, trace = h11 * h22 - h12 * h12, h11 + h22
    minima = (det > 0) & (trace > 0)
    long_enough = np.all(lengths > np.array([[values[f"l0_{i}"]] for i in (1, 2, 3)]), axis=0)
    index = (int(minima.sum()), int((det < 0).sum()), int(((det > 0) & (trace < 0)).sum()))
    return {
        "total": len(found),
        "stable": index[0],
        "index": index,
        "admissible": int((minima & long_enough).sum()),
        "margin": float(np.min(np.abs(det) / (1 + trace**2))) if found else 0.0,
        "lengths": lengths,
    }
