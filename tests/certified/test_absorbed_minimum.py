"""Minima that vanish without a fold, in a spring without length: the search for folds must enclose
these points too.

Lemma S5 of docs/soundness.md proves it; here is a curve of such points for a flat cone and one for
a crease.
"""

from __future__ import annotations

from fractions import Fraction
from math import cos, sin
from typing import Any

import numpy as np
import pytest
import yaml

pytest.importorskip("numba")

import ptmcad
from ptmcad.certified.branchandprune import search_curve
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.pointcounts import plain_counter as point_counter
from ptmcad.model.builtinmechanisms import RECORD
from ptmcad.question.slice import Count, Slice

FLAT_CONE = yaml.safe_load("""
parameters: {rho: 2, L1: 1, L2: 1, k: 100, F3: 100*f, F4: -100*f}
axes: {f: [1/10, 3/10], l0: [1/10, 3/10]}
""")
"""At th = (0, 0) spring 3 has no length; for f = l0 its push balances the loads."""
CREASE = yaml.safe_load("""
parameters: {rho: 1, L1: 1, L2: 3/2, k: 100, F3: 100*f, F4: 100*g, l0: 1/5}
axes: {f: [-3/2, -1/2], g: [1/2, 3/2]}
""")
"""At th1 = 0 spring 2 has no length, whatever th2 is."""
MECHANISMS = {
    "refined": "ptm",
    "plain": {key: value for key, value in RECORD.items() if key != "symmetries"}
    | {"name": "plain_ptm"},
}
by_all_formulas = pytest.mark.parametrize("formulas", list(MECHANISMS))


def _slice(record: dict[str, Any], formulas: str) -> Slice:
    return ptmcad.slice_from_mapping(
        {"name": "absorbed", "mechanism": MECHANISMS[formulas], "count": "stable", **record}
    )


def enclosed(slice: Slice, points: list[tuple[float, float]], tiles: int = 4) -> list[bool]:
    """Whether each point lies in a box that the search for folds of minima leaves."""
    low = np.array([float(axis.low) for axis in slice.axes])
    size = np.array([float(axis.high) for axis in slice.axes]) - low
    corners = [low + size * (i, j) / tiles for i in range(tiles) for j in range(tiles)]
    window = np.array([[*corner, *(corner + size / tiles)] for corner in corners])
    inside = np.zeros(len(points), dtype=bool)
    covered = 0.0
    for curve in curves(slice, Count.STABLE):
        area = float(size.prod()) * 4.0**-7
        _, _, small, waiting, _ = search_curve(
            curve.system.arguments, curve.start(window), area, 3_000_000, curve.weights
        )
        assert len(waiting) == 0
        first, last = small[:, :2], small[:, small.shape[1] // 2 :][:, :2]
        covered += float(np.prod(last - first, axis=1).sum())
        inside |= [bool(((first <= point) & (point <= last)).all(axis=1).any()) for point in points]
    assert covered < 0.9 * size.prod()
    return inside.tolist()


def stable(slice: Slice, x: Fraction, y: Fraction) -> int | None:
    return point_counter(slice).at(x, y, Count.STABLE).stable


@by_all_formulas
def test_a_minimum_vanishes_in_a_flat_cone_without_a_fold(formulas: str) -> None:
    slice = _slice(FLAT_CONE, formulas)
    assert stable(slice, Fraction(19, 100), Fraction(1, 5)) == 2
    assert stable(slice, Fraction(21, 100), Fraction(1, 5)) == 1
    line = [(t, t) for t in np.linspace(0.1, 0.3, 41)]
    assert all(enclosed(slice, line))


def crease_loads(th2: float, side: int) -> tuple[float, float]:
    """Loads over k that balance spring 2's push, to one side, at th1 = 0 in ``CREASE``."""
    l2, pull = 1.5, 0.2
    s2, c2 = sin(th2), cos(th2)
    d1, d3 = np.array([1 - l2 * c2, l2 * s2]), np.array([-l2 * c2, l2 * s2])
    u1, u3 = d1 / np.hypot(*d1), d3 / np.hypot(*d3)
    t2 = np.array([s2, c2])
    f3 = -l2 * s2 - side * pull + pull * u3[1]
    f4 = (s2 + (s2 - s2) - pull * (u1 + u3) @ t2) / c2
    return float(f3), float(f4)


@by_all_formulas
def test_minima_vanish_in_a_crease_without_a_fold(formulas: str) -> None:
    slice = _slice(CREASE, formulas)
    curve = [crease_loads(th2, side) for th2 in np.linspace(0.65, 0.95, 41) for side in (1, -1)]
    f3, f4 = (Fraction(x).limit_denominator(1000) for x in crease_loads(0.8, 1))
    assert stable(slice, f3 - Fraction(1, 100), f4) != stable(slice, f3 + Fraction(1, 100), f4)
    assert all(enclosed(slice, curve))
