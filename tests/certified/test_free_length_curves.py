"""The curves of slices with free lengths: no true fold, cone or free-length point may lie outside
their enclosures.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray
from support import dense_search
from support.replacing import replace

from ptmcad.certified.branchandprune import search_curve
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.model import ptm
from ptmcad.question.slice import Axis, Count, Slice
from ptmcad.text.expressions import axis, constant

Vector = NDArray[np.float64]
LOADED = {"F3": "-1/10", "F4": "-1/10"}


def slice_of(free: str, x: str = "rho", y: str = "L2", **values: str) -> Slice:
    """The paper's mechanism in unit stiffness, axes ``x`` and ``y``, all free lengths the same."""
    names = ("L1", "L2", "rho", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x")
    parameters = {
        name: constant(Fraction(values.get(name, "1" if name[0] != "F" else "0"))) for name in names
    }
    parameters |= {f"l0_{i}": constant(Fraction(free)) for i in (1, 2, 3)}
    parameters |= {x: axis(0), y: axis(1)}
    return Slice(
        "test",
        ptm(),
        (Axis(x, Fraction(1, 20), Fraction(2)), Axis(y, Fraction(0), Fraction(2))),
        parameters,
    )


def derivatives(z: Vector, free: float, load: float) -> tuple[Vector, Vector]:
    """Gradient and Hessian of the energy in (th1, th2) at z = (rho, L2, th1, th2), with L1 = k = 1."""
    values = dict.fromkeys(("L1", "k1", "k2", "k3"), 1.0) | dict.fromkeys(("F3x", "F4x"), 0.0)
    values |= dict.fromkeys(("l0_1", "l0_2", "l0_3"), free) | {"F3": load, "F4": load}
    g1, g2, h11, h12, h22, _ = dense_search.derivatives(values | {"rho": z[0], "L2": z[1]}, *z[2:])
    return np.array([g1, g2]), np.array([[h11, h12], [h12, h22]])


def refine(f: Callable[[Vector], Vector], z: Vector) -> Vector | None:
    """Newton's least change to a zero of f, which takes points as columns; None when it does not
    get there.
    """
    around = np.concatenate([1e-6 * np.eye(len(z)), -1e-6 * np.eye(len(z))], axis=1)
    for _ in range(40):
        value = f(z)
        ahead, behind = np.split(f(z[:, None] + around), 2, axis=1)
        if not np.all(np.isfinite(ahead - behind)):
            return None
        step = np.linalg.lstsq((ahead - behind) / 2e-6, -value, rcond=None)[0]
        size = float(np.linalg.norm(step))
        z = z + step * min(1.0, 0.2 / max(size, 1e-300))
        if size < 1e-10:
            return z if np.abs(f(z)).max() < 1e-9 else None
    return None


def fold_points(free: float, load: float, seed: int, number: int) -> list[Vector]:
    """Points (rho, L2, th1, th2) of fold curves, found without the engine."""
    rng = np.random.default_rng(seed)

    def equations(z: Vector) -> Vector:
        slope, curvature = derivatives(z, free, load)
        return np.array([*slope, curvature[0, 0] * curvature[1, 1] - curvature[0, 1] ** 2])

    found: list[Vector] = []
    while len(found) < number:
        z = refine(equations, rng.uniform([0.1, 0.1, -3, -3], [1.9, 1.9, 3.2, 3.2]))
        if z is not None and 0.1 < z[0] < 1.9 and 0.1 < z[1] < 1.9:
            found.append(z)
    return found


def rectangles(
    all_curves: tuple[CriticalCurve, ...], centre: Vector, half: float, area: float
) -> Vector:
    """The enclosure over a small square of the plane: rows low x, low y, high x, high y."""
    window = np.array([[*(centre - half), *(centre + half)]])
    parts = []
    for curve in all_curves:
        boxes = search_curve(
            curve.system.arguments, curve.start(window), area, 20_000, curve.weights
        ).left()
        v = boxes.shape[1] // 2
        parts.append(boxes[:, [0, 1, v, v + 1]])
    return np.concatenate(parts)


def covers(found: Vector, p: Vector, slack: float) -> bool:
    return bool(np.any(np.all((found[:, :2] <= p + slack) & (p - slack <= found[:, 2:]), axis=1)))


@pytest.mark.parametrize(("free", "load", "number"), [
    ("1/5", "-1/10", 10), pytest.param("1/2", "-1/10", 8, marks=pytest.mark.slow),
    pytest.param("1/5", "0", 2, marks=pytest.mark.slow),
])  # fmt: skip
def test_true_folds_lie_in_the_enclosures(free: str, load: str, number: int) -> None:
    """Folds found by Newton's method on derivatives that share no code with the engine; they err by
    less than 1e-8.
    """
    s = slice_of(free, F3=load, F4=load)
    every, stable = curves(s, Count.TOTAL), curves(s, Count.STABLE)
    for z in fold_points(float(Fraction(free)), float(Fraction(load)), 5, number):
        assert covers(rectangles(every, z[:2], 0.013, 1e-7), z[:2], 1e-8)
        h = derivatives(z, float(Fraction(free)), float(Fraction(load)))[1]
        if np.trace(h) > 1e-2:
            assert covers(rectangles(stable, z[:2], 0.013, 1e-7), z[:2], 1e-8)


def test_enclosures_are_thin() -> None:
    """A fold's enclosure over a square is a small part of it, so the tests above are not passed by
    covering all.
    """
    z = fold_points(0.2, -0.1, 5, 1)[0]
    found = rectangles(curves(slice_of("1/5", **LOADED), Count.TOTAL), z[:2], 0.013, 1e-9)
    assert np.prod(found[:, 2:] - found[:, :2], axis=1).sum() < 0.1 * 0.026**2


def test_creases_are_the_lines_where_a_spring_can_have_no_length() -> None:
    total = {c.name: c for c in curves(slice_of("1/5", **LOADED), Count.TOTAL)}
    for name, p in (
        ("crease where spring A1A4 has no length", (0.7, 0.7)),
        ("crease where spring A2A3 has no length", (1.0, 0.7)),
    ):
        assert covers(rectangles((total[name],), np.array(p), 0.01, 1e-7), np.array(p), 0.0)
    assert not len(
        rectangles(
            (total["crease where spring A2A3 has no length"],), np.array([0.9, 0.7]), 0.01, 1e-7
        )
    )


def test_curves_of_each_count() -> None:
    s = slice_of("1/5", **LOADED)
    names = {count: [c.name for c in curves(replace(s, count=count), count)] for count in Count}
    assert names[Count.TOTAL] == names[Count.INDEX]
    cone = "point where spring A3A4 has no length"
    assert cone in names[Count.TOTAL] and cone not in names[Count.STABLE]
    assert names[Count.ADMISSIBLE] == [
        *names[Count.STABLE],
        "point where spring A1A4 has its free length",
        "point where spring A2A3 has its free length",
        "point where spring A3A4 has its free length",
    ]
    assert [c.name for c in curves(slice_of("0", **LOADED), Count.TOTAL)] == ["fold"]
