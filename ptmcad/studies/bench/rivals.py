"""The rivals that people write, on a grid: companion matrices of a sextic, or scipy's root finder from many starts.

Guarantee: none for the counts, as with every such program; they are what floating point and a tolerance say. The same
input and seed give the same counts.

``companion`` takes eigenvalues of stacked companion matrices (numpy, hence LAPACK) of `ptmcad.studies.byhand`, drops
imaginary parts, takes two Newton steps on what is left, theta1 from the first equation, and stability from the
Hessian's signs. ``multistart`` finds roots in (theta1, theta2) at each point and removes duplicates; an
equilibrium that no start leads to is not counted. They run as
``python -m ptmcad.studies.bench.rivals METHOD QUESTION N RESULT SEED`` and import no algebra.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval
from numpy.typing import NDArray

from ptmcad.studies.byhand import derivatives, parts, sextic

Array = NDArray[np.float64]
MAX_IMAGINARY = 1e-7
"""Relative size of imaginary parts that are taken for rounding; nearby values change little."""
POLISHING = 2
BATCH_POINTS = 40_000
"""Points whose matrices are in memory together."""
MIN_LEADING = 1e-14
"""A leading coefficient that is relatively smaller everywhere is taken for zero."""
STARTS = 5
"""Along each angle: 25 starts a point."""
RESIDUAL = 1e-9
"""Of the equations, relative to the sizes of their terms."""
SAME_SOLUTION = 1e-5
"""Two solutions closer than this in both angles are one."""

Values = Mapping[str, Any]


def grid_values(question: Mapping[str, Any], n: int) -> dict[str, Array]:
    """The mechanism's parameters at the n x n pixel centres, of shape (n * n,), the second axis running fastest."""
    x, y = (low + (high - low) * (np.arange(n) + 0.5) / n for low, high in question["window"])
    first, second = (a.ravel() for a in np.meshgrid(x, y, indexing="ij"))

    def evaluated(terms: list[list[float]]) -> Array:
        return sum((c * first ** int(i) * second ** int(j) for i, j, c in terms), np.zeros(n * n))

    return {name: evaluated(a) / evaluated(b) for name, (a, b) in question["parameters"].items()}


def companion(p: Mapping[str, Array], seed: int = 0) -> NDArray[np.int8]:
    """Stable and total counts at each point, of shape (2, points)."""
    starts = range(0, len(p["rho"]), BATCH_POINTS)
    parts = [{name: values[k : k + BATCH_POINTS] for name, values in p.items()} for k in starts]
    return np.concatenate([_from_sextic(part) for part in parts], axis=1)


def _from_sextic(p: Values) -> NDArray[np.int8]:
    polynomial = np.stack(sextic(p)[0])
    size = np.abs(polynomial).max(axis=0)
    polynomial = polynomial / np.where(size > 0, size, 1)
    while len(polynomial) > 2 and np.abs(polynomial[-1]).max() < MIN_LEADING:
        polynomial = polynomial[:-1]
    degree, points = len(polynomial) - 1, polynomial.shape[1]
    leading = np.where(polynomial[-1] == 0, np.finfo(float).tiny ** 0.25, polynomial[-1])
    matrices = np.zeros((points, degree, degree))
    matrices[:, 0, :] = (-polynomial[-2::-1] / leading).T
    matrices[:, np.arange(1, degree), np.arange(degree - 1)] = 1
    roots = np.linalg.eigvals(matrices).T
    real = np.abs(roots.imag) < MAX_IMAGINARY * (1 + np.abs(roots.real))
    t, slope = roots.real, polyder(polynomial)

    with np.errstate(all="ignore"):
        for _ in range(POLISHING):
            step = polyval(t, polynomial[:, None], tensor=False) / polyval(t, slope[:, None], tensor=False)
            good = np.isfinite(step) & (np.abs(step) < 1e-3 * (1 + np.abs(t)))
            t = np.where(good, t - step, t)
        c2, s2 = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        v, w, x, y = parts(p, c2, s2)
        norm = np.copysign(np.hypot(x, y), v * w)
        stable = real & is_stable(*derivatives(p, [(x / norm, y / norm), (c2, s2)], np.sqrt)[1])
    return np.stack([stable.sum(axis=0), real.sum(axis=0)]).astype(np.int8)


def is_stable(h11: Any, h12: Any, h22: Any) -> Any:
    """Whether the Hessian is positive definite."""
    return (h11 > 0) & (h11 * h22 > h12 * h12)


def multistart(values: Mapping[str, Array], seed: int) -> NDArray[np.int8]:
    """Stable and total counts at each point, of shape (2, points)."""
    generator = np.random.default_rng(seed)
    apart = 2 * np.pi / STARTS
    places = (np.arange(STARTS) + 0.5) * apart - np.pi
    starts = np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 2)
    counts = [
        _from_starts(dict(zip(values, point, strict=True)), starts + generator.uniform(-0.5, 0.5, starts.shape) * apart)
        for point in zip(*values.values(), strict=True)
    ]
    return np.array(counts, dtype=np.int8).T


def _from_starts(p: Values, starts: Array) -> tuple[int, int]:
    from scipy.optimize import root

    scale = sum(map(abs, p.values()))

    def at(angles: Array) -> tuple[Array, Array]:
        (g1, g2), (h11, h12, h22) = derivatives(p, list(zip(np.cos(angles), np.sin(angles), strict=True)), np.sqrt)
        return np.array([g1, g2]), np.array([[h11, h12], [h12, h22]])

    seen: list[Array] = []
    stable = 0
    for start in starts:
        angles = root(at, start, jac=True, method="hybr").x
        gradient, hessian = at(angles)
        apart = [np.abs(np.remainder(angles - a + np.pi, 2 * np.pi) - np.pi).max() for a in seen]
        if np.abs(gradient).max() < RESIDUAL * scale and min(apart, default=1.0) >= SAME_SOLUTION:
            seen.append(angles)
            stable += bool(is_stable(*hessian.ravel()[[0, 1, 3]]))
    return stable, len(seen)


def main(method: str, question: str, n: str, result: str, seed: str) -> None:
    """Count on N x N points, save the counts, of shape (2, N, N), and print the seconds."""
    asked = json.loads(Path(question).read_text(encoding="utf-8"))
    counts = companion if method == "companion" else multistart
    start = perf_counter()
    found = counts(grid_values(asked, int(n)), int(seed)).reshape(2, int(n), int(n))
    seconds = perf_counter() - start
    np.save(result, found)
    print(json.dumps({"computing": seconds}))


if __name__ == "__main__":
    main(*sys.argv[1:])
