"""Tapes on boxes enclose what Arb computes, formulas are the potential's derivatives, and no known
solution is lost.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from flint import arb, ctx
from numpy.typing import NDArray
from support.paper_energy import PaperEnergy, energy_at

from ptmcad.text.balls import ball_of

pytest.importorskip("numba")

from ptmcad.certified.branchandprune import search_curve
from ptmcad.certified.contraction import contract, workspace
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.springchart import SpringChart, chart
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.formulas.ballarithmetic import run_arb
from ptmcad.formulas.graph import Formula
from ptmcad.formulas.intervalarithmetic import program, run
from ptmcad.formulas.tape import Tape, record
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice

Floats = NDArray[np.float64]
SLICES = {
    "free02": {"L1": "1", "k": "100", "F3": "-10", "F4": "-10", "l0": "1/5"},
    "all different": {
        "L1": "4/5", "k1": "90", "k2": "110", "k3": "70", "F3": "-10", "F4": "7", "F3x": "3", "F4x": "-2",
        "l0_1": "1/3", "l0_2": "1/7", "l0_3": "rho/4",
    },
}  # fmt: skip


def slice_of(name: str) -> Slice:
    return slice_from_mapping(
        {
            "name": "s",
            "parameters": SLICES[name],
            "axes": {"rho": ["1/20", "2"], "L2": ["1/20", "2"]},
        }
    )


def differentiable(m: SpringChart) -> list[Formula]:
    (p11, q), (_, p22) = m.hessian
    return [*m.equations, p11, p22, q, m.determinant()]


def tape_of(name: str) -> tuple[Tape, int]:
    """Both slopes, the Hessian and its determinant, then the lengths; and derivatives of all six,
    row by row.
    """
    m = chart(geometry(problem_of(slice_of(name))))
    graph = m.equations[0].graph
    wanted = differentiable(m)
    gradients = [graph.derivative(f, variable) for f in wanted for variable in range(4)]
    return record([[*wanted, *m.lengths, *gradients]]), len(wanted)


def random_boxes(rng: random.Random, number: int) -> Iterator[tuple[list[float], list[float]]]:
    """Boxes of all sizes; many of them around configurations in which springs are short."""
    for k in range(number):
        x, y = rng.uniform(0.05, 2), rng.uniform(0.05, 2)
        if k % 3 == 0:
            y = x * (1 + rng.choice([0, 1e-9, 1e-3, -1e-2]))
        th1, th2 = (
            rng.uniform(-3.2, 3.3),
            rng.choice([0.0, rng.uniform(-3.2, 3.3), rng.uniform(-1e-3, 1e-3)]),
        )
        middle = [x, y, th1, th2]
        radius = [10 ** rng.uniform(-14, 0) for _ in range(4)]
        if k % 5 == 0:
            radius = [0.0] * 4
        yield (
            [m - r for m, r in zip(middle, radius, strict=True)],
            [m + r for m, r in zip(middle, radius, strict=True)],
        )


@pytest.mark.parametrize("name", SLICES)
@pytest.mark.slow_cases("all different")
def test_a_tape_encloses_all_its_nodes(name: str) -> None:
    """Every node, at corners and at random points of each box, in Arb with 200 bits."""
    rng = random.Random(3)
    tape, _ = tape_of(name)
    code, (low, high) = program(tape), np.empty((2, len(tape)))
    for box_low, box_high in random_boxes(rng, 120):
        assert run(code, np.array(box_low), np.array(box_high), low, high, 0, len(tape))
        for k in range(3):
            shares = [
                Fraction(rng.choice([0, 1])) if k == 0 else Fraction(rng.random()) for _ in range(4)
            ]
            point = [
                Fraction(a) + (Fraction(b) - Fraction(a)) * s
                for a, b, s in zip(box_low, box_high, shares, strict=True)
            ]  # fmt: skip
            with ctx.workprec(200):
                values = run_arb(tape, [ball_of(p) for p in point], 200)
                for place, value in enumerate(values):
                    if value.is_finite():
                        bounds = float(low[place]), float(high[place])
                        assert not value < bounds[0], (place, tape.operations[place])
                        assert not value > bounds[1], (place, tape.operations[place])


def energy(slice: Slice, x: Fraction, y: Fraction) -> PaperEnergy:
    return energy_at(
        lambda n: slice.parameters[n].evaluate(x, y) if n in slice.parameters else Fraction(0)
    )


@pytest.mark.parametrize("name", SLICES)
def test_formulas_are_those_of_the_verification(name: str) -> None:
    """Unit vectors against square roots, which were written down apart."""
    rng = random.Random(4)
    tape, number = tape_of(name)
    slice = slice_of(name)
    for _ in range(20):
        point = [Fraction(rng.randint(60, 1990), 1000) for _ in range(2)]
        point += [Fraction(rng.randint(-3100, 3100), 1000) for _ in range(2)]
        with ctx.workprec(200):
            values = run_arb(tape, [ball_of(p) for p in point], 200)
            there = energy(slice, point[0], point[1])
            d = there(ball_of(point[2]), ball_of(point[3]))
            bar1, bar2 = there.bars
            h11, h22, h12 = bar1 * d.e11, bar2 * d.e22, bar1 * d.e12
            expected = [bar1 * d.e1, bar2 * d.e2, h11, h22, h12, h11 * h22 - h12 * h12]
            lengths = [q.sqrt() for q in there.squares(ball_of(point[2]), ball_of(point[3]))]
            for place, value in zip(
                tape.outputs[0][: number + 3], [*expected, *lengths], strict=True
            ):
                assert abs(values[int(place)] - value) < 1e-40


@pytest.mark.parametrize("name", SLICES)
def test_derivatives_against_divided_differences(name: str) -> None:
    rng = random.Random(5)
    tape, number = tape_of(name)
    outputs = [int(p) for p in tape.outputs[0]]
    with ctx.workprec(300):
        h = arb(2) ** -70
        for _ in range(5):
            point = [ball_of(Fraction(rng.randint(60, 1990), 1000)) for _ in range(2)]
            point += [ball_of(Fraction(rng.randint(-3100, 3100), 1000)) for _ in range(2)]
            here = run_arb(tape, point, 300)
            for variable in range(4):
                ends = []
                for side in (1, -1):
                    moved = list(point)
                    moved[variable] += side * h
                    ends.append(run_arb(tape, moved, 300))
                for k in range(number):
                    difference = (ends[0][outputs[k]] - ends[1][outputs[k]]) / (2 * h)
                    derivative = here[outputs[number + 3 + 4 * k + variable]]
                    assert abs(difference - derivative) < 1e-28 * (1 + abs(derivative)) * 2**20


def fold_points(slice: Slice, count: int) -> list[Floats]:
    """Folds of a minimum and a saddle, by Newton's method for (e1, e2, det) at random abscissae,
    from random starts.
    """
    rng = np.random.default_rng(6)

    def equations(x: float, z: Floats) -> Floats:
        d = energy(slice, Fraction(x), Fraction(float(z[0])))(arb(float(z[1])), arb(float(z[2])))
        return np.array([float(v.mid()) for v in (d.e1, d.e2, d.e11 * d.e22 - d.e12 * d.e21)])

    found: list[Floats] = []
    while len(found) < count:
        x = float(rng.uniform(0.1, 1.9))
        z = np.array([rng.uniform(0.1, 1.9), rng.uniform(-3, 3), rng.uniform(-3, 3)])
        for _ in range(40):
            if not (0.06 < z[0] < 1.99):
                break
            value = equations(x, z)
            jacobian = np.empty((3, 3))
            for j in range(3):
                step = np.zeros(3)
                step[j] = 1e-7
                jacobian[:, j] = (equations(x, z + step) - equations(x, z - step)) / 2e-7
            try:
                move = np.linalg.solve(jacobian, value)
            except np.linalg.LinAlgError:
                break
            z = z - np.clip(move, -0.3, 0.3)
            if np.abs(move).max() < 1e-12:
                turned = (z[1:] + 3) % (2 * np.pi) - 3
                here = np.array([x, z[0], *turned])
                d = energy(slice, Fraction(x), Fraction(float(z[0])))(
                    arb(float(turned[0])), arb(float(turned[1]))
                )
                if 0.06 < z[0] < 1.99 and d.e11 > 1e-3 and d.e22 > 1e-3:
                    found.append(here)
                break
    return found


@pytest.fixture(scope="module")
def folds() -> list[Floats]:
    return fold_points(slice_of("free02"), 8)


FOLDS = 2
"""How many systems there are, which are not made before they are asked for."""


@cache
def fold_curves() -> list[CriticalCurve]:
    """The systems in the four unknowns whose solutions include all folds of minima away from short
    springs.
    """
    slice = slice_of("free02")
    return [c for count in (Count.STABLE, Count.TOTAL) for c in curves(slice, count)
            if "fold" in c.name and len(c.ranges) == 2]  # fmt: skip


@pytest.mark.parametrize("number", range(FOLDS))
@pytest.mark.slow
def test_contraction_keeps_known_folds(number: int, folds: list[Floats]) -> None:
    assert len(fold_curves()) == FOLDS
    rng = np.random.default_rng(8)
    system = fold_curves()[number].system.arguments()
    work = workspace(system, 4)
    kept = narrowed = 0
    for point in folds:
        if number and _shortest(point) < 0.1:
            continue  # this system's domain leaves them to another one
        for _ in range(60):
            size = 10 ** rng.uniform(-8, 0.3, 4)
            share = rng.uniform(0, 1, 4)
            low, high = point - size * share - 1e-9, point + size * (1 - share) + 1e-9
            before = (high - low).prod()
            assert contract(system, low, high, work)
            assert (low <= point + 1e-10).all()
            assert (high >= point - 1e-10).all()
            kept += 1
            narrowed += bool((high - low).prod() < 0.5 * before)
    assert kept > 100
    assert narrowed > kept // 4, "nothing is contracted, so that nothing is tested"


def _shortest(point: Floats) -> float:
    there = energy(slice_of("free02"), Fraction(float(point[0])), Fraction(float(point[1])))
    return min(
        float(q.mid()) ** 0.5 for q in there.squares(arb(float(point[2])), arb(float(point[3])))
    )


def test_contraction_discards_what_holds_none() -> None:
    """Boxes around random points off the curve, small enough to be decided."""
    rng = np.random.default_rng(9)
    system = fold_curves()[0].system.arguments()
    work = workspace(system, 4)
    gone = 0
    for _ in range(200):
        point = np.array([*rng.uniform(0.1, 1.9, 2), *rng.uniform(-3, 3, 2)])
        gone += not contract(system, point - 1e-3, point + 1e-3, work)
    assert gone > 190


def test_search_keeps_known_folds(folds: list[Floats]) -> None:
    """Around each fold a part of the window is searched, and one of the boxes that are left has it."""
    curve = fold_curves()[0]
    for point in folds:
        window = np.array([[point[0] - 0.02, point[1] - 0.013, point[0] + 0.011, point[1] + 0.017]])
        boxes = search_curve(
            curve.system.arguments(), curve.start(window), 1e-6, 20_000, curve.importance()
        ).left()
        inside = (boxes[:, :4] <= point + 1e-9).all(axis=1) & (boxes[:, 4:] >= point - 1e-9).all(
            axis=1
        )
        assert inside.any()
