"""The rivals that people write, on a grid: companion matrices of a sextic, or Newton's method from many starts.

Guarantee: none for the counts, as with every such program; they are what floating point and a tolerance say
(`ptmcad.studies.doubles`). The same input gives the same counts. They run as
``python -m ptmcad.studies.bench.rivals METHOD QUESTION N RESULT`` and import no algebra.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.studies.doubles import Floats, Values, at, companion, distinct, newton

MAX_IMAGINARY = 1e-7
"""Relative size of imaginary parts that are taken for rounding; nearby values change little."""
BATCH_POINTS = 40_000
"""Points whose matrices are in memory together."""
STARTS = 5
"""Along each angle: 25 starts a point."""


def grid_values(question: Mapping[str, Any], n: int) -> dict[str, Floats]:
    """The mechanism's parameters at the n x n pixel centres, of shape (n * n,), the second axis running fastest."""
    x, y = (low + (high - low) * (np.arange(n) + 0.5) / n for low, high in question["window"])
    first, second = (a.ravel() for a in np.meshgrid(x, y, indexing="ij"))

    def evaluated(terms: list[list[float]]) -> Floats:
        return sum((c * first ** int(i) * second ** int(j) for i, j, c in terms), np.zeros(n * n))

    return {name: evaluated(a) / evaluated(b) for name, (a, b) in question["parameters"].items()}


def counts(method: str, p: Values) -> NDArray[np.int8]:
    """Stable and total counts at each point, of shape (2, points)."""
    found = []
    for k in range(0, len(p["rho"]), BATCH_POINTS):
        part = {name: values[k : k + BATCH_POINTS] for name, values in p.items()}
        with np.errstate(all="ignore"):
            poses = companion(part, MAX_IMAGINARY) if method == "companion" else newton(part, STARTS)
            kept = distinct(*poses)
            # roots count as often as they are there: at a double one floating point has two poses that differ
            total = np.isfinite(poses[1][::2]) if method == "companion" else kept
            h11, h12, h22 = at(part, *poses)[1]
            stable = kept & (h11 > 0) & (h11 * h22 > h12 * h12)
        found.append(np.stack([stable.sum(axis=0), total.sum(axis=0)]).astype(np.int8))
    return np.concatenate(found, axis=1)


def main(method: str, question: str, n: str, result: str) -> None:
    """Count on N x N points, save the counts, of shape (2, N, N), and print the seconds."""
    asked = json.loads(Path(question).read_text(encoding="utf-8"))
    start = perf_counter()
    found = counts(method, grid_values(asked, int(n))).reshape(2, int(n), int(n))
    seconds = perf_counter() - start
    np.save(result, found)
    print(json.dumps({"computing": seconds}))


if __name__ == "__main__":
    main(*sys.argv[1:])
