"""The curves of slices with free lengths: no true fold, cone or free-length point may lie outside
their enclosures.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from ptmcad.certified.branchandprune import search_curve
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.springchart import chart
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.formulas.intervalarithmetic import program, run
from ptmcad.formulas.tape import record
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
    """Gradient and Hessian of the energy in (th1, th2), spring by spring; z = (rho, L2, th1, th2),
    L1 = k = 1.

    At one point, or at as many as z has columns.
    """
    rho, bar, th1, th2 = z
    a3, da3 = np.array([np.cos(th1), np.sin(th1)]), np.array([-np.sin(th1), np.cos(th1)])
    arm, darm = (
        bar * np.array([-np.cos(th2), np.sin(th2)]),
        bar * np.array([np.sin(th2), np.cos(th2)]),
    )
    zero, base = np.zeros_like(a3), np.array([rho, np.zeros_like(rho)])
    slope1, slope2 = -load * da3[1], -load * darm[1]
    h11, h12, h22 = load * a3[1], np.zeros_like(rho), load * arm[1]
    for d, (first1, first2), (second1, second2) in (
        (base + arm, (zero, darm), (zero, -arm)),
        (base - a3, (-da3, zero), (a3, zero)),
        (base + arm - a3, (-da3, darm), (a3, -arm)),
    ):
        length = np.hypot(*d)
        pull, bend = 1 - free / length, free / length**3
        part1, part2 = (first1 * d).sum(0), (first2 * d).sum(0)
        slope1, slope2 = slope1 + pull * part1, slope2 + pull * part2
        h11 = h11 + pull * (first1 * first1 + second1 * d).sum(0) + bend * part1 * part1
        h12 = h12 + pull * (first1 * first2).sum(0) + bend * part1 * part2
        h22 = h22 + pull * (first2 * first2 + second2 * d).sum(0) + bend * part2 * part2
    return np.array([slope1, slope2]), np.array([[h11, h12], [h12, h22]])


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
            curve.system.arguments(), curve.start(window), area, 20_000, curve.importance()
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


def test_absorption_by_the_cone_lies_in_the_enclosure() -> None:
    """At l3 = 0 the pull of springs 1 and 2 and the loads on A3 and A4 has the size of the free
    length.
    """
    free, load = 0.2, -0.1

    def defect(rho: float, bar: float, side: float) -> float:
        c1 = (rho * rho + 1 - bar * bar) / (2 * rho)
        joint = np.array([c1, side * np.sqrt(1 - c1 * c1)])
        base = np.array([rho, 0.0])
        t1, t2 = np.array([-joint[1], joint[0]]), np.array([-joint[1], joint[0] - rho]) / bar
        forces = []
        for anchor, t in (
            (base, t1),
            (np.zeros(2), t2),
        ):  # spring 2 pulls A3 to A2, spring 1 pulls A4 to A1
            d = anchor - joint
            forces.append(((1 - free / np.hypot(*d)) * d + [0, load]) @ t)
        # spring 3 pulls A3 by free * u and A4 by -free * u
        return float(np.linalg.norm(np.linalg.solve(np.array([t1, -t2]), -np.array(forces))) - free)

    name = "point where spring A3A4 has no length"
    cone = tuple(c for c in curves(slice_of("1/5", **LOADED), Count.TOTAL) if c.name == name)
    rng, seen = np.random.default_rng(3), 0
    while seen < 12:
        bar, side = rng.uniform(0.3, 1.8), float(rng.choice([-1.0, 1.0]))
        steps = [
            float(r) for r in np.linspace(0.1, 1.9, 60) if abs(1 - bar) + 0.02 < r < 1 + bar - 0.02
        ]
        for start, end in pairwise(steps):
            low, high = start, end
            if defect(low, bar, side) * defect(high, bar, side) < 0:
                for _ in range(50):
                    middle = (low + high) / 2
                    below = defect(start, bar, side) * defect(middle, bar, side) > 0
                    low, high = (middle, high) if below else (low, middle)
                p = np.array([low, bar])
                assert covers(rectangles(cone, p, 0.013, 1e-7), p, 1e-8)
                seen += 1


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


def test_formulas_of_the_fold_agree_with_the_energy() -> None:
    """Equations, Hessian and determinant, against derivatives that share no code with the engine."""
    rng = np.random.default_rng(1)
    m = chart(geometry(problem_of(slice_of("1/5", **LOADED))))
    tape = record([[*m.equations, *(entry for row in m.hessian for entry in row), m.determinant()]])
    low, high = np.empty(len(tape)), np.empty(len(tape))
    for _ in range(20):
        z = rng.uniform([0.2, 0.2, -3, -3], [1.9, 1.9, 3, 3])
        slope, h = derivatives(z, 0.2, -0.1)
        assert run(program(tape), z, z, low, high, 0, len(tape))
        np.testing.assert_allclose(
            low[tape.outputs[0]], [*slope, *h.ravel(), np.linalg.det(h)], rtol=1e-9, atol=1e-9
        )
