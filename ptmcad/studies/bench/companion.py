"""The rival that people write: on an N x N grid, eigenvalues of the companion matrix of a sextic in tan(theta2/2).

Guarantee: none for the counts, as with every such program; they are what floating point and a tolerance say. The same
input gives the same counts.

All of it is vectorised: eigenvalues of stacked companion matrices (numpy, hence LAPACK), imaginary parts below
`MAX_IMAGINARY` dropped, two Newton steps on what is left, theta1 from the first equation, stability from the Hessian's
signs. It runs as ``python -m ptmcad.studies.bench.companion QUESTION N RESULT`` and imports no algebra.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.studies.sextic import sextic

Array = NDArray[np.float64]
MAX_IMAGINARY = 1e-7
"""Relative size of imaginary parts that are taken for rounding; nearby values change the result little."""
POLISHING = 2
BATCH_POINTS = 40_000
"""Points whose matrices are in memory together."""
MIN_LEADING = 1e-14
"""A leading coefficient that is relatively smaller everywhere in the window is taken for zero: the degree is lower."""

Values = dict[str, Array]
Moments = Mapping[str, Callable[..., Any]]


def moments_of(question: Mapping[str, Any]) -> Moments:
    """The mechanism's equations, compiled; they come as text, so that deriving them is no part of what is measured."""
    functions: dict[str, Any] = {}
    exec(compile(question["moments"], "moments", "exec"), functions)
    return functions


def grid_values(question: dict[str, Any], n: int) -> Values:
    """The mechanism's parameters at the n x n pixel centres, of shape (n * n,), the second axis running fastest."""
    (x0, x1), (y0, y1) = question["window"]
    x = x0 + (x1 - x0) * (np.arange(n) + 0.5) / n
    y = y0 + (y1 - y0) * (np.arange(n) + 0.5) / n
    first, second = (a.ravel() for a in np.meshgrid(x, y, indexing="ij"))

    def evaluated(terms: list[list[float]]) -> Array:
        total = np.zeros(n * n)
        for i, j, c in terms:
            total += c * first ** int(i) * second ** int(j)
        return total

    return {
        name: evaluated(numerator) / evaluated(denominator)
        for name, (numerator, denominator) in question["parameters"].items()
    }


def counts(p: Values, moments: Moments) -> NDArray[np.int8]:
    """Stable and total counts at each point, of shape (2, points).

    Parameters
    ----------
    moments : the functions of `ptmcad.studies.moments`.
    """
    polynomials: Array = np.stack(sextic(p).coefficients[::-1], axis=1)
    size = np.abs(polynomials).max(axis=1, keepdims=True)
    polynomials = polynomials / np.where(size > 0, size, 1)
    while polynomials.shape[1] > 2 and np.abs(polynomials[:, 0]).max() < MIN_LEADING:
        polynomials = polynomials[:, 1:]
    found = np.zeros((2, len(polynomials)), dtype=np.int8)
    for start in range(0, len(polynomials), BATCH_POINTS):
        part = slice(start, start + BATCH_POINTS)
        found[:, part] = _counts(polynomials[part], {name: values[part] for name, values in p.items()}, moments)
    return found


def _counts(polynomials: Array, p: Values, moments: Moments) -> NDArray[np.int8]:
    degree = polynomials.shape[1] - 1
    leading = polynomials[:, :1]
    monic = polynomials[:, 1:] / np.where(leading == 0, np.finfo(float).tiny ** 0.25, leading)
    companion = np.zeros((len(polynomials), degree, degree))
    companion[:, 0, :] = -monic
    companion[:, np.arange(1, degree), np.arange(degree - 1)] = 1
    roots = np.linalg.eigvals(companion)
    real = np.abs(roots.imag) < MAX_IMAGINARY * (1 + np.abs(roots.real))
    t = _polished(polynomials, roots.real)
    stable = real & _stable(t, {name: values[:, None] for name, values in p.items()}, moments)
    return np.stack([stable.sum(axis=1), real.sum(axis=1)]).astype(np.int8)


def _polished(polynomials: Array, t: Array) -> Array:
    for _ in range(POLISHING):
        value, slope = np.zeros_like(t), np.zeros_like(t)
        for c in polynomials.T:
            slope = slope * t + value
            value = value * t + c[:, None]
        with np.errstate(all="ignore"):
            step = value / slope
        t = np.where(np.isfinite(step) & (np.abs(step) < 1e-3 * (1 + np.abs(t))), t - step, t)
    return t


def _stable(t: Array, p: Values, moments: Moments) -> NDArray[np.bool_]:
    """Whether the Hessian is positive definite at the equilibrium that belongs to t."""
    with np.errstate(all="ignore"):
        c2, s2 = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        a, (first, second) = moments["coefficients"](p), moments["factors"](p)
        across, along = moments["first"](a, c2, s2)
        norm = np.hypot(along, across)
        c1, s1 = along / norm, -across / norm
        # (c1, s1) or its negative: the one that fulfils the second equation better
        rest, turned = moments["second"](a, c1, s1, c2, s2)
        sign = np.where(np.abs(rest + turned) <= np.abs(rest - turned), 1.0, -1.0)
        h11, h12, h21, h22 = moments["slopes"](a, sign * c1, sign * s1, c2, s2)
        # the Hessian's rows are these slopes times the factors
        answer: NDArray[np.bool_] = (first * h11 > 0) & (first * second * (h11 * h22 - h12 * h21) > 0)
        return answer


def main(arguments: list[str], answer: Callable[..., NDArray[np.int8]] = counts) -> None:
    """Read QUESTION, count on N x N points, save the counts, of shape (2, N, N), as RESULT, and print the seconds."""
    question, n, target = json.loads(Path(arguments[0]).read_text(encoding="utf-8")), int(arguments[1]), arguments[2]
    start = perf_counter()
    found = answer(grid_values(question, n), moments_of(question), *map(int, arguments[3:])).reshape(2, n, n)
    seconds = perf_counter() - start
    np.save(target, found)
    print(json.dumps({"computing": seconds}))


if __name__ == "__main__":
    main(sys.argv[1:])
