"""Tapes on boxes enclose what Arb computes, formulas are the potential's derivatives, and no known
solution is lost.
"""

from __future__ import annotations

import random
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from flint import arb, ctx
from support.paper_energy import bent, in_balls

from ptmcad.text.balls import ball_of

pytest.importorskip("numba")

from ptmcad.certified.contraction import contract, workspace
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.springchart import SpringChart, chart
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.formulas.ballarithmetic import run_arb
from ptmcad.formulas.graph import Formula
from ptmcad.formulas.tape import Tape, record
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice

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


def values_at(slice: Slice, x: Fraction, y: Fraction) -> dict[str, arb]:
    return in_balls(
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
            there = bent(values_at(slice, *point[:2]), *map(ball_of, point[2:]), arb)
            h11, h12, h22 = there.bends
            expected = [*there.slopes, h11, h22, h12, h11 * h22 - h12 * h12, *there.lengths]
            for place, value in zip(tape.outputs[0][: number + 3], expected, strict=True):
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


@cache
def fold_curves() -> list[CriticalCurve]:
    """The systems in the four unknowns whose solutions include all folds of minima away from short
    springs.
    """
    slice = slice_of("free02")
    return [c for count in (Count.STABLE, Count.TOTAL) for c in curves(slice, count)
            if "fold" in c.name and len(c.ranges) == 2]  # fmt: skip


def test_contraction_discards_what_holds_none() -> None:
    """Boxes around random points off the curve, small enough to be decided."""
    rng = np.random.default_rng(9)
    system = fold_curves()[0].system.arguments
    work = workspace(system, 4)
    gone = 0
    for _ in range(200):
        point = np.array([*rng.uniform(0.1, 1.9, 2), *rng.uniform(-3, 3, 2)])
        gone += not contract(system, point - 1e-3, point + 1e-3, work)
    assert gone > 190
