"""Axes that are solved for: the quotients are the equations', and no solution is lost, least where
a slope vanishes.
"""

from __future__ import annotations

import random

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("numba")

from ptmcad.certified.contraction import contract, workspace
from ptmcad.certified.enclosedline import on_line
from ptmcad.certified.equationsystem import quotients, system
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.springchart import SpringChart, chart
from ptmcad.formulas.graph import Formula, Graph
from ptmcad.formulas.intervalarithmetic import run
from ptmcad.formulas.tape import record
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice

Floats = NDArray[np.float64]
LINEAR = {
    "F": {"F3": "F", "F4": "2*F/rho"},
    "Fx": {"F3x": "Fx", "F4": "-10"},
    "l0": {"F3": "-10", "F4": "-7"},
    "l0_2": {"F3": "-10", "F4": "-7"},
    "k3": {"F3": "-10", "F4": "-7"},
}
"""Axes that E1 or E2 is linear in, with further parameters."""


def slice_of(horizontal: str, vertical: str, **given: str) -> Slice:
    parameters = {
        "L1": "1",
        "L2": "3/2",
        "k1": "100",
        "k2": "90",
        "k3": "80",
        "l0_1": "1/5",
        "l0_3": "1/4",
    } | given
    if "l0" in (horizontal, vertical):
        parameters = {n: v for n, v in parameters.items() if not n.startswith("l0_")}
    window = {
        horizontal: ["1/20", "2"],
        vertical: ["0" if vertical.startswith("l0") else "-30", "1"],
    }
    if vertical == "k3":
        parameters.pop("k3")
        window[vertical] = ["10", "100"]
    return slice_from_mapping({"name": "s", "parameters": parameters, "axes": window})


def chart_of(slice: Slice) -> SpringChart:
    return chart(geometry(problem_of(slice), slice.axes))


def values(formulas: list[Formula], point: list[float]) -> Floats:
    tape = record([formulas])
    low, high = np.empty((2, len(tape)))
    assert run(tape.program, np.array(point), np.array(point), low, high, 0, len(tape))
    return np.asarray((low[tape.outputs[0]] + high[tape.outputs[0]]) / 2)


@pytest.mark.parametrize("axis", LINEAR)
def test_rest_and_slope_are_the_equation(axis: str) -> None:
    m = chart_of(slice_of("rho", axis, **LINEAR[axis]))
    formulas = [*m.equations, *m.dependent]
    found = [(f, q) for f in formulas for q in quotients([f], (0, 1))]
    assert len(found) >= 2
    assert {variable for _, (variable, _, _) in found} == {1}
    rng = random.Random(2)
    for formula, (_, *quotient) in found:
        for _ in range(5):
            point = [
                rng.uniform(0.1, 2),
                rng.uniform(0.1, 1),
                rng.uniform(-3, 3),
                rng.uniform(-3, 3),
            ]
            whole, rest, slope = values([formula, *quotient], point)
            assert abs(rest + slope * point[1] - whole) < 1e-9 * (1 + abs(whole))
            point[1] += 7
            assert values(quotient, point).tolist() == [rest, slope]


def test_what_is_not_linear_is_left_alone() -> None:
    m = chart_of(slice_of("rho", "F", F3="F^2", F4="F^3"))
    assert quotients([*m.equations, *m.dependent], (0, 1)) == ()
    graph = Graph()
    x, y, t = (graph.variable(k) for k in range(3))
    assert quotients([x + t, y * y, t.cos() + t, (x * t) / y], (1,)) == ()
    assert quotients([x * t / y], (0, 1)) != ()


def test_a_solution_at_which_the_slope_is_zero_is_kept() -> None:
    """t (y - 1) = 0 and x + t y = 0 at t = 0 and x = 0, whatever y is: the rests are zero there,
    too.
    """
    graph = Graph()
    x, y, t = (graph.variable(k) for k in range(3))
    equations = [t * y - t, x + t * y]
    arguments = system(equations, (0, 1, 2), solved=quotients(equations, (0, 1))).arguments
    assert len(arguments.solved) == 3
    for width in (0.0, 1e-9, 0.25):
        low, high = np.array([-width, 0.0, -1.0]), np.array([width, 3.0, 1.0])
        assert contract(arguments, low, high, workspace(arguments, 3))
        assert (low <= 0).tolist() == [True, True, True]
        assert (high >= [0, 3, 0]).all()
        point = np.array([0.0, 2.5, 0.0])
        assert contract(arguments, point.copy(), point.copy(), workspace(arguments, 3))


def test_a_value_that_is_given_is_not_narrowed() -> None:
    """On a line one axis is floats around a number: what the equations say of it would leave the
    number out.
    """
    curve = curves(slice_of("rho", "F", F3="F", F4="F"), Count.STABLE)[0]
    assert set(curve.system.arguments.solved[:, 0].tolist()) == {1}
    assert set(on_line(curve.system, 1).arguments.solved[:, 0].tolist()) == {1}
    system = on_line(curve.system, 0)
    assert len(system.arguments.solved) == 0
    value = np.nextafter(-10.0, [-11, -9])
    low, high = np.array([0.05, value[0], -3.0, -3.0]), np.array([2.0, value[1], 3.3, 3.3])
    arguments = system.arguments
    contract(arguments, low, high, workspace(arguments, 4))
    assert (low[1], high[1]) == tuple(value)
