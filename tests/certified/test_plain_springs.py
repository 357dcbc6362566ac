"""What the plain formulas say of springs: determinants bent by them, and what holds at equilibria
only.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import atan2, hypot
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from test_plain_formulas import PLAIN_PTM

import ptmcad
from ptmcad.certified.plain.divisors import common_factor
from ptmcad.certified.plain.geometry import common_factors, geometry
from ptmcad.certified.plain.problem import Problem, problem_of
from ptmcad.certified.plain.springchart import SpringChart, chart, principal_minors
from ptmcad.formulas.graph import Formula, Operation
from ptmcad.formulas.intervalarithmetic import run
from ptmcad.formulas.tape import record
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import axis, constant

THREE_BARS: dict[str, Any] = yaml.safe_load("""
name: three_bars
mechanism:
  name: three_bars
  parameters: {a: {kind: length}, b: {kind: length}}
  unknowns: {r: angle, s: angle, t: angle}
  points:
    O: [0, 0]
    A: [1, 1/2]
    P: [a*cos(r), a*sin(r)]
    Q: [a*cos(r) + b*cos(s), a*sin(r) + b*sin(s)]
    R: [a*cos(r) + b*cos(s) + cos(t), a*sin(r) + b*sin(s) + sin(t)]
  bars: [[O, P], [P, Q], [Q, R]]
  springs:
    - {between: [A, P], k: 1, free: 1/2}
    - {between: [A, Q], k: 2, free: 1/3}
    - {between: [A, R], k: 3, free: 1/4}
    - {between: [P, R], k: 1, free: 1/5}
axes: {a: [0, 2], b: [0, 2]}
count: index
""")
POINT = np.array([0.7, 1.5, 0.4, -1.1, 0.9, 0.0])


def charts(record: dict[str, Any], short: int | None = None) -> tuple[Problem, SpringChart]:
    slice = slice_from_mapping(record)
    problem = problem_of(slice)
    return problem, chart(geometry(problem, slice.axes), short)


def values(formulas: Sequence[Formula], at: NDArray[np.float64]) -> NDArray[np.float64]:
    tape = record([formulas])
    low, high = np.empty((2, len(tape)))
    assert run(tape.program, at, at, low, high, 0, len(tape))
    found: NDArray[np.float64] = (low[tape.outputs[0]] + high[tape.outputs[0]]) / 2
    return found


def matrix(at: SpringChart, point: NDArray[np.float64]) -> NDArray[np.float64]:
    return values([entry for row in at.hessian for entry in row], point).reshape(
        len(at.hessian), -1
    )


@pytest.mark.parametrize("mechanism", [PLAIN_PTM, THREE_BARS])
def test_matrix_is_the_derivative_of_the_equations(mechanism: dict[str, Any]) -> None:
    problem, at = charts(mechanism)
    graph = at.equations[0].graph
    slopes = [graph.derivative(f, k) for f in at.equations for k in problem.variables]
    assert values(slopes, POINT) == pytest.approx(matrix(at, POINT).ravel(), rel=1e-9)


@pytest.mark.parametrize("mechanism", [PLAIN_PTM, THREE_BARS])
@pytest.mark.slow_cases("mechanism1")
def test_determinant_in_a_chart_is_that_times_the_length(mechanism: dict[str, Any]) -> None:
    problem, direct = charts(mechanism)
    phi = 2 + len(problem.unknowns)
    for s in range(len(problem.cones)):
        _, turned = charts(mechanism, s)
        x, y = values(turned.cones[s].vector, POINT)
        point = POINT.copy()
        point[phi] = atan2(y, x)
        length = hypot(x, y)
        found = values(
            [turned.determinant(), turned.aligned, turned.cones[s].extent, *turned.equations], point
        )
        assert found[0] == pytest.approx(np.linalg.det(matrix(direct, POINT)) * length, rel=1e-9)
        assert found[1:3] == pytest.approx([0, length], abs=1e-12)
        assert found[3:] == pytest.approx(values(direct.equations, POINT), rel=1e-9)


def equilibria(at: SpringChart, number: int) -> list[NDArray[np.float64]]:
    """Points in the axes and the unknowns, by Newton's method."""
    generator = np.random.default_rng(1)
    found: list[NDArray[np.float64]] = []
    unknowns = slice(2, 2 + len(at.equations))
    while len(found) < number:
        point = np.array([0.7, 1.5, *generator.uniform(-3, 3, len(at.equations))])
        for _ in range(40):
            point[unknowns] -= np.linalg.solve(matrix(at, point), values(at.equations, point))
        if abs(values(at.equations, point)).max() < 1e-10:
            found.append(point)
    return found


@pytest.mark.parametrize("mechanism", [PLAIN_PTM, THREE_BARS])
@pytest.mark.slow_cases("mechanism1")
def test_what_holds_at_equilibria_holds_there_and_nowhere_else(mechanism: dict[str, Any]) -> None:
    _, at = charts(mechanism)
    number = len(at.cones)
    exact = [at.determinant(), *principal_minors(at.hessian)]
    there = [at.determinant(at_equilibrium=True), *principal_minors(at.matrix_at_equilibrium())]
    times = [f for s in range(number) for f in at.diagonal_times_length(s)]
    diagonal = [
        at.cones[s].extent * at.hessian[i][i] for s in range(number) for i in at.cones[s].active
    ]
    zero = [*at.dependent, *at.balances]
    for point in equilibria(at, 4):
        # only equal operands of meets give a value
        assert values(_open(there + times), point) == pytest.approx(
            values(exact + diagonal, point), rel=1e-4, abs=1e-4
        )
        assert values(zero, point) == pytest.approx([0.0] * len(zero), abs=1e-6)
    assert abs(values(zero, POINT)).min() > 1e-6
    assert values(_open(there), POINT) != pytest.approx(values(exact, POINT), rel=1e-2)


def _open(formulas: Sequence[Formula]) -> list[Formula]:
    """The formulas with the second operand of each meet, the one that holds at equilibria, in its
    place.
    """
    graph = formulas[0].graph
    made: dict[int, Formula] = {}
    for node in list(graph.nodes):
        operands = tuple(made[n.number] for n in (node.a, node.b) if n is not None)
        if node.operation is Operation.MEET:
            made[node.number] = operands[1]
        elif operands == tuple(n for n in (node.a, node.b) if n is not None):
            made[node.number] = node
        else:
            made[node.number] = graph.node(node.operation, *operands)
    return [made[f.number] for f in formulas]


def test_bars_that_turn_by_one_angle_leave_the_base_only() -> None:
    slice = slice_from_mapping(PLAIN_PTM)
    (loaded,) = geometry(problem_of(slice), slice.axes).turns
    assert loaded.weights == (1, -1) and loaded.factor == constant(1)
    assert [len(f.terms) for _, e, _ in loaded.levers for f in e] == 3 * [0, 1]
    unloaded = slice_from_mapping({**PLAIN_PTM, "parameters": {"L1": 1, "k": 100, "l0": "1/5"}})
    (free,) = geometry(problem_of(unloaded), unloaded.axes).turns
    assert free.factor == axis(0)


def test_determinants_by_turning_and_levelled_hold_at_equilibria() -> None:
    _, at = charts(PLAIN_PTM)
    (by_turning,) = at.determinants_by_turning()
    for point in equilibria(at, 4):
        determinant = np.linalg.det(matrix(at, point))
        lengths, (_, second) = values(at.lengths, point), values(at.scales, point)
        found = values(_open([by_turning, at.levelled()]), point)
        assert found == pytest.approx(
            [determinant * second, determinant * lengths.prod()], rel=1e-4, abs=1e-4
        )


def test_a_matrix_that_is_not_symmetric_has_no_determinant_by_turning() -> None:
    mechanism = {**PLAIN_PTM["mechanism"], "moments": {"th1": "sin(th2)"}}
    _, at = charts({**PLAIN_PTM, "mechanism": mechanism, "count": "total"})
    assert at.turned and not list(at.determinants_by_turning())


def test_no_equation_has_a_formula_in_it_that_holds_at_equilibria_only() -> None:
    _, at = charts(PLAIN_PTM)
    tape = record([[*at.equations, at.determinant(), *(f for row in at.hessian for f in row)]])
    assert int(Operation.MEET) not in tape.program.operations
    assert int(Operation.MEET) in record([[at.determinant(at_equilibrium=True)]]).program.operations


def test_a_spring_that_nothing_balances_tells_no_direction() -> None:
    """Two springs to opposite pivots: without the second one's free length the rest of the first
    one's equation is 0.

    Where the first one's stiffness is zero, every configuration is an equilibrium, which 0/0 must
    not exclude.
    """
    springs = [
        {"between": [end, "P"], "k": "k", "free": free} for end, free in (("A", "1/2"), ("B", 0))
    ]
    opposite = slice_from_mapping({
        "name": "opposite",
        "mechanism": {
            "name": "opposite",
            "parameters": {"k": {"kind": "stiffness"}, "b": {"kind": "length"}},
            "unknowns": {"t": "angle"},
            "points": {"O": [0, 0], "A": ["b", 0], "B": ["-b", 0], "P": ["cos(t)", "sin(t)"]},
            "bars": [["O", "P"]],
            "springs": springs,
        },
        "axes": {"k": [0, 1], "b": [2, 3]},
    })  # fmt: skip
    problem = problem_of(opposite)
    assert [cone.name for cone in problem.cones] == ["k"]
    tape = record(
        [[entry for row in chart(geometry(problem)).matrix_at_equilibrium() for entry in row]]
    )
    assert int(Operation.DIVIDE) not in tape.program.operations


def test_equations_are_divided_by_what_is_positive_in_the_open_window() -> None:
    slice = slice_from_mapping(PLAIN_PTM)
    assert common_factors(problem_of(slice), slice.axes) == (constant(1), axis(1))
    assert common_factors(problem_of(slice_from_mapping(THREE_BARS)), slice.axes) == (
        axis(0),
        axis(1),
        constant(1),
    )


@pytest.mark.parametrize(("low", "factor"), [(0, 4 * axis(1)), (1, 4 * axis(1)), (-1, constant(1))])
def test_a_factor_that_may_be_zero_stays(low: int, factor: Any) -> None:
    """Where it is zero every configuration is an equilibrium: without the factor the map would have
    counts there.
    """
    slice = factored(low)
    (found,) = common_factors(problem_of(slice), slice.axes)
    assert found.is_constant == factor.is_constant and (found / factor).is_constant


def factored(low: int) -> Slice:
    system = {"unknowns": {"t": "angle"}, "potential": "b*cos(t) + a*b*cos(2*t)"}
    return slice_from_mapping(
        {"name": "f", "system": system, "axes": {"a": [0, 1], "b": [low, 2]}, "count": "index"}
    )


def test_points_at_which_all_configurations_are_equilibria_stay_undetermined() -> None:
    result = ptmcad.classify(factored(-1), engine="certified", tolerance="1/20")
    assert all(result.locate(a=a, b=0).index is None for a in ("1/7", "1/2", "6/7"))
    assert result.locate(a="1/7", b=1).index == (1, 1)


def test_a_negative_factor_is_taken_out_with_its_sign() -> None:
    slice = factored(-1)
    below = tuple(
        a if k == 0 else type(a)(a.name, Fraction(-2), Fraction(0))
        for k, a in enumerate(slice.axes)
    )
    factor = common_factor(problem_of(slice).equations, below)  # type: ignore[arg-type]
    assert factor.evaluate(Fraction(1, 2), Fraction(-1)) > 0
